"""The role of every joint of a URDF: a column of q, a follower of one, or locked at a value."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from dualarm_pin.cell.joint_limits import column, narrowed, span
from dualarm_pin.cell.joint_settings import RobotSettings
from dualarm_pin.cell.parts import Joint, Owner
from dualarm_pin.robot.robot import UrdfJoint
from dualarm_pin.tolerance import TOLERANCE


class Follower(NamedTuple):
    """A mimic joint of a column: value = multiplier * value of `leader` + offset."""

    leader: str
    multiplier: float
    offset: float


@dataclass
class Roles:
    """What each joint of one URDF does in the cell.

    Attributes:
        columns: Joints of q by plain name, arm1, arm2, common; each base to tip.
        followers: Mimic joints of columns.
        values: Where every other moving joint stands [rad or m].
        warnings: What a user should know.
    """

    columns: dict[str, Joint] = field(default_factory=dict)
    followers: dict[str, Follower] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def roles_of(settings: RobotSettings, free: Iterable[str]) -> Roles:
    """Sort the joints of one URDF; `free` are the common joints that may move.

    Raises:
        InputError: A joint of a chain has no usable bounds, or a lock value is outside them, or
            the cell file limits a joint that is locked.
    """
    out, chains, free = Roles(), settings.chains, set(free)
    joints = chains.robot.joints
    live: dict[str, Owner] = {
        joint.name: owner
        for owner in ("arm1", "arm2", "common")
        for joint in chains.moving.get(owner, ())
        if joint.name not in settings.lock and (owner != "common" or joint.name in free)
    }
    for name in joints:
        _leader(settings, name, live, out)
    for name, owner in live.items():
        if joints[name].mimic is None:
            out.columns[name], odd = column(joints[name], owner, settings)
            out.warnings += odd
    for name, (leader, multiplier, offset) in out.followers.items():
        follower = joints[name], multiplier, offset
        out.columns[leader], odd = narrowed(out.columns[leader], *follower, settings)
        out.warnings += odd
    for joint in joints.values():
        if joint.moves and joint.name not in out.columns and joint.name not in out.followers:
            out.values[joint.name] = _locked(joint, settings)
    _refuse_idle_settings(settings, out)
    return out


def _refuse_idle_settings(settings: RobotSettings, out: Roles) -> None:
    chains = f"the joints of the two chains ({', '.join(out.columns) or 'none'})"
    # A follower may have limits of motion: they bind the joint that leads it.
    for word, what, allowed in (
        ("limits", "bounds", out.columns),
        ("velocity", "speeds", out.columns | out.followers),
        ("acceleration", "accelerations", out.columns | out.followers),
        ("jerk", "jerks", out.columns | out.followers),
        ("torque", "torques", out.columns),
    ):
        for name in getattr(settings, word):
            if name not in allowed:
                reason = "follows another joint" if name in out.followers else "is locked"
                message = f"joint {name!r} {reason}: {what} are for {chains}"
                raise settings.error(message, word, name)


def _leader(settings: RobotSettings, name: str, live: Mapping[str, Owner], out: Roles) -> None:
    """Record a mimic joint as follower if the joint at the end of its mimics is a column."""
    robot = settings.chains.robot
    joints = robot.joints
    multiplier, offset, leader = 1.0, 0.0, name
    while (mimic := joints[leader].mimic) is not None and leader not in settings.lock:
        if mimic.joint not in joints:
            if name in live:
                lack = f"mimics joint {mimic.joint!r}, which does not exist"
                raise joints[leader].error(f"{lack}; lock it in the cell file", robot.file)
            return
        offset += multiplier * mimic.offset
        multiplier *= mimic.multiplier
        leader = mimic.joint
    if leader != name and leader in live and leader not in settings.lock and joints[name].moves:
        out.followers[name] = Follower(leader, multiplier, offset)
    elif leader != name and name in live:
        out.warnings.append(
            f"{live[name]}/{name} mimics {leader!r}, which is locked: it is locked too"
        )


def _locked(joint: UrdfJoint, settings: RobotSettings) -> float:
    """Return where a locked joint stands: as asked, as mimicked, or nearest to 0 in its bounds."""
    lower = -math.inf if joint.lower is None else joint.lower
    upper = math.inf if joint.upper is None else joint.upper
    if joint.name in settings.lock:
        value = settings.lock[joint.name]
        if not lower - TOLERANCE.bound <= value <= upper + TOLERANCE.bound:
            bounds = f"its bounds are {span((lower, upper), joint)}"
            message = f"joint {joint.name!r} cannot be locked at {value:g}: {bounds}"
            raise settings.error(message, "lock", joint.name)
        return value
    mimic, joints = joint.mimic, settings.chains.robot.joints
    if mimic is not None and mimic.joint in joints and joints[mimic.joint].moves:
        return mimic.multiplier * _locked(joints[mimic.joint], settings) + mimic.offset
    return min(max(0.0, lower), upper)
