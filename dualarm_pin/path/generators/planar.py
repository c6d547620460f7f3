"""Lines and arcs in a plane of constant height: corner, circle, arc, raster.

Their normal is the z axis of e1, so a tool with the default rotation stands on the plane.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Unpack

import numpy as np

from dualarm_pin.errors import InputError
from dualarm_pin.path import Path
from dualarm_pin.path.generators.arguments import (
    Angle,
    Point2,
    Shares,
    about_z,
    middle,
    not_zero,
    positive,
)
from dualarm_pin.path.generators.curve import Samples
from dualarm_pin.path.generators.follow import Follow, Hold, follow, hold
from dualarm_pin.path.generators.piece import UP, flat
from dualarm_pin.path.generators.polyline import rounded


def corner(
    side: float = 0.15,
    fillet: float = 0.01,
    height: float = 0.3,
    points: Shares = (13, 5, 13),
    *,
    step: float | None = None,
    **how: Unpack[Hold],
) -> Path:
    """Return the corner of the paper's section IV.B, up along y and back along x.

    Args:
        side: Length l of a side [m].
        fillet: Radius r of the fillet [m].
        height: z of the plane [m].
        points: Three numbers h1, h2, h3 of points on the first side, the fillet and the second
            side, exactly by the paper's formulas; or one number, evenly by arc length.
        step: Largest distance of neighbours [m], instead of `points`, such as `0.01`.
        **how: See `Hold`.

    Raises:
        InputError: A length that is not positive, a fillet larger than the side, or fewer than
            (2, 0, 2) points.
    """
    positive(side=side)
    if not 0.0 < fillet < side:
        message = f"a radius above 0 and below the side {side:g} is expected; given {fillet:g}"
        raise InputError(message, field="fillet")
    if step is not None:
        points = None if points == (13, 5, 13) else points
    if points is None or isinstance(points, int | np.integer):
        vertices = [[side, 0.0, height], [side, side, height], [0.0, side, height]]
        pieces = [flat(piece) for piece in rounded(np.array(vertices), fillet)]
        return follow(pieces, "corner", {**how, "points": points, "step": step})
    if step is not None:
        raise InputError("give one of `points` and `step`: both are given", field="points")
    return hold(_paper(side, fillet, height, points), "corner", how)


def circle(
    radius: float,
    *,
    center: Point2 = (0.0, 0.0),
    height: float = 0.3,
    start: Angle = 0.0,
    turns: float = 1.0,
    **how: Unpack[Follow],
) -> Path:
    """Return a circle, counter-clockwise seen from +z; first and last point are the same place.

    Args:
        radius: Above 0 [m], such as `0.1`.
        center: x and y [m].
        height: z of the plane [m].
        start: Angle of the first point from x [rad], such as `0.0`.
        turns: How often it goes round; negative for clockwise.
        **how: See `Follow`.

    Raises:
        InputError: A radius that is not positive, or no turn.
    """
    not_zero(turns=turns)
    piece = about_z(radius, center, height, start, 2 * math.pi * turns)
    return follow([piece], "circle", how)


def arc(
    radius: float,
    start: Angle,
    stop: Angle,
    *,
    center: Point2 = (0.0, 0.0),
    height: float = 0.3,
    **how: Unpack[Follow],
) -> Path:
    """Return an arc about z from the angle `start` to `stop`.

    Args:
        radius: Above 0 [m], such as `0.1`.
        start: Angle of the first point from x [rad], such as `0.0`.
        stop: Angle of the last point [rad], such as `1.5707963268`; below `start` for clockwise.
        center: x and y [m].
        height: z of the plane [m].
        **how: See `Follow`.

    Raises:
        InputError: A radius that is not positive, or both angles the same.
    """
    if start == stop:
        raise InputError("the arc has no length: start and stop are the same", field="stop")
    return follow([about_z(radius, center, height, start, stop - start)], "arc", how)


def raster(
    width: float,
    depth: float,
    rows: int,
    *,
    fillet: float = 0.0,
    center: Point2 = (0.0, 0.0),
    height: float = 0.3,
    **how: Unpack[Follow],
) -> Path:
    """Return rows to and fro along x, one beside the other along y.

    Args:
        width: Length of a row [m], such as `0.24`.
        depth: Distance of the first and the last row [m], such as `0.16`.
        rows: Number of rows, 2 or more, such as `5`.
        fillet: Radius at the ends of the rows [m]; 0 for sharp corners.
        center: x and y of the middle [m].
        height: z of the plane [m].
        **how: See `Follow`.

    Raises:
        InputError: A length that is not positive, fewer than 2 rows, or a fillet too large.
    """
    positive(width=width, depth=depth)
    if not 2 <= rows <= 10_000:
        raise InputError(f"2 to 10000 rows are expected; given {rows}", field="rows")
    x = np.tile([-0.5, 0.5, 0.5, -0.5], rows)[: 2 * rows] * width
    y = np.repeat(np.linspace(-0.5, 0.5, rows), 2) * depth
    vertices = np.column_stack([x, y, np.zeros(2 * rows)]) + middle(center, height)
    return follow([flat(piece) for piece in rounded(vertices, fillet)], "raster", how)


def _paper(side: float, r: float, height: float, points: Sequence[int]) -> Samples:
    """Return x_i and t_i of section IV.B, with the arc length along the exact curve."""
    if len(points) != 3 or points[0] < 2 or points[1] < 0 or points[2] < 2:
        message = f"three numbers, at least [2, 0, 2], or one number; given {list(points)}"
        raise InputError(message, field="points")
    h1, h2, h3 = points
    inner = side - r
    up = inner * np.arange(h1) / (h1 - 1)
    angle = 0.5 * math.pi * np.arange(1, h2 + 1) / (h2 + 1)
    back = inner * (1.0 - np.arange(h3) / (h3 - 1))
    x = np.concatenate([np.full(h1, side), inner + r * np.cos(angle), back])
    y = np.concatenate([up, inner + r * np.sin(angle), np.full(h3, side)])
    tx = np.concatenate([np.zeros(h1), -np.sin(angle), np.full(h3, -1.0)])
    ty = np.concatenate([np.ones(h1), np.cos(angle), np.zeros(h3)])
    s = np.concatenate([up, inner + r * angle, 2 * inner + 0.5 * math.pi * r - back])
    h = h1 + h2 + h3
    return Samples(
        np.column_stack([x, y, np.full(h, height)]),
        np.column_stack([tx, ty, np.zeros(h)]),
        s,
        np.broadcast_to(UP, (h, 3)),
    )
