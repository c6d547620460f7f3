"""The bodies of a link: inertia, visuals and collisions, checked."""

from __future__ import annotations

from typing import Any, Literal

from dualarm_pin.robot.robot import Inertial, Shape, Triple
from dualarm_pin.robot.xml import HUGE, Reader

_Kind = Literal["box", "cylinder", "sphere", "capsule"]
# A size that is missing is negative, and refused.
_PRIMITIVES: dict[str, tuple[_Kind, tuple[str, ...], tuple[float, ...]]] = {
    "box": ("box", ("size",), (-1.0, -1.0, -1.0)),
    "sphere": ("sphere", ("radius",), (-1.0,)),
    "cylinder": ("cylinder", ("radius", "length"), (-1.0,)),
    "capsule": ("capsule", ("radius", "length"), (-1.0,)),
}


def pose(read: Reader, element: Any, owner: str) -> tuple[Triple, Triple]:
    """Return xyz [m] and rpy [rad] of the `<origin>` of an element, zero if there is none.

    Raises:
        InputError: Not three numbers, or absurdly large ones.
    """
    origin = read.child(element, "origin")
    xyz = read.numbers(origin, "xyz", (0.0, 0.0, 0.0), owner)
    rpy = read.numbers(origin, "rpy", (0.0, 0.0, 0.0), owner)
    for key, values, unit in (("xyz", xyz, "m"), ("rpy", rpy, "rad")):
        if max(map(abs, values)) > HUGE:
            raise read.error(f"{key}={values} [{unit}] is absurdly large", origin, owner)
    return (xyz[0], xyz[1], xyz[2]), (rpy[0], rpy[1], rpy[2])


def inertial(read: Reader, link: Any, owner: str, warnings: list[str]) -> Inertial | None:
    """Return the `<inertial>` of a link, or None; kinematics never needs it.

    Raises:
        InputError: A value is not a number, or the mass is negative.
    """
    element = read.child(link, "inertial")
    if element is None:
        return None
    xyz, rpy = pose(read, element, owner)
    mass = read.number(read.child(element, "mass"), "value", owner)
    if mass is not None and mass < 0:
        message = f"mass {mass:g} kg is negative; give a positive mass or leave <inertial> out"
        raise read.error(message, element, owner)
    child = read.child(element, "inertia")
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    values = [read.number(child, key, owner) for key in keys]
    if mass is None or None in values:
        warnings.append(f"{read.file.name}: {owner}: <inertial> is incomplete and was left out")
        return None
    moments = tuple(value or 0.0 for value in values)
    negative = [f"{keys[k]}={moments[k]:g}" for k in (0, 3, 5) if moments[k] < 0]
    if negative:  # seen in the field (icub)
        warnings.append(
            f"{read.file.name}:{child.sourceline}: {owner}: a moment of "
            f"inertia is negative ({', '.join(negative)}): torques computed with it are wrong"
        )
    return Inertial(mass, xyz, rpy, moments)


def shapes(read: Reader, link: Any, tag: str, owner: str, unknown: list[str]) -> list[Shape]:
    """Return the `<visual>` or `<collision>` parts of a link.

    Args:
        read: The file.
        link: The link element.
        tag: `visual` or `collision`.
        owner: The link in messages.
        unknown: Collects what cannot be represented.

    Raises:
        InputError: A value is not a number, or a size is not positive.
    """
    found = []
    for element in read.children(link, tag):
        xyz, rpy = pose(read, element, owner)
        geometry = read.child(element, "geometry")
        bodies = [] if geometry is None else [child for child in geometry if read.tag(child)]
        if not bodies:
            unknown.append(f"{owner}: <{tag}> on line {element.sourceline} has no geometry")
            continue
        body = bodies[0]
        kind = read.tag(body)
        colour = _colour(read, element, owner)
        if kind == "mesh":
            file = read.text(body, "filename", owner)
            scale = read.numbers(body, "scale", (1.0, 1.0, 1.0), owner)
            if 0.0 in scale or max(map(abs, scale)) > HUGE:
                raise read.error(f"mesh scale {scale} is useless", body, owner)
            shape = Shape("mesh", scale, file, xyz, rpy, colour, body.sourceline)
        elif kind in _PRIMITIVES:
            name, keys, default = _PRIMITIVES[kind]
            size = tuple(x for key in keys for x in read.numbers(body, key, default, owner))
            size = _positive(read, body, size, owner)
            shape = Shape(name, size, "", xyz, rpy, colour, body.sourceline)
        else:
            line = body.sourceline
            unknown.append(f"{owner}: <{tag}> on line {line}: {kind!r} is no known shape")
            continue
        found.append(shape)
    return found


def _positive(read: Reader, body: Any, size: tuple[float, ...], owner: str) -> tuple[float, ...]:
    if min(size) < 0 or max(size) > HUGE:
        message = f"<{read.tag(body)}> has no valid size: it must be positive and in metres"
        raise read.error(message, body, owner)
    return tuple(max(value, 1e-9) for value in size)


def _colour(read: Reader, element: Any, owner: str) -> tuple[float, ...] | None:
    material = read.child(element, "material")
    if material is None:
        return None
    return material_colour(read, material, owner) or read.colours.get(material.get("name", ""))


def material_colour(read: Reader, material: Any, owner: str) -> tuple[float, ...] | None:
    """Return red, green, blue and alpha that a `<material>` states itself, or None.

    Raises:
        InputError: Not four numbers.
    """
    colour = read.child(material, "color")
    if colour is None or colour.get("rgba") is None:
        return None
    return read.numbers(colour, "rgba", (0.0, 0.0, 0.0, 1.0), owner)
