"""The smallest distance between the bodies of a cell, over its collision pairs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.cell.build_bodies import Bodies
from dualarm_pin.cell.parts import ARMS, Clearance
from dualarm_pin.cell.solids import Solids

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
        between_arms: Only pairs of a body of arm1 and one of arm2, with what they carry.
        meshes: The same bodies with meshes as they are; then the hulls only bound from below, and
            pairs are measured again until no other can be nearer.
    """
    scene, any_active = _scene_of(hulls, scratch, between_arms=between_arms)
    if not any_active:
        return None
    nearest = pin.computeDistances(model, scratch["data"], hulls.model, scene, q)
    if meshes is not None:
        return _measured(model, hulls, meshes, scratch, scene)
    return _named(hulls, nearest, scene.distanceResults[nearest].min_distance)


def all_distances(
    model: pin.Model, hulls: Bodies, q: NDArray[np.float64], scratch: Scratch
) -> NDArray[np.float64]:
    """Return the distance of every pair (p,) at Pinocchio's q (nv,), meshes as convex hulls."""
    scene = _scene_of(hulls, scratch, between_arms=False)[0]
    if len(hulls.model.collisionPairs):  # Pinocchio crashes on none
        pin.computeDistances(model, scratch["data"], hulls.model, scene, q)
    return np.array([result.min_distance for result in scene.distanceResults])


def measured(
    model: pin.Model,
    hulls: Bodies,
    q: NDArray[np.float64],
    scratch: Scratch,
    pair: int,
    meshes: Bodies | None = None,
) -> float:
    """Return the distance of one pair at Pinocchio's q (nv,); `meshes` to compare them exactly."""
    scene = _scene_of(hulls, scratch, between_arms=False)[0]
    pin.updateGeometryPlacements(model, scratch["data"], hulls.model, scene, q)
    bound = float(pin.computeDistance(hulls.model, scene, pair).min_distance)
    if meshes is None:
        return bound
    return _exact(meshes, scratch, _placed(model, meshes, scratch), pair, bound)


def placed(
    hulls: Bodies,
    scratch: Scratch,
    pair: int,
    poses: tuple[pin.SE3, pin.SE3],
    meshes: Bodies | None = None,
) -> float:
    """Return the distance of a pair of bodies put anywhere; `meshes` to compare them exactly."""
    scene = _scene_of(hulls, scratch, between_arms=False)[0]
    ends = hulls.model.collisionPairs[pair]
    scene.oMg[ends.first], scene.oMg[ends.second] = poses
    bound = float(pin.computeDistance(hulls.model, scene, pair).min_distance)
    if meshes is None:
        return bound
    exact = _data_of(meshes, scratch)
    exact.oMg[ends.first], exact.oMg[ends.second] = poses
    return _exact(meshes, scratch, exact, pair, bound)


def _exact(
    meshes: Bodies, scratch: Scratch, exact: pin.GeometryData, pair: int, bound: float
) -> float:
    """Return the distance of placed meshes; those that meet have no depth: the hulls say it."""
    if "solids" not in scratch:
        scratch["solids"] = Solids(meshes.model)
    distance = float(scratch["solids"].distance(pair, exact, bound).min_distance)
    return min(bound, 0.0) if distance <= 0.0 else distance


def _placed(model: pin.Model, meshes: Bodies, scratch: Scratch) -> pin.GeometryData:
    """Return the meshes where the joints of the last computation put them."""
    exact = _data_of(meshes, scratch)
    pin.updateGeometryPlacements(model, scratch["data"], meshes.model, exact)
    return exact


def _data_of(meshes: Bodies, scratch: Scratch) -> pin.GeometryData:
    if "meshes" not in scratch:
        scratch["meshes"] = meshes.model.createData()
    exact: pin.GeometryData = scratch["meshes"]
    return exact


def _scene_of(
    bodies: Bodies, scratch: Scratch, *, between_arms: bool
) -> tuple[pin.GeometryData, bool]:
    name = "arms" if between_arms else "scene"
    if name not in scratch:
        scratch[name] = _scene(bodies, between_arms)
    scene: tuple[pin.GeometryData, bool] = scratch[name]
    return scene


def _scene(bodies: Bodies, between_arms: bool) -> tuple[pin.GeometryData, bool]:
    scene = bodies.model.createData()
    active = len(bodies.model.collisionPairs)
    if between_arms:
        for k, pair in enumerate(bodies.model.collisionPairs):
            arms = {bodies.owners[pair.first], bodies.owners[pair.second]}
            if arms != set(ARMS):
                scene.deactivateCollisionPair(k)
                active -= 1
    return scene, active > 0


def _measured(
    model: pin.Model, hulls: Bodies, meshes: Bodies, scratch: Scratch, scene: pin.GeometryData
) -> Clearance:
    exact = _placed(model, meshes, scratch)
    active = np.array(list(scene.activeCollisionPairs), dtype=bool)
    bound = np.array([result.min_distance for result in scene.distanceResults])
    bound[~active] = np.inf
    best, pair = np.inf, 0
    for k in np.argsort(bound, kind="stable"):
        if bound[k] >= best:
            break
        distance = _exact(meshes, scratch, exact, int(k), float(bound[k]))
        if distance < best:
            best, pair = distance, int(k)
    return _named(hulls, pair, best)


def _named(bodies: Bodies, pair: int, distance: float) -> Clearance:
    ends = bodies.model.collisionPairs[pair]
    return Clearance(float(distance), bodies.links[ends.first], bodies.links[ends.second])
