"""Transfers: a good path changed, at every point, by what two others differ in.

What one arm, or one half of the path, may do in two ways combines freely with what the others do:
the difference of two paths is one such choice, and added to a third it makes that choice there. If
the choices are independent so are their prices, and three objectives tell a fourth: only the few
transfers that promise to come near the best are looked at, each once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.search.pool import Pool
from dualarm_pin.search.turns import Turns

Array = NDArray[np.float64]
Triple = tuple[int, int, int]
_OF = 12  # best paths whose differences are taken
_CUT = 0.3  # rad: a path farther outside the bounds is not looked at
_SAME = 0.3  # rad: a smaller change leads back to the path it was made from, or to a known one
_TWICE = 0.2  # rad: nearer to one that was returned before it would end where that did
# Share of the best above it: prices are not quite independent, and a path that ends a little above
# the best holds a choice that the next transfer takes from it.
_MARGIN = 5e-3
_AT_ONCE = 32  # looked at together: few are left to look at once there are enough
_LOOKS = 150  # sums of three that are made in one call at most: beyond, looking costs more than it


class Transfers:
    """The transfers within a pool, each of which is returned once.

    Args:
        problem: Its bounds.
        turns: Full turns, that are no difference.
        pool: Paths (k, n) and their objectives.
    """

    def __init__(self, problem: Problem, turns: Turns, pool: Pool) -> None:
        self.problem, self.turns, self.pool = problem, turns, pool
        self._number: dict[bytes, int] = {}
        self._seen: set[Triple] = set()
        self._returned: Array | None = None

    def promising(self, count: int) -> Array:
        """Return changed paths (s, k, n), `count` or fewer, that with the lowest promise first."""
        known = np.array(self.pool.paths)
        returned = known[:0] if self._returned is None else self._returned
        fresh = self._fresh()[:_LOOKS]
        found: list[Array] = []
        for start in range(0, len(fresh), _AT_ONCE):
            if len(found) == count:
                break
            some = fresh[start : start + _AT_ONCE]
            for (_, key), q in zip(some, self._changed(known, [at for at, _ in some]), strict=True):
                if len(found) == count:
                    break
                self._seen.add(key)
                if not (np.isnan(q[0, 0]) or _near(returned, q, _TWICE)):
                    found.append(q)
                    returned = np.concatenate([returned, q[None]])
        self._returned = returned
        return np.array(found).reshape(-1, *known.shape[1:])

    def _changed(self, known: Array, triples: list[Triple]) -> Array:
        """Return the sums (s, k, n); not a number where nothing new can come of one."""
        base, one, other = np.array(triples).T
        shift = self.turns.nearest(known[one] - known[other])
        q = self.turns.folded(known[base] + shift)
        outside = np.maximum(self.problem.lower - q, q - self.problem.upper).max(axis=(1, 2))
        vain = (np.abs(shift).max(axis=(1, 2)) < _SAME) | (outside > _CUT)
        vain[~vain] = _nearest(known, q[~vain]) < _SAME
        q[vain] = np.nan
        return q

    def _fresh(self) -> list[tuple[Triple, Triple]]:
        """Return the sums not looked at that promise enough, best first.

        Of each: base, one and other by their places in the pool, and by the numbers of their paths.
        """
        values = np.array(self.pool.objectives[:_OF])
        promise = values[:, None, None] + values[None, :, None] - values[None, None, :]
        limit = self.pool.best + _MARGIN * abs(self.pool.best)
        base, one, other = np.nonzero(promise < limit)
        # base + one - other is one + base - other
        own = (base < one) & (other != base) & (other != one)
        triples = np.stack([base, one, other], axis=1)[own]
        order = np.argsort(promise[tuple(triples.T)], kind="stable")
        number = [
            self._number.setdefault(path.tobytes(), len(self._number))
            for path in self.pool.paths[:_OF]
        ]
        pairs = [
            ((a, b, c), (number[a], number[b], number[c])) for a, b, c in triples[order].tolist()
        ]
        return [each for each in pairs if each[1] not in self._seen]


def _nearest(paths: Array, q: Array) -> Array:
    """Return how far the nearest of paths (s, k, n) is from each of q (m, k, n) (m,)."""
    return np.array([np.abs(paths - one).max(axis=(1, 2)).min() for one in q])


def _near(paths: Array, q: Array, reach: float) -> bool:
    """Tell whether one of paths (s, k, n) is nearer than that to q (k, n); by their ends first."""
    ends = np.maximum(np.abs(paths[:, 0] - q[0]), np.abs(paths[:, -1] - q[-1])).max(axis=1)
    close = ends < reach
    return bool(close.any()) and bool((np.abs(paths[close] - q).max(axis=(1, 2)) < reach).any())
