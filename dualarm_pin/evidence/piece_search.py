"""The search for the minimum of a piece: a cheap one for every step, a wide one to trust."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.engine.solve import Options
from dualarm_pin.evidence.bundle import Planes
from dualarm_pin.evidence.pieces import Piece
from dualarm_pin.multistart.starts import common_postures, generator
from dualarm_pin.problem import Problem
from dualarm_pin.solvers import engine
from dualarm_pin.solvers.ends import Ends, distinct
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SearchOptions:
    """How many starts a piece gets.

    Attributes:
        pool: Known paths that start each cheap search.
        cheap: Random starts of each cheap search.
        postures: Postures at each of three points alone, whose minima start the first and the
            wide search.
        refined: Most of these minima taken a point.
        wide: Random starts of the wide search.
        most: Random starts of the wide search at most, while the minimum is hit too rarely.
        hits: How often the wide search must hit the minimum.
    """

    pool: int = 15
    cheap: int = 2
    postures: int = 150
    refined: int = 15
    wide: int = 400
    most: int = 1600
    hits: int = 3


@dataclass(frozen=True)
class Wide:
    """What a wide search of one piece found.

    Attributes:
        value: The piece's minimum.
        starts: Starts, those from known paths not counted.
        hits: How many of them ended at that value.
    """

    value: float
    starts: int
    hits: int


class PieceSearch:
    """One piece, the paths known of it, and their planes."""

    def __init__(
        self,
        piece: Piece,
        incumbent: Array,
        cuts: int,
        seed: tuple[int, ...],
        options: SearchOptions,
        jobs: int | None,
    ) -> None:
        self.piece, self.cuts, self.options, self.jobs = piece, cuts, options, jobs
        self.seed = seed
        self.planes = self._plane(incumbent)
        self.pool: Array = incumbent[None]

    def add_path(self, q: Array) -> None:
        """Add one path (points, n) of the piece, known to be feasible."""
        self.planes.add(self._plane(q))
        self.pool = np.concatenate([q[None], self.pool])

    def prepare(self, theta: Array) -> None:
        """Fill the pool with the minima that single points lead to."""
        problem = self.piece.tilted(theta)
        self._run(problem, theta, self._pointwise(problem, 0), Options())

    def cheap(self, theta: Array, number: int) -> float:
        """Return the lowest value at theta (cuts, n) that the known paths lead to."""
        problem = self.piece.tilted(theta)
        starts = common_postures(
            problem.lower, problem.upper, problem.k, self.options.cheap, self._random(1, number)
        )
        near = replace(Options(), mu0=1e-3, push=1e-3)
        value = self._run(problem, theta, self.pool[: self.options.pool], near)[0]
        if len(starts):
            value = min(value, self._run(problem, theta, starts, Options())[0])
        return value

    def wide(self, theta: Array, number: int) -> Wide:
        """Search the piece at theta anew: random postures, minima of single points, known paths."""
        problem = self.piece.tilted(theta)
        lowest, _ = self._run(problem, theta, self.pool, replace(Options(), mu0=1e-3, push=1e-3))
        random = self._random(2, number)
        starts = self._pointwise(problem, number)
        values: list[Array] = []
        drawn = 0
        while True:
            fresh = self.options.wide
            postures = common_postures(problem.lower, problem.upper, problem.k, fresh, random)
            starts = np.concatenate([starts, postures])
            lower, ends = self._run(problem, theta, starts, Options())
            values.append(np.where(ends.feasible, ends.objective, np.inf))
            drawn, lowest = drawn + fresh, min(lowest, lower)
            level = lowest + TOLERANCE.same_objective * max(1.0, abs(lowest))
            every = np.concatenate(values)
            hits = int(np.sum(every <= level))
            if hits >= self.options.hits or drawn >= self.options.most:
                return Wide(lowest, len(every), hits)
            starts = np.zeros((0, problem.k, problem.n))

    def _pointwise(self, problem: Problem, number: int) -> Array:
        """Return starts (s, points, n): minima of the first, middle and last point alone."""
        found = []
        for point in sorted({0, problem.k // 2, problem.k - 1}):
            alone = problem.subset([point], 0.0)
            random = self._random(3, number, point)
            postures = common_postures(alone.lower, alone.upper, 1, self.options.postures, random)
            minima = distinct(engine.solve_many(alone, postures, jobs=self.jobs))
            found.append(minima.ends.q[: self.options.refined])
        return np.repeat(np.concatenate(found), problem.k, axis=1)

    def _run(
        self, problem: Problem, theta: Array, starts: Array, options: Options
    ) -> tuple[float, Ends]:
        """Solve from all starts; keep what they came to; return the lowest value known."""
        ends = engine.solve_many(problem, starts, jobs=self.jobs, options=options)
        usable = ends.take(ends.feasible)
        flat = theta.ravel()
        if len(usable):
            order = np.argsort(usable.objective, kind="stable")[: 2 * self.options.pool]
            usable = usable.take(order)
            slope = self._slope(usable.q)
            self.planes.add(Planes(usable.objective - slope @ flat, slope, usable.q))
            self._merge(usable)
        return self.planes.lowest(flat), ends

    def _plane(self, q: Array) -> Planes:
        return Planes(np.array([self.piece.problem.objective(q)]), self._slope(q[None]), q[None])

    def _slope(self, q: Array) -> Array:
        return self.piece.slopes(q, self.cuts).reshape(len(q), -1)

    def _merge(self, ends: Ends) -> None:
        """Put new ends before the pool, drop what lies in the same basin, best first."""
        joined = np.concatenate([ends.q, self.pool])
        flat = joined.reshape(len(joined), -1)
        kept: list[int] = []
        for at in range(len(joined)):
            if all(np.max(np.abs(flat[at] - flat[k])) >= TOLERANCE.same_joint for k in kept):
                kept.append(at)
        self.pool = joined[kept][: 3 * self.options.pool]

    def _random(self, *keys: int) -> np.random.Generator:
        return generator(self.seed[0], 40, *self.seed[1:], *keys)
