"""The engine's face in Python: one solve, a batch of solves over threads, an evaluation."""

from __future__ import annotations

import dataclasses
import os
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
from dualarm_pin.engine.layout import Problem, new_workspace, room_for_window
from dualarm_pin.engine.problem_data import problem_data
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

STATUS = ("converged", "iteration limit", "infeasible", "stalled", "not run")
_CHUNKS_PER_JOB = 8


@dataclass(frozen=True)
class Options:
    """How one start is solved.

    Attributes:
        tolerance: On stationarity, pose residual and complementarity.
        iterations: Cap on Newton steps.
        mu0: First barrier parameter.
        push: Share of every range to which the start is moved away from its bounds.
    """

    tolerance: float = 1e-7
    iterations: int = 150
    mu0: float = 0.1
    push: float = 1e-2

    @classmethod
    def warm(cls, tolerance: float = 1e-7, iterations: int = 150) -> Options:
        """Return options for a start that is nearly the answer, multipliers kept."""
        return cls(tolerance, iterations, 1e-6, 1e-6)

    def settings(self) -> Settings:
        """Return the numbers as the compiled code takes them, checked.

        Raises:
            InputError: A number is out of its range.
        """
        for name in ("tolerance", "mu0", "push"):
            value = getattr(self, name)
            if not 0.0 < value < np.inf:
                raise InputError(f"is {value}, must be above 0", field=name)
        if self.push >= 0.5:
            raise InputError(f"is {self.push}, must be below 0.5", field="push")
        return Settings(
            float(self.tolerance), int(self.iterations), float(self.mu0), float(self.push)
        )


@dataclass(frozen=True, eq=False)
class Outcome:
    """One local solve; everything is evaluated at the q returned.

    Attributes:
        q: (k, n) rad or m, always within the bounds.
        status: Index into `STATUS`.
        objective: The problem's objective at q.
        residual: Largest absolute pose residual at q [m, or 2 sin(angle / 2)].
        stationarity: Largest absolute entry of the Lagrangian's gradient.
        iterations: Newton steps and restorations.
        pose_multipliers: (k, 6), 0 beyond a point's rows. The sign of the last three follows the
            sign of the running quaternion of the chain.
        lower_multipliers: (k, n), at least 0.
        upper_multipliers: (k, n), at least 0.
        mu: Last barrier parameter.
    """

    q: Floats
    status: int
    objective: float
    residual: float
    stationarity: float
    iterations: int
    pose_multipliers: Floats
    lower_multipliers: Floats
    upper_multipliers: Floats
    mu: float

    @property
    def converged(self) -> bool:
        """Whether the solver met its tolerance."""
        return self.status == CONVERGED

    @property
    def message(self) -> str:
        """The status in words."""
        return STATUS[self.status]


@dataclass(frozen=True, eq=False)
class Batch:
    """Many solves, row by row as `Outcome`.

    Attributes:
        q: (s, k, n) rad or m.
        status: (s,) index into `STATUS`; NOT_RUN where the batch was stopped before.
        objective: (s,).
        residual: (s,).
        stationarity: (s,).
        iterations: (s,).
        pose_multipliers: (s, k, 6).
        lower_multipliers: (s, k, n).
        upper_multipliers: (s, k, n).
        mu: (s,).
        interrupted: Whether it was stopped before every start was run.
    """

    q: Floats
    status: Integers
    objective: Floats
    residual: Floats
    stationarity: Floats
    iterations: Integers
    pose_multipliers: Floats
    lower_multipliers: Floats
    upper_multipliers: Floats
    mu: Floats
    interrupted: bool

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, item: int) -> Outcome:
        """Return one solve."""
        values = {
            field.name: getattr(self, field.name)[item] for field in dataclasses.fields(Outcome)
        }
        scalars = ("objective", "residual", "stationarity", "mu")
        values |= {name: float(values[name]) for name in scalars}
        values |= {name: int(values[name]) for name in ("status", "iterations")}
        return Outcome(**values)

    def feasible(self, tolerance: float = 1e-6) -> NDArray[np.bool_]:
        """Return which starts (s,) were run and ended on the path, by the residual at their q."""
        return np.asarray((self.status != NOT_RUN) & (self.residual <= tolerance))


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


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Values and derivatives at q (k, n), as the engine computes them.

    Attributes:
        objective: The problem's objective.
        values: (k,) per point: weighted index and linear term, no links.
        residual: (k, 6).
        jacobian: (k, 6, n) of the residual.
        gradient: (k, n) of the objective.
        hessian: (k, n, n) diagonal blocks of the Hessian of objective + y . residual.
        link: (k, n) diag(metric) dq of the link after each point.
        stiffness: (k,) of that link: the block (i+1, i) of the Hessian is
            -(stiffness_i diag(metric) + 8 link_weight_i link_i link_i^T).
        J_r: (k, 6, n) relative Jacobian [linear; angular] of e2 with respect to e1, in e1.
    """

    objective: float
    values: Floats
    residual: Floats
    jacobian: Floats
    gradient: Floats
    hessian: Floats
    link: Floats
    stiffness: Floats
    J_r: Floats


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
