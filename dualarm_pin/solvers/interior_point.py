"""The compiled engine as a solver: closed-form derivatives, structured interior point."""

from __future__ import annotations

import time
import weakref
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.solvers.ends import Ends
from dualarm_pin.solvers.solution import Solution
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell
    from dualarm_pin.engine.chain import Chain
    from dualarm_pin.engine.layout import Problem as Data
    from dualarm_pin.engine.solve import Options, Outcome
    from dualarm_pin.problem import Problem

Array = NDArray[np.float64]
NAME = "engine"
_FEASIBLE = TOLERANCE.position / 10.0
_CHAINS: weakref.WeakKeyDictionary[Cell, Chain] = weakref.WeakKeyDictionary()


def data_of(problem: Problem) -> Data:
    """Return a problem as the arrays the engine takes.

    Raises:
        InputError: A value is not finite or bounds cross.
    """
    from dualarm_pin.engine.problem_data import problem_data

    return problem_data(
        _chain(problem.cell),
        problem.index,
        problem.position,
        problem.rotation,
        lower=problem.lower,
        upper=problem.upper,
        rows=problem.rows,
        spin_axis=problem.spin_axis,
        u=problem.u,
        link_weight=problem.link_weight,
        metric=problem.metric,
        index_weight=problem.index_weight,
        linear=problem.linear,
        before=problem.before,
        before_weight=problem.before_weight,
        after=problem.after,
        after_weight=problem.after_weight,
    )


def solve(
    problem: Problem,
    start: Array,
    options: Options | None = None,
    *,
    warm: Outcome | None = None,
    number: int = 0,
) -> Solution:
    """Minimise `problem` from `start` (k, n).

    Args:
        problem: The problem.
        start: Joints (k, n).
        options: How; None for the engine's defaults.
        warm: Outcome of a nearby problem, whose multipliers are kept.
        number: Number of the start.

    Returns:
        The solution; `extra["outcome"]` holds multipliers and stationarity.
    """
    from dualarm_pin.engine.solve import solve as run

    begun = time.perf_counter()
    outcome = run(data_of(problem), start, options, warm)
    wall = time.perf_counter() - begun
    return Solution(
        q=outcome.q,
        objective=outcome.objective,
        residual=outcome.residual,
        feasible=outcome.residual <= _FEASIBLE,
        converged=outcome.converged and outcome.residual <= _FEASIBLE,
        message=outcome.message,
        start=number,
        wall_s=wall,
        iterations=outcome.iterations,
        extra={"outcome": outcome},
    )


def solve_many(
    problem: Problem,
    starts: Array,
    *,
    jobs: int | None = None,
    options: Options | None = None,
    points: Sequence[int] | None = None,
) -> Ends:
    """Minimise `problem` from many starts over threads; the same ends for any number of them.

    Args:
        problem: The problem.
        starts: Joints (s, k, n), or (s, 1, n) with `points`.
        jobs: Threads; None takes the processors there are.
        options: How; None for the engine's defaults.
        points: For each start the one point of the path that it solves alone (s,).

    Returns:
        The ends; after Ctrl-C those that were finished, the rest infeasible and `interrupted` set.
    """
    from dualarm_pin.engine.solve import NOT_RUN, solve_batch

    batch = solve_batch(data_of(problem), starts, options, jobs, first=points)
    feasible = (batch.status != NOT_RUN) & (batch.residual <= _FEASIBLE)
    return Ends(
        q=batch.q,
        objective=batch.objective,
        residual=batch.residual,
        feasible=feasible,
        converged=feasible & (batch.status == 0),
        iterations=batch.iterations,
        interrupted=batch.interrupted,
    )


def ensure_compiled(say: Callable[[str], None] = lambda line: None) -> float:
    """Compile or load the engine; return the seconds that compiling took, 0 from the cache.

    Args:
        say: Told one line if the engine has to be compiled.
    """
    from dualarm_pin.engine.ready import ensure_compiled as run

    report = run(say)
    return 0.0 if report.from_cache else report.seconds


def _chain(cell: Cell) -> Chain:
    from dualarm_pin.engine.chain import chain_from_model

    if cell not in _CHAINS:
        _CHAINS[cell] = chain_from_model(
            cell.model, cell.e1, cell.e2, cell.joint_map, cell.joint_offset
        )
    return _CHAINS[cell]
