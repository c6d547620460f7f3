"""The same path with other points, by arc length."""

from __future__ import annotations

import itertools

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.path.generators.curve import at_arc_length, knots_of, sample
from dualarm_pin.path.generators.piece import line_piece
from dualarm_pin.path.generators.spatial import spline_pieces
from dualarm_pin.path.path import Path, repeated


def resample(
    path: Path, *, points: int | None = None, step: float | None = None, smooth: bool = False
) -> Path:
    """Return points on the curve through the points of a path.

    Rotations turn by the shortest way from one given point to the next; directions go straight,
    and stay the tangents where they were; `rows` are those of the given point before.

    Args:
        path: The path.
        points: How many points; or
        step: the largest distance of neighbours [m]. With neither the points stay, and `smooth`
            gives them the tangents of the spline.
        smooth: The curve is a cubic spline through the points instead of straight lines, whose
            corners sharper than 20 degrees are points.

    Raises:
        InputError: Both `points` and `step`, or points in one place (the tool turns on the spot).
    """
    if len(still := repeated(path.position)):
        message = f"the tool turns on the spot at points {still[0] + 1} and {still[0] + 2}"
        raise InputError(f"{message}: such a path is not resampled", field="position")
    if smooth:
        pieces = spline_pieces(path.position, "position")
    else:
        pieces = [line_piece(start, stop) for start, stop in itertools.pairwise(path.position)]
    knots = knots_of(pieces)
    if points is None and step is None:
        samples = at_arc_length(pieces, knots)
    else:
        samples = sample(pieces, points=points, step=step)
    s = np.clip(samples.arc_length, 0.0, knots[-1])
    before = np.clip(np.searchsorted(knots, s * (1 + 1e-12), side="right") - 1, 0, path.h - 1)
    along = np.hstack([path.tangent, np.zeros((path.h, 3))])
    return Path(
        samples.position,
        _between_rotations(path.rotation, knots, s),
        u=None if np.array_equal(path.u, along) else _between(path.u, knots, s),
        rows=path.rows[before],
        spin_axis=path.spin_axis,
        tangent=samples.tangent,
        arc_length=samples.arc_length,
        name=path.name,
    )


def _between_rotations(rotation: Array, knots: Array, s: Array) -> Array:
    if len(s) == len(knots) and np.array_equal(s, knots):
        return rotation
    from scipy.spatial.transform import Rotation, Slerp

    return np.asarray(Slerp(knots, Rotation.from_matrix(rotation))(s).as_matrix())


def _between(u: Array, knots: Array, s: Array) -> Array:
    return np.column_stack([np.interp(s, knots, column) for column in u.T])
