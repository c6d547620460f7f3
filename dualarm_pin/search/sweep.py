"""Sweeps: a long path refined window by window, each between neighbours that stay where they are.

On many hundred points one Newton step of all of them is held back by the worst: whole solves stall
where windows converge, each with a line search and a barrier of its own. Every other window is
solved, then those between; they overlap. The path stays feasible and never gets worse.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.engine.solve import Options
from dualarm_pin.problem import Problem
from dualarm_pin.search.coarse import coarse_of
from dualarm_pin.search.work import Work
from dualarm_pin.solution import Solutions
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
LONG = 150  # points: below, the whole path converges as surely, and at once
_WINDOW, _STEP = 48, 30  # points of a window, and from one to the next
_ITERATIONS = 60
_MUS = ((0.1, 1e-2), (1e-3, 1e-3), (1e-2, 1e-2))  # barrier and push of later sweeps
_GAIN, _SWEEPS = 1e-3, 8  # windows beside one that won this share are solved again; sweeps
_WHOLE = 0.15  # s: what the whole solve from a swept path may cost; it converges soon or never
# Points of the paths between the coarse and the whole one, and how many starts are solved on them:
# a start of a few points does not tell which basin is low where there are many, and sweeps from
# one that was solved on more of them end lower.
_OFF_PATH = 1e3  # what an end pays for its distance from its rows
_BETWEEN = ((80, 5), (200, 3))
_PLACE = Options(TOLERANCE.search, 25, 1e-3, 1e-3)
_HERE = Options(TOLERANCE.search, 0, push=TOLERANCE.no_length)  # the objective, and no more


class Sweeps:
    """Refines long paths of a problem, and counts the work."""

    def __init__(self, problem: Problem, work: Work, jobs: int | None = None) -> None:
        self.problem, self.work, self.jobs = problem, work, jobs
        k = problem.k
        count = 1 + -(-(k - _WINDOW) // _STEP)
        self._first = np.round(np.linspace(0, k - _WINDOW, count)).astype(np.int64)
        self._most = max(10, int(_WHOLE / work.seconds(k)))

    def settled(self, paths: Array, options: Options) -> Solutions:
        """Return where paths (s, k, n) end: converged, or merely on the path and low.

        Args:
            paths: Starts; they need not be on the path.
            options: Barrier and push of the first sweep.
        """
        here = self.valued(paths)
        stale = np.ones((len(paths), len(self._first)), dtype=bool)
        for number in range(_SWEEPS):
            # A window that failed tries another barrier.
            mu, push = (options.mu0, options.push) if number == 0 else _MUS[number % len(_MUS)]
            here = self._swept(here, stale, Options(TOLERANCE.search, _ITERATIONS, mu, push))
            if not stale.any():
                break
            if number + 2 == _SWEEPS:
                here = self._placed(here, stale)
        near = Options(TOLERANCE.search, self._most, 1e-4, 1e-4)
        whole = engine.solve_many(self.problem, here.q, jobs=self.jobs, options=near)
        self.work.add(int(whole.iterations.sum()) * self.problem.k)
        better = whole.converged & ~whole.saddle
        order = [whole.take([i]) if ok else here.take([i]) for i, ok in enumerate(better)]
        return Solutions.join(order)

    def nested(self, paths: Array, options: Options) -> tuple[Array, NDArray[np.int64]]:
        """Return starts solved on ever more points, the best first, and which ones they were.

        Args:
            paths: Starts (s, k, n).
            options: Barrier and push of the first solve.
        """
        which, how = np.arange(len(paths)), replace(options, tolerance=1e-5, iterations=_ITERATIONS)
        for points, most in _BETWEEN:
            level = coarse_of(self.problem, points)
            starts = paths[which[:most]][:, level.points]
            ends = engine.solve_many(level.problem, starts, jobs=self.jobs, options=how)
            self.work.add(int(ends.iterations.sum()) * level.problem.k)
            if ends.interrupted:
                raise KeyboardInterrupt
            standing = ends.objective + _OFF_PATH * ends.residual
            order = np.argsort(standing, kind="stable")
            which = which[:most][order]
            paths[which] = [level.start(q) for q in ends.q[order]]
            how = replace(how, mu0=1e-3, push=1e-3)
        return paths[which], which

    def valued(self, paths: Array) -> Solutions:
        """Return paths (s, k, n) as they are, with their objectives."""
        self.work.add(len(paths) * self.problem.k)
        return engine.solve_many(self.problem, paths, jobs=self.jobs, options=_HERE)

    def _placed(self, here: Solutions, stale: Flags) -> Solutions:
        """Put every point of the windows that failed on its rows alone, near where it was."""
        q, k = here.q.copy(), self.problem.k
        path, window = np.nonzero(stale)
        pairs = np.unique(
            np.stack([np.repeat(path, _WINDOW), _points(self._first[window]).ravel()]), axis=1
        )
        path, point = pairs
        before, after = np.maximum(point - 1, 0), np.minimum(point + 1, k - 1)
        ends = engine.solve_many(
            self.problem,
            q[path, point][:, None],
            options=_PLACE,
            points=point,
            neighbours=np.stack([q[path, before], q[path, after]], axis=1),
            jobs=self.jobs,
        )
        self.work.add(int(ends.iterations.sum()))
        q[path[ends.feasible], point[ends.feasible]] = ends.q[ends.feasible, 0]
        return self.valued(q)

    def _swept(self, here: Solutions, stale: Flags, options: Options) -> Solutions:
        """Solve the windows that are `stale` (s, windows): what is beside them has moved."""
        q, k = here.q.copy(), self.problem.k
        for colour in (0, 1):
            waiting = stale.copy()
            waiting[:, 1 - colour :: 2] = False
            path, window = np.nonzero(waiting)
            if not len(path):
                continue
            stale[path, window] = False
            first = self._first[window]
            rows = (path[:, None], _points(first))
            before, after = np.maximum(first - 1, 0), np.minimum(first + _WINDOW, k - 1)
            beside = np.stack([q[path, before], q[path, after]], axis=1)
            now, ends = (
                engine.solve_many(
                    self.problem,
                    q[rows],
                    options=each,
                    points=first,
                    neighbours=beside,
                    jobs=self.jobs,
                )
                for each in (_HERE, options)
            )
            self.work.add(int(ends.iterations.sum() + len(first)) * _WINDOW)
            if ends.interrupted:
                raise KeyboardInterrupt
            lower = ends.feasible & (ends.objective < now.objective)
            taken = np.where(now.feasible, lower, ends.residual < now.residual)
            q[path[taken, None], rows[1][taken]] = ends.q[taken]
            gain = now.objective - ends.objective
            moved = taken & (~now.feasible | (gain > _GAIN * np.abs(ends.objective)))
            stale[path[moved], np.maximum(window[moved] - 1, 0)] = True
            stale[path[moved], np.minimum(window[moved] + 1, stale.shape[1] - 1)] = True
            stale[path[~ends.feasible], window[~ends.feasible]] = True
        return self.valued(q)


def _points(first: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the points (s, window) of windows that begin at `first` (s,)."""
    return first[:, None] + np.arange(_WINDOW)
