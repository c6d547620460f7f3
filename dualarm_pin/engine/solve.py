"""The engine's face in Python: one solve, a batch of solves over threads, an evaluation."""

from __future__ import annotations

import os
from concurrent.futures import Future, ThreadPoolExecutor, wait

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.engine import entries
from dualarm_pin.engine.chain import Floats, Integers
from dualarm_pin.engine.interior_point import (
    CONVERGED,
    INFEASIBLE,
    ITERATION_LIMIT,
    NOT_RUN,
    STALLED,
    Settings,
)
from dualarm_pin.engine.layout import Problem, room_for_window
from dualarm_pin.engine.outcome import STATUS, Batch, Evaluation, Options, Outcome
from dualarm_pin.engine.problem_data import problem_data
from dualarm_pin.engine.workspace import new_workspace
from dualarm_pin.errors import InputError, ShapeError

__all__ = [
    "CONVERGED",
    "INFEASIBLE",
    "ITERATION_LIMIT",
    "NOT_RUN",
    "STALLED",
    "STATUS",
    "Batch",
    "Evaluation",
    "Options",
    "Outcome",
    "Problem",
    "evaluate",
    "problem_data",
    "solve",
    "solve_batch",
]

_CHUNKS_PER_JOB = 8


def solve(
    data: Problem, start: ArrayLike, options: Options | None = None, warm: Outcome | None = None
) -> Outcome:
    """Solve from one start.

    Args:
        data: From `problem_data`.
        start: (k, n) rad or m; moved inside the bounds.
        options: How; `Options.warm()` by default where `warm` is given, else `Options()`.
        warm: An earlier outcome of a nearby problem, whose multipliers are kept.

    Raises:
        ShapeError: The start has another shape.
        InputError: The start is not finite.
    """
    first = _start("start", start, data)
    if options is None:
        options = Options() if warm is None else Options.warm()
    batch = _Rows(data, first[None], np.zeros(1, dtype=np.int64))
    if warm is not None:
        batch.y[0] = _shaped("warm", warm.pose_multipliers, (len(first), 6))
        batch.z_l[0] = _shaped("warm", warm.lower_multipliers, first.shape)
        batch.z_u[0] = _shaped("warm", warm.upper_multipliers, first.shape)
    batch.run(np.zeros(1, dtype=np.int64), options.settings(), warm is not None)
    return batch.result()[0]


def solve_batch(
    data: Problem,
    starts: ArrayLike,
    options: Options | None = None,
    jobs: int | None = None,
    first: ArrayLike | None = None,
    interrupt: Integers | None = None,
) -> Batch:
    """Solve from many starts over threads; the result does not depend on their number.

    Args:
        data: From `problem_data`, for the whole path.
        starts: (s, k, n) rad or m. k may be smaller than the path: see `first`.
        options: How, for every start.
        jobs: Threads; the number of usable cores if None.
        first: (s,) first point of every start: it then solves the k points from there on (one
            point alone if k is 1), with their links. 0 by default.
        interrupt: (1,) integer array; set to 1 by anyone, it ends the batch before the next start.
            Ctrl-C does the same. What is finished is kept, the rest is NOT_RUN.

    Raises:
        ShapeError: An array has another shape.
        InputError: A start is not finite, or a window leaves the path.
    """
    array = np.array(starts, dtype=np.float64, order="C")
    k, n = len(data.points.position), len(data.lower)
    if array.ndim != 3 or array.shape[2] != n or not 1 <= array.shape[1] <= k:
        raise ShapeError(f"has shape {array.shape}, not (s, k <= {k}, {n})", field="starts")
    _refuse_not_finite("starts", array)
    at = np.zeros(len(array), dtype=np.int64) if first is None else np.array(first, dtype=np.int64)
    if at.shape != (len(array),):
        raise ShapeError(f"has shape {at.shape}, not ({len(array)},)", field="first")
    if len(at) and (at.min() < 0 or at.max() + array.shape[1] > k):
        raise InputError(
            f"windows of {array.shape[1]} points from {at.min()} .. {at.max()} leave the path of "
            f"{k} points",
            field="first",
        )
    settings = (options or Options()).settings()
    rows = _Rows(data, array, at, interrupt)
    rows.run_over_threads(jobs or usable_cores(), settings)
    return rows.result()


def usable_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def evaluate(data: Problem, q: ArrayLike, y: ArrayLike | None = None) -> Evaluation:
    """Evaluate the problem at q (k, n) with multipliers y (k, 6) of the pose rows (default 0).

    Raises:
        ShapeError: An array has another shape.
        InputError: A value is not finite.
    """
    at = _start("q", q, data)
    shape = (len(at), 6)
    multipliers = np.zeros(shape) if y is None else _shaped("y", y, shape)
    k, n = at.shape
    work = new_workspace(k, len(data.chain.kind), n)
    values, J_r = np.zeros(k), np.zeros((k, 6, n))
    total = entries.evaluate(data, work, at, multipliers, values, J_r)
    return Evaluation(
        objective=total,
        values=values,
        residual=work.residual,
        jacobian=work.jacobian,
        gradient=work.gradient,
        hessian=work.hessian,
        link=work.link,
        stiffness=work.stiffness,
        J_r=J_r,
    )


class _Rows:
    """The arrays of a batch while it runs; every start is a row of its own."""

    def __init__(
        self, data: Problem, q: Floats, first: Integers, interrupt: Integers | None = None
    ) -> None:
        s, k, n = q.shape
        self.data, self.q, self.first = data, q, first
        self.y, self.z_l, self.z_u = np.zeros((s, k, 6)), np.zeros((s, k, n)), np.zeros((s, k, n))
        self.codes = np.full((s, 2), [NOT_RUN, 0], dtype=np.int64)
        self.values = np.full((s, 4), np.inf)
        self.interrupt = np.zeros(1, dtype=np.int64) if interrupt is None else interrupt

    def run(self, items: Integers, settings: Settings, keep_multipliers: bool = False) -> None:
        """Solve some rows in this thread."""
        _, k, n = self.q.shape
        entries.solve_items(
            self.data._replace(points=room_for_window(self.data.points, k)),
            self.data.points,
            new_workspace(k, len(self.data.chain.kind), n),
            settings,
            keep_multipliers,
            items,
            self.first,
            self.interrupt,
            self.q,
            self.y,
            self.z_l,
            self.z_u,
            self.codes,
            self.values,
        )

    def run_over_threads(self, jobs: int, settings: Settings) -> None:
        """Solve all rows; Ctrl-C ends the batch after the starts that are running."""
        items = np.arange(len(self.q))
        chunks = np.array_split(items, min(len(items), jobs * _CHUNKS_PER_JOB)) if jobs else []
        with ThreadPoolExecutor(max(1, jobs)) as pool:
            running: list[Future[None]] = []
            try:
                running = [pool.submit(self.run, chunk, settings) for chunk in chunks]
                for future in running:
                    future.result()
            except KeyboardInterrupt:
                self.interrupt[0] = 1
                wait(running)

    def result(self) -> Batch:
        status = self.codes[:, 0].copy()
        return Batch(
            q=self.q,
            status=status,
            objective=self.values[:, 0].copy(),
            residual=self.values[:, 1].copy(),
            stationarity=self.values[:, 2].copy(),
            iterations=self.codes[:, 1].copy(),
            pose_multipliers=self.y,
            lower_multipliers=self.z_l,
            upper_multipliers=self.z_u,
            mu=self.values[:, 3].copy(),
            interrupted=bool((status == NOT_RUN).any()),
        )


def _start(name: str, value: ArrayLike, data: Problem) -> Floats:
    return _shaped(name, value, (len(data.points.position), len(data.lower)))


def _shaped(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    array = np.array(value, dtype=np.float64, order="C")
    if array.shape != shape:
        raise ShapeError(f"has shape {array.shape}, not {shape}", field=name)
    _refuse_not_finite(name, array)
    return array


def _refuse_not_finite(name: str, array: Floats) -> None:
    if not np.isfinite(array).all():
        at = np.argwhere(~np.isfinite(array))[0].tolist()
        raise InputError(f"is not finite at {at}", field=name)
