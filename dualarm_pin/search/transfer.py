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
_OF = 12  # best paths whose differences are taken
_CUT = 0.3  # rad: a path farther outside the bounds is not looked at
_SAME = 0.3  # rad: a smaller change leads back to the path it was made from, or to a known one
_TWICE = 0.2  # rad: nearer to one that was returned before it would end where that did
# Share of the best above it: prices are not quite independent, and a path that ends a little above
# the best holds a choice that the next transfer takes from it.
_MARGIN = 5e-3
_LOOKS = 150  # sums of three that are made in one call at most: beyond, looking costs more than it


class Transfers:
    """The transfers within a pool, each of which is returned once."""

    def __init__(self, problem: Problem, turns: Turns, pool: Pool) -> None:
        self.problem, self.turns, self.pool = problem, turns, pool
        self._number: dict[bytes, int] = {}
        self._seen: set[tuple[int, int, int]] = set()
        self._returned: list[Array] = []

    def promising(self, count: int) -> Array:
        """Return changed paths (s, k, n), `count` or fewer, that with the lowest promise first."""
        pool, turns = self.pool, self.turns
        known = np.array(pool.paths)
        found: list[Array] = []
        for looks, (base, one, other) in enumerate(self._fresh()):
            if looks == _LOOKS or len(found) == count:
                break
            self._seen.add(self._key(base, one, other))
            shift = turns.nearest(known[one] - known[other])
            q = turns.folded((known[base] + shift)[None])[0]
            if np.abs(shift).max() < _SAME or self._outside(q) > _CUT:
                continue
            if _nearest(known, q) < _SAME or _nearest(self._returned, q) < _TWICE:
                continue
            found.append(q)
            self._returned.append(q)
        return np.array(found).reshape(-1, *known.shape[1:])

    def _fresh(self) -> list[tuple[int, int, int]]:
        """Return base, one and other of the sums not looked at that promise enough, best first."""
        values = np.array(self.pool.objectives[:_OF])
        promise = values[:, None, None] + values[None, :, None] - values[None, None, :]
        limit = self.pool.best + _MARGIN * abs(self.pool.best)
        triples = np.argwhere(promise < limit)
        order = np.argsort(promise[promise < limit], kind="stable")
        return [
            (base, one, other)
            for base, one, other in triples[order].tolist()
            # base + one - other is one + base - other
            if base < one
            and other not in (base, one)
            and self._key(base, one, other) not in self._seen
        ]

    def _key(self, *places: int) -> tuple[int, int, int]:
        base, one, other = (
            self._number.setdefault(self.pool.paths[at].tobytes(), len(self._number))
            for at in places
        )
        return base, one, other

    def _outside(self, q: Array) -> float:
        return float(np.maximum(self.problem.lower - q, q - self.problem.upper).max())


def _nearest(paths: Array | list[Array], q: Array) -> float:
    """Return how far the nearest of paths (s, k, n) is from q, infinite without any."""
    if not len(paths):
        return np.inf
    return float(np.abs(np.asarray(paths) - q).max(axis=(1, 2)).min())
