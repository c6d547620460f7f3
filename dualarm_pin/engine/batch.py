"""A batch of starts while it is solved, over threads."""

from __future__ import annotations

import os
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import replace

import numpy as np

from dualarm_pin.chain import Floats, Integers
from dualarm_pin.engine import entries
from dualarm_pin.engine.arrow_problem import arrow_problem
from dualarm_pin.engine.interior_point.solve_one import CONVERGED, NOT_RUN, Settings
from dualarm_pin.engine.room import own_window, widths, workspace_for
from dualarm_pin.engine.workspace import Workspace
from dualarm_pin.placement.shared import SharedProblem
from dualarm_pin.problem import Problem
from dualarm_pin.solution import Solutions
from dualarm_pin.tolerance import TOLERANCE

_FEASIBLE = TOLERANCE.position / 10.0
_CHUNKS_PER_JOB = 8  # small enough that no thread waits long for the slowest chunk
_FEW = 64  # points in all: done in a few milliseconds
_NO_LIMIT = np.full(1, np.inf)
_NO_POINT = np.zeros(0, dtype=np.int64)


class Batch:
    """The arrays of a batch while it runs; every start is a row of its own."""

    def __init__(
        self,
        problem: Problem,
        q: Floats,
        neighbours: Floats | None = None,
        interrupt: Integers | None = None,
        limit: Floats = _NO_LIMIT,
    ) -> None:
        self.problem, self.q, self.limit = problem, q, limit
        self.linked = neighbours is not None
        own = problem.neighbours.posture[None].copy()
        self.neighbours = own if neighbours is None else neighbours
        self.codes = np.full((len(q), 3), [NOT_RUN, 0, 0], dtype=np.int64)
        self.values = np.full((len(q), 4), np.inf)
        self.interrupt = np.zeros(1, dtype=np.int64) if interrupt is None else interrupt

    def run(
        self,
        problem: Problem,
        work: Workspace,
        items: Integers,
        settings: Settings,
        *,
        keep_multipliers: bool = False,
        path: Problem | None = None,
        first: Integers = _NO_POINT,
    ) -> None:
        """Solve some rows in this thread; with `path`, each the window from its first point on."""
        posture = np.empty_like(problem.neighbours.posture)  # of this thread alone
        own = replace(problem, neighbours=problem.neighbours._replace(posture=posture))
        solve_items = entries.solve_items
        if isinstance(own, SharedProblem) and own.k > 1:
            own, solve_items = arrow_problem(own, widths(own)), entries.solve_arrow_items
        solve_items(
            own,
            work,
            settings,
            keep_multipliers,
            items,
            self.neighbours,
            self.interrupt,
            self.q,
            self.codes,
            self.values,
            self.limit,
            path or problem,
            first,
            _NO_POINT,
            np.full(len(first), float(self.linked)),
        )

    def run_over_threads(self, first: Integers, jobs: int, settings: Settings) -> None:
        """Solve all rows; Ctrl-C ends the batch after the starts that are running."""
        (s, k), scaled = self.q.shape[:2], self.problem.scaled()
        most = 1 if jobs == 1 else min(jobs * _CHUNKS_PER_JOB, s * k // _FEW)
        places = np.unique(first)
        pieces: list[tuple[Problem, Integers, Integers]] = []
        if len(places) <= 1 or (isinstance(scaled, SharedProblem) and k > 1):
            for point in places:  # each a problem of its own, with its border
                window = scaled.window(int(point), k, linked=self.linked)
                items = np.flatnonzero(first == point)
                pieces += [(window, _NO_POINT, part) for part in _parts(items, most)]
        else:
            pieces = [(scaled, first, part) for part in _parts(np.arange(s), most)]
        if s * k <= _FEW or len(pieces) == 1:  # done sooner than threads are started
            for piece in pieces:
                self._run_piece(*piece, settings)
            return
        with ThreadPoolExecutor(jobs) as pool:
            running: list[Future[None]] = []
            try:
                running = [pool.submit(self._run_piece, *piece, settings) for piece in pieces]
                for future in running:
                    future.result()
            except KeyboardInterrupt:
                self.interrupt[0] = 1
                wait(running)

    def _run_piece(
        self, path: Problem, first: Integers, items: Integers, settings: Settings
    ) -> None:
        if not len(first):
            self.run(path, workspace_for(path), items, settings)
            return
        window = own_window(path, self.q.shape[1])
        self.run(window, workspace_for(window, path), items, settings, path=path, first=first)

    def result(self) -> Solutions:
        """Return the rows as they stand."""
        status = self.codes[:, 0].copy()
        residual = self.values[:, 1].copy()
        feasible = (status != NOT_RUN) & (residual <= _FEASIBLE)
        return Solutions(
            q=self.q,
            objective=self.problem.size * self.values[:, 0],
            residual=residual,
            feasible=feasible,
            converged=feasible & (status == CONVERGED),
            iterations=self.codes[:, 1].copy(),
            saddle=self.codes[:, 2] == 1,
            status=status,
            size=self.problem.size,
            interrupted=bool((status == NOT_RUN).any()),
        )


def _parts(items: Integers, most: int) -> list[Integers]:
    return np.array_split(items, max(1, min(len(items), most)))


def usable_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
