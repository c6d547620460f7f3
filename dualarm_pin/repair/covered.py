"""A search over paths whose capsules stay apart: they end near paths whose bodies do.

A search needs thousands of distances, and those of bodies are dear; capsules around the bodies are
rows that the engine knows. They are fatter than the bodies, so much is taken off for each pair as
was measured where the two were near. The pairs that lack most in what a round found have rows from
the next round on.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.engine.solve import Options
from dualarm_pin.problem import Problem
from dualarm_pin.repair.dips import INNER, inner_postures
from dualarm_pin.repair.survey import Survey
from dualarm_pin.search.independent import IndependentSearch
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

_POSTURES = 8  # of a path, at which its bodies are measured
_BETWEEN = 4  # postures between its points, at which they are looked at
_PATHS = 2  # paths, the best first, from which is learnt
_WORST = 3  # pairs of a posture that have rows from then on: those beside them move with them
_REACH = 0.03  # m: pairs so near say how much fatter their capsules are
# m: pairs deeper in each other say it less well, and those farther apart do not count.
_CLOSE, _APART = 0.04, 0.01
_AGAIN, _SEEDS = 0.06, 8  # m: paths that lack less take part in the next round, the best ones
_SEED = Options(TOLERANCE.search, 60, 1e-2, 1e-2)  # new rows move them a little
_BEYOND = 1.3  # a step like the last one that would end beyond so many times the work is not begun
_FATTER = 0.02  # m: so much are capsules fatter than bodies, until anything is measured
# Which of the measured values is taken off, in turn: with less off the bodies are sure to be apart,
# with more the path is better and some of it has to be mended.
_SHARES = (0.6, 0.6, 0.6, 0.9, 0.75, 0.95)
_NUMBER = 200  # of the first search, far from those that look without capsules
_ALIKE = 1e-3  # of the objective: minima nearer than this are twins, of which one is enough


class CoveredSearch:
    """Rounds of a search, each with rows for more pairs.

    Attributes:
        paths: Objective, path (k, n) and what its bodies lack [m], of the last round.
    """

    def __init__(self, survey: Survey, *, seed: int, jobs: int | None) -> None:
        self.survey = survey
        self.paths: list[tuple[float, Array, float]] = []
        self._seed, self._jobs, self._rounds, self._rows = seed, jobs, 0, -1
        pairs = survey.pairs
        self._active = np.zeros(len(pairs.number), dtype=bool)
        self._near: list[list[float]] = [[] for _ in pairs.number]
        self._deep = np.full(len(pairs.number), -np.inf)

    @property
    def rows(self) -> int:
        """How many pairs have rows in the next round."""
        return int(self._active.sum())

    def learn(self, q: Array) -> float:
        """Measure some points of a path (k, n); return what bodies lack at most on it [m].

        That is looked for where capsules are nearest, between points too: a path that jumps
        through a body keeps it apart at its points.
        """
        some = q[:: max(1, len(q) // _POSTURES)]
        found, gaps = self.survey.contacts(some, _REACH), self.survey.capsule_gaps(some)
        lacking = np.flatnonzero(found.lack > TOLERANCE.clearance)
        order = lacking[np.lexsort((-found.lack[lacking], found.point[lacking]))]
        place = np.arange(len(order)) - np.searchsorted(found.point[order], found.point[order])
        self._active[found.pair[order[place < _WORST]]] = True
        self._active &= self.survey.covered
        fatter = -found.lack - gaps[found.point, found.pair]
        for pair, lack, much in zip(found.pair.tolist(), found.lack, fatter, strict=True):
            if -_APART < lack < _CLOSE:
                self._near[pair].append(float(much))
            elif lack >= _CLOSE:
                self._deep[pair] = max(self._deep[pair], float(much))
        between = inner_postures(q)
        gaps = (self.survey.capsule_gaps(between) + self._reduced())[:, self.survey.covered]
        nearest = np.argsort(gaps.min(axis=1, initial=np.inf), kind="stable")[::INNER][:_BETWEEN]
        return max(found.worst, self.survey.contacts(between[np.sort(nearest)], 0.0).worst)

    def round(self, work: float) -> None:
        """Search for so many seconds of work.

        What the last round came to takes part where it lacks little. A round with the rows of the
        last one hops from that and draws no more.

        Raises:
            OverError: The meter of the survey has had enough.
            KeyboardInterrupt: Ctrl-C.
        """
        number, self._rounds = _NUMBER + self._rounds, self._rounds + 1
        search = IndependentSearch(self._problem(), self._seed, number=number, jobs=self._jobs)
        seeds = np.array([q for _, q, lack in self.paths if lack < _AGAIN][:_SEEDS])
        if len(seeds):
            self._enter(search, seeds)
        hops, self._rows = len(seeds) > 0 and self.rows == self._rows, self.rows
        spent = last = 0.0
        while search.work.spent < work and search.work.spent + last < _BEYOND * work:
            before = search.work.spent
            if hops and search.pool.paths:
                search.hops.make()
            else:
                search.step()
            last = search.work.spent - before
            self.survey.meter.searched(search.work.spent - spent)
            spent = search.work.spent
        pool = search.pool
        paths = differing(list(zip(pool.objectives, pool.paths, strict=True)))
        lacks = [self.learn(q) for _, q in paths[:_PATHS]]
        lacks += [max(lacks, default=0.0)] * (len(paths) - len(lacks))
        self.paths = [(value, q, lack) for (value, q), lack in zip(paths, lacks, strict=True)]

    def _enter(self, search: IndependentSearch, seeds: Array) -> None:
        """Let paths (s, k, n) take part in a search, moved to where its rows hold them."""
        problem = search.track.problem
        ends = engine.solve_many(problem, seeds, jobs=self._jobs, options=_SEED)
        search.work.add(int(ends.iterations.sum()) * problem.k)
        for q, value in zip(
            search.track.turns.folded(ends.q[ends.feasible]),
            ends.objective[ends.feasible].tolist(),
            strict=True,
        ):
            search.pool.offer(q, value)

    def _problem(self) -> Problem:
        active = np.tile(self._active, (self.survey.problem.k, 1))
        rows = self.survey.capsule_table(active, self._reduced())
        return self.survey.problem.with_pairs(rows)

    def _reduced(self) -> Array:
        """Return what is taken off the capsules of each pair (p,) [m]."""
        share = _SHARES[max(self._rounds - 1, 0) % len(_SHARES)]
        reduced = np.where(self._deep > -np.inf, self._deep, _FATTER)
        for pair, much in enumerate(self._near):
            if much:
                reduced[pair] = np.quantile(much, share)
        return reduced


def differing(minima: Sequence[tuple[float, Array]]) -> list[tuple[float, Array]]:
    """Return one of those of equal objective."""
    found: list[tuple[float, Array]] = []
    for value, path in minima:
        if not found or value > found[-1][0] + _ALIKE * max(1.0, abs(value)):
            found.append((value, path))
    return found
