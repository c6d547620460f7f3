"""The track law: minima of single points, walked through the path, the best of them refined.

On cells where one posture for all points is far from any path this reaches, at the price of one
such start, sixty paths that already follow it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.search.anchored import anchor_points
from dualarm_pin.search.coarse import coarse_of
from dualarm_pin.search.law import Drawn
from dualarm_pin.search.starts import generator
from dualarm_pin.search.turns import draw_postures, fold
from dualarm_pin.search.walk import walk
from dualarm_pin.solution import Solutions, distinct
from dualarm_pin.solvers import interior_point as engine

Array = NDArray[np.float64]
Labels = NDArray[np.int64]

_COARSE = 32  # points that rounds work on where the path has many more
_WHOLE = 40  # up to here a path is short enough as it is
_ALONE_TOLERANCE, _ALONE_ITERATIONS = 1e-4, 60  # a start that needs more hardly ever converges
# After a few iterations the objective ranks paths far better than before the first.
_RACE_ITERATIONS, _FINISHED, _REFINED = 6, 8, 5
_RACE = 3  # times as many are raced as are finished
# A low and a high barrier end in different minima.
_BARRIERS = ((1e-2, 1e-3), (0.1, 1e-2))


@dataclass(frozen=True)
class Round:
    """One round.

    Attributes:
        postures: Postures drawn at each anchor.
        minima: Minima of each anchor that are walked.
    """

    postures: int = 100
    minima: int = 12


class TrackLaw:
    """A law (`law.Law`) whose starts are the walks; those that were not refined lead to no end.

    Attributes:
        work: Points times iterations so far.
    """

    name = "track"

    def __init__(self, problem: Problem, seed: int, *, jobs: int | None = None) -> None:
        self.problem, self.seed, self.jobs = problem, seed, jobs
        self.coarse = coarse_of(problem, _COARSE) if problem.k > _WHOLE else None
        self.work = 0
        self._rounds = 0
        self._walks = 0
        self._ends: Solutions | None = None

    def drawn(self) -> Drawn | None:
        """Return what the walks so far came to, or None before the first."""
        return None if self._ends is None else Drawn(self._walks, self._ends)

    def grow(self, starts: int) -> None:
        """Make rounds until there are `starts` walks, those made before included.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        while self._walks < starts:
            before = self._walks
            self.round(Round())
            if self._walks == before:
                return  # no point of the path is reached alone

    def round(self, how: Round) -> None:
        """Draw, walk, race and refine once.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        problem = self.problem if self.coarse is None else self.coarse.problem
        random = generator(self.seed, 50, self._rounds)
        self._rounds += 1
        at, postures = self._minima(problem, how, random)
        if not len(at):
            return
        paths, work = walk(problem, at, postures, jobs=self.jobs)
        self.work += work
        self._walks += len(at)
        mu0, push = _BARRIERS[(self._rounds - 1) % len(_BARRIERS)]
        ends = self._race(problem, fold(problem, paths), mu0, push)
        if self.coarse is not None:
            ends = self._on_the_whole_path(ends, mu0, push)
        self._ends = ends if self._ends is None else Solutions.join([self._ends, ends])
        if ends.interrupted:
            raise KeyboardInterrupt

    def _minima(
        self, problem: Problem, how: Round, random: np.random.Generator
    ) -> tuple[Labels, Array]:
        """Return the best minima (s, n) of the anchors alone, and the anchor of each (s,)."""
        anchors = anchor_points(problem.k)
        drawn = draw_postures(problem, how.postures * len(anchors), random)
        points = np.repeat(anchors, how.postures)
        ends = self._solve(
            problem,
            drawn[:, None],
            points=points,
            tolerance=_ALONE_TOLERANCE,
            iterations=_ALONE_ITERATIONS,
        )
        # At this tolerance an end is near its pose, not on it: good enough to walk from.
        ends = replace(ends, q=fold(problem, ends.q), converged=ends.status == 0)
        at, found = [], []
        for anchor in anchors:
            minima = distinct(ends.take(np.flatnonzero(points == anchor)))
            best = minima.ends.q[: how.minima, 0]
            at.append(np.full(len(best), anchor))
            found.append(best)
        return np.concatenate(at), np.concatenate(found)

    def _race(self, problem: Problem, paths: Array, mu0: float, push: float) -> Solutions:
        """Refine the most promising paths."""
        first = self._solve(problem, paths, iterations=0, mu0=mu0, push=1e-6)
        raced = np.argsort(first.objective, kind="stable")[: _RACE * _FINISHED]
        ends = self._solve(problem, paths[raced], iterations=_RACE_ITERATIONS, mu0=mu0, push=push)
        order = np.argsort(np.where(ends.residual < 1e-2, ends.objective, np.inf), kind="stable")
        chosen = raced[order[:_FINISHED]]
        whole = self.coarse is None
        return self._solve(problem, paths[chosen], mu0=mu0, push=push, last=whole)

    def _on_the_whole_path(self, ends: Solutions, mu0: float, push: float) -> Solutions:
        """Refine the best distinct coarse paths on all points."""
        assert self.coarse is not None
        best = distinct(ends).ends.q[:_REFINED]
        starts = np.array([self.coarse.start(q) for q in best])
        starts = starts.reshape(len(best), self.problem.k, self.problem.n)
        return self._solve(self.problem, starts, mu0=mu0, push=push, last=True)

    def _solve(
        self,
        problem: Problem,
        starts: Array,
        *,
        points: Labels | None = None,
        tolerance: float | None = None,
        iterations: int = 150,
        mu0: float = 0.1,
        push: float = 1e-2,
        last: bool = False,
    ) -> Solutions:
        from dualarm_pin.engine.solve import Options

        options = Options(iterations=iterations, mu0=mu0, push=push)
        if tolerance is not None:
            options = replace(options, tolerance=tolerance)
        ends = engine.solve_many(problem, starts, jobs=self.jobs, points=points, options=options)
        self.work += int(ends.iterations.sum()) * starts.shape[1]
        if ends.interrupted and not last:
            raise KeyboardInterrupt  # what is finished is no path of the law yet
        return ends
