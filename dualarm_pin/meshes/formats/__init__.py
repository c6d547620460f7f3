"""Mesh formats: one module each, and the table of their readers.

To add a format, write a module with a reader `(bytes, path) -> (corners, triangles)` that raises
`ValueError` for damaged files, and give its suffix a row in `READERS`.

Why not a library: Assimp crashes or hangs on damaged files. Trimesh leaves out, without a word,
what it finds damaged, so that a clearance would be too large; it also refuses Collada sources
without names of their columns, does not apply the unit of a Collada file, and takes half a second
to import.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.meshes.formats.collada import read_collada
from dualarm_pin.meshes.formats.obj import read_obj
from dualarm_pin.meshes.formats.stl import read_stl

READERS: dict[str, Callable[[bytes, Path], tuple[Array, Integers]]] = {
    ".stl": read_stl,
    ".obj": read_obj,
    ".dae": read_collada,
}


def read_mesh(path: Path) -> tuple[Array, Integers]:
    """Return corners (m, 3) [the unit of the file, metres for Collada] and triangles (k, 3).

    Raises:
        ValueError: It is damaged, or of a format that is not in `READERS`.
        OSError: It cannot be read.
    """
    suffix = path.suffix.lower()
    if suffix not in READERS:
        raise ValueError(f"{suffix or 'no suffix'} is not read: convert it to STL, OBJ or DAE")
    points, triangles = READERS[suffix](path.read_bytes(), path)
    if not len(triangles):
        raise ValueError("the mesh has no triangles")
    if triangles.min() < 0 or triangles.max() >= len(points):
        raise ValueError("a triangle names a corner that does not exist")
    return points, triangles
