"""Curves in space: helix, and a smooth curve through points."""

from __future__ import annotations

import itertools
import math
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.errors import InputError
from dualarm_pin.path import Path
from dualarm_pin.path.generators.arguments import Angle, Point2, Points3, about_z, not_zero
from dualarm_pin.path.generators.follow import Follow, follow
from dualarm_pin.path.generators.piece import Piece
from dualarm_pin.path.generators.polyline import distinct
from dualarm_pin.tolerance import TOLERANCE


def helix(
    radius: float,
    pitch: float,
    turns: float,
    *,
    center: Point2 = (0.0, 0.0),
    height: float = 0.3,
    start: Angle = 0.0,
    **how: Unpack[Follow],
) -> Path:
    """Return a helix about z, rising from `height`.

    Args:
        radius: Above 0 [m], such as `0.06`.
        pitch: Rise of one turn [m], such as `0.04`; negative to go down.
        turns: How often it goes round, such as `2`; negative for clockwise seen from +z.
        center: x and y of the axis [m].
        height: z of the first point [m].
        start: Angle of the first point from x [rad].
        **how: See `Follow`.

    Raises:
        InputError: A radius that is not positive, or no turn.
    """
    not_zero(turns=turns)
    angle, rise = 2 * math.pi * turns, pitch * abs(turns)
    return follow([about_z(radius, center, height, start, angle, rise)], "helix", how)


def spline(through: Points3, *, closed: bool = False, **how: Unpack[Follow]) -> Path:
    """Return the cubic spline through points, smooth to its second derivative.

    The parameter is the chord length; open ends have no curvature of their own ("not-a-knot").

    Args:
        through: Shape (k, 3), in e1 [m], such as `[[0, 0, 0.3], [0.1, 0, 0.3], [0.1, 0.1, 0.3]]`;
            at least 2, or 3 when closed.
        closed: Go back to the first point, smoothly.
        **how: See `Follow`.

    Raises:
        ShapeError: Another shape.
        InputError: Too few points, or neighbours that coincide.
    """
    return follow(spline_pieces(through, "through", closed), "spline", how)


def spline_pieces(through: ArrayLike, field: str, closed: bool = False) -> list[Piece]:
    """Return one cubic piece for each pair of neighbouring points."""
    from scipy.interpolate import CubicSpline

    points = distinct(through, field)
    if closed and np.linalg.norm(points[0] - points[-1]) > TOLERANCE.coincident:
        points = np.vstack([points, points[:1]])
    if closed and len(points) < 4:
        message = f"a closed curve needs 3 points or more; given {len(points) - 1}"
        raise InputError(message, field=field)
    if closed:
        points[-1] = points[0]
    knots = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    curve = CubicSpline(knots, points, bc_type="periodic" if closed else "not-a-knot")
    slope = curve.derivative()
    # A cubic is smooth: 64 panels in all, and a few in each piece, are plenty.
    panels = max(4, 64 // len(points))

    def piece(a: float, b: float) -> Piece:
        return Piece(
            lambda t: np.asarray(curve(a + t * (b - a))),
            lambda t: np.asarray((b - a) * slope(a + t * (b - a))),
            even=False,
            panels=panels,
        )

    return [piece(a, b) for a, b in itertools.pairwise(knots)]
