"""Decide for every joint of a URDF: a column of q, a follower of one, or locked at a value."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

from dualarm_pin.cell.joint_settings import Asked, Blame
from dualarm_pin.cell.chains import Chains
from dualarm_pin.cell.parts import Joint, Owner
from dualarm_pin.robot.robot import UrdfJoint
from dualarm_pin.errors import InputError

TURN = 2.0 * math.pi
_FAR = 1000.0  # a bound beyond this [rad or m] means "none"


@dataclass
class Settled:
    """The joints of one URDF after the decision.

    Attributes:
        columns: Joints of q by plain name, arm1, arm2, common; each base to tip.
        followers: Mimic joint to (leading joint, multiplier, offset).
        values: Where every other moving joint stands [rad or m].
        warnings: What a user should know.
    """

    columns: dict[str, Joint] = field(default_factory=dict)
    followers: dict[str, tuple[str, float, float]] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def settle(chains: Chains, asked: Asked, free: Iterable[str], blame: Blame) -> Settled:
    """Sort the joints of one URDF.

    Args:
        chains: The URDF and its chains.
        asked: What the cell file says about its joints.
        free: Common joints that may move.
        blame: Makes an error from a message and the keys at fault.

    Raises:
        InputError: A joint of a chain has no usable bounds, or a lock value is outside them.
    """
    out = Settled()
    robot = chains.robot
    free = set(free)
    live: dict[str, Owner] = {}
    for owner in ("arm1", "arm2", "common"):
        for joint in chains.moving.get(owner, ()):
            if joint.name not in asked.lock and (owner != "common" or joint.name in free):
                live[joint.name] = owner
    for name in robot.joints:
        _leader(chains, asked, name, live, out)
    for name, owner in live.items():
        if robot.joints[name].mimic is None:
            out.columns[name] = _column(chains, robot.joints[name], owner, asked, blame, out)
    for name in list(out.followers):
        _narrow(chains, name, out)
    for joint in robot.joints.values():
        if joint.moves and joint.name not in out.columns and joint.name not in out.followers:
            out.values[joint.name] = _locked(chains, joint, asked, blame)
    for name in asked.bounds:
        if name not in out.columns:
            reason = "follows another joint" if name in out.followers else "is locked"
            raise blame(
                f"joint {name!r} {reason}: bounds are for the joints of the two chains "
                f"({', '.join(out.columns) or 'none'})",
                asked.place["limits", name],
            )
    return out


def _leader(chains: Chains, asked: Asked, name: str, live: dict[str, Owner], out: Settled) -> None:
    """Record a mimic joint as follower if the joint at the end of its mimics is a column."""
    joints = chains.robot.joints
    multiplier, offset, leader = 1.0, 0.0, name
    while (mimic := joints[leader].mimic) is not None and leader not in asked.lock:
        if mimic.joint not in joints:
            if name in live:
                raise InputError(
                    f"mimics joint {mimic.joint!r}, which does not exist; lock it in the cell file",
                    file=chains.robot.file,
                    line=joints[leader].line,
                    field=f"joint {leader!r}",
                )
            return
        offset += multiplier * mimic.offset
        multiplier *= mimic.multiplier
        leader = mimic.joint
    if leader != name and leader in live and leader not in asked.lock and joints[name].moves:
        out.followers[name] = (leader, multiplier, offset)
    elif leader != name and name in live:
        out.warnings.append(
            f"{live[name]}/{name} mimics {leader!r}, which is locked: it is locked too"
        )


def _column(
    chains: Chains, joint: UrdfJoint, owner: Owner, asked: Asked, blame: Blame, out: Settled
) -> Joint:
    name = f"{owner}/{joint.name}"
    own, endless = _own_bounds(joint)
    if endless and joint.kind != "continuous":
        out.warnings.append(f"{name}: its bounds are absurdly wide; it is taken as continuous")
    given = asked.bounds.get(joint.name)
    if given is not None:
        if max(-given[0], given[1]) > _FAR:
            raise blame("these bounds are absurdly wide", asked.place["limits", joint.name])
        if own is None:
            out.warnings.append(f"{name}: no usable bounds in the URDF; those of the cell are used")
        elif not endless and (given[0] < own[0] - 1e-9 or given[1] > own[1] + 1e-9):
            out.warnings.append(
                f"{name}: bounds {_span(given, joint)} are wider than those of the URDF, "
                f"{_span(own, joint)}"
            )
    bounds = given or own
    if bounds is None or not bounds[0] < bounds[1]:
        unit = "limits" if joint.kind == "prismatic" else "limits_deg"
        what = "usable bounds" if bounds is None else f"range: lower = upper = {bounds[0]:g}"
        raise InputError(
            f"has no {what}; correct <limit lower= upper=>, or give `{unit}` or `lock` for it in "
            "the cell file",
            file=chains.robot.file,
            line=joint.line,
            field=f"joint {joint.name!r}",
        )
    velocity = asked.velocity.get(joint.name, joint.velocity)
    return Joint(
        name,
        owner,
        "prismatic" if joint.kind == "prismatic" else "revolute",
        endless,
        bounds[0],
        bounds[1],
        velocity,
    )


def _own_bounds(joint: UrdfJoint) -> tuple[tuple[float, float] | None, bool]:
    """Return the usable bounds of the URDF, if any, and whether the joint turns endlessly."""
    if joint.kind == "continuous":
        return (-TURN, TURN), True
    if joint.lower is None or joint.upper is None:
        return None, False
    if max(-joint.lower, joint.upper) <= _FAR:
        return (joint.lower, joint.upper), False
    return ((-TURN, TURN), True) if joint.kind == "revolute" else (None, False)


def _narrow(chains: Chains, name: str, out: Settled) -> None:
    """Narrow the bounds of a leading joint so that its follower stays within its own."""
    leader, multiplier, offset = out.followers[name]
    joint, column = chains.robot.joints[name], out.columns[leader]
    if (
        joint.lower is None
        or joint.upper is None
        or not multiplier
        or not joint.lower < joint.upper
    ):
        return
    ends = sorted((bound - offset) / multiplier for bound in (joint.lower, joint.upper))
    lower, upper = max(column.lower, ends[0]), min(column.upper, ends[1])
    if (lower, upper) == (column.lower, column.upper):
        return
    if not lower < upper:
        raise InputError(
            f"its bounds leave no range to joint {leader!r}, which it mimics",
            file=chains.robot.file,
            line=joint.line,
            field=f"joint {name!r}",
        )
    out.columns[leader] = Joint(
        column.name, column.arm, column.kind, False, lower, upper, column.velocity
    )
    out.warnings.append(f"{column.name}: narrowed so that {name!r}, which follows it, stays inside")


def _locked(chains: Chains, joint: UrdfJoint, asked: Asked, blame: Blame) -> float:
    """Return where a locked joint stands: as asked, as mimicked, or nearest to 0 in its bounds."""
    lower = -math.inf if joint.lower is None else joint.lower
    upper = math.inf if joint.upper is None else joint.upper
    if joint.name in asked.lock:
        value = asked.lock[joint.name]
        if not lower - 1e-9 <= value <= upper + 1e-9:
            raise blame(
                f"joint {joint.name!r} cannot be locked at {value:g}: its bounds are "
                f"{_span((lower, upper), joint)}",
                asked.place["lock", joint.name],
            )
        return value
    joints = chains.robot.joints
    if joint.mimic is not None and joint.mimic.joint in joints and joints[joint.mimic.joint].moves:
        leader = _locked(chains, joints[joint.mimic.joint], asked, blame)
        return joint.mimic.multiplier * leader + joint.mimic.offset
    return min(max(0.0, lower), upper)


def _span(bounds: tuple[float, float], joint: UrdfJoint) -> str:
    scale, unit = (1.0, "m") if joint.kind == "prismatic" else (180.0 / math.pi, "deg")
    return f"{bounds[0] * scale:.6g}..{bounds[1] * scale:.6g} {unit}"
