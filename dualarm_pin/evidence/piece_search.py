"""The search for the minimum of a piece: a cheap one for every step, a wide one to trust."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.evidence.bundle import Planes
from dualarm_pin.evidence.check import near
from dualarm_pin.evidence.pieces import Piece
from dualarm_pin.multistart.starts import common_postures, generator
from dualarm_pin.problem import Problem
from dualarm_pin.solvers import engine
from dualarm_pin.solvers.ends import Ends, distinct
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.engine.solve import Options

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
        self.pool = self._plane(incumbent)

    def add_path(self, q: Array) -> None:
        """Add one path (points, n) of the piece, known to be feasible."""
        self.planes.add(self._plane(q))
        self.pool.add(self._plane(q))

    def prepare(self, theta: Array) -> None:
        """Fill the pool with the minima that single points lead to."""
        problem = self.piece.tilted(theta)
        self._run(problem, theta.ravel(), self._pointwise(problem, 0))

    def cheap(self, theta: Array, number: int) -> float:
        """Return the lowest value at theta (cuts, n) that the known paths lead to."""
        problem = self.piece.tilted(theta)
        flat = theta.ravel()
        best = np.argsort(self.pool.height(flat), kind="stable")[: self.options.pool]
        self._run(problem, flat, self.pool.path[best], _near())
        if self.options.cheap:
            drawn = self._postures(problem, self.options.cheap, self._random(1, number))
            self._run(problem, flat, drawn)
        return self.planes.lowest(flat)

    def wide(self, theta: Array, number: int) -> Wide:
        """Search the piece at theta anew: random postures, minima of single points, known paths."""
        problem = self.piece.tilted(theta)
        flat = theta.ravel()
        self._run(problem, flat, self.pool.path, _near())
        random = self._random(2, number)
        starts = self._pointwise(problem, number)
        values = np.zeros(0)
        drawn = 0
        while True:
            fresh = self._postures(problem, self.options.wide, random)
            ends = self._run(problem, flat, np.concatenate([starts, fresh]))
            values = np.append(values, np.where(ends.feasible, ends.objective, np.inf))
            lowest = self.planes.lowest(flat)
            level = lowest + TOLERANCE.same_objective * max(1.0, abs(lowest))
            hits, drawn = int(np.sum(values <= level)), drawn + len(fresh)
            if hits >= self.options.hits or drawn >= self.options.most:
                return Wide(lowest, len(values), hits)
            starts = starts[:0]

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

    def _postures(self, problem: Problem, count: int, random: np.random.Generator) -> Array:
        return common_postures(problem.lower, problem.upper, problem.k, count, random)

    def _run(
        self, problem: Problem, theta: Array, starts: Array, options: Options | None = None
    ) -> Ends:
        """Solve from all starts and keep what they came to."""
        ends = engine.solve_many(problem, starts, jobs=self.jobs, options=options)
        usable = np.flatnonzero(ends.feasible)
        # Every feasible end counts, converged or not: a path of that value exists.
        best = usable[np.argsort(ends.objective[usable], kind="stable")][: 2 * self.options.pool]
        slope = self._slope(ends.q[best])
        planes = Planes(ends.objective[best] - slope @ theta, slope, ends.q[best])
        self.planes.add(planes)
        self._merge(planes, theta)
        return ends

    def _plane(self, q: Array) -> Planes:
        return Planes(np.array([self.piece.problem.objective(q)]), self._slope(q[None]), q[None])

    def _slope(self, q: Array) -> Array:
        return self.piece.slopes(q, self.cuts).reshape(len(q), -1)

    def _merge(self, planes: Planes, theta: Array) -> None:
        """Put paths into the pool, lowest at theta first, one of each basin."""
        self.pool.add(planes)
        order = np.argsort(self.pool.height(theta), kind="stable")
        flat = self.pool.path.reshape(len(order), -1)
        kept: list[int] = []
        for at in order:
            if not kept or np.min(np.max(np.abs(flat[kept] - flat[at]), axis=1)) >= (
                TOLERANCE.same_joint
            ):
                kept.append(int(at))
        self.pool = self.pool.take(kept[: 3 * self.options.pool])

    def _random(self, *keys: int) -> np.random.Generator:
        return generator(self.seed[0], 40, *self.seed[1:], *keys)


def _near() -> Options:
    """Return options for known paths, whose minima moved a little with the multipliers."""
    return near(TOLERANCE.search, mu0=1e-3)
