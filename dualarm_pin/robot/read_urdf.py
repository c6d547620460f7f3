"""URDF text to a checked `Robot`; every breach is named by file, line and joint or link."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from dualarm_pin.errors import nearest
from dualarm_pin.robot.check_tree import check_tree
from dualarm_pin.robot.read_link import inertial, material_colour, pose, shapes
from dualarm_pin.robot.robot import KINDS, Link, Mimic, Robot, Triple, UrdfJoint
from dualarm_pin.robot.xml import Element, read_root
from dualarm_pin.tolerance import TOLERANCE

_DIALECTS = {"sdf": "SDF", "mujoco": "MJCF (MuJoCo)", "COLLADA": "COLLADA", "html": "HTML"}


def parse_urdf(raw: bytes, file: Path) -> Robot:
    """Check URDF text that came from `file`.

    Raises:
        InputError: It is not a URDF that can be used, with line and joint or link.
    """
    root = read_root(raw, file)
    if root.tag != "robot":
        dialect = _DIALECTS.get(root.tag)
        other = f"<{root.tag}> is not the root of a URDF"
        given = f"this is {dialect}, not URDF" if dialect else other
        raise root.error(f"{given}; a URDF starts with <robot name=...>")
    for material in root.children("material", owner="material"):
        colour = material_colour(material)
        if colour is not None:
            root.document.colours[material.get("name") or ""] = colour
    links = {name: _link(name, element) for name, element in _named(root, "link")}
    if not links:
        raise root.error("the robot has no links; a URDF needs at least one <link>")
    joints = {name: _joint(name, element, links) for name, element in _named(root, "joint")}
    warnings = root.document.warnings
    # Seen in the field on fingers; refused only where a chain needs it (cell/joint_roles.py).
    warnings += [
        f"{file.name}:{joint.line}: joint {joint.name!r} mimics {joint.mimic.joint!r}, "
        f"which does not exist: {nearest(joint.mimic.joint, joints)}"
        for joint in joints.values()
        if joint.mimic is not None and joint.mimic.joint not in joints
    ]
    top = check_tree(links, joints, file)
    name = root.get("name") or ""
    if not name.strip():
        warnings.append(f"{file.name}: <robot> has no name")
    return Robot(name or file.stem, file, top, links, joints, tuple(warnings))


def _named(root: Element, tag: str) -> Iterator[tuple[str, Element]]:
    """Yield the links or joints by name, each once."""
    lines: dict[str, int] = {}
    for element in root.children(tag, owner=tag):
        name = element.text("name")
        element = replace(element, owner=f"{tag} {name!r}")
        if name in lines:
            message = f"a second {tag} of this name; the first is on line {lines[name]}"
            raise element.error(message)
        lines[name] = element.line
        yield name, element


def _link(name: str, element: Element) -> Link:
    unknown: list[str] = []
    return Link(
        name,
        element.line,
        inertial(element),
        shapes(element, "visual", unknown),
        shapes(element, "collision", unknown),
        tuple(unknown),
    )


def _joint(name: str, element: Element, links: Mapping[str, Link]) -> UrdfJoint:
    kind = element.text("type")
    if kind not in KINDS:
        raise element.error(f"unknown joint type {kind!r}: {nearest(kind, KINDS)}")
    return UrdfJoint(
        name,
        kind,
        _end(element, "parent", links),
        _end(element, "child", links),
        *pose(element),
        _axis(element, kind),
        *_limit(element, kind),
        _mimic(element),
        element.line,
    )


def _end(element: Element, side: str, links: Mapping[str, Link]) -> str:
    child = element.child(side)
    if not child:
        raise element.error(f"<{side} link=...> is missing")
    name = child.text("link")
    if name not in links:
        raise child.error(f"its {side} link {name!r} is not defined: {nearest(name, links)}")
    return name


def _axis(element: Element, kind: str) -> Triple:
    if kind in ("fixed", "floating"):
        return (1.0, 0.0, 0.0)
    child = element.child("axis")
    x, y, z = child.triple("xyz", (1.0, 0.0, 0.0))
    length = math.hypot(x, y, z)
    if not TOLERANCE.coincident < length < 1.0 / TOLERANCE.coincident:
        raise child.error(f"axis ({x:g}, {y:g}, {z:g}) has no direction; give a unit vector")
    if abs(length - 1.0) < 1e-15:
        return (x, y, z)
    return (x / length, y / length, z / length)


def _limit(
    element: Element, kind: str
) -> tuple[float | None, float | None, float | None, float | None]:
    """Return lower, upper, velocity and effort; None where the URDF says nothing."""
    child = element.child("limit")
    if kind == "fixed":
        return None, None, None, None
    lower, upper = child.number("lower"), child.number("upper")
    effort, velocity = child.number("effort"), child.number("velocity")
    for key, value in (("effort", effort), ("velocity", velocity)):
        if value is not None and value < 0:
            message = f"{key}={value:g} is negative; give a magnitude, or 0 for unknown"
            raise child.error(message)
    if kind == "continuous":
        lower = upper = None
    elif lower is not None or upper is not None:  # a missing one is 0, as the format says
        lower, upper = lower or 0.0, upper or 0.0
        if lower > upper:
            raise child.error(f"lower={lower:g} is above upper={upper:g}: exchange them")
    return lower, upper, velocity or None, effort or None


def _mimic(element: Element) -> Mimic | None:
    child = element.child("mimic")
    if not child:
        return None
    multiplier = child.numbers("multiplier", (1.0,))[0]
    return Mimic(child.text("joint"), multiplier, child.numbers("offset", (0.0,))[0])
