"""Read STL and OBJ meshes.

The usual importer (Assimp) crashes or hangs on damaged files, and a robot of a stranger must do
neither; these formats are small enough to read here.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Triangles = NDArray[np.int64]
_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def read_stl(raw: bytes) -> tuple[Points, Triangles]:
    """Return corners (m, 3) and triangles (k, 3) of an STL file, binary or text.

    Raises:
        ValueError: It is damaged.
    """
    count = int.from_bytes(raw[80:84], "little")
    size = 84 + 50 * count
    if raw[:5].lower() == b"solid" and size != len(raw):
        corners = np.array(_VERTEX.findall(raw)).astype(float).reshape(-1, 3)
        if len(corners) % 3:
            raise ValueError("the STL file is truncated")
    else:
        if len(raw) < size or len(raw) < 84:
            raise ValueError("the STL file is truncated")
        record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
        corners = np.frombuffer(raw, record, count, 84)["corners"].astype(float).reshape(-1, 3)
    points, inverse = np.unique(corners, axis=0, return_inverse=True)
    return points, inverse.reshape(-1, 3)


def read_obj(raw: bytes) -> tuple[Points, Triangles]:
    """Return corners (m, 3) and triangles (k, 3) of a Wavefront OBJ file.

    Raises:
        ValueError: It is damaged.
    """
    points: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    for line in raw.replace(b"\\\n", b" ").splitlines():
        words = line.split()
        if not words:
            continue
        if words[0] == b"v":
            points.append([float(word) for word in words[1:4]])
        elif words[0] == b"f":
            face = [int(word.partition(b"/")[0]) for word in words[1:]]
            face = [k - 1 if k > 0 else len(points) + k for k in face]
            triangles += [(face[0], face[k], face[k + 1]) for k in range(1, len(face) - 1)]
    corners = np.array(points, dtype=float).reshape(-1, 3)
    return corners, np.array(triangles, dtype=np.int64).reshape(-1, 3)


READERS = {".stl": read_stl, ".obj": read_obj}


def read_mesh(path: Path) -> tuple[Points, Triangles]:
    """Return corners (m, 3) [the unit of the file, metres for Collada] and triangles (k, 3).

    Raises:
        ValueError: It is damaged, or of another format than STL, OBJ or Collada.
        OSError: It cannot be read.
    """
    from dualarm_pin.meshes.formats.collada import read_collada

    suffix = path.suffix.lower()
    if suffix == ".dae":
        points, triangles = read_collada(path.read_bytes(), path)
    elif suffix in READERS:
        points, triangles = READERS[suffix](path.read_bytes())
    else:
        raise ValueError(f"{suffix or 'no suffix'} is not read: convert it to STL, OBJ or DAE")
    if not len(triangles):
        raise ValueError("the mesh has no triangles")
    if triangles.min() < 0 or triangles.max() >= len(points):
        raise ValueError("a triangle names a corner that does not exist")
    return points, triangles
