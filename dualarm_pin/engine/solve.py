"""The engine's face in Python: one solve, many over threads."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import checked, finite
from dualarm_pin.chain import VARIABLE, Floats, Integers
from dualarm_pin.engine.batch import Batch, usable_cores
from dualarm_pin.engine.options import Options
from dualarm_pin.engine.room import load_multipliers, workspace_for
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.problem import Problem
from dualarm_pin.solution import Multipliers, Solution, Solutions
from dualarm_pin.tolerance import TOLERANCE


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
    rows = Batch(problem, q)
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
    rows = Batch(problem, q, ends, interrupt, limits)
    rows.run_over_threads(first, jobs or usable_cores(), (options or Options()).settings())
    return rows.result()


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


__all__ = ["Options", "kinematics", "solve", "solve_many"]
