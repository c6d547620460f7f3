"""Convex hulls that Coal survives."""

from __future__ import annotations

from contextlib import suppress

import coal
import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cpp_messages import captured_stderr

_MANY = 200_000  # corners; a hull of so many takes five seconds, and as long to draw
_SAMPLE = 5_000  # corners: their hull takes a tenth of a second
_SHARE = 0.6  # robots and castings have up to a third of a sample on its hull, balls all of it
_THIN = 1e-4  # m, and share of its size: a body thinner than this is made so thick


def convex_hull(corners: Array) -> coal.CollisionGeometry:
    """Return the convex hull of corners (m, 3) [m].

    Raises:
        ValueError: They have none.
    """
    # Coal does not survive a set of points without volume, so those are given some.
    points = coal.StdVec_Vec3s()
    for point in _thickened(corners):
        points.append(point)
    # QJ joggles the corners by a hair: it helps where many facets meet in one corner.
    for options in ("Qt", "QJ"):
        with captured_stderr(), suppress(RuntimeError, ValueError):
            return coal.Convex.convexHull(points, True, options)
    raise ValueError("it has no convex hull")


def too_round(corners: Array) -> bool:
    """Tell from a sample whether a hull has too many corners: a finely cut ball has only such."""
    if len(corners) <= _MANY:
        return False
    sample = corners[np.random.default_rng(0).choice(len(corners), _SAMPLE, replace=False)]
    hull = convex_hull(sample)
    return isinstance(hull, coal.ConvexBase) and hull.num_points > _SHARE * _SAMPLE


def _thickened(points: Array) -> Array:
    """Return points (m, 3) whose hull is nowhere thinner than `_THIN`; flat ones are doubled."""
    centred = points - points.mean(axis=0)
    size = np.abs(centred).max()
    axes = np.linalg.eigh(centred.T @ centred)[1].T
    thin = max(_THIN, _THIN * size)
    for axis in axes:
        if np.ptp(points @ axis) < thin:
            points = np.concatenate([points + thin / 2 * axis, points - thin / 2 * axis])
    return points
