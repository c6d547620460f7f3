"""Points on a curve made of pieces, by arc length."""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.files.numbers import MOST_POINTS
from dualarm_pin.path.generators.piece import Piece
from dualarm_pin.tolerance import TOLERANCE

SHARP = math.radians(20.0)
"""A curve that turns by more at one place has a corner there, and the corner gets a point."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Points on a curve.

    Attributes:
        position: Shape (h, 3), in e1 [m].
        tangent: Unit tangents, shape (h, 3). At a corner: the mean of the directions in which the
            curve comes and leaves; where it turns straight back, the one in which it leaves.
        arc_length: Exact arc length from the start of the curve, shape (h,) [m].
        normal: Outward unit normals of the surface, shape (h, 3), or None.
    """

    position: Array
    tangent: Array
    arc_length: Array
    normal: Array | None


def sample(
    pieces: Sequence[Piece], *, points: int | None = None, step: float | None = None
) -> Samples:
    """Return points on a curve, evenly by arc length between its corners.

    Both ends and every corner sharper than `SHARP` are points.

    Args:
        pieces: The curve, in order, each starting where the one before ends.
        points: How many points; or
        step: Largest distance of neighbours along the curve [m].

    Raises:
        InputError: Both or neither of the two given, not enough points for the corners, or a curve
            without length.
    """
    if (points is None) == (step is None):
        given = "neither is" if points is None else "both are"
        raise InputError(f"give one of `points` and `step`: {given} given", field="points")
    if not pieces:
        raise InputError("the curve has no length: nothing is left of it")
    starts = knots_of(pieces)
    arrives, leaves = _end_tangents(pieces)
    turn = np.arccos(np.clip(np.sum(arrives[:-1] * leaves[1:], axis=1), -1.0, 1.0))
    corners = np.concatenate([[0.0], starts[1:-1][turn > SHARP], [starts[-1]]])
    counts = _share(np.diff(corners), points, step)
    stretches = zip(corners, corners[1:], counts, strict=False)
    s = [np.linspace(a, b, n + 1)[1:] for a, b, n in stretches]
    return at_arc_length(pieces, np.concatenate([[0.0], *s]))


def at_arc_length(pieces: Sequence[Piece], s: Array) -> Samples:
    """Return the points of a curve at the arc lengths `s` from its start, shape (h,)."""
    starts = knots_of(pieces)
    close = 1e-9 * starts[-1]
    which = np.clip(np.searchsorted(starts, s + close, side="right") - 1, 0, len(pieces) - 1)
    position, tangent, normal = np.zeros((3, len(s), 3))
    for k in np.unique(which):
        here = which == k
        t = pieces[k].parameter(s[here] - starts[k])
        position[here] = pieces[k].point(t)
        tangent[here] = pieces[k].derivative(t)
        if (along := pieces[k].normal) is not None:
            normal[here] = along(t)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    joints = np.flatnonzero((np.abs(s - starts[which]) <= close) & (which > 0))
    if len(joints):
        arrives, _ = _end_tangents([pieces[k - 1] for k in which[joints]])
        tangent[joints] = _mean(arrives, tangent[joints])
    surface = all(piece.normal is not None for piece in pieces)
    return Samples(position, tangent, s, normal if surface else None)


def knots_of(pieces: Sequence[Piece]) -> Array:
    """Return the arc length at the start of each piece and at the end, shape (k + 1,) [m]."""
    return np.concatenate([[0.0], np.cumsum([piece.length for piece in pieces])])


def _share(stretches: Array, points: int | None, step: float | None) -> list[int]:
    """Return the number of intervals of each stretch, so that the longest interval is shortest."""
    if step is not None:
        if not step > 0.0:
            raise InputError(f"a length above 0 is expected; given {step}", field="step")
        intervals = [max(1.0, np.ceil(length / step - 1e-9)) for length in stretches]
        if not sum(intervals) < MOST_POINTS:
            message = (
                f"a step of {step:g} m gives more than {MOST_POINTS} points: take a larger one"
            )
            raise InputError(message, field="step")
        return [int(n) for n in intervals]
    if points is None or points < len(stretches) + 1:
        needed = f"this curve with {len(stretches) - 1} corners needs {len(stretches) + 1}"
        raise InputError(f"{needed} points or more; given {points}", field="points")
    counts = [1] * len(stretches)
    queue = [(-round(float(length), 12), k) for k, length in enumerate(stretches)]
    heapq.heapify(queue)
    for _ in range(points - 1 - len(stretches)):
        _, k = queue[0]
        counts[k] += 1
        # Rounded, so that stretches of one length get the same share whatever the last digit.
        heapq.heapreplace(queue, (-round(float(stretches[k]) / counts[k], 12), k))
    return counts


def _mean(arrives: Array, leaves: Array) -> Array:
    """Return the unit mean of two directions, or the second where they are opposite."""
    mean = arrives + leaves
    length, least = np.linalg.norm(mean, axis=1, keepdims=True), TOLERANCE.parallel
    return np.where(length > least, mean / np.maximum(length, least), leaves)


def _end_tangents(pieces: Sequence[Piece]) -> tuple[Array, Array]:
    """Return unit tangents at the end and at the start of each piece."""
    ends = np.array([piece.derivative(np.array([1.0, 0.0])) for piece in pieces])
    ends = ends / np.linalg.norm(ends, axis=2, keepdims=True)
    return ends[:, 0], ends[:, 1]
