"""How far a body reaches: bounds on what its points can move when a joint turns."""

from __future__ import annotations

import coal
import numpy as np

from dualarm_pin.arrays import Array


def corners_of(body: coal.CollisionGeometry) -> Array:
    """Return points (m, 3) [m], in the frame of a body, whose convex hull holds the body."""
    if isinstance(body, coal.BVHModelBase):
        return np.array(body.vertices())
    if isinstance(body, coal.ConvexBase):
        return np.array(body.points())
    body.computeLocalAABB()
    low, high = np.array(body.aabb_local.min_), np.array(body.aabb_local.max_)
    return np.array([np.where(upper, high, low) for upper in np.ndindex(2, 2, 2)])


def ball_of(body: coal.CollisionGeometry) -> tuple[Array, float]:
    """Return centre (3,) and radius [m] of a ball, in the frame of a body, that holds the body."""
    corners = corners_of(body)
    centre = (corners.min(axis=0) + corners.max(axis=0)) / 2.0
    return centre, float(np.linalg.norm(corners - centre, axis=1).max())
