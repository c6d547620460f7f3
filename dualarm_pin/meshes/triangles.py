"""Triangles of Coal's bodies: meshes, convex hulls and primitives."""

from __future__ import annotations

from dataclasses import dataclass

import coal
import numpy as np
from numpy.typing import NDArray

from dualarm_pin.arrays import Array, Integers

_LARGEST = 6_000  # triangles of one mesh; beyond it detail is lost on a screen and pages swell
_SIDES = 32


@dataclass(frozen=True, eq=False)
class Triangles:
    """A body as corners on a grid and faces.

    Attributes:
        corners: Whole numbers 0..65535, shape (v, 3).
        faces: Indices of corners, counter-clockwise from outside, shape (f, 3).
        origin: Corner of the grid, shape (3,) [m].
        step: Width of the grid along each axis, shape (3,) [m].
    """

    corners: Integers
    faces: Integers
    origin: Array
    step: Array


def triangles_of(body: coal.CollisionGeometry) -> Triangles | None:
    """Return the surface of `body`, or None if it has none that can be drawn (a half-space)."""
    surface = _surface(body)
    if surface is None or not len(surface[1]):
        return None
    vertices, faces = surface
    if len(faces) > _LARGEST:
        vertices, faces = _coarser(vertices, faces)
    origin = vertices.min(axis=0)
    step = np.maximum(np.ptp(vertices, axis=0), 1e-9) / 65535
    corners, faces = _weld(np.rint((vertices - origin) / step).astype(np.int64), faces)
    return Triangles(corners, faces, origin, step)


def _surface(body: coal.CollisionGeometry) -> tuple[Array, Integers] | None:
    if isinstance(body, coal.BVHModelBase):
        faces = [body.tri_indices(k) for k in range(body.num_tris)]
        return np.array(body.vertices()), np.array([[t[0], t[1], t[2]] for t in faces])
    if isinstance(body, coal.ConvexBase):
        return _hull(np.array(body.points()))
    if isinstance(body, coal.Box):
        signs = np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
        return _hull(signs * np.asarray(body.halfSide))
    if isinstance(body, coal.Sphere):
        return _capsule(body.radius, 0.0)
    if isinstance(body, coal.Capsule):
        return _capsule(body.radius, body.halfLength)
    if isinstance(body, coal.Cylinder):
        rim = _ring(body.radius)
        ends = [np.column_stack([rim, np.full(_SIDES, z * body.halfLength)]) for z in (-1, 1)]
        return _hull(np.vstack(ends))
    return None


def _hull(points: Array) -> tuple[Array, Integers]:
    from scipy.spatial import ConvexHull  # half a second that only pictures need

    hull = ConvexHull(points, qhull_options="QJ Pp")
    faces = hull.simplices.astype(np.int64)
    a, b, c = (points[faces[:, k]] for k in range(3))
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) > 0
    faces[~outward] = faces[~outward][:, ::-1]
    return points, faces


def _ring(radius: float) -> Array:
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def _capsule(radius: float, half: float) -> tuple[Array, Integers]:
    tilt = np.linspace(0, np.pi / 2, _SIDES // 4 + 1)[:-1]
    rows = [[0.0, 0.0, -half - radius], [0.0, 0.0, half + radius]]
    for side in (-1, 1):
        for a in tilt:
            rim = _ring(radius * np.cos(a))
            height = side * (half + radius * np.sin(a))
            rows += np.column_stack([rim, np.full(_SIDES, height)]).tolist()
    return _hull(np.array(rows))


def _weld(corners: Integers, faces: Integers) -> tuple[Integers, Integers]:
    _, first, place = np.unique(_key(corners), return_index=True, return_inverse=True)
    faces = place.reshape(-1)[faces]
    return corners[first], faces[_proper(faces)]


def _coarser(vertices: Array, faces: Integers) -> tuple[Array, Integers]:
    """Merge corners that share a cell of an ever coarser grid until few triangles are left."""
    low, size = vertices.min(axis=0), float(np.ptp(vertices, axis=0).max())
    for cells in (256, 192, 128, 96, 64, 48, 32, 24):
        grid = np.floor((vertices - low) * (cells / size)).astype(np.int64)
        places, where = np.unique(_key(grid), return_inverse=True)
        where = where.reshape(-1)
        kept = where[faces]
        kept = kept[_proper(kept)]
        _, first = np.unique(_key(np.sort(kept, axis=1)), return_index=True)
        kept = kept[first]
        if len(kept) <= _LARGEST:
            break
    merged = np.zeros((len(places), 3))
    np.add.at(merged, where, vertices)
    return merged / np.bincount(where)[:, None], kept


def _key(rows: Integers) -> Integers:
    """Return one number for each row of three numbers below 2^21: unique rows in no time."""
    return (rows[:, 0] << 42) | (rows[:, 1] << 21) | rows[:, 2]


def _proper(faces: Integers) -> NDArray[np.bool_]:
    a, b, c = faces.T
    proper: NDArray[np.bool_] = (a != b) & (b != c) & (c != a)
    return proper
