"""Use: how much of each limit a motion takes, checked densely, and the slowing that heals it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.motion.joint_curve import JointCurve
from dualarm_pin.motion.limits import Limits
from dualarm_pin.motion.schedule import Schedule
from dualarm_pin.motion.summary import Kind
from dualarm_pin.motion.torque import Torques

_PER_INTERVAL = 4  # places between grid points at which limits are checked


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Joints and their derivatives at m times.

    Attributes:
        place: Place along the path (m,) [m].
        speed: Its rate (m,) [m/s].
        q: (m, n) [rad or m].
        velocity: (m, n).
        acceleration: (m, n).
        jerk: (m, n).
    """

    place: Array
    speed: Array
    q: Array
    velocity: Array
    acceleration: Array
    jerk: Array


def joints_at(curve: JointCurve, schedule: Schedule, time: Array) -> JointMotion:
    """Return the joints of a schedule at times (m,)."""
    s, v, a, j = schedule.at(time)
    s = np.clip(s, 0.0, curve.relative.length)
    v, a, j = v[:, None], a[:, None], j[:, None]
    d1, d2, d3 = (curve.at(s, order) for order in (1, 2, 3))
    return JointMotion(
        place=s,
        speed=v[:, 0],
        q=curve.at(s),
        velocity=d1 * v,
        acceleration=d2 * v**2 + d1 * a,
        jerk=d3 * v**3 + 3.0 * d2 * v * a + d1 * j,
    )


@dataclass(frozen=True, eq=False)
class Use:
    """How much of each limit a motion takes.

    Attributes:
        place: Where (m,) [m].
        share: Shares of the limits by kind (m, n), 1 is all; the feed has one column.
        pace: Factor of time by kind (m, n) at which each limit would be just met: the largest
            is what holds the motion back there. Of a torque only the part that moves counts.
    """

    place: Array
    share: dict[Kind, Array]
    pace: dict[Kind, Array]

    @property
    def paces(self) -> Array:
        """All of `pace`, kind by kind, side by side (m, columns)."""
        return np.concatenate(list(self.pace.values()), axis=1)

    @property
    def slower(self) -> float:
        """Factor of time that brings every share to 1 or less."""
        return max(1.0, *(float(pace.max()) for pace in self.pace.values()))


def use_of(
    curve: JointCurve,
    schedule: Schedule,
    limits: Limits,
    torques: Torques,
    feed: float = np.inf,
) -> Use:
    """Return how much of each limit a schedule uses, looking densely everywhere.

    Args:
        curve: Joints along the path.
        schedule: Place over time.
        limits: What the joints can do.
        torques: What their drives hold.
        feed: Largest speed of the tool [m/s].
    """
    reached = schedule.times_of(curve.places(_PER_INTERVAL))
    time = np.unique(np.concatenate([schedule.dense(), reached]))
    motion = joints_at(curve, schedule, time)
    share: dict[Kind, Array] = {}
    pace: dict[Kind, Array] = {}
    powers: dict[Kind, float] = {"velocity": 1.0, "acceleration": 2.0, "jerk": 3.0}
    for kind, power in powers.items():
        if kind in limits.kinds:
            share[kind] = np.abs(getattr(motion, kind)) / limits.of(kind)
            pace[kind] = share[kind] ** (1.0 / power)
    if np.isfinite(feed):
        share["feed"] = pace["feed"] = np.abs(motion.speed[:, None]) / feed
    if "torque" in limits.kinds:
        u = curve.relative.direction(motion.place)
        static = torques.static(motion.q, u)
        dynamic = torques.moving(motion.q, motion.velocity, motion.acceleration)
        dynamic -= torques.moving(motion.q, 0.0 * motion.q, 0.0 * motion.q)
        share["torque"] = np.abs(static + dynamic) / limits.torque
        room = np.maximum(limits.torque - np.sign(dynamic) * static, 1e-12 * limits.torque)
        pace["torque"] = np.sqrt(np.abs(dynamic) / room)
    return Use(motion.place, share, pace)
