"""The anchored law: solve one point alone, take its distinct minima to all points, refine.

One point alone costs a fraction of a millisecond a start and has few minima, each of which leads
the whole path into a good basin. Anchors at the first, the middle and the last point guard each
other: the budget grows until they agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.search.coarse import coarse_of
from dualarm_pin.search.law import Drawn
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import Minima, Solutions, distinct, same_path
from dualarm_pin.solvers.shipped import ENGINE
from dualarm_pin.solvers.solver import Solver, solve_many

Array = NDArray[np.float64]
_ALONE_ITERATIONS = 60  # a start that needs more at one point alone hardly ever converges


def anchor_points(k: int) -> tuple[int, ...]:
    """Return the first, the middle and the last of k points."""
    return tuple(sorted({0, k // 2, k - 1}))


@dataclass
class _Seed:
    """A minimum of one point alone, and where it led.

    Attributes:
        q: Joints (n,).
        coarse: Which coarse end it led to, or None.
        path: Which path it led to when copied to all points, or None.
    """

    q: Array
    coarse: int | None = None
    path: int | None = None


@dataclass
class Anchor:
    """One point that was solved alone.

    Attributes:
        point: Which point.
        starts: Postures drawn so far.
        alone: Solutions of the one-point problem from all of them.
        minima: The distinct minima among these.
        seeds: The minima that were taken further.
    """

    point: int
    starts: int = 0
    alone: Solutions | None = None
    minima: Minima | None = None
    seeds: list[_Seed] = field(default_factory=list)

    def seeds_of_best(self, count: int | None) -> list[_Seed]:
        """Return a seed for each of the best minima, those that were met before and new ones."""
        chosen = []
        for q in [] if self.minima is None else self.minima.ends.q[:count, 0]:
            seed = next((seed for seed in self.seeds if same_path(seed.q, q)), None)
            if seed is None:
                seed = _Seed(q)
                self.seeds.append(seed)
            chosen.append(seed)
        return chosen

    def hits(self, seed: _Seed) -> int:
        """Return how many postures ended in the minimum of a seed."""
        if self.minima is None:
            return 0
        distance = np.abs(self.minima.ends.q[:, 0] - seed.q).max(axis=1)
        return int(self.minima.hits[int(np.argmin(distance))])


class AnchoredLaw:
    """A law (`law.Law`) whose starts are postures at the anchors: many lead to one path.

    `scout` takes the most promising of them further, `grow` all.
    """

    name = "anchored"

    def __init__(
        self,
        problem: Problem,
        seed: int,
        *,
        points: Sequence[int] | None = None,
        jobs: int | None = None,
        solver: Solver = ENGINE,
    ) -> None:
        self.problem, self.seed, self.jobs, self.solver = problem, seed, jobs, solver
        points = anchor_points(problem.k) if points is None else points
        self.anchors = [Anchor(point) for point in points]
        self._coarse = coarse_of(problem)
        self._screened: Solutions | None = None
        self._path_of_coarse: dict[int, int] = {}
        self._paths: Solutions | None = None

    def scout(self, starts: int, screened: int, refinements: int) -> None:
        """Bring every anchor to `starts` postures, screen its best minima, refine the best of all.

        Args:
            starts: Postures an anchor, those drawn before included.
            screened: How many minima of each anchor are solved on the coarse path.
            refinements: How many distinct coarse minima are refined on the whole path.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        self._draw(starts)
        seeds = [s for anchor in self.anchors for s in anchor.seeds_of_best(screened)]
        self._screen([seed for seed in seeds if seed.coarse is None])
        if self._screened is None:
            return
        minima = distinct(self._screened)
        waiting = []
        for label, q in enumerate(minima.ends.q):
            members = [int(end) for end in np.flatnonzero(minima.label == label)]
            known = [self._path_of_coarse[end] for end in members if end in self._path_of_coarse]
            if known:  # refined before: a seed that fell into it since leads to the same path
                self._path_of_coarse = dict.fromkeys(members, known[0]) | self._path_of_coarse
            elif label < refinements:
                waiting.append((members, self._coarse.start(q)))
        paths = self._refine([start for _, start in waiting])
        for (members, _), path in zip(waiting, paths, strict=True):
            self._path_of_coarse |= dict.fromkeys(members, path)

    def grow(self, starts: int) -> None:
        """Bring every anchor to `starts` postures and refine every minimum, copied to all points.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        self._draw(starts)
        seeds = [s for anchor in self.anchors for s in anchor.seeds_of_best(None)]
        fresh = [seed for seed in seeds if seed.path is None]
        paths = self._refine([np.tile(seed.q, (self.problem.k, 1)) for seed in fresh])
        for seed, path in zip(fresh, paths, strict=True):
            seed.path = path

    def unseen_share(self) -> float:
        """Return the share of postures whose minimum no other posture met, as Good and Turing.

        Near 1 the minima of single points are hardly seen, and that anchors agree says little.
        """
        hits = [anchor.minima.hits for anchor in self.anchors if anchor.minima is not None]
        met = sum(int(each.sum()) for each in hits)
        return sum(int(np.sum(each == 1)) for each in hits) / met if met else 1.0

    def agree(self) -> bool:
        """Tell whether the best path was reached from at least two anchors, or from all."""
        drawn = self.drawn()
        best = None if drawn is None or not drawn.ends.converged.any() else drawn.best
        if drawn is None or best is None:
            return False
        reached = 0
        for anchor in self.anchors:
            ends = {end for seed in anchor.seeds if (end := self._path(seed)) is not None}
            reached += any(same_path(drawn.ends.q[end], best) for end in ends)
        return reached >= min(2, len(self.anchors))

    def drawn(self) -> Drawn | None:
        """Return all paths refined so far and how many postures led to each, or None.

        A posture counts for the path that its one-point minimum was refined to. Minima that were
        not refined count for none.
        """
        if self._paths is None:
            return None
        weight = np.zeros(len(self._paths), dtype=np.int64)
        for anchor in self.anchors:
            for seed in anchor.seeds:
                path = self._path(seed)
                if path is not None:
                    weight[path] += anchor.hits(seed)
        return Drawn(sum(anchor.starts for anchor in self.anchors), self._paths, weight)

    def _path(self, seed: _Seed) -> int | None:
        if seed.path is not None or seed.coarse is None:
            return seed.path
        return self._path_of_coarse.get(seed.coarse)

    def _draw(self, starts: int) -> None:
        """Solve the anchors alone, all in one batch, from as many new postures as are missing."""
        problem = self.problem
        drawn, points = [], []
        for anchor in self.anchors:
            random = generator(self.seed, 10, anchor.point, anchor.starts)
            fresh = max(0, starts - anchor.starts)
            drawn.append(common_postures(problem.lower, problem.upper, 1, fresh, random))
            points += [anchor.point] * fresh
        if not points:
            return
        ends = solve_many(
            self.solver,
            problem,
            np.concatenate(drawn),
            jobs=self.jobs,
            points=points,
            iterations=_ALONE_ITERATIONS,
        )
        for anchor in self.anchors:
            mine = ends.take((np.array(points) == anchor.point) & ends.ran)
            if len(mine):
                anchor.alone = (
                    mine if anchor.alone is None else Solutions.join([anchor.alone, mine])
                )
                anchor.starts += len(mine)
                anchor.minima = distinct(anchor.alone)
        if ends.interrupted:
            raise KeyboardInterrupt

    def _screen(self, seeds: list[_Seed]) -> None:
        if not seeds:
            return
        tiled = np.array([np.tile(seed.q, (len(self._coarse.points), 1)) for seed in seeds])
        ends = solve_many(self.solver, self._coarse.problem, tiled, jobs=self.jobs)
        first = 0 if self._screened is None else len(self._screened)
        self._screened = ends if self._screened is None else Solutions.join([self._screened, ends])
        for number, seed in enumerate(seeds, first):
            seed.coarse = number
        if ends.interrupted:
            raise KeyboardInterrupt

    def _refine(self, starts: list[Array]) -> range:
        """Refine whole paths in one batch; return which of `paths` they became."""
        first = 0 if self._paths is None else len(self._paths)
        if starts:
            ends = solve_many(self.solver, self.problem, np.array(starts), jobs=self.jobs)
            self._paths = ends if self._paths is None else Solutions.join([self._paths, ends])
            if ends.interrupted:
                raise KeyboardInterrupt
        return range(first, first + len(starts))
