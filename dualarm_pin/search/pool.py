"""The pool: the best paths that a search has met, one of each flat valley, from which it hops."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]
# Two paths of nearly one objective and nearly one place lie in one flat valley: one of them is kept
_SAME_OBJECTIVE, _SAME_JOINT = 1e-3, 0.3
_KEPT = 20
_FAVOUR = 2.0  # a path e^-1 times as likely to be picked as that two places before it
_TIRED = 20  # after so many hops in vain a path is half as likely to be picked: some lead nowhere
_RIVALS = 4  # starts are dropped above this one of the pool ...
_NEAR = 0.25  # what a path is worth that becomes such a rival, where a new best is worth 1
_CLOSE = 0.02  # ... but never within this share of the best


class Pool:
    """Distinct paths, best first.

    Attributes:
        paths: Joints (k, n) of each.
        objectives: Of each, ascending.
        picks: How often each was picked.
        won: What was offered so far: one for each new best, a part for each that came near it.
    """

    def __init__(self) -> None:
        self.paths: list[Array] = []
        self.objectives: list[float] = []
        self.picks: list[int] = []
        self.won = 0.0

    @property
    def best(self) -> float:
        """The lowest objective, infinite without any path."""
        return self.objectives[0] if self.objectives else np.inf

    @property
    def limit(self) -> float:
        """An objective above which no start is worth finishing."""
        if len(self.objectives) <= _RIVALS:
            return np.inf
        return max(self.objectives[_RIVALS], self.best + _CLOSE * abs(self.best))

    def offer(self, q: Array, objective: float) -> None:
        """Take a path (k, n) in, if it is good enough and not there."""
        for at, (path, value) in enumerate(zip(self.paths, self.objectives, strict=True)):
            close = abs(value - objective) < _SAME_OBJECTIVE * abs(objective)
            if close and np.abs(path - q).max() < _SAME_JOINT:
                if objective >= value:
                    return
                del self.paths[at], self.objectives[at], self.picks[at]
                break
        at = int(np.searchsorted(self.objectives, objective))
        self.won += self._worth(at, objective)
        self.paths.insert(at, q)
        self.objectives.insert(at, float(objective))
        self.picks.insert(at, 0)
        del self.paths[_KEPT:], self.objectives[_KEPT:], self.picks[_KEPT:]

    def _worth(self, at: int, objective: float) -> float:
        """Return what a path is worth that comes to a place: nothing if it is a twin of another."""
        around = self.objectives[max(0, at - 1) : at + 1]
        if any(abs(v - objective) < TOLERANCE.same_objective * abs(v) for v in around):
            return 0.0
        return 1.0 if at == 0 else _NEAR if at <= _RIVALS else 0.0

    def merged(self, others: Sequence[Pool]) -> Pool:
        """Return a new pool of the paths of this one and others."""
        pool = Pool()
        for each in (self, *others):
            for q, objective in zip(each.paths, each.objectives, strict=True):
                pool.offer(q, objective)
        return pool

    def pick(self, random: np.random.Generator) -> int:
        """Draw a path, the better the likelier, but less so the more often it was drawn.

        Twins of one objective share its chance.
        """
        values = np.array(self.objectives)
        fresh = np.diff(values, prepend=-np.inf) > TOLERANCE.same_objective * np.abs(values)
        place = np.cumsum(fresh) - 1
        weight = np.exp(-place / _FAVOUR) / np.bincount(place)[place]
        weight /= 1.0 + np.array(self.picks) / _TIRED
        at = int(random.choice(len(weight), p=weight / weight.sum()))
        self.picks[at] += 1
        return at
