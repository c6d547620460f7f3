"""Read STL meshes, binary or text, in the unit of the file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from dualarm_pin.arrays import Array, Integers

_VERTEX = re.compile(rb"vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def read_stl(raw: bytes, _path: Path) -> tuple[Array, Integers]:
    """Return corners (m, 3), each once and in ascending order, and triangles (k, 3).

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
    # As np.unique over rows, but several times faster.
    order = np.lexsort(corners.T[::-1])
    ascending = corners[order]
    new = np.ones(len(corners), dtype=bool)
    new[1:] = (ascending[1:] != ascending[:-1]).any(axis=1)
    place = np.empty(len(corners), dtype=np.int64)
    place[order] = np.cumsum(new) - 1
    return ascending[new], place.reshape(-1, 3)
