"""The search for the minimum of a piece: a cheap one for every step, a wide one to trust."""

from __future__ import annotations

from dataclasses import InitVar, dataclass
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.evidence.bundle import Planes
from dualarm_pin.evidence.check import near
from dualarm_pin.evidence.pieces import PathPiece
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import Solutions, distinct
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.engine.solve import Options


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


@dataclass(eq=False)
class PieceSearch:
    """One piece, the paths known of it, and their planes."""

    piece: PathPiece
    incumbent: InitVar[Array]
    cuts: int
    seed: tuple[int, ...]
    options: SearchOptions
    jobs: int | None

    def __post_init__(self, incumbent: Array) -> None:
        self.planes, self.pool = self._plane(incumbent), self._plane(incumbent)

    def add_path(self, q: Array) -> None:
        """Add one path (points, n) of the piece, known to be feasible."""
        self.planes.add(self._plane(q))
        self.pool.add(self._plane(q))

    def prepare(self, theta: Array) -> None:
        """Fill the pool with the minima that single points lead to."""
        problem = self.piece.tilted(theta)
        self.run(problem, theta.ravel(), self.pointwise(problem, 0))

    def cheap(self, theta: Array, number: int) -> float:
        """Return the lowest value at theta (cuts, n) that the known paths lead to."""
        problem = self.piece.tilted(theta)
        flat = theta.ravel()
        best = np.argsort(self.pool.height(flat), kind="stable")[: self.options.pool]
        self.run(problem, flat, self.pool.path[best], _near())
        if self.options.cheap:
            drawn = postures(problem, self.options.cheap, self.random(1, number))
            self.run(problem, flat, drawn)
        return self.planes.lowest(flat)

    def pointwise(self, problem: Problem, number: int) -> Array:
        """Return starts (s, points, n): minima of the first, middle and last point alone."""
        found = []
        for point in sorted({0, problem.k // 2, problem.k - 1}):
            alone = problem.subset([point], 0.0)
            random = self.random(3, number, point)
            drawn = postures(alone, self.options.postures, random)
            minima = distinct(engine.solve_many(alone, drawn, jobs=self.jobs))
            found.append(minima.ends.q[: self.options.refined])
        return np.repeat(np.concatenate(found), problem.k, axis=1)

    def run(
        self, problem: Problem, theta: Array, starts: Array, options: Options | None = None
    ) -> Solutions:
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
        return self.piece.slopes(q, self.cuts).reshape(len(q), self.cuts * self.piece.problem.n)

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

    def random(self, *keys: int) -> np.random.Generator:
        """Return the generator of one of this piece's stages."""
        return generator(self.seed[0], 40, *self.seed[1:], *keys)


class WideSearch:
    """A search of one piece at theta (cuts, n) whose starts owe nothing to the cheap searches.

    Args:
        search: The piece.
        theta: The multipliers.
        number: Of the search; each has starts of its own.

    Attributes:
        believed: The lowest value that the known paths lead to.
        drawn: Random starts so far.
    """

    def __init__(self, search: PieceSearch, theta: Array, number: int) -> None:
        self.search, self.options = search, search.options
        self.problem, self.theta = search.piece.tilted(theta), theta.ravel()
        self.random = search.random(2, number)
        search.run(self.problem, self.theta, search.pool.path, _near())
        self.believed = search.planes.lowest(self.theta)
        self.drawn = 0
        self._waiting = search.pointwise(self.problem, number)
        self._values = np.zeros(0)

    @property
    def value(self) -> float:
        """The piece's minimum, as far as it is known."""
        return self.search.planes.lowest(self.theta)

    @property
    def starts(self) -> int:
        """Starts so far, those from known paths not counted."""
        return len(self._values)

    @property
    def hits(self) -> int:
        """How many of them ended at the piece's minimum."""
        level = TOLERANCE.same_objective * max(1.0, abs(self.value))
        return int(np.sum(self._values <= self.value + level))

    @property
    def done(self) -> bool:
        """Whether there were enough starts and hits, or too many starts."""
        options = self.options
        enough = self.drawn >= options.wide and self.hits >= options.hits
        return enough or self.drawn >= options.most

    def extend(self) -> None:
        """Make a quarter of the starts; the first time also those from points alone."""
        fresh = postures(self.problem, max(1, self.options.wide // 4), self.random)
        starts = np.concatenate([self._waiting, fresh])
        ends = self.search.run(self.problem, self.theta, starts)
        self._values = np.append(self._values, np.where(ends.feasible, ends.objective, np.inf))
        self.drawn += len(fresh)
        self._waiting = self._waiting[:0]


def postures(problem: Problem, count: int, random: np.random.Generator) -> Array:
    """Draw starts (count, points, n), one posture each."""
    return common_postures(problem.lower, problem.upper, problem.k, count, random)


def _near() -> Options:
    """Return options for known paths, whose minima moved a little with the multipliers."""
    return near(TOLERANCE.search, mu0=1e-3)
