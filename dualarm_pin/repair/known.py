"""Distances of meshes that are known from nearby poses: measuring them is dear.

Between two relative poses a distance changes by at most what the second body moves against the
first, and no point of a body moves more than the corners of a box around it.
"""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array

_KEPT = 64  # poses of each pair, the newest
_NEARLY = 5e-3  # m: meshes that met are taken to meet, so that their hulls say how deep


class Known:
    """What was measured between two bodies.

    Args:
        points: Points whose hull holds the second body (m, 3), in its joint's frame [m].
    """

    def __init__(self, points: Array) -> None:
        low, high = points.min(axis=0), points.max(axis=0)
        self._box = np.array([np.where(upper, high, low) for upper in np.ndindex(2, 2, 2)])
        self._at = np.zeros((_KEPT, 8, 3))
        self._distance = np.full(_KEPT, -np.inf)
        self._next = 0

    def least(self, pose: Array) -> tuple[float, bool]:
        """Say what is known at a pose (4, 4) of the second body in the first.

        Returns:
            A distance [m] that they keep, and whether they met at nearly this pose.
        """
        away = np.linalg.norm(self._at - self._corners(pose), axis=2).max(axis=1)
        met = (self._distance <= 0.0) & (away < _NEARLY) & np.isfinite(self._distance)
        return float(np.max(self._distance - away)), bool(met.any())

    def add(self, pose: Array, distance: float) -> None:
        """Keep what was measured at a pose (4, 4) [m]."""
        self._at[self._next], self._distance[self._next] = self._corners(pose), distance
        self._next = (self._next + 1) % _KEPT

    def _corners(self, pose: Array) -> Array:
        return np.asarray(self._box @ pose[:3, :3].T + pose[:3, 3])
