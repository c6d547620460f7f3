"""The track law: minima of one point alone, the best of them walked through the path.

A walk (`engine.interior_point.walk`) costs a few iterations a point and stays on its branch, where
a whole path that starts from one common posture is torn between the points. Rounds begin at the
first, the middle and the last point: random anchors find worse paths. Where the path is long a
coarse one comes first. Of all walks a few iterations pick those that are refined.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.engine.solve import Options
from dualarm_pin.problem import Problem
from dualarm_pin.search.anchored import anchor_points
from dualarm_pin.search.coarse import Coarse, coarse_of
from dualarm_pin.search.law import Drawn
from dualarm_pin.search.pool import Pool
from dualarm_pin.search.starts import generator
from dualarm_pin.search.sweep import LONG, Sweeps
from dualarm_pin.search.turns import Turns
from dualarm_pin.search.work import Work
from dualarm_pin.solution import Solutions
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True)
class Round:
    """How many go on from stage to stage of a round.

    Attributes:
        postures: Drawn at each anchor.
        minima: Of one point alone, an anchor: these are walked.
        raced: Walks that get a few iterations.
        coarse: Of these, refined on the coarse path.
        fine: Of these, refined on the whole path.
    """

    postures: int = 80
    minima: int = 16
    raced: int = 20
    coarse: int = 7
    fine: int = 5


# Longer paths are walked and raced on so many points: in turn with all of them, which finds what
# the coarse path misses, or always where all would cost too much.
_LONG, _COARSE_POINTS, _TOO_LONG = 40, 32, 100
_FINE_SHARE = 0.25  # s: after these a round refines no more paths
_ALONE = Options(1e-4, 30)  # those that need more are rarely the best, and cost a third
_RACE_ITERATIONS = 6  # after these the objective ranks paths far better than before the first
_NEAR = 1e-2  # a coarse end or a minimum of one point alone within this counts as on its rows
_OFF_PATH = 0.05  # a raced path farther off its rows pays ten times the excess
# Of the links while walking: weak ones follow the minima of single points, those of the path stay
# smooth; either finds what the other misses. In the order of Thue and Morse, so that each meets
# every level and barrier.
_SCALES = (0.05, 0.5)
MUS = ((1e-2, 1e-3), (0.1, 1e-2))  # barrier and push of starts: either finds what the other misses


class TrackLaw:
    """A law (`law.Law`) whose starts are postures at the anchors, walked through the path.

    Attributes:
        rounds: The lowest objective that each round so far found by itself.
        unseen: Share of the postures of the last round whose minimum no other posture met, as Good
            and Turing: near 1 the minima of single points are hardly seen.
        reachable: Whether each anchor was reached by some posture of the first round.
    """

    name = "track"

    def __init__(
        self,
        problem: Problem,
        seed: int,
        *,
        number: int = 0,
        jobs: int | None = None,
        pool: Pool | None = None,
        work: Work | None = None,
    ) -> None:
        self.problem, self.seed, self.number, self.jobs = problem, seed, number, jobs
        self.pool, self.work = pool or Pool(), work or Work(problem)
        self.turns = Turns(problem)
        self.rounds: list[float] = []
        self.unseen, self.reachable = 1.0, True
        whole = Coarse(problem, np.arange(problem.k), problem.k)
        self._levels = [whole] if problem.k <= _TOO_LONG else []
        if problem.k > _LONG:
            self._levels.insert(0, coarse_of(problem, _COARSE_POINTS))
        self._sweeps = Sweeps(problem, self.work, jobs) if problem.k > LONG else None
        self._starts = 0
        self._ends: list[Solutions] = []
        self._weight: list[Integers] = []

    def grow(self, starts: int) -> None:
        """Make rounds until there are `starts` postures, those drawn before included.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        while self._starts < starts:
            self.round()

    def drawn(self) -> Drawn | None:
        """Return what the tracks came to: an end counts the tracks that led to it."""
        if not self._ends:
            return None
        return Drawn(self._starts, Solutions.join(self._ends), np.concatenate(self._weight))

    def round(self, how: Round | None = None) -> None:
        """Draw postures at the anchors, walk, race, refine; offer what comes to the pool.

        Args:
            how: How many go on from stage to stage.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        how = how or Round()
        random = generator(self.seed, 40, self.number, len(self.rounds))
        turn, lap = len(self.rounds), len(self.rounds) // len(self._levels)
        level = self._levels[turn % len(self._levels)]
        mu, push = MUS[(self.number + turn + (lap if len(self._levels) > 1 else 0)) % len(MUS)]
        self.rounds.append(np.inf)
        scale = _SCALES[(self.number + turn.bit_count()) % len(_SCALES)]
        paths, value = self._walked(level.problem, random, how, scale)
        kept, count = _groups(paths, value)
        kept, count = kept[: how.raced], count[: how.raced]
        if not len(kept):
            return
        coarse = level.problem
        race = self._solved(coarse, paths[kept], Options(1e-3, _RACE_ITERATIONS, mu, push))
        top = np.argsort(standing(race), kind="stable")[: how.coarse]
        paths, count = race.q[top], count[top]
        if coarse.k < self.problem.k:
            ends = self._solved(coarse, paths, Options(1e-3, mu0=mu, push=push))
            near = np.flatnonzero(ends.residual < _NEAR)
            folded = self.turns.folded(ends.q[near])
            kept, merged = _groups(folded, ends.objective[near], count[near])
            kept, count = kept[: how.fine], merged[: how.fine]
            paths = np.array([level.start(folded[at]) for at in kept])
        at_once = 3
        if self._sweeps is not None and len(paths):
            paths, order = self._sweeps.nested(paths, Options(mu0=mu, push=push))
            count, at_once, mu, push = count[order], 1, 1e-3, 1e-3
        spent = self.work.spent
        for first in range(0, len(paths), at_once):
            part = slice(first, first + at_once)
            self._settle(paths[part], count[part], mu, push)
            if self.work.spent - spent > _FINE_SHARE:
                return

    def _walked(
        self, problem: Problem, random: np.random.Generator, how: Round, scale: float
    ) -> tuple[Array, Array]:
        """Return walked paths (s, k, n) of the whole or the coarse path, folded, and objectives."""
        turns = self.turns
        anchors = anchor_points(problem.k)
        at = np.repeat(anchors, how.postures)
        postures = random.uniform(turns.lower, turns.upper, (len(at), 1, problem.n))
        alone = self._solved(problem, postures, _ALONE, points=at)
        self._starts += int(alone.ran.sum())
        folded = turns.folded(alone.q)
        chosen: list[int] = []
        met = once = 0
        for anchor in anchors:
            mine = np.flatnonzero((at == anchor) & (alone.residual < _NEAR))
            kept, count = _groups(folded[mine], alone.objective[mine])
            self.reachable = self.reachable and (len(mine) > 0 or len(self.rounds) > 1)
            met, once = met + len(mine), once + int(np.sum(count == 1))
            chosen += mine[kept[: how.minima]].tolist()
        self.unseen = once / met if met else 1.0
        if not chosen:
            return np.zeros((0, problem.k, problem.n)), np.zeros(0)
        walked = engine.walk_many(
            turns.widened(problem), folded[chosen, 0], at[chosen], jobs=self.jobs, scale=scale
        )
        self.work.add(walked.steps)
        if walked.interrupted:
            raise KeyboardInterrupt
        paths = turns.folded(walked.q[walked.reached])
        if not len(paths):
            return paths, np.zeros(0)
        here = self._solved(problem, paths, Options(1e-3, 0, push=TOLERANCE.no_length))
        return paths, here.objective

    def _settle(self, paths: Array, count: Integers, mu: float, push: float) -> None:
        """Refine paths on all points; keep and offer the ends."""
        options = Options(TOLERANCE.search, mu0=mu, push=push)
        if self._sweeps is None:
            ends = self._solved(self.problem, paths, options, limit=self.pool.limit, keep=True)
            good = ends.converged & ~ends.saddle
        else:
            ends = self._sweeps.settled(paths, options)
            ends, good = replace(ends, q=self.turns.folded(ends.q)), ends.feasible
        self._ends.append(ends)
        self._weight.append(count)
        for end in np.flatnonzero(good):
            self.pool.offer(ends.q[end], ends.objective[end])
            self.rounds[-1] = min(self.rounds[-1], float(ends.objective[end]))
        if ends.interrupted:
            raise KeyboardInterrupt

    def _solved(
        self,
        problem: Problem,
        starts: Array,
        options: Options,
        *,
        keep: bool = False,
        **more: Any,
    ) -> Solutions:
        """Solve, and count the work; with `keep` Ctrl-C is left to the caller."""
        ends = engine.solve_many(problem, starts, jobs=self.jobs, options=options, **more)
        self.work.add(int(ends.iterations.sum()) * starts.shape[1])
        whole = problem is self.problem and starts.shape[1] == problem.k
        if ends.interrupted and not keep:
            raise KeyboardInterrupt
        return replace(ends, q=self.turns.folded(ends.q)) if whole else ends


def standing(ends: Solutions) -> Array:
    """Return objectives (s,), and what those far off their rows pay for it."""
    return np.asarray(ends.objective + 10.0 * np.maximum(0.0, ends.residual - _OFF_PATH))


def _groups(paths: Array, value: Array, count: Integers | None = None) -> tuple[Integers, Integers]:
    """Return the best of every group of paths that agree by joints, best first, and their counts.

    Args:
        paths: (s, k, n).
        value: (s,) objective; what is infinite is left out.
        count: (s,) what each path counts; 1 by default.
    """
    flat = paths.reshape(len(paths), math.prod(paths.shape[1:]))
    kept: list[int] = []
    counts: list[int] = []
    for at in np.argsort(value, kind="stable"):
        if not np.isfinite(value[at]):
            break
        one = 1 if count is None else int(count[at])
        if kept:
            away = np.abs(flat[kept] - flat[at]).max(axis=1)
            nearest = int(np.argmin(away))
            if away[nearest] < TOLERANCE.same_joint:
                counts[nearest] += one
                continue
        kept.append(int(at))
        counts.append(one)
    return np.array(kept, dtype=np.int64), np.array(counts, dtype=np.int64)
