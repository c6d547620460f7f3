"""Transfers: a good path changed, at every point, by what two others differ in.

What one arm, or one half of the path, may do in two ways combines freely with what the others do:
the difference of two paths is one such choice, and added to a third it makes that choice there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.search.pool import Pool
from dualarm_pin.search.turns import Turns

Array = NDArray[np.float64]
_OF = 12  # best paths whose differences are taken
_CUT = 0.3  # rad: a path farther outside the bounds is not looked at
_SAME = 0.3  # rad: a smaller change leads back to the path it was made from
_TRIES = 4  # draws for each path that is asked for


def transfers(
    problem: Problem, turns: Turns, pool: Pool, count: int, random: np.random.Generator
) -> Array:
    """Return changed paths (s, k, n) of a pool of three or more, `count` or fewer."""
    lower, upper = problem.lower, problem.upper
    found: list[Array] = []
    for _ in range(_TRIES * count):
        base = pool.paths[pool.pick(random)]
        one, other = random.choice(min(len(pool.paths), _OF), 2, replace=False)
        shift = turns.nearest(pool.paths[one] - pool.paths[other])
        q = turns.folded((base + shift)[None])[0]
        if np.abs(shift).max() < _SAME or np.maximum(lower - q, q - upper).max() > _CUT:
            continue
        found.append(q)
        if len(found) == count:
            break
    return np.array(found).reshape(-1, *pool.paths[0].shape)
