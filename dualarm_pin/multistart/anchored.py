"""The anchored law: solve one point alone, copy its distinct minima to all points, refine.

One point alone costs a fraction of a millisecond a start and has few minima, each of which leads
the whole path into a good basin. Anchors at the first, the middle and the last point guard each
other: the budget grows until they agree.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.multistart.starts import common_postures, generator
from dualarm_pin.problem import Problem
from dualarm_pin.solvers import engine
from dualarm_pin.solvers.ends import Ends, Minima, distinct, same_path

Array = NDArray[np.float64]
NAME = "anchored"


def anchor_points(k: int) -> tuple[int, ...]:
    """Return the first, the middle and the last of k points."""
    return tuple(sorted({0, k // 2, k - 1}))


@dataclass
class Anchor:
    """One point that was solved alone.

    Attributes:
        point: Which point.
        starts: Postures drawn so far.
        alone: Ends of the one-point problem from all of them.
        minima: The distinct minima among these.
        refined: Whole paths from minima, in the order they were refined.
        seeds: The minimum (n,) each of them was refined from.
    """

    point: int
    starts: int
    alone: Ends | None
    minima: Minima | None
    refined: Ends | None
    seeds: list[Array]

    def best(self) -> int | None:
        """Return which refined path is best, if any converged."""
        if self.refined is None or not self.refined.converged.any():
            return None
        return int(np.argmin(np.where(self.refined.converged, self.refined.objective, np.inf)))


class AnchoredSearch:
    """A search that can grow: more postures at each anchor, more of their minima refined."""

    def __init__(
        self,
        problem: Problem,
        seed: int,
        *,
        points: Sequence[int] | None = None,
        jobs: int | None = None,
    ) -> None:
        self.problem, self.seed, self.jobs = problem, seed, jobs
        points = anchor_points(problem.k) if points is None else points
        self.anchors = [Anchor(point, 0, None, None, None, []) for point in points]

    def grow(self, starts: int, refinements: int | None) -> None:
        """Bring every anchor to `starts` postures and refine its best minima.

        Args:
            starts: Postures an anchor, those drawn before included.
            refinements: How many of the best minima are refined; None refines all.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        self._draw(starts)
        waiting = [(anchor, self._unrefined(anchor, refinements)) for anchor in self.anchors]
        seeds = [q for _, chosen in waiting for q in chosen]
        if not seeds:
            return
        tiled = np.repeat(np.array(seeds)[:, None], self.problem.k, axis=1)
        # All anchors in one batch, so that no processor waits for the last start of one anchor.
        ends = engine.solve_many(self.problem, tiled, jobs=self.jobs)
        begin = 0
        for anchor, chosen in waiting:
            mine = ends.take(list(range(begin, begin + len(chosen))))
            begin += len(chosen)
            anchor.refined = mine if anchor.refined is None else Ends.join([anchor.refined, mine])
            anchor.seeds += chosen
        if ends.interrupted:
            raise KeyboardInterrupt

    def ends(self) -> Ends | None:
        """Return all refined paths of all anchors."""
        parts = [anchor.refined for anchor in self.anchors if anchor.refined is not None]
        return Ends.join(parts) if parts else None

    def agree(self) -> bool:
        """Tell whether the best paths of all anchors lie in one basin."""
        best = []
        for anchor in self.anchors:
            which = anchor.best()
            if which is None or anchor.refined is None:
                return False
            best.append(anchor.refined.q[which])
        return all(same_path(best[0], other) for other in best[1:])

    def complete(self) -> bool:
        """Tell whether every minimum of every anchor was refined."""
        return all(not self._unrefined(anchor, None) for anchor in self.anchors)

    def starts_by_path(self) -> tuple[int, Ends, NDArray[np.int64]] | None:
        """Return how many postures were drawn, and how many led to each refined path.

        A posture counts for the path that its one-point minimum was refined to. Minima that were
        not refined count for none.
        """
        ends = self.ends()
        if ends is None:
            return None
        weight = [np.array(self._hits(anchor), dtype=np.int64) for anchor in self.anchors]
        return sum(a.starts for a in self.anchors), ends, np.concatenate(weight)

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
        ends = engine.solve_many(problem, np.concatenate(drawn), jobs=self.jobs, points=points)
        for anchor in self.anchors:
            mine = ends.take(np.array(points) == anchor.point)
            if len(mine):
                anchor.alone = mine if anchor.alone is None else Ends.join([anchor.alone, mine])
                anchor.starts += len(mine)
                anchor.minima = distinct(anchor.alone)
        if ends.interrupted:
            raise KeyboardInterrupt

    def _unrefined(self, anchor: Anchor, refinements: int | None) -> list[Array]:
        if anchor.minima is None:
            return []
        return [
            q
            for q in anchor.minima.ends.q[:refinements, 0]
            if not any(same_path(q, seed) for seed in anchor.seeds)
        ]

    def _hits(self, anchor: Anchor) -> list[int]:
        """Return how many postures led to each refined path of an anchor."""
        assert anchor.minima is not None
        minima = anchor.minima.ends.q[:, 0]
        hits = []
        for seed in anchor.seeds:
            distance = np.abs(minima - seed).max(axis=1)
            hits.append(int(anchor.minima.hits[int(np.argmin(distance))]))
        return hits
