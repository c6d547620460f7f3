"""The engine's face in Python: one solve, many over threads, an evaluation."""

from __future__ import annotations

import os
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import checked, finite
from dualarm_pin.chain import VARIABLE, Floats, Integers
from dualarm_pin.engine import entries
from dualarm_pin.engine.arrow_problem import arrow_problem
from dualarm_pin.engine.interior_point.solve_one import CONVERGED, NOT_RUN, Settings
from dualarm_pin.engine.jit.functions import INDEX, addresses, row_signatures
from dualarm_pin.engine.kernels.address import index_address
from dualarm_pin.engine.workspace import Scratch, Workspace, new_scratch, new_workspace
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.placement.shared import SharedProblem
from dualarm_pin.problem import CALLED, Problem
from dualarm_pin.rows import table
from dualarm_pin.solution import STATUS, Multipliers, Solution, Solutions
from dualarm_pin.tolerance import TOLERANCE

R = TypeVar("R", bound=NamedTuple)
_FEASIBLE = TOLERANCE.position / 10.0
_CHUNKS_PER_JOB = 8  # small enough that no thread waits long for the slowest chunk
_FEW = 64  # points in all: done in a few milliseconds


@dataclass(frozen=True)
class Options:
    """How one start is solved.

    Attributes:
        tolerance: On stationarity, rows and complementarity, of an objective of size 1.
        iterations: Cap on Newton steps.
        mu0: First barrier parameter.
        push: Share of every range to which the start is moved away from its bounds.
    """

    tolerance: float = TOLERANCE.search
    iterations: int = 150
    mu0: float = 0.1
    push: float = 1e-2

    @classmethod
    def warm(cls, tolerance: float = TOLERANCE.search, iterations: int = 150) -> Options:
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
            float(self.tolerance), int(self.iterations), float(self.mu0), float(self.push), np.inf
        )


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Values and derivatives at q (k, n), as the engine computes them.

    Attributes:
        objective: The problem's objective.
        values: (k,) per point: weighted index and linear term, no links.
        residual: (k, m) equality rows.
        jacobian: (k, m, n) of these.
        gap: (k, r) inequality rows.
        row_jacobian: (k, r, n) of these.
        gradient: (k, n) of the objective.
        hessian: (k, n, n) diagonal blocks of the Hessian of objective + y . residual - push . gap.
        link: (k, n) diag(metric) dq of the link after each point.
        stiffness: (k,) of that link: the block (i+1, i) of the Hessian is
            -(stiffness_i diag(metric) + 8 link_weight_i link_i link_i^T).
        J_r: (k, 6, n) relative Jacobian [linear; angular] of e2 with respect to e1, in e1.
    """

    objective: float
    values: Floats
    residual: Floats
    jacobian: Floats
    gap: Floats
    row_jacobian: Floats
    gradient: Floats
    hessian: Floats
    link: Floats
    stiffness: Floats
    J_r: Floats


def solve(
    problem: Problem,
    start: ArrayLike,
    options: Options | None = None,
    *,
    warm: Multipliers | None = None,
    number: int = 0,
) -> Solution:
    """Solve from one start.

    Args:
        problem: The problem.
        start: (k, n) rad or m; moved inside the bounds.
        options: How; `Options.warm()` by default where `warm` is given, else `Options()`.
        warm: Multipliers of a nearby problem's solution.
        number: Number of the start.

    Raises:
        ShapeError: The start has another shape.
        InputError: The start is not finite.
    """
    begun = time.perf_counter()
    q = checked("start", start, (problem.k, problem.n))[None]
    options = options or (Options() if warm is None else Options.warm())
    rows = _Batch(problem, q)
    item = np.zeros(1, dtype=np.int64)
    scaled = problem.scaled()
    work = workspace_for(scaled)
    if warm is not None:
        load_multipliers(warm, work, problem.size)
    rows.run(scaled, work, item, options.settings(), keep_multipliers=warm is not None)
    size, at = problem.size, work.at
    return replace(
        rows.result()[0],
        start=number,
        wall_s=time.perf_counter() - begun,
        stationarity=size * float(rows.values[0, 2]),
        multipliers=Multipliers(size * at.y, size * at.lower, size * at.upper, size * at.push),
    )


def solve_many(
    problem: Problem,
    starts: ArrayLike,
    options: Options | None = None,
    *,
    jobs: int | None = None,
    points: ArrayLike | None = None,
    neighbours: ArrayLike | None = None,
    limit: ArrayLike = np.inf,
    interrupt: Integers | None = None,
) -> Solutions:
    """Solve from many starts over threads; the result does not depend on their number.

    Args:
        problem: The problem over the whole path.
        starts: (s, k, n) rad or m. k may be smaller than the path: see `points`.
        options: How, for every start.
        jobs: Threads; the number of usable cores if None.
        points: (s,) first point of every start: it then solves the k points from there on (one
            point alone if k is 1), with their links. 0 by default.
        neighbours: (s, 2, n) fixed postures before and after the points of every start, which
            then count as their links do. The problem's own by default, where the path ends.
        limit: (s,) or one number: a start is dropped once it is clear that it will not come below
            this objective.
        interrupt: (1,) integer array; set to 1 by anyone, it ends the batch before the next start.
            Ctrl-C does the same. What is finished is kept, the rest was not run.

    Raises:
        ShapeError: An array has another shape.
        InputError: A start is not finite, or its points leave the path.
    """
    q = np.ascontiguousarray(finite(starts, "starts", (-1, -1, problem.n)))
    s, k = q.shape[:2]
    if not 1 <= k <= problem.k:
        raise ShapeError(f"{k} points a start; the path has {problem.k}", field="starts")
    first = np.zeros(s, dtype=np.int64) if points is None else np.array(points, dtype=np.int64)
    if first.shape != (s,):
        raise ShapeError(f"has shape {first.shape}, not ({s},)", field="points")
    if s and (first.min() < 0 or first.max() + k > problem.k):
        raise InputError(
            f"{k} points from {first.min()} .. {first.max()} leave the path of {problem.k} points",
            field="points",
        )
    ends = None if neighbours is None else checked("neighbours", neighbours, (s, 2, problem.n))
    limits = np.atleast_1d(np.asarray(limit, dtype=float)) / problem.size
    if limits.shape not in ((1,), (s,)):
        raise ShapeError(f"has shape {limits.shape}, not ({s},)", field="limit")
    rows = _Batch(problem, q, ends, interrupt, limits)
    rows.run_over_threads(first, jobs or usable_cores(), (options or Options()).settings())
    return rows.result()


def evaluate(
    problem: Problem, q: ArrayLike, y: ArrayLike = 0.0, push: ArrayLike = 0.0
) -> Evaluation:
    """Evaluate the problem at q (k, n) with multipliers y (k, m) and push (k, r) of its rows.

    Raises:
        ShapeError: An array has another shape.
        InputError: A value is not finite.
    """
    work = new_room(problem)
    at = work.at
    at.q[:] = checked("q", q, at.q.shape)
    at.y[:] = checked("y", y, at.y.shape)
    at.push[:] = checked("push", push, at.push.shape)
    values, J_r = np.zeros(problem.k), np.zeros((problem.k, 6, problem.n))
    total = entries.evaluate(problem, work, values, J_r)
    return Evaluation(
        objective=total,
        values=values,
        residual=work.residual,
        jacobian=work.jacobian,
        gap=work.gap,
        row_jacobian=work.row_jacobian,
        gradient=work.gradient,
        hessian=work.hessian,
        link=work.link,
        stiffness=work.stiffness,
        J_r=J_r,
    )


def gaps(problem: Problem, q: ArrayLike) -> Floats:
    """Return the inequality rows (k, r) at q (k, n), without derivatives; 0 beyond a point's own.

    Raises:
        ShapeError: q has another shape.
        InputError: A value is not finite.
    """
    postures = checked("q", q, (problem.k, problem.n))
    values = np.zeros(problem.inequalities.kind.shape)
    scratch = new_scratch(len(problem.chain.kind), problem.n, len(problem.rows))
    _set_calls(problem, scratch)
    entries.gaps(problem, scratch, postures, values)
    return values


def kinematics(problem: Problem, q: Floats) -> tuple[Floats, float]:
    """Return J_r (6, n) and the largest pose residual at q (n,) of a problem of one point.

    By the entry that solves, so that nothing else is loaded.
    """
    end = solve(problem, q[None], Options(iterations=0, push=TOLERANCE.no_length))
    chain, work = problem.chain, workspace_for(problem.scaled())
    columns = np.vstack([work.columns[0], work.axes[0]]) * chain.scale
    J_r = np.zeros((6, problem.n))
    for e in np.flatnonzero(chain.role == VARIABLE):
        J_r[:, chain.source[e]] += columns[:, e]
    return J_r, end.residual


def usable_cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


_NO_LIMIT = np.full(1, np.inf)
_NO_POINT = np.zeros(0, dtype=np.int64)


class _Batch:
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
        pieces: list[tuple[Problem, Integers, Integers]] = []
        apart = isinstance(scaled, SharedProblem) and k > 1  # has a border of its own
        for point in np.unique(first) if apart else first[:1] if (first == first[:1]).all() else []:
            window = scaled.window(int(point), k, linked=self.linked)
            items = np.flatnonzero(first == point)
            pieces += [(window, _NO_POINT, each) for each in _parts(items, most)]
        if not pieces:
            pieces = [(scaled, first, each) for each in _parts(np.arange(s), most)]
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


def own_window(path: Problem, k: int) -> Problem:
    """Return the first k points as a problem with arrays of its own: walks overwrite them."""
    window = path.window(0, k)
    return replace(
        window,
        points=_copied(window.points),
        links=_copied(window.links),
        neighbours=_copied(window.neighbours),
        equalities=_copied(window.equalities),
        inequalities=_copied(window.inequalities),
    )


def _copied(record: R) -> R:
    return type(record)(*(array.copy() for array in record))


_ROOMS = threading.local()


def workspace_for(problem: Problem, path: Problem | None = None) -> Workspace:
    """Return room for this thread and this shape of problem, kept from one batch to the next.

    One point alone has room of its own: walks and whole paths take turns.

    Args:
        problem: What is solved.
        path: The path whose points, with their rows, are put into the problem one by one.
    """
    shape = (problem.k, len(problem.chain.kind), problem.n, *widths(problem))
    rooms: dict[bool, tuple[object, Workspace]] = _ROOMS.__dict__.setdefault("rooms", {})
    known, work = rooms.get(problem.k == 1, (None, None))
    if work is None or known != shape:
        work = new_room(problem)
        rooms[problem.k == 1] = shape, work
    _set_calls(path or problem, work.scratch)
    return work


def new_room(problem: Problem) -> Workspace:
    work = new_workspace(problem.k, len(problem.chain.kind), problem.n, *widths(problem))
    _set_calls(problem, work.scratch)
    return work


def widths(problem: Problem) -> tuple[int, int, int]:
    return problem.m, problem.inequalities.kind.shape[1], len(problem.rows)


def _set_calls(problem: Problem, scratch: Scratch) -> None:
    """Put the addresses of the index and the rows that have no kernel of their own."""
    index = problem.index
    if problem.terms.kind == CALLED:
        scratch.index_call[0] = index_address(problem, scratch)
        if not index.kernel:
            functions = (index.phi, index.gradient, index.curvature)
            scratch.index_calls[:] = addresses(index.name, functions, INDEX)
    called = {
        int(source)
        for rows in (problem.equalities, problem.inequalities)
        for source in rows.source[rows.kind == table.CALLED]
    }
    for number in called:
        row = problem.rows[number]
        assert row.slope is not None  # set when the row was made
        assert row.bend is not None
        signatures = row_signatures(len(row.parameters))
        scratch.row_calls[number] = addresses(row.name, (row.phi, row.slope, row.bend), signatures)


def load_multipliers(warm: Multipliers, work: Workspace, size: float) -> None:
    """Put multipliers into the room as those of the scaled problem."""
    at = work.at
    for name, room, value in (
        ("equalities", at.y, warm.equalities),
        ("lower", at.lower, warm.lower),
        ("upper", at.upper, warm.upper),
        ("inequalities", at.push, warm.inequalities),
    ):
        room[:] = checked(f"warm.{name}", value, room.shape) / size


__all__ = [
    "STATUS",
    "Evaluation",
    "Options",
    "evaluate",
    "gaps",
    "solve",
    "solve_many",
    "usable_cores",
]
