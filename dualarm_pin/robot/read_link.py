"""The bodies of a link: inertia, visuals and collisions, checked."""

from __future__ import annotations

from typing import Literal

from dualarm_pin.robot.robot import MOMENTS, Inertial, Shape, Triple
from dualarm_pin.robot.xml import HUGE, Element

_NONE = (0.0, 0.0, 0.0)  # what URDF takes where an origin says nothing
_Kind = Literal["mesh", "box", "cylinder", "sphere", "capsule"]
# Attributes that give the size. One that is missing is negative, and refused.
_PRIMITIVES: dict[str, tuple[_Kind, tuple[tuple[str, tuple[float, ...]], ...]]] = {
    "box": ("box", (("size", (-1.0, -1.0, -1.0)),)),
    "sphere": ("sphere", (("radius", (-1.0,)),)),
    "cylinder": ("cylinder", (("radius", (-1.0,)), ("length", (-1.0,)))),
    "capsule": ("capsule", (("radius", (-1.0,)), ("length", (-1.0,)))),
}


def pose(element: Element) -> tuple[Triple, Triple]:
    """Return xyz [m] and rpy [rad] of the `<origin>` of an element, zero if there is none.

    Raises:
        InputError: Not three numbers, or absurdly large ones.
    """
    origin = element.child("origin")
    xyz, rpy = origin.triple("xyz", _NONE), origin.triple("rpy", _NONE)
    for key, values, unit in (("xyz", xyz, "m"), ("rpy", rpy, "rad")):
        if max(map(abs, values)) > HUGE:
            raise origin.error(f"{key}={values} [{unit}] is absurdly large")
    return xyz, rpy


def inertial(link: Element) -> Inertial | None:
    """Return the `<inertial>` of a link, or None; kinematics never needs it.

    Raises:
        InputError: A value is not a number.
    """
    element, document = link.child("inertial"), link.document
    if not element:
        return None
    xyz, rpy = pose(element)
    mass = element.child("mass").number("value")
    child = element.child("inertia")
    values = [child.number(key) for key in MOMENTS]
    if mass is None or None in values:
        message = f"{document.file.name}: {link.owner}: <inertial> is incomplete and was left out"
        document.warnings.append(message)
        return None
    if mass < 0:
        document.warnings.append(
            f"{document.file.name}:{element.line}: {link.owner}: mass {mass:g} kg is negative: "
            "<inertial> was left out, so torques cannot be computed"
        )
        return None
    moments = tuple(value or 0.0 for value in values)
    negative = [f"{MOMENTS[k]}={moments[k]:g}" for k in (0, 3, 5) if moments[k] < 0]
    if negative:  # seen in the field (icub)
        document.warnings.append(
            f"{document.file.name}:{child.line}: {link.owner}: a moment of "
            f"inertia is negative ({', '.join(negative)}): torques computed with it are wrong"
        )
    return Inertial(mass, xyz, rpy, moments)


def shapes(link: Element, tag: str, unknown: list[str]) -> tuple[Shape, ...]:
    """Return the `<visual>` or `<collision>` parts of a link; `unknown` collects what is none.

    Raises:
        InputError: A value is not a number, or a size is not positive.
    """
    found = []
    for element in link.children(tag):
        xyz, rpy = pose(element)
        bodies = element.child("geometry").children()
        if not bodies:
            unknown.append(f"{link.owner}: <{tag}> on line {element.line} has no geometry")
            continue
        body, colour = bodies[0], _colour(element)
        if body.tag == "mesh":
            file, scale = body.text("filename"), body.numbers("scale", (1.0, 1.0, 1.0))
            if 0.0 in scale or max(map(abs, scale)) > HUGE:
                raise body.error(f"mesh scale {scale} is useless")
            found.append(Shape("mesh", scale, file, xyz, rpy, colour, body.line))
        elif body.tag in _PRIMITIVES:
            kind, sizes = _PRIMITIVES[body.tag]
            size = [value for key, default in sizes for value in body.numbers(key, default)]
            if min(size) < 0 or max(size) > HUGE:
                message = f"<{kind}> has no valid size: it must be positive and in metres"
                raise body.error(message)
            size = [max(value, 1e-9) for value in size]
            found.append(Shape(kind, tuple(size), "", xyz, rpy, colour, body.line))
        else:
            what = f"on line {body.line}: {body.tag!r} is no known shape"
            unknown.append(f"{link.owner}: <{tag}> {what}")
    return tuple(found)


def _colour(element: Element) -> tuple[float, ...] | None:
    material = element.child("material")
    if not material:
        return None
    return material_colour(material) or element.document.colours.get(material.get("name") or "")


def material_colour(material: Element) -> tuple[float, ...] | None:
    """Return red, green, blue and alpha that a `<material>` states itself, or None.

    Raises:
        InputError: Not four numbers.
    """
    colour = material.child("color")
    return None if colour.get("rgba") is None else colour.numbers("rgba", (0.0, 0.0, 0.0, 1.0))
