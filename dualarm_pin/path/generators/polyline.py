"""Straight lines from vertex to vertex, with or without fillets."""

from __future__ import annotations

import math
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array, finite
from dualarm_pin.errors import InputError
from dualarm_pin.files.numbers import LARGEST
from dualarm_pin.path.generators.arguments import Points3
from dualarm_pin.path.generators.follow import Follow, follow
from dualarm_pin.path.generators.piece import Piece, arc_piece, line_piece
from dualarm_pin.path.path import Path, repeated
from dualarm_pin.tolerance import TOLERANCE


def polyline(
    vertices: Points3, *, fillet: float = 0.0, closed: bool = False, **how: Unpack[Follow]
) -> Path:
    """Return straight lines through vertices in space.

    Args:
        vertices: Shape (k, 3), in e1 [m], such as `[[0, 0, 0.3], [0.1, 0, 0.3], [0.1, 0.1, 0.3]]`.
        fillet: Radius at every inner vertex [m]; 0 for sharp corners, which are points then.
        closed: Go back to the start; with a fillet it starts behind the one of the first vertex.
        **how: See `Follow`.

    Raises:
        ShapeError: Another shape.
        InputError: Fewer than two vertices, two that coincide, a negative fillet, or one too large
            for a side; the message names the vertex and the largest radius.
    """
    return follow(rounded(distinct(vertices, "vertices"), fillet, closed), "polyline", how)


def distinct(value: ArrayLike, field: str) -> Array:
    """Return points of which no two neighbours coincide, shape (k, 3) with k at least 2.

    Raises:
        ShapeError: Another shape.
        InputError: Fewer than two points, or neighbours that coincide.
    """
    points = finite(value, field, (-1, 3))
    if len(points) < 2:
        raise InputError(f"2 points or more are expected; given {len(points)}", field=field)
    if np.abs(points).max() > LARGEST:
        i = int(np.argmax(np.abs(points).max(axis=1))) + 1
        message = f"point {i} is farther than {LARGEST:g} m: {points[i - 1].tolist()}"
        raise InputError(message, field=field)
    if len(twice := repeated(points)):
        i = twice[0] + 1
        raise InputError(f"points {i} and {i + 1} coincide: remove one of them", field=field)
    return points


def rounded(vertices: Array, fillet: float, closed: bool = False) -> list[Piece]:
    """Return the lines between vertices, and the arcs of radius `fillet` at them.

    Args:
        vertices: Shape (k, 3), neighbours apart [m].
        fillet: Radius [m], or 0.
        closed: Go back to the start.

    Raises:
        InputError: A negative fillet, or one too large for a side.
    """
    if not (fillet >= 0.0 and math.isfinite(fillet)):
        raise InputError(f"a radius of 0 or more is expected; given {fillet:g}", field="fillet")
    if closed:
        back = np.linalg.norm(vertices[0] - vertices[-1]) <= TOLERANCE.coincident
        vertices = np.vstack([vertices[:-1] if back else vertices, vertices[:1]])
    sides = np.diff(vertices, axis=0)
    length = np.linalg.norm(sides, axis=1)
    way = sides / length[:, None]
    turn = np.arccos(np.clip(np.sum(way * np.roll(way, -1, axis=0), axis=1), -1.0, 1.0))
    if not closed:
        turn[-1] = 0.0
    tangent_of_half = np.tan(0.5 * np.concatenate([turn[-1:], turn]))
    _refuse_large(fillet, tangent_of_half, length)
    cut = fillet * tangent_of_half
    pieces: list[Piece] = []
    for k, side in enumerate(way):
        start, stop = vertices[k] + cut[k] * side, vertices[k + 1] - cut[k + 1] * side
        if length[k] - cut[k] - cut[k + 1] > TOLERANCE.coincident:
            pieces.append(line_piece(start, stop))
        if cut[k + 1] > TOLERANCE.coincident:
            # From the tangent point, `inward` points to the centre of the fillet.
            following = way[(k + 1) % len(way)]
            inward = following - (following @ side) * side
            inward /= np.linalg.norm(inward)
            center = stop + fillet * inward
            pieces.append(arc_piece(center, -fillet * inward, fillet * side, float(turn[k])))
    return pieces


def _refuse_large(fillet: float, tangent_of_half: Array, length: Array) -> None:
    needed = tangent_of_half[:-1] + tangent_of_half[1:]
    if fillet > 0.0 and np.any(fillet * needed > length * (1.0 + 1e-12)):
        k = int(np.argmax(fillet * needed - length))
        largest = float(np.min(length / np.maximum(needed, 1e-300)))
        raise InputError(
            f"a radius of {fillet:g} m does not fit between vertex {k + 1} and the next, "
            f"{length[k]:g} m away; the largest that fits everywhere is {largest:.4g} m",
            field="fillet",
        )
