"""Splices: paths put together from parts of several, by dynamic programming over the points.

A jump from one path to another costs its link, lowered as if it were spread over a few points:
refining does spread it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.search.turns import Turns

Array = NDArray[np.float64]
_SPREAD = (2, 3, 5)  # a link over m points weighs 1 / m^3


def splices(
    problem: Problem, turns: Turns, paths: Array, values: Array, random: np.random.Generator
) -> Iterator[Array]:
    """Yield the cheapest combination of paths for each spread, where it is none of the paths.

    Args:
        problem: The problem.
        turns: Of its joints: a jump goes to the nearest turn of a path.
        paths: (s, k, n), s of 3 or more.
        values: (s, k) objective of every point.
        random: Half of the combinations are made from half of the paths.
    """
    count = len(paths)
    for spread in _SPREAD:
        some = np.arange(count)
        if random.random() < 0.5:
            some = np.sort(random.choice(count, max(2, count // 2), replace=False))
        chosen = _cheapest(problem, turns, paths[some], values[some], spread)
        if len(set(chosen.tolist())) > 1:
            q = turns.unwound(paths[some][chosen, np.arange(problem.k)])
            if q is not None:
                yield q


def _cheapest(
    problem: Problem, turns: Turns, paths: Array, values: Array, spread: int
) -> NDArray[np.int64]:
    """Return which path each point is taken from (k,)."""
    count, k = values.shape
    share = np.full((count, count), 1.0 / spread**3)
    np.fill_diagonal(share, 1.0)
    cost, came = values[:, 0].copy(), np.zeros((k, count), dtype=np.int64)
    for i in range(1, k):
        step = turns.nearest(paths[:, None, i - 1] - paths[None, :, i])
        square = np.sum(problem.links.metric[i - 1] * step**2, axis=2)
        total = cost[:, None] + problem.links.weight[i - 1] * square**2 * share
        came[i] = total.argmin(axis=0)
        cost = total.min(axis=0) + values[:, i]
    chosen = np.zeros(k, dtype=np.int64)
    chosen[-1] = cost.argmin()
    for i in range(k - 1, 0, -1):
        chosen[i - 1] = came[i, chosen[i]]
    return chosen
