"""The compiled engine as a solver: closed-form derivatives, structured interior point.

numba and the engine are loaded by the first solve, and compared with Pinocchio for every cell.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.errors import EngineError
from dualarm_pin.reference import violation
from dualarm_pin.relative import Relative
from dualarm_pin.solution import Multipliers, Solution, Solutions

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell
    from dualarm_pin.engine.solve import Options
    from dualarm_pin.engine.walks import Walked
    from dualarm_pin.problem import Problem

Array = NDArray[np.float64]
NAME = "engine"
_AGREES = 1e-9  # m or rad, times the length of the arms where that is above 1
_POSTURES = 3
_COMPARED: weakref.WeakSet[Cell] = weakref.WeakSet()


def solve(
    problem: Problem,
    start: Array,
    options: Options | None = None,
    *,
    warm: Multipliers | None = None,
    number: int = 0,
) -> Solution:
    """Minimise `problem` from `start` (k, n); see `dualarm_pin.engine.solve.solve`."""
    from dualarm_pin.engine.solve import solve as run

    compare(problem)
    return run(problem, start, options, warm=warm, number=number)


def solve_many(
    problem: Problem,
    starts: Array,
    *,
    jobs: int | None = None,
    options: Options | None = None,
    points: ArrayLike | None = None,
    neighbours: ArrayLike | None = None,
    limit: ArrayLike = np.inf,
) -> Solutions:
    """Minimise `problem` from many starts; see `dualarm_pin.engine.solve.solve_many`."""
    from dualarm_pin.engine.solve import solve_many as run

    compare(problem)
    return run(
        problem, starts, options, jobs=jobs, points=points, neighbours=neighbours, limit=limit
    )


def walk_many(
    problem: Problem,
    postures: Array,
    at: ArrayLike,
    *,
    jobs: int | None = None,
    first: ArrayLike = 0,
    points: int | None = None,
    scale: ArrayLike = 1.0,
    options: Options | None = None,
) -> Walked:
    """Walk from postures (s, n) through the path; see `dualarm_pin.engine.walks.walk_many`."""
    from dualarm_pin.engine.walks import walk_many as run

    compare(problem)
    return run(
        problem,
        postures,
        at,
        jobs=jobs,
        first=first,
        points=points,
        scale=scale,
        options=options,
    )


def compare(problem: Problem) -> None:
    """Hold the engine's kinematics against Pinocchio at random postures, once for every cell.

    Raises:
        EngineError: They differ by more than 1e-9.
    """
    from dualarm_pin.engine.solve import kinematics

    cell = problem.cell
    if cell in _COMPARED:
        return
    one = problem.window(0, 1).with_points(pose_rows=[6])
    for q in np.random.default_rng(0).uniform(problem.lower, problem.upper, (_POSTURES, cell.n)):
        relative = Relative(cell, q)
        J_r, residual = kinematics(one, q)
        size = max(1.0, float(np.abs(relative.J_r).max()))
        away = max(np.abs(J_r - relative.J_r).max(), abs(residual - violation(one, q[None])))
        if not away <= _AGREES * size:
            raise EngineError(
                f"the engine and Pinocchio differ by {away:.1e} on the cell {cell.name!r}: this is "
                "an error of this program; please report it with the cell"
            )
    _COMPARED.add(cell)


def ensure_compiled(say: Callable[[str], Any] = lambda line: None) -> float:
    """Compile or load the engine; return the seconds that compiling took, 0 from the cache.

    Args:
        say: Told one line if the engine has to be compiled.
    """
    from dualarm_pin.engine.jit.compilation import ensure_compiled as run

    report = run(say)
    return 0.0 if report.from_cache else report.seconds
