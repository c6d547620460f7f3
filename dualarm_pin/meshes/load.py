"""Load a mesh once: as it is for the eye, as its convex hull for collisions."""

from __future__ import annotations

from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import coal
import numpy as np

from dualarm_pin.meshes.formats.obj import Points, Triangles, read_mesh
from dualarm_pin.cpp_messages import captured_stderr
from dualarm_pin.errors import InputError

_LARGEST = 500_000_000  # bytes
_THIN = 1e-4  # m, and share of its size: a body thinner than this is made so thick
_FAR = 1e6  # m


def load_mesh(path: Path, scale: tuple[float, float, float], hull: bool) -> coal.CollisionGeometry:
    """Return the mesh at `path`, or its convex hull.

    Args:
        path: STL, OBJ or Collada (DAE).
        scale: Factors along x, y and z.
        hull: Return the convex hull, as collision checks want it.

    Raises:
        InputError: It is damaged, empty, or of an unknown format.
    """
    try:
        stamp = path.stat()
        return _load(path, scale, hull, stamp.st_mtime_ns, stamp.st_size)
    except (OSError, ValueError, LookupError, MemoryError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"not a mesh: {error}", file=path) from error


@lru_cache(maxsize=1024)
def _load(
    path: Path, scale: tuple[float, float, float], hull: bool, changed: int, size: int
) -> coal.CollisionGeometry:
    if not 0 < size < _LARGEST:
        raise ValueError("the file is empty" if not size else "the file is too large")
    points, triangles = _read(path, changed, size)
    points = points * scale
    if not np.abs(points).max(initial=0.0) < _FAR:
        raise ValueError("a corner is not finite or absurdly far away")
    if hull:
        return _hull(points[np.unique(triangles)], path)
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(triangles), len(points))
    mesh.addVertices(points)
    mesh.addTriangles(triangles)
    mesh.endModel()
    return mesh


@lru_cache(maxsize=64)
def _read(path: Path, _changed: int, _size: int) -> tuple[Points, Triangles]:
    return read_mesh(path)


def _hull(corners: Points, path: Path) -> coal.CollisionGeometry:
    # Coal does not survive a set of points without volume, so those are given some.
    points = coal.StdVec_Vec3s()
    for point in _thickened(corners):
        points.append(point)
    # QJ joggles the corners by a hair: it helps where many facets meet in one corner.
    for options in ("Qt", "QJ"):
        with captured_stderr(), suppress(RuntimeError, ValueError):
            return coal.Convex.convexHull(points, True, options)
    raise InputError("the mesh has no convex hull", file=path)


def _thickened(points: Points) -> Points:
    """Return points (m, 3) whose hull is nowhere thinner than `_THIN`; flat ones are doubled."""
    centred = points - points.mean(axis=0)
    size = np.abs(centred).max()
    axes = np.linalg.eigh(centred.T @ centred)[1].T
    thin = max(_THIN, _THIN * size)
    for axis in axes:
        if np.ptp(points @ axis) < thin:
            points = np.concatenate([points + thin / 2 * axis, points - thin / 2 * axis])
    return points
