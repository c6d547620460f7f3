"""Whether links and joints of a URDF form one tree."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from dualarm_pin.errors import InputError
from dualarm_pin.robot.robot import Link, UrdfJoint

_DEEPEST = 500  # Pinocchio descends by recursion, and a far deeper tree overflows its stack


def check_tree(links: Mapping[str, Link], joints: Mapping[str, UrdfJoint], file: Path) -> str:
    """Return the root link.

    Raises:
        InputError: A loop, two roots, a link below itself, or mimic joints in a circle.
    """
    above: dict[str, UrdfJoint] = {}
    for joint in joints.values():
        if joint.child in above:
            other = above[joint.child]
            taken = f"its child link {joint.child!r} is already the child of joint {other.name!r}"
            raise joint.error(f"{taken} (line {other.line}): a loop; a URDF is a tree", file)
        above[joint.child] = joint
    depth: dict[str, int] = {}  # of links known to hang from a root
    for joint in joints.values():
        _climb(file, joint, above, depth)
    roots = [name for name in links if name not in above]
    if len(roots) > 1:
        first, second = links[roots[0]], links[roots[1]]
        raise InputError(
            f"{len(roots)} root links: {', '.join(map(repr, roots[:5]))}"
            f"{', ...' if len(roots) > 5 else ''}; a URDF is one tree: join {second.name!r} to "
            f"{first.name!r} with a joint",
            file=file,
            line=second.line,
            field=f"link {second.name!r}",
        )
    _check_mimics(joints, file)
    return roots[0]


def _climb(
    file: Path, start: UrdfJoint, above: Mapping[str, UrdfJoint], depth: dict[str, int]
) -> None:
    passed = [start.child]
    link = start.parent
    while link not in depth and link in above:
        if link == start.child:
            path = "its own child" if start.parent == start.child else "below its own child"
            raise start.error(f"its parent link {start.parent!r} is {path}: a loop", file)
        if len(passed) > len(above):  # runs into a loop that another joint will report
            return
        passed.append(link)
        link = above[link].parent
    for steps, each in enumerate(reversed(passed), start=depth.get(link, 0) + 1):
        if steps > _DEEPEST:
            message = f"more than {_DEEPEST} joints lie between it and the root"
            raise above[each].error(message, file)
        depth[each] = steps


def _check_mimics(joints: Mapping[str, UrdfJoint], file: Path) -> None:
    for joint in joints.values():
        seen = {joint.name}
        mimic = joint.mimic
        while mimic is not None:
            if mimic.joint in seen:
                raise joint.error(f"mimics itself through {mimic.joint!r}", file)
            seen.add(mimic.joint)
            mimic = joints[mimic.joint].mimic if mimic.joint in joints else None
