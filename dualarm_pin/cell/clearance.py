"""The smallest distance between the bodies of a cell, over its collision pairs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.cell.build_bodies import Bodies
from dualarm_pin.cell.parts import Clearance

Scratch = dict[str, Any]


def smallest(
    model: pin.Model,
    hulls: Bodies,
    q: NDArray[np.float64],
    scratch: Scratch,
    between_arms: bool = False,
    meshes: Bodies | None = None,
) -> Clearance | None:
    """Return the smallest distance, or None without a pair.

    Args:
        model: The cell's model.
        hulls: Its bodies with the pairs, meshes as convex hulls.
        q: Pinocchio's q (nv,).
        scratch: Work space of one thread and one cell.
        between_arms: Only pairs of a body of arm1 and one of arm2.
        meshes: The same bodies with meshes as they are; then the hulls only bound from below, and
            pairs are measured again until no other can be nearer. (A mesh is a surface: a part that
            is wholly inside another counts as apart.)
    """
    name = "arms" if between_arms else "scene"
    if name not in scratch:
        scratch[name] = _scene(hulls, between_arms)
    scene, any_active = scratch[name]
    if not any_active:
        return None
    nearest = pin.computeDistances(model, scratch["data"], hulls.model, scene, q)
    if meshes is not None:
        return _measured(model, hulls, meshes, scratch, scene)
    return _named(hulls, nearest, scene.distanceResults[nearest].min_distance)


def _scene(bodies: Bodies, between_arms: bool) -> tuple[pin.GeometryData, bool]:
    scene = bodies.model.createData()
    active = len(bodies.model.collisionPairs)
    if between_arms:
        for k, pair in enumerate(bodies.model.collisionPairs):
            arms = {bodies.links[pair.first][:5], bodies.links[pair.second][:5]}
            if arms != {"arm1/", "arm2/"}:
                scene.deactivateCollisionPair(k)
                active -= 1
    return scene, active > 0


def _measured(
    model: pin.Model, hulls: Bodies, meshes: Bodies, scratch: Scratch, scene: pin.GeometryData
) -> Clearance:
    if "meshes" not in scratch:
        scratch["meshes"] = meshes.model.createData()
    exact = scratch["meshes"]
    pin.updateGeometryPlacements(model, scratch["data"], meshes.model, exact)
    active = np.array(list(scene.activeCollisionPairs), dtype=bool)
    bound = np.array([result.min_distance for result in scene.distanceResults])
    bound[~active] = np.inf
    best, pair = np.inf, 0
    for k in np.argsort(bound, kind="stable"):
        if bound[k] >= best:
            break
        distance = pin.computeDistance(meshes.model, exact, int(k)).min_distance
        # Meshes that meet have no depth: the hulls say how deep.
        distance = min(bound[k], 0.0) if distance <= 0.0 else distance
        if distance < best:
            best, pair = distance, int(k)
    return _named(hulls, pair, best)


def _named(bodies: Bodies, pair: int, distance: float) -> Clearance:
    ends = bodies.model.collisionPairs[pair]
    return Clearance(float(distance), bodies.links[ends.first], bodies.links[ends.second])
