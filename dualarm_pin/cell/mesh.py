"""Load a mesh once: as it is for the eye, as its convex hull for collisions."""

from __future__ import annotations

import struct
from functools import lru_cache
from pathlib import Path

import coal
import numpy as np

from dualarm_pin.cell.native import captured_stderr
from dualarm_pin.errors import InputError

_LARGEST = 500_000_000  # bytes


def load_mesh(path: Path, scale: tuple[float, float, float], hull: bool) -> coal.CollisionGeometry:
    """Return the mesh at `path`, or its convex hull.

    Args:
        path: STL, DAE, OBJ or another format that Assimp reads.
        scale: Factors along x, y and z.
        hull: Return the convex hull, as collision checks want it.

    Raises:
        InputError: It is damaged, empty, or of an unknown format.
    """
    stamp = path.stat()
    return _load(path, scale, hull, stamp.st_mtime_ns, stamp.st_size)


@lru_cache(maxsize=1024)
def _load(
    path: Path, scale: tuple[float, float, float], hull: bool, _changed: int, size: int
) -> coal.CollisionGeometry:
    if not 0 < size < _LARGEST:
        raise InputError("the mesh is empty" if not size else "the mesh is too large", file=path)
    if path.suffix.lower() == ".stl":
        _check_stl(path, size)
    if hull:
        return _hull(_load(path, scale, False, _changed, size), path)
    with captured_stderr() as written:
        try:
            mesh = coal.MeshLoader().load(str(path), np.array(scale))
            vertices = mesh.vertices()
        except Exception as error:  # the bindings raise whatever Assimp throws
            reason = (written() or str(error)).splitlines()
            raise InputError(f"not a mesh: {reason[-1] if reason else error}", file=path) from error
    if mesh.num_tris < 1 or not np.isfinite(vertices).all():
        raise InputError("the mesh has no triangles or no finite corners", file=path)
    return mesh


def _hull(mesh: coal.BVHModelBase, path: Path) -> coal.CollisionGeometry:
    # A flat mesh has no hull: QJ joggles its corners by a hair so that it gets one.
    with captured_stderr():
        for options in ("Qt", "QJ"):
            try:
                mesh.buildConvexHull(True, options)
            except Exception:
                continue
            return mesh.convex
    raise InputError("the mesh has no convex hull", file=path)


def _check_stl(path: Path, size: int) -> None:
    """Refuse a binary STL that is shorter than it says before Assimp reads it."""
    with path.open("rb") as file:
        head = file.read(84)
    if head[:5].lower() == b"solid" and size != _stl_size(head):
        return
    if len(head) < 84 or size < _stl_size(head):
        raise InputError("not a mesh: the STL file is truncated", file=path)


def _stl_size(head: bytes) -> int:
    triangles: int = struct.unpack("<I", head[80:84])[0] if len(head) == 84 else 0
    return 84 + 50 * triangles
