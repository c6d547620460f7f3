"""Read Wavefront OBJ meshes, in the unit of the file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dualarm_pin.arrays import Array, Integers


def read_obj(raw: bytes, _path: Path) -> tuple[Array, Integers]:
    """Return corners (m, 3) and triangles (k, 3); materials are not looked at.

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
