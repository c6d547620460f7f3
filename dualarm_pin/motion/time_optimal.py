"""The fastest law that all limits allow, and its smoothing where jerk is limited."""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.motion.joint_curve import JointCurve
from dualarm_pin.motion.limits import Limits
from dualarm_pin.motion.recursion import fastest
from dualarm_pin.motion.schedule import Schedule
from dualarm_pin.motion.torque import Torques
from dualarm_pin.motion.use import use_of

_PER_INTERVAL = 3  # of the law to one of the grid: rows at their ends then miss little inside
# Windows of the smoothing, as shares of the duration: the best of them is taken.
_WINDOWS = np.geomspace(0.003, 0.3, 14)
_FAR = 1e12  # stands for no limit of the speed, squared [m^2/s^2]


def time_optimal(
    curve: JointCurve, limits: Limits, torques: Torques, feed: float = np.inf
) -> Schedule:
    """Return the fastest schedule on the grid of a curve; a dense check is the caller's.

    Args:
        curve: Joints along the path.
        limits: What the joints can do; of jerk only its part at a steady speed is kept.
        torques: What their drives hold.
        feed: Largest speed of the tool [m/s].

    Raises:
        InputError: No speed at all keeps the limits at some place.
    """
    s = curve.places(_PER_INTERVAL)
    rows = limit_rows(curve, limits, torques, s)
    first = np.abs(curve.at(s, 1))
    moving = np.maximum(first / limits.velocity, np.sqrt(1.0 / _FAR)).max(axis=1)
    most = np.minimum(moving**-2.0, feed**2)
    if "jerk" in limits.kinds:  # what a steady speed may have: smoothing alone slows all alike
        third = np.abs(curve.at(s, 3)) / limits.jerk
        most = np.minimum(most, np.maximum(third.max(axis=1), _FAR**-1.5) ** (-2.0 / 3.0))
    stuck, x = fastest(s, rows, most, rests(limits))
    if stuck < 0:
        still = np.flatnonzero((x[1:] <= 0.0) & (x[:-1] <= 0.0))
        stuck = int(still[0]) if len(still) else -1
    if stuck >= 0:
        at = float(curve.relative.arc_length(s[stuck : stuck + 1])[0])
        raise InputError(
            f"no speed keeps the limits at {at:.4f} m of the path: the joints turn too sharply "
            "there for their acceleration or torque",
            field="motion",
        )
    return Schedule.of_squares(s, x)


def rests(limits: Limits) -> bool:
    """Tell whether a motion begins and ends at rest: only if something limits how it gets there."""
    return bool({"acceleration", "torque", "jerk"} & set(limits.kinds))


def limit_rows(
    curve: JointCurve, limits: Limits, torques: Torques, s: Array
) -> tuple[Array, Array, Array]:
    """Return rows a u + b x <= g, each (len(s), m), of acceleration and torque at places s.

    Raises:
        InputError: Gravity and the tool force alone are above the limit of a joint.
    """
    d1, d2 = curve.at(s, 1), curve.at(s, 2)
    a, b, g = [], [], []
    if "acceleration" in limits.kinds:
        a, b = [d1, -d1], [d2, -d2]
        g = [np.broadcast_to(limits.acceleration, d1.shape)] * 2
    if "torque" in limits.kinds:
        q, still = curve.at(s), np.zeros_like(d1)
        masses = torques.moving(q, still, still)
        static = masses + torques.pressing(q, curve.relative.direction(s))
        _refuse_load(curve, limits, static, s)
        by_u, by_x = torques.moving(q, still, d1) - masses, torques.moving(q, d1, d2) - masses
        a += [by_u, -by_u]
        b += [by_x, -by_x]
        g += [limits.torque - static, limits.torque + static]
    if not a:
        empty = np.zeros((len(s), 0))
        return empty, empty, empty
    arrays = [np.ascontiguousarray(np.concatenate(part, axis=1)) for part in (a, b, g)]
    return arrays[0], arrays[1], arrays[2]


def _refuse_load(curve: JointCurve, limits: Limits, static: Array, s: Array) -> None:
    share = np.abs(static) / limits.torque
    if share.max() < 1.0:
        return
    i, j = np.unravel_index(int(np.argmax(share)), share.shape)
    place = curve.relative.place
    point = int(np.argmin(np.abs(place - s[i]))) + 1
    raise InputError(
        f"standing still takes {abs(static[i, j]):.4g} of {limits.torque[j]:.4g} N m (or N) of "
        f"{limits.joints[j]} near point {point}: gravity and the tool force alone are too much; "
        "give a larger `torque` in the cell file, leave torque out of motion.limits, or change the "
        "path",
        field=limits.joints[j],
    )


def smoothed(
    curve: JointCurve, schedule: Schedule, limits: Limits, torques: Torques, feed: float
) -> Schedule:
    """Return a schedule smoothed in time and slowed until the jerk limits hold too.

    The largest jerk is not convex in the law, so this is a motion that was checked, not the
    fastest one.
    """
    best = None
    for share in _WINDOWS:
        smooth = schedule.smoothed(share * schedule.duration)
        slowed = smooth.slower(use_of(curve, smooth, limits, torques, feed).slower)
        if best is None or slowed.duration < best.duration:
            best = slowed
    assert best is not None  # there are windows
    return best
