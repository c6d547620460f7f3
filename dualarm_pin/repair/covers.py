"""A capsule around each body: a cheap bound of distances, and a guide out of deep collisions."""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array

_RIM = 16  # corners of the prism around a cylinder
_TIGHT = 5.0  # times the volume of the body: links of robots have 1.3 to 4
_NO_VOLUME = 1e-12  # m^3
_STEPS = 24  # towards the least circle: within 4 % of it, and a capsule is a guide only


class Cover(NamedTuple):
    """A capsule.

    Attributes:
        ends: (2, 3) of its segment [m].
        radius: [m].
        tight: It is not much larger than the body: a plate has no capsule that says anything.
    """

    ends: Array
    radius: float
    tight: bool = True


def cover(thing: pin.GeometryObject) -> Cover:
    """Return a capsule around a body, in the frame of the body's joint."""
    shape = thing.geometry
    if isinstance(shape, coal.Sphere):
        found = Cover(np.zeros((2, 3)), float(shape.radius))
    elif isinstance(shape, coal.Capsule):
        half = np.array([0.0, 0.0, shape.halfLength])
        found = Cover(np.array([-half, half]), float(shape.radius))
    else:
        found = capsule_around(_corners(shape))
    place, volume = thing.placement, max(abs(shape.computeVolume()), _NO_VOLUME)
    ends = found.ends @ place.rotation.T + place.translation
    return Cover(ends, found.radius, _volume(found) < _TIGHT * volume)


def hull_of(thing: pin.GeometryObject) -> tuple[Array, float]:
    """Return points (m, 3) in the frame of a body's joint and a radius: their hull holds it [m]."""
    shape, place = thing.geometry, thing.placement
    if isinstance(shape, coal.Sphere | coal.Capsule):
        found = cover(thing)
        return found.ends, found.radius
    return _corners(shape) @ place.rotation.T + place.translation, 0.0


def capsule_around(corners: Array) -> Cover:
    """Return a small capsule around points (m, 3): the least volume along three directions."""
    middle = corners.mean(axis=0)
    directions = np.linalg.eigh((corners - middle).T @ (corners - middle))[1].T
    rough = [_along(corners, axis, 1) for axis in directions]
    best = directions[int(np.argmin([_volume(capsule) for capsule in rough]))]
    return _along(corners, best, _STEPS)


def _along(corners: Array, axis: Array, steps: int) -> Cover:
    """Return the capsule around points whose segment has a direction.

    The circle around the points seen along the axis: from the middle of their box in steps towards
    the farthest, each shorter (Badoiu and Clarkson 2003).
    """
    height = corners @ axis
    flat = corners - np.outer(height, axis)
    centre = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
    radius, line = np.inf, centre
    for step in range(steps):
        away = np.sum((flat - centre) ** 2, axis=1)
        far = int(np.argmax(away))
        if away[far] < radius**2:
            radius, line = float(np.sqrt(away[far])), centre
        centre = centre + (flat[far] - centre) / (step + 2)
    off = np.linalg.norm(flat - line, axis=1)
    cap = np.sqrt(np.maximum(radius**2 - off**2, 0.0))
    low, high = float(np.min(height + cap)), float(np.max(height - cap))
    if low > high:  # as short as it is wide: a ball
        low = high = 0.5 * (low + high)
        radius = float(np.max(np.hypot(off, height - low)))
    line = line - (line @ axis) * axis
    return Cover(np.array([line + low * axis, line + high * axis]), radius)


def _volume(capsule: Cover) -> float:
    length = float(np.linalg.norm(capsule.ends[1] - capsule.ends[0]))
    return float(np.pi * capsule.radius**2 * (length + 4.0 / 3.0 * capsule.radius))


def _corners(shape: coal.CollisionGeometry) -> Array:
    """Return points (m, 3) whose hull holds the shape."""
    if isinstance(shape, coal.Cylinder):
        angle = 2.0 * np.pi * np.arange(_RIM) / _RIM
        radius = shape.radius / np.cos(np.pi / _RIM)
        ring = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        half = np.full((_RIM, 1), shape.halfLength)
        return np.concatenate([np.hstack([ring, half]), np.hstack([ring, -half])])
    if hasattr(shape, "points"):  # a convex hull
        return np.array(shape.points())
    shape.computeLocalAABB()
    box = shape.aabb_local
    ends = np.array([box.min_, box.max_])
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])
