"""The law of processes: one speed of the tool along the path, with smooth ramps at both ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial
from scipy.interpolate import PPoly

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.motion.joint_curve import JointCurve
from dualarm_pin.motion.limits import Limits
from dualarm_pin.motion.schedule import Schedule
from dualarm_pin.motion.summary import Kind
from dualarm_pin.motion.time_optimal import limit_rows, rests
from dualarm_pin.motion.torque import Torques
from dualarm_pin.motion.use import use_of

_PER_INTERVAL = 4  # places between grid points at which the feed is limited
_RAMP_SAMPLES = 33
_HALVINGS = 24  # of a ramp's time, and of the feed where ramps do not fit
_RAMP = Polynomial(
    [0.0, 0.0, 0.0, 1.0, -0.5]
)  # place of a ramp in v T, over t / T: speed 3t^2-2t^3


@dataclass(frozen=True)
class FeedLimit:
    """The largest constant feed, and what stops it.

    Attributes:
        feed: [m/s].
        joint: Name of the joint.
        kind: Which of its limits.
        arc_length: Where [m].
    """

    feed: float
    joint: str
    kind: Kind
    arc_length: float


def feed_limit(curve: JointCurve, limits: Limits, torques: Torques) -> FeedLimit:
    """Return the largest speed that all limits allow everywhere, ramps left aside.

    Raises:
        InputError: Gravity and the tool force alone are above the limit of a joint.
    """
    s = curve.places(_PER_INTERVAL)
    slowness = {kind: _slowness(curve, limits, torques, kind, s) for kind in limits.kinds}
    kind = max(slowness, key=lambda each: float(slowness[each].max()))
    i, j = np.unravel_index(int(np.argmax(slowness[kind])), slowness[kind].shape)
    at = float(curve.relative.arc_length(s[i : i + 1])[0])
    return FeedLimit(1.0 / float(slowness[kind][i, j]), limits.joints[j], kind, at)


def _slowness(curve: JointCurve, limits: Limits, torques: Torques, kind: Kind, s: Array) -> Array:
    """Return 1 / v (m, n) of the largest constant speed v at which one limit holds [s/m]."""
    if kind == "torque":
        only = Limits(**{**vars(limits), "kinds": ("torque",)})
        _, b, g = limit_rows(curve, only, torques, s)
        n = len(limits.joints)
        both = np.sqrt(np.maximum(b, 0.0) / g)
        return np.maximum(both[:, :n], both[:, n:])
    order = {"velocity": 1, "acceleration": 2, "jerk": 3}[kind]
    slow: Array = (np.abs(curve.at(s, order)) / limits.of(kind)) ** (1.0 / order)
    return slow


def constant_feed(
    curve: JointCurve, limits: Limits, torques: Torques, feed: float | None
) -> tuple[Schedule, FeedLimit]:
    """Return the schedule of one feed and the largest feed there is, ramps considered.

    Args:
        curve: Joints along the path.
        limits: What the joints can do.
        torques: What their drives hold.
        feed: Wanted speed [m/s]; the largest if None.

    Raises:
        InputError: The feed cannot be reached; the message says the largest, and which joint
            stops it where.
    """
    stop = feed_limit(curve, limits, torques)
    largest = stop.feed

    def ramped(v: float) -> Schedule | None:
        return _ramped(curve, limits, torques, v)

    schedule = ramped(largest)
    if schedule is None:  # no room for such ramps
        low, high = 0.0, largest
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            found = ramped(middle)
            if found is None:
                high = middle
            else:
                low, schedule = middle, found
        largest = low
    stop = FeedLimit(largest, stop.joint, stop.kind, stop.arc_length)
    if schedule is None:
        raise InputError("no ramp fits on this path within the limits", field="motion.feed")
    if feed is None:
        return schedule, stop
    if feed > largest:
        raise InputError(
            f"a feed of {feed:g} m/s cannot be held: the largest is {largest:.6g} m/s; "
            f"{stop.joint} stops it by its {stop.kind} limit at {stop.arc_length:.4f} m",
            field="motion.feed",
        )
    schedule = ramped(feed)
    if schedule is None:
        message = f"no ramps to a feed of {feed:g} m/s fit on this path; try a smaller one"
        raise InputError(message, field="motion.feed")
    return schedule, stop


def _ramped(curve: JointCurve, limits: Limits, torques: Torques, v: float) -> Schedule | None:
    """Return the schedule with the shortest ramps that keep the limits; None if none fit."""
    length = curve.relative.length
    if not rests(limits):
        return Schedule(PPoly(np.array([[v], [0.0]]), np.array([0.0, length / v])))
    times = []
    for end in (False, True):
        low, high = 0.0, 2.0 * length / v
        for _ in range(_HALVINGS):
            if high - low < 0.01 * high and high < length / v:
                break
            ramp = 0.5 * (low + high)
            if _ramp_holds(curve, limits, torques, v, ramp, end):
                high = ramp
            else:
                low = ramp
        times.append(high)
    up, down = times
    cruise = length / v - 0.5 * (up + down)
    if cruise <= 0.0:
        return None
    pieces = [_piece(v, up, 0.0, up=True), Polynomial([0.5 * v * up, v])]
    pieces.append(_piece(v, down, length, up=False))
    c = np.array([np.pad(piece.coef, (0, 5 - len(piece.coef)))[::-1] for piece in pieces]).T
    return Schedule(PPoly(c, np.cumsum([0.0, up, cruise, down])))


def _piece(v: float, ramp: float, end: float, *, up: bool) -> Polynomial:
    """Return the place over time of a ramp from rest at `end`, or to it."""
    if up:
        return end + v * ramp * _RAMP(Polynomial([0.0, 1.0 / ramp]))
    return end - v * ramp * _RAMP(Polynomial([1.0, -1.0 / ramp]))


def _ramp_holds(
    curve: JointCurve, limits: Limits, torques: Torques, v: float, ramp: float, end: bool
) -> bool:
    piece = _piece(v, ramp, curve.relative.length if end else 0.0, up=not end)
    c = np.pad(piece.coef, (0, 5 - len(piece.coef)))[::-1, None]
    time = np.linspace(0.0, ramp, _RAMP_SAMPLES)
    schedule = Schedule(PPoly(c, np.array([0.0, ramp])))
    use = use_of(curve, schedule, limits, torques, time=time)
    return all(float(share.max()) <= 1.0 for share in use.share.values())
