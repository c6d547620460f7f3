"""A search over paths whose capsules stay apart, which end near paths whose bodies do.

Distances of bodies are dear and the search needs many; capsules are rows that the engine knows.
They are fatter than the bodies: of each pair so much is taken off as was measured. The pairs that
come nearest in what was found have rows in the next round.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.engine.solve import Options
from dualarm_pin.repair.bodies import OFF_CHAIN
from dualarm_pin.repair.survey import Survey
from dualarm_pin.search.anchored import anchor_points
from dualarm_pin.search.independent import IndependentSearch
from dualarm_pin.search.pool import Pool
from dualarm_pin.search.starts import generator
from dualarm_pin.search.turns import Turns
from dualarm_pin.search.work import Work
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

_POSTURES = 8  # of a path, at which its bodies are measured
_PATHS = 3  # paths, the best first, from which is learnt
_WORST = 2  # pairs of a posture, those that lack most, that have rows from then on
_REACH = 0.03  # m: pairs that are so near tell how much fatter their capsules are
_CLOSE = 0.04  # m: nearer ones tell it better than those that are deep in each other
_FATTER = 0.02  # m: so much are capsules fatter than bodies before anything is measured
_QUANTILE = 0.6  # of what was measured of a pair: rather too thin, what is missing is added later
_GOES_ON = 6  # paths that go on with more rows
_NUMBER = 200  # of the first search, so that its numbers are no other's
LOOPS, TIGHT, SEED0, FRESH =0, True, False, True
_ALIKE = 1e-3  # of the objective: minima nearer than this are twins, of which one is enough
_AGAIN = Options(TOLERANCE.search, 60, 1e-2, 1e-2)


class CoveredSearch:
    """Rounds of a search, each with rows for more pairs.

    Attributes:
        paths: Objective, path (k, n) and what its bodies lack [m], of the last round.
    """

    def __init__(self, survey: Survey, *, seed: int, jobs: int | None) -> None:
        self.survey, self.paths = survey, list[tuple[float, Array, float]]()
        self._seed, self._jobs, self._rounds = seed, jobs, 0
        pairs = survey.pairs
        on_chain = (survey.joints.segment[pairs.joint] != OFF_CHAIN).all(axis=1)
        self._may = on_chain & (pairs.tight if TIGHT else True)
        self._active = np.zeros(len(pairs.number), dtype=bool)
        self._fatter: list[list[float]] = [[] for _ in pairs.number]

    def learn(self, minima: Sequence[Array]) -> None:
        """Learn which pairs come near from minima (k, n) and from minima of single points."""
        for q in minima[:_PATHS]:
            self._measured(q[:: max(1, len(q) // _POSTURES)])
        paths = np.array(minima[:_GOES_ON])
        for _ in range(LOOPS):
            problem = self._problem()
            ends = engine.solve_many(problem, paths, jobs=self._jobs, options=_AGAIN)
            self.survey.meter.searched(Work(problem).seconds(int(ends.iterations.sum()) * problem.k))
            order = np.argsort(ends.objective)
            paths = ends.q[order]
            for q in paths[:_PATHS]:
                self._measured(q[:: max(1, len(q) // _POSTURES)])
        if SEED0: self.paths = [(0.0, q, 0.0) for q in paths]

    def _problem(self):
        survey, k = self.survey, self.survey.problem.k
        rows = survey.capsule_table(np.tile(self._active, (k, 1)), self._reduced())
        return survey.problem.with_pairs(rows)

    def _measured(self, postures: Array) -> float:
        """Measure postures (m, n); return what their bodies lack at most [m]."""
        found, gaps = self.survey.contacts(postures, _REACH), self.survey.capsule_gaps(postures)
        for i in range(len(postures)):
            here = np.flatnonzero((found.point == i) & (found.lack > TOLERANCE.clearance))
            worst = here[np.argsort(-found.lack[here], kind="stable")][:_WORST]
            self._active[found.pair[worst]] = True
        fatter = -found.lack - gaps[found.point, found.pair]
        for pair, lack, much in zip(found.pair, found.lack, fatter, strict=True):
            self._fatter[pair].append((abs(float(lack)) > _CLOSE, float(much)))
        self._active &= self._may
        return found.worst

    def round(self, work: float) -> None:
        """Search for so many seconds of work."""
        survey, k = self.survey, self.survey.problem.k
        rows = survey.capsule_table(np.tile(self._active, (k, 1)), self._reduced())
        problem = survey.problem.with_pairs(rows)
        number = _NUMBER + self._rounds
        self._rounds += 1
        pool = Pool()
        if self.paths and not FRESH:
            starts = np.array([q for _, q, _ in self.paths[:_GOES_ON]])
            ends = engine.solve_many(problem, starts, jobs=self._jobs, options=_AGAIN)
            survey.meter.searched(Work(problem).seconds(int(ends.iterations.sum()) * k))
            for end in np.flatnonzero(ends.converged):
                pool.offer(ends.q[end], ends.objective[end])
        search = IndependentSearch(
            problem, self._seed, number=number, jobs=self._jobs, pool=pool if pool.paths else None
        )
        spent = 0.0
        while search.work.spent < work:
            search.step()
            survey.meter.searched(search.work.spent - spent)
            spent = search.work.spent
        paths = differing(list(zip(search.pool.objectives, search.pool.paths, strict=True)))
        lacks = [self._measured(q[:: max(1, k // _POSTURES)]) for _, q in paths[:_PATHS]]
        lacks += [max(lacks, default=0.0)] * (len(paths) - len(lacks))
        self.paths = [(value, q, lack) for (value, q), lack in zip(paths, lacks, strict=True)]

    def _reduced(self) -> Array:
        """Return what is taken off the radii of each pair (p,) [m]."""
        reduced = np.full(len(self._fatter), _FATTER)
        for pair, known in enumerate(self._fatter):
            close = [much for far, much in known if not far]
            if known:
                reduced[pair] = np.quantile(close, _QUANTILE) if close else max(m for _, m in known)
        return reduced


def differing(minima: Sequence[tuple[float, Array]]) -> list[tuple[float, Array]]:
    """Return one of those of equal objective."""
    found: list[tuple[float, Array]] = []
    for value, path in minima:
        if not found or value > found[-1][0] + _ALIKE * max(1.0, abs(value)):
            found.append((value, path))
    return found
