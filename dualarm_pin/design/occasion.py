"""When a global search should be run again while things move."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.arrays import Array
from dualarm_pin.design.pool import Pool
from dualarm_pin.problem import Problem
from dualarm_pin.tolerance import TOLERANCE

_CLOSE = 0.02  # of the best value: two members this near may change rank
_FAR, _FAR_TURN = 0.02, np.deg2rad(5.0)  # m and rad since the last search


class Occasion:
    """What was so at the last search.

    Args:
        names: Names of the parameters.
    """

    def __init__(self, names: tuple[str, ...]) -> None:
        self._turns = np.array([name.endswith(".yaw") for name in names])
        self._at = np.zeros(len(names))
        self._held = np.zeros(0, dtype=bool)

    def searched(self, values: Array) -> None:
        """Note that a search was run where the parameters (p,) have these values."""
        self._at = values.copy()

    def seen(self, pool: Pool, problem: Problem) -> None:
        """Note which joint limits hold the best motion now."""
        self._held = _held(pool, problem)

    def due(self, pool: Pool, problem: Problem, values: Array) -> str:
        """Return why a search should be run; empty if none is due."""
        members = pool.members
        if pool.lost or not members:
            return "a motion that was followed has ended"
        best = members[0].solution.objective
        if len(members) > 1 and members[1].solution.objective - best < _CLOSE * abs(best):
            return "two motions are nearly as good"
        before = self._held
        self.seen(pool, problem)
        if not np.array_equal(before, self._held):
            return "another joint limit holds"
        away = np.abs(values - self._at)
        if (away[self._turns] > _FAR_TURN).any() or (away[~self._turns] > _FAR).any():
            return "far from where the last search was"
        return ""


def _held(pool: Pool, problem: Problem) -> NDArray[np.bool_]:
    """Return which joints (n,) come to a bound on the best motion."""
    if not pool.members:
        return np.zeros(0, dtype=bool)
    q = pool.members[0].solution.q
    room = np.minimum(q - problem.lower, problem.upper - q)
    return np.asarray((room < TOLERANCE.active).any(axis=0))
