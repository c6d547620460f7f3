"""Hops from the pool: disturb one point of a good path, walk from there, keep what is better.

Most hops shift all joints at random, the others put the point on another branch (`Branches`).
A window hop leaves the rest of the path as it is and solves its window between fixed neighbours; a
whole hop has no neighbours. Which kind gets how much of the work is seen from what it wins
(`Shares`). Transfers and splices put paths together from several as soon as there are new ones.
None of these are independent starts: a hop knows what was found before, so it is no law and counts
for no evidence.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.engine.solve import Options
from dualarm_pin.problem import Problem
from dualarm_pin.search.branches import Branches
from dualarm_pin.search.pool import Pool
from dualarm_pin.search.shares import Shares
from dualarm_pin.search.splice import splices
from dualarm_pin.search.starts import generator
from dualarm_pin.search.sweep import LONG, Sweeps
from dualarm_pin.search.track import MUS, standing
from dualarm_pin.search.transfer import Transfers
from dualarm_pin.search.turns import Turns
from dualarm_pin.search.work import Work
from dualarm_pin.solution import Solutions
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Integers = NDArray[np.int64]
_BATCH = 8  # hops made at once ...
_BATCH_COST = 0.1  # ... or fewer, where 20 iterations of each would cost more than this [s]
_LOG_SHIFT = (np.log(0.3), np.log(3.0))  # rad, of all joints together
_SCALES = 10.0 ** np.arange(-1, 3)  # of the links while walking
_ITERATIONS = 60
# How likely which share of the path is believed to win as a window: a quarter next to nothing once
# the path is good.
_WINDOWS = {0.25: 0.05, 0.5: 0.3, 0.75: 0.2, 1.0: 0.25}
# Transfers: that many are evaluated at once and the best few refined; one so far off its rows
# [m or rad] would end anywhere.
_EVALUATED, _TRANSFERRED, _LOST = 24, 4, 2.0
_FREELY = 0.06  # share of the work that transfers have before they must win as hops do
_VALUE = 1.0 / 3.0  # of a Newton step, what the objective of a point costs
_BRANCH = 0.25  # share of hops to another branch: on some cells they win most, on others nothing
_HERE = Options(1e-3, 0, push=TOLERANCE.no_length)  # the objective of a start, and no more
_LEAST = 2  # paths, from more of which others are put together
_SPLICED = 12  # best paths that are spliced
_OF_LONG = [31, 61]  # points of a hop on a long path, where links are weak and whole solves stall
# Either the nearest minimum of the disturbed point alone, or merely its nearest place on the path.
_ALONE, _PLACED = Options(1e-4, 60), Options(1e-4, 5, 1e-3, 1e-3)


class Hops:
    """Moves that improve the best paths of a pool.

    Attributes:
        made: Hops and splices so far.
    """

    def __init__(
        self,
        problem: Problem,
        seed: int,
        pool: Pool,
        work: Work,
        *,
        number: int = 0,
        jobs: int | None = None,
    ) -> None:
        self.problem, self.seed, self.number, self.jobs = problem, seed, number, jobs
        self.pool, self.work = pool, work
        self.turns = Turns(problem)
        self.wide = self.turns.widened(problem)
        self.branches = Branches(problem)
        k = problem.k
        self._sizes = [min(k, max(9, int(share * k)) | 1) for share in _WINDOWS]
        self._shares = Shares(list(_WINDOWS.values()))
        self._sweeps = Sweeps(problem, work, jobs) if k > LONG else None
        if self._sweeps is not None:
            self._sizes, self._shares = _OF_LONG, Shares([0.5, 0.5])
        self.made = self._batches = 0
        self._splicing = 0.0
        self._transferred = (0.0, 0.0)  # what transfers won, and their work
        self._transfers = Transfers(problem, self.turns, pool)
        self._offered: list[float] = []
        self._known: dict[bytes, Array] = {}
        self._spliced: set[bytes] = set()

    def make(self) -> None:
        """Make one batch of hops of one kind, and splices where it brought good paths.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        random = generator(self.seed, 41, self.number, self._batches)
        self._batches += 1
        many = len(self.pool.paths) > _LEAST and self._sweeps is None  # values of long paths cost
        if many:
            self._transfer(random)
        kind, work, won = self._shares.draw(random), self.work.spent, self.pool.won
        self._hop(self._sizes[kind], random)
        self._shares.record(kind, self.work.spent - work, self.pool.won - won)
        if many and self.pool.won > self._splicing:
            self._splicing = self.pool.won
            self._splice(random)
        if many:
            self._transfer(random)

    def _hop(self, w: int, random: np.random.Generator) -> None:
        problem, pool = self.problem, self.pool
        k = problem.k
        base = np.array([pool.paths[pool.pick(random)] for _ in range(self._batch(w))])
        at = random.integers(0, k, len(base))
        first = np.clip(at - w // 2, 0, k - w)
        place = np.array([self._disturbed(q, random) for q in base[np.arange(len(base)), at]])
        scale = random.choice(_SCALES, len(base))
        alone = _PLACED if random.random() < 0.5 else _ALONE
        placed = self._solved(place[:, None], alone, points=at)
        fit = np.flatnonzero(placed.residual < 0.05)
        if not len(fit):
            return
        walked = engine.walk_many(
            self.wide,
            placed.q[fit, 0],
            at[fit],
            jobs=self.jobs,
            first=first[fit],
            points=w,
            scale=scale[fit],
        )
        self.work.add(walked.steps)
        if walked.interrupted:
            raise KeyboardInterrupt
        fit, starts = fit[walked.reached], walked.q[walked.reached]
        if not len(fit):
            return
        self._improve(base[fit], starts, first[fit], random)

    def _transfer(self, random: np.random.Generator) -> None:
        """Refine the most promising transfers, if the pool has changed and they pay as hops do."""
        pool, k, work, won = self.pool, self.problem.k, self.work.spent, self.pool.won
        before = self._transferred
        pays = before[1] < _FREELY * work or self._shares.outdone_by(*before)
        if self._offered == pool.objectives or not pays:
            return
        self._offered = pool.objectives.copy()
        starts = self._transfers.promising(_EVALUATED)
        if not len(starts):
            return
        here = self._solved(starts, _HERE)
        self.work.add(_VALUE * len(starts) * k)
        best = np.argsort(standing(here), kind="stable")[: min(_TRANSFERRED, self._batch(k))]
        best = best[here.residual[best] < _LOST]
        if len(best):
            first = np.zeros(len(best), dtype=np.int64)
            self._improve(starts[best], starts[best], first, random)
        self._transferred = before[0] + pool.won - won, before[1] + self.work.spent - work

    def _batch(self, w: int) -> int:
        """Return how many windows of w points make a batch."""
        return max(1, min(_BATCH, int(_BATCH_COST / self.work.seconds(20.0 * w))))

    def _improve(
        self, base: Array, starts: Array, first: Integers, random: np.random.Generator
    ) -> None:
        """Refine windows (s, w, n) of paths (s, k, n) that begin at points first (s,)."""
        problem, pool = self.problem, self.pool
        k, w, count = problem.k, starts.shape[1], len(starts)
        mu, push = MUS[int(random.integers(len(MUS)))]
        self.made += count
        fixed = problem.neighbours.posture
        beside = np.array(
            [
                [path[a - 1] if a else fixed[0], path[a + w] if a + w < k else fixed[1]]
                for path, a in zip(base, first, strict=True)
            ]
        )
        rows = np.arange(w) + first[:, None]
        before = base[np.arange(count)[:, None], rows]
        here = self._solved(before, _HERE, points=first, neighbours=beside).objective
        for i, a in enumerate(first):
            base[i], starts[i], beside[i] = self.turns.joined(base[i], starts[i], a, beside[i])
        ends = self._solved(
            starts,
            Options(TOLERANCE.search if w == k else 1e-5, _ITERATIONS, mu, push),
            points=first,
            neighbours=beside,
            limit=np.full(count, pool.limit) if w == k else here,
        )
        if w == k:
            self._offer(ends)
            return
        better = (ends.status == 0) & (
            ends.objective < here - TOLERANCE.same_objective * abs(pool.best)
        )
        for end in np.flatnonzero(better):
            base[end, first[end] : first[end] + w] = ends.q[end]
        if better.any() and self._sweeps is not None:
            valued = self._sweeps.valued(base[better])
            self._offer(valued, valued.feasible)
        elif better.any():
            self._offer(self._solved(base[better], Options(mu0=1e-3, push=1e-3)))

    def _disturbed(self, q: Array, random: np.random.Generator) -> Array:
        """Return a posture (n,) away from q, within the bounds."""
        shift = random.normal(size=len(q))
        shift *= np.exp(random.uniform(*_LOG_SHIFT)) / np.linalg.norm(shift)
        if random.random() < _BRANCH:
            moved = self.branches.other(q, random)
            if moved is not None:
                return moved
        return np.clip(q + shift, self.problem.lower, self.problem.upper)

    def _splice(self, random: np.random.Generator) -> None:
        pool, problem = self.pool, self.problem
        paths = np.array(pool.paths[:_SPLICED])
        found = []
        for q in splices(problem, self.turns, paths, self._values(paths), random):
            key = np.round(q, 2).tobytes()
            if key not in self._spliced:
                self._spliced.add(key)
                found.append(q)
        if found:
            self.made += len(found)
            mu, push = MUS[int(random.integers(len(MUS)))]
            options = Options(mu0=mu, push=push)
            self._offer(self._solved(np.array(found), options, limit=pool.limit))

    def _values(self, paths: Array) -> Array:
        """Return the objective of every point (s, k) of paths, without links; known ones again."""
        k, n = paths.shape[1:]
        fresh = [q for q in paths if q.tobytes() not in self._known]
        if fresh:
            points = np.tile(np.arange(k), len(fresh))
            alone = self._solved(np.reshape(fresh, (-1, 1, n)), _HERE, points=points)
            self.work.add(len(fresh) * k)
            for q, values in zip(fresh, alone.objective.reshape(-1, k), strict=True):
                self._known[q.tobytes()] = values
        return np.array([self._known[q.tobytes()] for q in paths])

    def _offer(self, ends: Solutions, good: Flags | None = None) -> None:
        for end in np.flatnonzero(ends.converged & ~ends.saddle if good is None else good):
            self.pool.offer(ends.q[end], ends.objective[end])
        if ends.interrupted:
            raise KeyboardInterrupt

    def _solved(self, starts: Array, options: Options, **more: Any) -> Solutions:
        ends = engine.solve_many(self.problem, starts, jobs=self.jobs, options=options, **more)
        self.work.add(int(ends.iterations.sum()) * starts.shape[1])
        whole = starts.shape[1] == self.problem.k
        if ends.interrupted and not whole:
            raise KeyboardInterrupt
        return replace(ends, q=self.turns.folded(ends.q)) if whole else ends
