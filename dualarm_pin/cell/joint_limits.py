"""Bounds, speed, acceleration and effort of a column of q, narrowed by what follows it."""

from __future__ import annotations

import math
from dataclasses import replace

from dualarm_pin.cell.joint_settings import RobotSettings
from dualarm_pin.cell.parts import Joint, Owner
from dualarm_pin.robot.robot import UrdfJoint
from dualarm_pin.tolerance import TOLERANCE

TURN = 2.0 * math.pi
_FAR = 1000.0  # a bound beyond this [rad or m] means "none"


def column(joint: UrdfJoint, owner: Owner, settings: RobotSettings) -> tuple[Joint, list[str]]:
    """Return a joint as a column of q, with warnings.

    Raises:
        InputError: It has no usable bounds.
    """
    name, warnings = f"{owner}/{joint.name}", []
    own, endless = _own_bounds(joint)
    if endless and joint.kind != "continuous":
        warnings.append(f"{name}: its bounds are absurdly wide; it is taken as continuous")
    given = settings.limits.get(joint.name)
    if given is not None:
        if max(-given[0], given[1]) > _FAR:
            raise settings.error("these bounds are absurdly wide", "limits", joint.name)
        if own is None:
            warnings.append(f"{name}: no usable bounds in the URDF; those of the cell are used")
        elif not endless and max(own[0] - given[0], given[1] - own[1]) > TOLERANCE.bound:
            wider = f"{span(given, joint)} are wider than those of the URDF, {span(own, joint)}"
            warnings.append(f"{name}: bounds {wider}")
    bounds = given or own
    if bounds is None or not bounds[0] < bounds[1]:
        unit = "limits" if joint.kind == "prismatic" else "limits_deg"
        what = "usable bounds" if bounds is None else f"range: lower = upper = {bounds[0]:g}"
        raise joint.error(
            f"has no {what}; correct <limit lower= upper=>, or give `{unit}` or `lock` for it in "
            "the cell file",
            settings.chains.robot.file,
        )
    kept = Joint(
        name,
        owner,
        "prismatic" if joint.kind == "prismatic" else "revolute",
        endless,
        bounds[0],
        bounds[1],
        settings.velocity.get(joint.name, joint.velocity),
        settings.acceleration.get(joint.name),
        settings.torque.get(joint.name, joint.effort),
        settings.jerk.get(joint.name),
    )
    return kept, warnings


def _own_bounds(joint: UrdfJoint) -> tuple[tuple[float, float] | None, bool]:
    """Return the usable bounds of the URDF, if any, and whether the joint turns endlessly."""
    if joint.kind == "continuous":
        return (-TURN, TURN), True
    if joint.lower is None or joint.upper is None:
        return None, False
    if max(-joint.lower, joint.upper) <= _FAR:
        return (joint.lower, joint.upper), False
    return ((-TURN, TURN), True) if joint.kind == "revolute" else (None, False)


def narrowed(
    leader: Joint, joint: UrdfJoint, multiplier: float, offset: float, settings: RobotSettings
) -> tuple[Joint, list[str]]:
    """Return a column whose follower keeps its own limits, with warnings.

    Args:
        leader: The column.
        joint: The follower.
        multiplier: Its value is multiplier * value of the leader + offset.
        offset: [rad or m].
        settings: What the cell file says about the joints of their URDF.

    Raises:
        InputError: The bounds of the follower leave no range.
    """
    if not multiplier:
        return leader, []
    warnings = []
    if joint.lower is not None and joint.upper is not None and joint.lower < joint.upper:
        ends = sorted((bound - offset) / multiplier for bound in (joint.lower, joint.upper))
        lower, upper = max(leader.lower, ends[0]), min(leader.upper, ends[1])
        if not lower < upper:
            plain = leader.name.partition("/")[2]
            message = f"its bounds leave no range to joint {plain!r}, which it mimics"
            raise joint.error(message, settings.chains.robot.file)
        if (lower, upper) != (leader.lower, leader.upper):
            leader = replace(leader, continuous=False, lower=lower, upper=upper)
            warnings.append(
                f"{leader.name}: narrowed so that {joint.name!r}, which follows it, stays inside"
            )
    velocity = settings.velocity.get(joint.name, joint.velocity)
    acceleration = settings.acceleration.get(joint.name)
    jerk = settings.jerk.get(joint.name)
    slower = replace(
        leader,
        velocity=_least(leader.velocity, velocity, multiplier),
        acceleration=_least(leader.acceleration, acceleration, multiplier),
        jerk=_least(leader.jerk, jerk, multiplier),
    )
    if slower != leader:
        warnings.append(f"{leader.name}: slowed down to what {joint.name!r}, which follows, allows")
    return slower, warnings


def _least(own: float | None, follower: float | None, multiplier: float) -> float | None:
    """Return the smaller of two limits, the second that of a follower."""
    if follower is None:
        return own
    most = follower / abs(multiplier)
    return most if own is None else min(own, most)


def span(bounds: tuple[float, float], joint: UrdfJoint) -> str:
    """Return bounds for a message, in degrees or metres."""
    scale, unit = (1.0, "m") if joint.kind == "prismatic" else (180.0 / math.pi, "deg")
    return f"{bounds[0] * scale:.6g}..{bounds[1] * scale:.6g} {unit}"
