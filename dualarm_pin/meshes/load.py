"""Load a mesh once: as it is for the eye, as its convex hull for collisions."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import coal
import numpy as np

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.errors import InputError
from dualarm_pin.meshes.formats import read_mesh
from dualarm_pin.meshes.hull import convex_hull, too_round

_LARGEST = 500_000_000  # bytes
_MOST = 2_000_000  # triangles: the tree over a million takes four seconds, its hull two
_FAR = 1e6  # m


def load_mesh(path: Path, scale: tuple[float, float, float], hull: bool) -> coal.CollisionGeometry:
    """Return the mesh at `path`, or its convex hull.

    Args:
        path: A file of one of the formats of `meshes.formats`.
        scale: Factors along x, y and z.
        hull: Return the convex hull, as collision checks want it.

    Raises:
        InputError: It is damaged, empty, or of an unknown format.
    """
    try:
        stamp = path.stat()
        return _load(path, scale, hull, stamp.st_mtime_ns, stamp.st_size)
    except (OSError, ValueError, LookupError, ArithmeticError, MemoryError) as error:
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
    if len(triangles) > _MOST:
        message = (
            f"{len(triangles)} triangles are more than {_MOST}, which take ten seconds to load: "
            "simplify the mesh, for instance to 20000 triangles"
        )
        raise InputError(message, file=path)
    points = points * scale
    if not np.abs(points).max(initial=0.0) < _FAR:
        raise ValueError("a corner is not finite or absurdly far away")
    if hull:
        corners = points[np.unique(triangles)]
        if too_round(corners):
            message = (
                f"{len(triangles)} triangles, nearly every corner of them on the convex hull, are "
                "too many: simplify the mesh, for instance to 20000 triangles"
            )
            raise InputError(message, file=path)
        return convex_hull(corners)
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(triangles), len(points))
    mesh.addVertices(points)
    mesh.addTriangles(triangles)
    mesh.endModel()
    return mesh


@lru_cache(maxsize=64)
def _read(path: Path, _changed: int, _size: int) -> tuple[Array, Integers]:
    return read_mesh(path)
