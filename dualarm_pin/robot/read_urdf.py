"""URDF text to a checked `Robot`; every breach is named by file, line and joint or link."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from dualarm_pin.errors import nearest
from dualarm_pin.robot.check_tree import check_tree
from dualarm_pin.robot.read_link import inertial, material_colour, pose, shapes
from dualarm_pin.robot.robot import KINDS, Link, Mimic, Robot, Triple, UrdfJoint
from dualarm_pin.robot.xml import Reader, parse_xml, read_bytes
from dualarm_pin.tolerance import TOLERANCE

_DIALECTS = {"sdf": "SDF", "mujoco": "MJCF (MuJoCo)", "COLLADA": "COLLADA", "html": "HTML"}


def read_urdf(file: Path) -> Robot:
    """Read and check a URDF.

    Raises:
        MissingFileError: There is no such file.
        InputError: It is not a URDF that can be used, with line and joint or link.
    """
    return parse_urdf(read_bytes(file), file)


def parse_urdf(raw: bytes, file: Path) -> Robot:
    """Check URDF text that came from `file`.

    Raises:
        InputError: It is not a URDF that can be used, with line and joint or link.
    """
    root = parse_xml(raw, file)
    read = Reader(file, root)
    tag = read.tag(root)
    if tag != "robot":
        dialect = _DIALECTS.get(tag)
        given = f"this is {dialect}, not URDF" if dialect else f"<{tag}> is not the root of a URDF"
        raise read.error(f"{given}; a URDF starts with <robot name=...>", root, "")
    warnings: list[str] = []
    for material in read.children(root, "material"):
        colour = material_colour(read, material, "material")
        if colour is not None:
            read.colours[material.get("name", "")] = colour
    links = _links(read, root, warnings)
    joints = _joints(read, root, links, warnings)
    top = check_tree(links, joints, file)
    name = root.get("name") or ""
    if not name.strip():
        warnings.append(f"{file.name}: <robot> has no name")
    return Robot(name or file.stem, file, top, links, joints, tuple(warnings))


def _links(read: Reader, root: Any, warnings: list[str]) -> dict[str, Link]:
    links: dict[str, Link] = {}
    for element in read.children(root, "link"):
        name = read.text(element, "name", "link")
        owner = f"link {name!r}"
        if name in links:
            first = links[name].line
            raise read.error(
                f"a second link of this name; the first is on line {first}", element, owner
            )
        unknown: list[str] = []
        links[name] = Link(
            name,
            element.sourceline,
            inertial(read, element, owner, warnings),
            tuple(shapes(read, element, "visual", owner, unknown)),
            tuple(shapes(read, element, "collision", owner, unknown)),
            tuple(unknown),
        )
    if not links:
        raise read.error("the robot has no links; a URDF needs at least one <link>", root, "")
    return links


def _joints(
    read: Reader, root: Any, links: dict[str, Link], warnings: list[str]
) -> dict[str, UrdfJoint]:
    joints: dict[str, UrdfJoint] = {}
    for element in read.children(root, "joint"):
        name = read.text(element, "name", "joint")
        owner = f"joint {name!r}"
        if name in joints:
            first = joints[name].line
            raise read.error(
                f"a second joint of this name; the first is on line {first}", element, owner
            )
        joints[name] = _joint(read, element, name, links, warnings)
    # Seen in the field on fingers; refused only where a chain needs it (cell/joint_roles.py).
    warnings.extend(
        f"{read.file.name}:{joint.line}: joint {joint.name!r} mimics {joint.mimic.joint!r}, "
        f"which does not exist: {nearest(joint.mimic.joint, joints)}"
        for joint in joints.values()
        if joint.mimic is not None and joint.mimic.joint not in joints
    )
    return joints


def _joint(
    read: Reader, element: Any, name: str, links: dict[str, Link], warnings: list[str]
) -> UrdfJoint:
    owner = f"joint {name!r}"
    kind = read.text(element, "type", owner)
    if kind not in KINDS:
        message = f"unknown joint type {kind!r}: {nearest(kind, KINDS)}"
        raise read.error(message, element, owner)
    ends = [_end(read, element, side, owner, links) for side in ("parent", "child")]
    xyz, rpy = pose(read, element, owner)
    return UrdfJoint(
        name,
        kind,
        ends[0],
        ends[1],
        xyz,
        rpy,
        _axis(read, element, kind, owner),
        *_limit(read, element, kind, owner),
        _mimic(read, element, owner),
        element.sourceline,
    )


def _end(read: Reader, element: Any, side: str, owner: str, links: dict[str, Link]) -> str:
    child = read.child(element, side)
    if child is None:
        raise read.error(f"<{side} link=...> is missing", element, owner)
    name = read.text(child, "link", owner)
    if name not in links:
        message = f"its {side} link {name!r} is not defined: {nearest(name, links)}"
        raise read.error(message, child, owner)
    return name


def _axis(read: Reader, element: Any, kind: str, owner: str) -> Triple:
    if kind in ("fixed", "floating"):
        return (1.0, 0.0, 0.0)
    child = read.child(element, "axis")
    x, y, z = read.numbers(child, "xyz", (1.0, 0.0, 0.0), owner)
    length = math.hypot(x, y, z)
    if not TOLERANCE.coincident < length < 1.0 / TOLERANCE.coincident:
        message = f"axis ({x:g}, {y:g}, {z:g}) has no direction; give a unit vector"
        raise read.error(message, child, owner)
    if abs(length - 1.0) < 1e-15:
        return (x, y, z)
    return (x / length, y / length, z / length)


def _limit(
    read: Reader, element: Any, kind: str, owner: str
) -> tuple[float | None, float | None, float | None, float | None]:
    """Return lower, upper, velocity and effort; None where the URDF says nothing."""
    child = read.child(element, "limit")
    if child is None or kind == "fixed":
        return None, None, None, None
    lower, upper = read.number(child, "lower", owner), read.number(child, "upper", owner)
    effort, velocity = read.number(child, "effort", owner), read.number(child, "velocity", owner)
    for key, value in (("effort", effort), ("velocity", velocity)):
        if value is not None and value < 0:
            message = f"{key}={value:g} is negative; give a magnitude, or 0 for unknown"
            raise read.error(message, child, owner)
    if kind == "continuous":
        return None, None, velocity or None, effort or None
    if lower is not None or upper is not None:  # a missing one is 0, as the format says
        lower, upper = lower or 0.0, upper or 0.0
        if lower > upper:
            message = f"lower={lower:g} is above upper={upper:g}: exchange them"
            raise read.error(message, child, owner)
    return lower, upper, velocity or None, effort or None


def _mimic(read: Reader, element: Any, owner: str) -> Mimic | None:
    child = read.child(element, "mimic")
    if child is None:
        return None
    multiplier = read.numbers(child, "multiplier", (1.0,), owner)[0]
    offset = read.numbers(child, "offset", (0.0,), owner)[0]
    return Mimic(read.text(child, "joint", owner), multiplier, offset)
