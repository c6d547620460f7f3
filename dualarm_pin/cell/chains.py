"""From two URDFs to two chains: which joints move, which stand still and where."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

from dualarm_pin.cell.parts import ARMS, Owner
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.robot.robot import Robot, UrdfJoint


@dataclass(frozen=True)
class Chains:
    """The joints of one URDF, sorted by what they do in the cell.

    Attributes:
        robot: The URDF.
        owner: Whose each link is: `arm1`, `arm2`, or `common` above where the arms part.
        joint_owner: The same for each joint.
        moving: Joints with one degree of freedom on each chain, base to tip.
        tips: Tip link of each arm.
    """

    robot: Robot
    owner: Mapping[str, Owner]
    joint_owner: Mapping[str, Owner]
    moving: Mapping[Owner, tuple[UrdfJoint, ...]]
    tips: Mapping[str, str]


def single_chain(robot: Robot, arm: Literal["arm1", "arm2"], tip: str) -> Chains:
    """Return the chain of a URDF that holds one arm.

    Raises:
        InputError: A floating or planar joint lies between root and tip.
    """
    chain = robot.chain(tip)
    _refuse_free_bases(robot, chain)
    return Chains(
        robot,
        dict.fromkeys(robot.links, arm),
        dict.fromkeys(robot.joints, arm),
        {arm: tuple(joint for joint in chain if joint.moves)},
        {arm: tip},
    )


def twin_chains(robot: Robot, tips: tuple[str, str]) -> Chains:
    """Return the two chains of a URDF that holds both arms.

    Raises:
        InputError: Both tips lie on one arm, or a joint on a chain is floating or planar.
    """
    first, second = (robot.chain(tip) for tip in tips)
    shared = sum(1 for a, b in zip(first, second, strict=False) if a is b)
    parts: dict[Owner, list[UrdfJoint]] = {
        "arm1": first[shared:],
        "arm2": second[shared:],
        "common": first[:shared],
    }
    for chain in parts.values():
        _refuse_free_bases(robot, chain)
    moving: dict[Owner, tuple[UrdfJoint, ...]] = {
        owner: tuple(joint for joint in chain if joint.moves) for owner, chain in parts.items()
    }
    _refuse_one_arm(tips, moving)
    heads = {chain[0].child: owner for owner, chain in parts.items() if chain and owner != "common"}
    owner: dict[str, Owner] = {
        link: next((heads[j.child] for j in robot.chain(link) if j.child in heads), "common")
        for link in robot.links
    }
    joint_owner = {name: owner[joint.child] for name, joint in robot.joints.items()}
    return Chains(robot, owner, joint_owner, moving, dict(zip(ARMS, tips, strict=True)))


def find_tip(robot: Robot, tip: str) -> str:
    """Return `tip` if it is a link.

    Raises:
        UnknownNameError: It is not; the message names the nearest link.
    """
    if tip in robot.links:
        return tip
    if tip in robot.joints:
        child = robot.joints[tip].child
        message = f"{tip!r} is a joint of {robot.file.name}, not a link; its link is {child!r}"
        raise UnknownNameError(message)
    hint = nearest(tip, robot.links)
    if not hint.startswith("did you"):
        hint = f"links at the ends: {', '.join(robot.leaves()[:8])}"
    raise UnknownNameError(f"{robot.file.name} has no link {tip!r}: {hint}")


def _refuse_free_bases(robot: Robot, chain: Iterable[UrdfJoint]) -> None:
    for joint in chain:
        if joint.kind in ("floating", "planar"):
            raise joint.error(
                f"is {joint.kind}: the arms of a cell stand on a fixed base; make this joint "
                "fixed, or replace it by prismatic and revolute joints with bounds",
                robot.file,
            )


def _refuse_one_arm(tips: tuple[str, str], moving: Mapping[Owner, tuple[UrdfJoint, ...]]) -> None:
    """Refuse tips of which one carries the other, unless one of them stands still anyway."""
    one: tuple[Owner, Owner, str, str] = ("arm1", "arm2", *tips)
    two: tuple[Owner, Owner, str, str] = ("arm2", "arm1", *tips[::-1])
    for own, others, tip, other in (one, two):
        if moving[own] or (moving[others] and not moving["common"]):
            continue
        raise InputError(
            f"both tips lie on one arm: every joint that moves {tip!r} moves {other!r} with it; "
            "choose one tip on each arm"
        )
