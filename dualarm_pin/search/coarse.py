"""The coarse path: a few points stand for all, to tell promising basins from hopeless ones.

Each point weighs as many points as it stands for. A link over m steps weighs lambda / m^3, since
m equal steps of d/m cost m lambda |d/m|^4. So the coarse objective comes close to that of the
whole path, at a sixth of the price.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem

Array = NDArray[np.float64]
# Points of the coarse path: a sixth of all, but enough to follow a corner and few enough to pay.
LEAST, MOST, SHARE = 7, 12, 6


@dataclass(frozen=True, eq=False)
class Coarse:
    """A problem over some of its points.

    Attributes:
        problem: The coarse problem.
        points: Which points of the path it holds, the first and the last among them.
        k: Number of points of the whole path.
    """

    problem: Problem
    points: NDArray[np.int64]
    k: int

    def start(self, q: Array) -> Array:
        """Return a start (k, n) of the whole path from a coarse one, linear between its points."""
        along = np.arange(self.k)
        return np.stack([np.interp(along, self.points, column) for column in q.T], axis=1)


def coarse_of(problem: Problem, most: int | None = None) -> Coarse:
    """Return the coarse path of a problem without fixed neighbours.

    Args:
        problem: The whole path.
        most: How many points it has, or all there are; by default a share of them.
    """
    k = problem.k
    count = min(k, max(LEAST, min(MOST, k // SHARE)) if most is None else most)
    points = np.unique(np.round(np.linspace(0, k - 1, count)).astype(np.int64))
    steps = np.diff(points)
    mean = [problem.links.weight[a:b].mean() for a, b in itertools.pairwise(points)]
    part = problem.subset(list(points), np.array(mean) / steps**3)
    nearest = np.abs(np.arange(k)[:, None] - points[None]).argmin(axis=1)
    weight = np.zeros(len(points))
    np.add.at(weight, nearest, problem.points.index_weight)
    return Coarse(part.with_points(index_weight=weight), points, k)
