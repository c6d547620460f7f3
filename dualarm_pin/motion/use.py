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
    """Shares of the limits, 1 is all of one.

    Attributes:
        place: Where (m,) [m].
        share: By kind (m, n); the feed has one column.
        slower: Factor of time that brings every share to 1 or less.
    """

    place: Array
    share: dict[Kind, Array]
    slower: float


def use_of(
    curve: JointCurve,
    schedule: Schedule,
    limits: Limits,
    torques: Torques,
    feed: float = np.inf,
    time: Array | None = None,
) -> Use:
    """Return how much of each limit a schedule uses.

    Args:
        curve: Joints along the path.
        schedule: Place over time.
        limits: What the joints can do.
        torques: What their drives hold.
        feed: Largest speed of the tool [m/s].
        time: Where to look (m,); densely everywhere by default.
    """
    motion = joints_at(curve, schedule, schedule.dense() if time is None else time)
    share: dict[Kind, Array] = {}
    slower = 1.0
    powers: dict[Kind, float] = {"velocity": 1.0, "acceleration": 2.0, "jerk": 3.0}
    for kind, power in powers.items():
        if kind in limits.kinds:
            share[kind] = np.abs(getattr(motion, kind)) / limits.of(kind)
            slower = max(slower, float(share[kind].max()) ** (1.0 / power))
    if np.isfinite(feed):
        share["feed"] = np.abs(motion.speed[:, None]) / feed
        slower = max(slower, float(share["feed"].max()))
    if "torque" in limits.kinds:
        u = curve.relative.direction(motion.place)
        static = torques.static(motion.q, u)
        dynamic = torques.moving(motion.q, motion.velocity, motion.acceleration)
        dynamic -= torques.moving(motion.q, 0.0 * motion.q, 0.0 * motion.q)
        share["torque"] = np.abs(static + dynamic) / limits.torque
        room = np.maximum(limits.torque - np.sign(dynamic) * static, 1e-12 * limits.torque)
        slower = max(slower, float(np.sqrt((np.abs(dynamic) / room).max())))
    return Use(motion.place, share, slower)
