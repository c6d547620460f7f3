"""A pair of capsules, one of body a and one of body b, that stay a distance apart.

    g = min_{s, t} |x_b(t) - x_a(s)| - apart,   x_a(s), x_b(t) on the two segments

with `apart` the two radii and the distance that is asked for. A sphere is a segment of no length.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array, finite
from dualarm_pin.errors import InputError
from dualarm_pin.rows.row import Row

_NO_LENGTH = 1e-18  # m^2: a shorter segment is a point
_PARALLEL = 1e-8  # square of the sine of an angle below which one point of the nearest is kept


def capsules(
    first: str,
    second: str,
    segment_a: ArrayLike,
    segment_b: ArrayLike,
    apart: float,
    *,
    points: Sequence[int] | None = None,
    name: str | None = None,
) -> Row:
    """Keep two segments apart.

    Args:
        first: Frame a.
        second: Frame b.
        segment_a: (2, 3) its two ends in a [m].
        segment_b: (2, 3) its two ends in b [m].
        apart: Least distance of the segments: radii and clearance [m].
        points: Points of the path, from 0; all by default.
        name: Name for tables.

    Raises:
        InputError: A number is not finite, or the distance is negative.
    """
    ends = [finite(segment_a, "segment_a", (2, 3)), finite(segment_b, "segment_b", (2, 3))]
    if not 0.0 <= apart < np.inf:
        raise InputError(f"is {apart}, must be 0 or more", field="apart")
    return Row(
        name=name or f"{first} and {second} {apart:g} m apart",
        first=first,
        second=second,
        phi=capsule_pair,
        slope=capsule_pair_slope,
        parameters=np.array([*np.ravel(ends), apart]),
        points=None if points is None else tuple(points),
    )


def capsule_pair(R: Array, p: Array, parameters: Array) -> float:
    """Return the distance of the segments minus `apart`; parameters are [a0; a1; b0; b1; apart]."""
    x_a, x_b = _nearest(R, p, parameters)
    return float(np.linalg.norm(x_b - x_a) - parameters[12])


def capsule_pair_slope(R: Array, p: Array, parameters: Array) -> Array:
    """Return [n; (x_b - p) x n] for the unit vector n from x_a to x_b."""
    x_a, x_b = _nearest(R, p, parameters)
    n = (x_b - x_a) / np.linalg.norm(x_b - x_a)
    return np.concatenate([n, np.cross(x_b - p, n)])


def _nearest(R: Array, p: Array, parameters: Array) -> tuple[Array, Array]:
    """Return the points of the two segments that are nearest to each other, in a."""
    a0, a1, b0, b1 = parameters[:12].reshape(4, 3)
    x, y = p + R @ b0, p + R @ b1
    along_a, along_b, between = a1 - a0, y - x, a0 - x
    a, b, r = along_a, along_b, between
    products = [float(np.dot(*pair)) for pair in ((a, a), (a, b), (b, b), (a, r), (b, r))]
    s, t, _, _ = nearest_of_segments(*products)
    return a0 + s * along_a, x + t * along_b


def nearest_of_segments(
    aa: float, ab: float, bb: float, ar: float, br: float
) -> tuple[float, float, bool, bool]:
    """Return where two segments are nearest, after Ericson (2005), section 5.1.9.

    The engine compiles this very function.

    Args:
        aa: a . a for the segments x_a = A + s a and x_b = B + t b.
        ab: a . b.
        bb: b . b.
        ar: a . (A - B).
        br: b . (A - B).

    Returns:
        s and t in [0, 1], and whether each moves with the bodies (it is not at an end).
    """
    s = 0.0
    if bb <= _NO_LENGTH:
        s = 0.0 if aa <= _NO_LENGTH else min(max(-ar / aa, 0.0), 1.0)
        return s, 0.0, 0.0 < s < 1.0, False
    square = aa * bb - ab * ab
    crossing = aa > _NO_LENGTH and square > _PARALLEL * aa * bb
    if crossing:
        s = min(max((ab * br - ar * bb) / square, 0.0), 1.0)
    t = (ab * s + br) / bb
    if t < 0.0 or t > 1.0:
        t = 0.0 if t < 0.0 else 1.0
        s = 0.0 if aa <= _NO_LENGTH else min(max((t * ab - ar) / aa, 0.0), 1.0)
        return s, t, 0.0 < s < 1.0, False
    return s, t, crossing and 0.0 < s < 1.0, 0.0 < t < 1.0
