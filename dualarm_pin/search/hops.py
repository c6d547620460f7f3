"""Hops: a good path, disturbed at one point, walked anew from there within a window, refined.

Hops start from what other laws found, so they are no independent starts and count for none.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import generator
from dualarm_pin.search.turns import fold
from dualarm_pin.search.walk import walk
from dualarm_pin.solution import Solutions, distinct
from dualarm_pin.solvers import interior_point as engine

Array = NDArray[np.float64]

_BATCH = 8  # hops that are solved together: enough for some threads
_POOL = 12  # best distinct paths that hops start from, the best of them most often
_WINDOWS = (0.25, 0.5, 1.0)  # share of the path that is walked anew
_STEPS = (0.3, 3.0)  # rad in all joints together, between these evenly by logarithm
_PROJECT, _MINIMISE = 5, 60  # iterations of the disturbed point alone: stay near it, or settle
_HOPELESS = 3.0  # times the best objective: such a start is not refined
_MU, _PUSH = 1e-2, 1e-3


class Hops:
    """Hops from a pool of paths.

    Attributes:
        ends: Where the hops ended; None before the first.
        work: Points times iterations so far.
    """

    def __init__(self, problem: Problem, seed: int, *, jobs: int | None = None) -> None:
        self.problem, self.seed, self.jobs = problem, seed, jobs
        self.ends: Solutions | None = None
        self.work = 0
        self._batches = 0

    def hop(self, known: Solutions) -> None:
        """Hop a few times from the best of known paths and of those that hops found.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        every = known if self.ends is None else Solutions.join([known, self.ends])
        minima = distinct(every).ends
        random = generator(self.seed, 60, self._batches)
        self._batches += 1
        if not len(minima):
            return
        window = max(3, round(self.problem.k * _WINDOWS[int(random.integers(len(_WINDOWS)))]))
        window = min(window, self.problem.k)
        lowest = float(minima.objective[0])
        rank = np.minimum(random.exponential(3.0, _BATCH).astype(int), min(_POOL, len(minima)) - 1)
        first = random.integers(0, self.problem.k - window + 1, _BATCH)
        starts = minima.q[rank].copy()
        for begin in np.unique(first):
            mine = np.flatnonzero(first == begin)
            piece = starts[mine, begin : begin + window]
            starts[mine, begin : begin + window] = self._walked(piece, int(begin), random)
        starts = fold(self.problem, starts)
        from dualarm_pin.engine.solve import Options

        here = engine.solve_many(
            self.problem, starts, jobs=self.jobs, options=Options(iterations=0, push=1e-6)
        )
        hopeful = np.flatnonzero(here.objective < lowest + (_HOPELESS - 1.0) * abs(lowest))
        if here.interrupted:
            raise KeyboardInterrupt
        if not len(hopeful):
            return
        ends = engine.solve_many(
            self.problem, starts[hopeful], jobs=self.jobs, options=Options(mu0=_MU, push=_PUSH)
        )
        self.work += int(ends.iterations.sum()) * self.problem.k
        self.ends = ends if self.ends is None else Solutions.join([self.ends, ends])
        if ends.interrupted:
            raise KeyboardInterrupt

    def _walked(self, pieces: Array, begin: int, random: np.random.Generator) -> Array:
        """Return pieces (s, window, n) walked anew from a disturbed posture of each."""
        from dualarm_pin.engine.solve import Options

        s, window, n = pieces.shape
        part = self.problem.window(begin, window)
        at = random.integers(0, window, s)
        direction = random.standard_normal((s, n))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        length = np.exp(random.uniform(np.log(_STEPS[0]), np.log(_STEPS[1]), (s, 1)))
        moved = pieces[np.arange(s), at] + length * direction
        moved = np.clip(moved, part.lower, part.upper)
        alone = Options(1e-4, _PROJECT if random.uniform() < 0.5 else _MINIMISE, 1e-2, 1e-3)
        ends = engine.solve_many(part, moved[:, None], jobs=self.jobs, points=at, options=alone)
        self.work += int(ends.iterations.sum())
        if ends.interrupted:
            raise KeyboardInterrupt
        walked, work = walk(part, at, ends.q[:, 0], jobs=self.jobs)
        self.work += work
        return walked
