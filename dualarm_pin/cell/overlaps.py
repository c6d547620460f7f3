"""Carried things that already stand inside what carries them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import coal
import pinocchio as pin

from dualarm_pin.cell.build_bodies import Bodies
from dualarm_pin.cell.objects import WORLD, PlacedObject
from dualarm_pin.errors import InputError
from dualarm_pin.meshes.load import load_mesh

_PRESSED = 1e-3  # m; a part against a flange may reach into it by what drawings are rounded to


def refuse_overlaps(bodies: Bodies, objects: Sequence[PlacedObject]) -> None:
    """Refuse an object that is inside the link that carries it, unless it is allowed.

    Args:
        bodies: Collision bodies of the cell, meshes as convex hulls.
        objects: What is carried, or stands.

    Raises:
        InputError: The message says how deep.
    """
    for thing in objects:
        if thing.owner == WORLD:  # it stands where it stands, and so do the bases
            continue
        for link, depth in _inside(bodies, thing):
            if link not in thing.allowed:
                raise InputError(
                    f"is {depth:.3f} m inside {link}, which carries it: move it (`at`), or say "
                    f"`allow: [{link}]`",
                    field=f"objects.{thing.name}",
                )


def _inside(bodies: Bodies, thing: PlacedObject) -> Iterator[tuple[str, float]]:
    """Yield the links that move with an object and that it reaches into, and how deep [m]."""
    items, names = bodies.model.geometryObjects, list(bodies.links)
    number = names.index(thing.name)
    own, objects = items[number], {each for each in names if "/" not in each}
    for k, name in enumerate(names):
        if name in objects or items[k].parentJoint != own.parentJoint:
            continue
        depth = -_distance(own, items[k], exact=False)
        # The hull of a gripper holds what its fingers hold: the meshes decide.
        if depth > _PRESSED and _distance(own, items[k], exact=True) <= 0.0:
            yield name, depth


def _distance(one: pin.GeometryObject, two: pin.GeometryObject, *, exact: bool) -> float:
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    poses = [coal.Transform3s(t.placement.rotation, t.placement.translation) for t in (one, two)]
    shapes = [_as_it_is(item) if exact else item.geometry for item in (one, two)]
    return float(coal.distance(shapes[0], poses[0], shapes[1], poses[1], request, result))


def _as_it_is(item: pin.GeometryObject) -> coal.CollisionGeometry:
    if not item.meshPath:
        return item.geometry
    x, y, z = map(float, item.meshScale)
    return load_mesh(Path(item.meshPath), (x, y, z), hull=False)
