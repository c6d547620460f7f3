"""What a motion comes to, as records; `motion` of result.json holds them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from dualarm_pin.answer.evidence import Number

Law = Literal["constant_feed", "time_optimal"]
Kind = Literal["velocity", "acceleration", "jerk", "torque", "feed"]


@dataclass(frozen=True)
class LimitUse:
    """What one limit does along the motion.

    Attributes:
        kind: Which limit.
        joint: Whose, `arm1/<name>`; "" for the feed, which is of the tool.
        limit: Its value [rad/s, rad/s^2, rad/s^3, N m, or the same in m and N; m/s].
        largest: Largest use after the dense check; 1 is all of it.
        share: Share of the path along which a faster motion would break it first.
    """

    kind: Kind
    joint: str
    limit: float
    largest: float
    share: float


@dataclass(frozen=True)
class TorqueUse:
    """What a joint's drive does.

    Attributes:
        joint: `arm1/<name>`.
        largest: Largest torque [N m or N].
        rms: Root mean square over time [N m or N].
        largest_share: The largest as a share of the limit; None where the limit is unknown.
        rms_share: The root mean square likewise.
        energy: Mechanical work, lifting and braking counted alike [J].
    """

    joint: str
    largest: float
    rms: float
    largest_share: float | None
    rms_share: float | None
    energy: float


@dataclass(frozen=True)
class MotionSummary:
    """What a motion comes to.

    Attributes:
        duration: [s].
        feed: Largest speed of the tool along the path [m/s]; the constant one of that law.
        largest_feed: Largest constant feed that all limits allow [m/s]; None for another law.
        mean_feed: Length over duration [m/s].
        path_error_mm: Largest distance of a sample from the path [mm].
        path_error_deg: Largest angle likewise [deg].
        chord_error_mm: Largest distance from the path halfway between samples, joints taken as
            straight there [mm].
        chord_error_deg: Largest angle likewise [deg].
        kinds: Kinds of limits that were observed.
        stretch: Factor by which the dense check made the motion slower, at least 1.
        jerk: "" without jerk limits, else "checked": the law is smoothed until they hold.
        limits: What each limit does.
        held_by: At each point of the path, the limit that a faster motion would break first.
        least_clearance: Smallest distance along the samples [m]; None where it is unknown.
        least_arm_clearance: The same between the arms [m].
        tool_force: Force at the tool of arm2, in axes of e1 [N], that the torques hold.
        torques: What each joint's drive does; () where torques are unknown.
        torque_note: What the torques are made of.
    """

    duration: float
    feed: float
    largest_feed: float | None
    mean_feed: float
    path_error_mm: float
    path_error_deg: float
    chord_error_mm: float
    chord_error_deg: float
    kinds: tuple[Kind, ...]
    stretch: float
    jerk: str
    limits: tuple[LimitUse, ...]
    held_by: tuple[str, ...] = ()
    least_clearance: Number | None = None
    least_arm_clearance: Number | None = None
    tool_force: float = 0.0
    torques: tuple[TorqueUse, ...] = ()
    torque_note: str = ""
