"""Drake's SNOPT as a column of the benchmark, with the compiled derivatives of the engine."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from dualarm_pin.engine.evaluation import evaluate
from dualarm_pin.errors import MissingExtraError
from dualarm_pin.problem import Problem
from dualarm_pin.reference import violation
from dualarm_pin.solution import Solution
from dualarm_pin.tolerance import TOLERANCE


def snopt_solver(problem: Problem) -> Callable[[Problem, np.ndarray], Solution]:
    """Return the solver; values and gradients are the engine's, called from Python.

    Raises:
        MissingExtraError: Drake is not installed.
    """
    try:
        from pydrake.autodiffutils import ExtractGradient, ExtractValue, InitializeAutoDiff
        from pydrake.solvers import MathematicalProgram, SnoptSolver
    except ImportError as error:
        raise MissingExtraError("this needs Drake: pip install 'dualarm-pin[drake]'") from error

    def with_slope(x: np.ndarray, value: np.ndarray, slope: np.ndarray) -> Any:
        return InitializeAutoDiff(value, slope @ ExtractGradient(x))

    alone = [problem.window(i, 1) for i in range(problem.k)]

    def cost(x: np.ndarray) -> Any:
        at = ExtractValue(x).reshape(problem.k, problem.n)
        found = evaluate(problem, at)
        return with_slope(x, np.array([found.objective]), found.gradient.reshape(1, -1))[0, 0]

    def rows(i: int) -> Callable[[np.ndarray], Any]:
        def row(x: np.ndarray) -> Any:
            found = evaluate(alone[i], ExtractValue(x).reshape(1, -1))
            count = int(problem.row_count[i])
            value, slope = found.residual[0, :count], found.jacobian[0, :count]
            return with_slope(x, value, slope).ravel()

        return row

    programme = MathematicalProgram()
    x = programme.NewContinuousVariables(problem.k, problem.n)
    programme.AddCost(cost, x.ravel())
    for i in range(problem.k):
        zero = np.zeros(int(problem.row_count[i]))
        programme.AddConstraint(rows(i), zero, zero, x[i])
    programme.AddBoundingBoxConstraint(
        np.tile(problem.lower, problem.k), np.tile(problem.upper, problem.k), x.ravel()
    )
    solver = SnoptSolver()
    programme.SetSolverOption(solver.solver_id(), "Major iterations limit", 1000)

    def solve(_: Problem, start: np.ndarray) -> Solution:
        programme.SetInitialGuess(x, start)
        begun = time.perf_counter()
        answer = solver.Solve(programme, programme.initial_guess())
        wall = time.perf_counter() - begun
        q = np.clip(answer.GetSolution(x).reshape(start.shape), problem.lower, problem.upper)
        residual = violation(problem, q)
        return Solution(
            q=q,
            objective=problem.objective(q),
            residual=residual,
            feasible=residual <= TOLERANCE.position,  # SNOPT's own tolerance is 1e-6
            converged=bool(answer.is_success()),
            message=str(answer.get_solution_result()),
            wall_s=wall,
        )

    return solve
