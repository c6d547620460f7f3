"""The law of processes: one speed of the tool along the path, with smooth ramps at both ends.

All in closed form: at a steady speed v a limit reads v |q'| <= limit, v^2 |q''| <= limit or
v^3 |q'''| <= limit, and a torque is static + v^2 b. Along a ramp the speed is v (3 t^2 - 2 t^3).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

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

_PER_INTERVAL = 4  # places between grid points at which limits are looked at
_SAMPLES = np.linspace(0.0, 1.0, 129)  # of a ramp, as shares of its time
_HALVINGS = 30  # of a ramp's time, and of the feed where ramps do not fit
_CLOSE = 0.01  # share to which the time of a ramp is found
_RAMP = Polynomial([0.0, 0.0, 0.0, 1.0, -0.5])  # place in v T over t / T, from rest


@dataclass(frozen=True)
class FeedLimit:
    """The largest constant feed, and what stops it.

    Attributes:
        feed: [m/s].
        joint: Name of the joint.
        kind: Which of its limits; a ramp to this feed is what does not fit if `by_ramp`.
        arc_length: Where [m].
        by_ramp: A larger feed could be held, but not reached on this path.
    """

    feed: float
    joint: str
    kind: Kind
    arc_length: float
    by_ramp: bool = False

    @property
    def reason(self) -> str:
        """What stops a larger feed, in words."""
        if self.by_ramp:
            return (
                f"ramps to more do not fit on the path; what most limits them is the {self.kind} "
                f"of {self.joint}"
            )
        return f"{self.joint} stops it by its {self.kind} limit at {self.arc_length:.4f} m"


class _Places:
    """Derivatives and rows at places (m,) along a curve."""

    def __init__(self, curve: JointCurve, limits: Limits, torques: Torques) -> None:
        self.curve, self.limits = curve, limits
        self.s = curve.places(_PER_INTERVAL)
        self.slopes = [curve.at(self.s, order) for order in (1, 2, 3)]
        only = replace(limits, kinds=("torque",) if "torque" in limits.kinds else ())
        self.by_u, self.by_x, self.room = limit_rows(curve, only, torques, self.s)

    def slowness(self, kind: Kind) -> Array:
        """Return 1 / v (m, n) of the largest steady speed v at which one limit holds [s/m]."""
        if kind == "torque":
            both = np.sqrt(np.maximum(self.by_x, 0.0) / self.room)
            n = len(self.limits.joints)
            return np.asarray(np.maximum(both[:, :n], both[:, n:]))
        order = {"velocity": 1, "acceleration": 2, "jerk": 3}[kind]
        slow: Array = (np.abs(self.slopes[order - 1]) / self.limits.of(kind)) ** (1.0 / order)
        return slow

    def largest_feed(self) -> FeedLimit:
        """Return the largest speed that can be held everywhere."""
        slowness = {kind: self.slowness(kind) for kind in self.limits.kinds}
        kind = max(slowness, key=lambda each: float(slowness[each].max()))
        i, j = np.unravel_index(int(np.argmax(slowness[kind])), slowness[kind].shape)
        at = float(self.curve.relative.arc_length(self.s[i : i + 1])[0])
        return FeedLimit(1.0 / float(slowness[kind][i, j]), self.limits.joints[j], kind, at)

    def ramp_use(self, v: float, time: float, at_end: bool) -> dict[Kind, Array]:
        """Return the largest share of each limit (n,) that a ramp from rest to v takes.

        A ramp down is one up, backwards: its jerk is the same, its odd derivatives turn.
        """
        length = self.curve.relative.length
        way = v * time * _RAMP(_SAMPLES)
        place = np.minimum(length - way if at_end else way, length)
        k = np.clip(np.searchsorted(self.s, place), 1, len(self.s) - 1)
        k -= place - self.s[k - 1] < self.s[k] - place
        sign = -1.0 if at_end else 1.0
        speed, u, j = (
            (v / time ** (order - 1) * _RAMP.deriv(order)(_SAMPLES))[:, None] for order in (1, 2, 3)
        )
        u = sign * u
        d1, d2, d3 = (slope[k] for slope in self.slopes)
        rates: dict[Kind, Array] = {
            "velocity": d1 * speed,
            "acceleration": d2 * speed**2 + d1 * u,
            "jerk": d3 * speed**3 + 3.0 * d2 * speed * u + d1 * j,
        }
        use: dict[Kind, Array] = {
            kind: (np.abs(rate) / self.limits.of(kind)).max(axis=0)
            for kind, rate in rates.items()
            if kind in self.limits.kinds
        }
        if "torque" in self.limits.kinds:
            dynamic = (self.by_u[k] * u + self.by_x[k] * speed**2) / self.room[k]
            use["torque"] = np.maximum(*np.split(dynamic.max(axis=0), 2))
        return use


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
            stops it where. Or gravity and the tool force alone are above the limit of a joint.
    """
    places = _Places(curve, limits, torques)
    stop = places.largest_feed()
    ramps = _ramps(places, stop.feed)
    if ramps is None:
        stop, ramps = _largest_with_ramps(places, stop)
    if feed is None:
        return _schedule(curve.relative.length, stop.feed, ramps), stop
    ramps = _ramps(places, feed) if feed <= stop.feed else None
    if ramps is None:
        raise InputError(
            f"a feed of {feed:g} m/s cannot be held: the largest is {stop.feed:.6g} m/s; "
            f"{stop.reason}",
            field="motion.feed",
        )
    return _schedule(curve.relative.length, feed, ramps), stop


def _largest_with_ramps(places: _Places, stop: FeedLimit) -> tuple[FeedLimit, tuple[float, float]]:
    """Return the largest feed to which ramps fit, and their times."""
    low, high, ramps = 0.0, stop.feed, None
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        found = _ramps(places, middle)
        if found is None:
            high = middle
        else:
            low, ramps = middle, found
    if ramps is None:
        raise InputError("no ramp from rest fits on this path", field="motion.feed")
    # What holds the faster of the two ramps back is what stops a larger feed.
    end = ramps[1] > ramps[0]
    use = places.ramp_use(low, max(ramps), end)
    kind = max(use, key=lambda each: float(use[each].max()))
    at = places.curve.task.path.length if end else 0.0
    joint = places.limits.joints[int(np.argmax(use[kind]))]
    return FeedLimit(low, joint, kind, at, by_ramp=True), ramps


def _ramps(places: _Places, v: float) -> tuple[float, float] | None:
    """Return the shortest times of both ramps to v; None if they do not fit on the path."""
    if not rests(places.limits):
        return 0.0, 0.0
    longest = 2.0 * places.curve.relative.length / v
    times = []
    for at_end in (False, True):
        low, high, holds = 0.0, longest, False
        for _ in range(_HALVINGS):
            if holds and high - low < _CLOSE * high:
                break
            time = high if not holds and low == 0.0 else 0.5 * (low + high)
            fine = all(share.max() <= 1.0 for share in places.ramp_use(v, time, at_end).values())
            if fine:
                high, holds = time, True
            elif not holds:
                return None
            else:
                low = time
        times.append(high)
    return (times[0], times[1]) if sum(times) < longest else None


def _schedule(length: float, v: float, ramps: tuple[float, float]) -> Schedule:
    up, down = ramps
    cruise = length / v - 0.5 * (up + down)
    pieces, times = [Polynomial([0.5 * v * up, v])], [cruise]
    if up > 0.0:
        pieces.insert(0, v * up * _RAMP(Polynomial([0.0, 1.0 / up])))
        times.insert(0, up)
    if down > 0.0:
        pieces.append(length - v * down * _RAMP(Polynomial([1.0, -1.0 / down])))
        times.append(down)
    c = np.array([np.pad(piece.coef, (0, 5 - len(piece.coef)))[::-1] for piece in pieces]).T
    return Schedule(PPoly(c, np.concatenate([[0.0], np.cumsum(times)])))
