"""The smallest distances between bodies at the points of a path, whatever is asked of them.

Between two points the bodies of a pair come nearer to each other by no more than they travel, so
on a path of many points most pairs are measured at a few of them only.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.trajectory import Distances
from dualarm_pin.arrays import Array
from dualarm_pin.clearance.travel import travel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dualarm_pin.cell import Cell

_SHARP = 1e-5  # m; how far Coal's distance of hulls may be off, many times over
_SINGLE = 8  # pairs measured one by one at a point; then all of them at once are cheaper


def distances_along(cell: Cell, q: Array) -> tuple[Distances | None, Distances | None]:
    """Return the smallest distances at joints q (m, n): of all pairs, and between the arms.

    Convex hulls are compared first; they never say more than there is. Where they touch, the
    meshes themselves decide.

    Returns:
        None for what is not known: where a body is missing, or there is no pair to compare.
    """
    everywhere, arms = np.ones(len(cell.pairs), dtype=bool), cell.between_arms
    if cell.missing_meshes or not len(cell.pairs):
        return None, None
    groups = [everywhere, arms] if arms.any() else [everywhere]
    found = np.zeros((len(groups), len(q)))
    pair = np.zeros(found.shape, dtype=np.int64)
    bound = np.full(len(cell.pairs), -np.inf)
    moved = travel(cell, q) + _SHARP if len(q) > 1 else np.zeros((0, len(bound)))
    for i, q_i in enumerate(q):
        if i:
            bound -= moved[i - 1]
        at = _Posture(cell, q_i, bound)
        for number, group in enumerate(groups):
            pair[number, i], found[number, i] = at.nearest(group)
    every, *between = (
        Distances(d, tuple(cell.pairs[k] for k in which))
        for d, which in zip(found, pair, strict=True)
    )
    return every, between[0] if between else None


class _Posture:
    """Pairs at one posture, measured when it matters.

    Args:
        cell: The two arms.
        q: Joints (n,).
        bound: What no pair is nearer than (p,) [m]; what is measured is written into it.
    """

    def __init__(self, cell: Cell, q: Array, bound: Array) -> None:
        self._cell, self._q, self._bound = cell, q, bound
        self._fresh = np.zeros(len(bound), dtype=bool)
        self._exact: dict[int, float] = {}
        self._single = 0

    def nearest(self, group: NDArray[np.bool_]) -> tuple[int, float]:
        """Return the nearest pair of a group, and its distance [m]."""
        best, pair, touch = np.inf, -1, False
        waiting = np.where(group, self._bound, np.inf)
        while True:
            k = int(np.argmin(waiting))
            if waiting[k] >= best:
                return pair, best
            if not self._fresh[k]:
                self._measure(k)
                waiting = np.where(group & (waiting < np.inf), self._bound, np.inf)
                continue
            touch = touch or (pair < 0 and waiting[k] <= 0.0)  # the nearest hulls: meshes decide
            distance = self._meshes(k) if touch else waiting[k]
            if distance < best:
                best, pair = float(distance), k
            waiting[k] = np.inf

    def _measure(self, k: int) -> None:
        if self._single == _SINGLE or self._bound[k] == -np.inf:
            self._bound[:] = self._cell.distances(self._q)
            self._fresh[:] = True
        else:
            self._bound[k] = self._cell.distance(self._q, k)
            self._fresh[k] = True
            self._single += 1

    def _meshes(self, k: int) -> float:
        if k not in self._exact:
            self._exact[k] = self._cell.distance(self._q, k, exact=True)
        return self._exact[k]
