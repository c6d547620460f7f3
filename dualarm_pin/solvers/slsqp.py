"""NLopt's SLSQP with analytic gradients: the solver of the paper's two-stage method.

NLopt has three habits to guard against: it raises on round-off although it holds a good point,
it reuses the buffers it hands to callbacks, and its last point need not be its best. So the best
feasible point is kept here, as a copy, and judged here.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import nlopt
import numpy as np
from numpy.typing import NDArray

from dualarm_pin.arrays import Array
from dualarm_pin.problem import Problem
from dualarm_pin.reference import coupling, equalities, inequalities, point_gradient, violation
from dualarm_pin.relative import Relative
from dualarm_pin.solution import Solution
from dualarm_pin.solvers.projection import project
from dualarm_pin.tolerance import TOLERANCE

_LAST_STEPS = 20  # from near the path a few are enough; rounding may keep the rest from ending
_REASONS = {
    nlopt.SUCCESS: "converged",
    nlopt.STOPVAL_REACHED: "converged",
    nlopt.FTOL_REACHED: "the objective stopped changing",
    nlopt.XTOL_REACHED: "the joints stopped changing",
    nlopt.MAXEVAL_REACHED: "evaluation limit",
}


@dataclass(frozen=True)
class SlsqpOptions:
    """Stop criteria of one start. No clock: the same end on any machine and for any load.

    Attributes:
        ftol_rel: Relative change of the objective.
        xtol_rel: Relative change of the joints.
        evaluations: Most evaluations.
    """

    ftol_rel: float = 1e-8
    xtol_rel: float = 1e-8
    evaluations: int = 200


def solve(
    problem: Problem, start: Array, options: SlsqpOptions | None = None, *, number: int = 0
) -> Solution:
    """Minimise `problem` from `start` (k, n).

    The start is put onto the path first; the point returned is put onto it once more, so that
    feasibility is a matter of `TOLERANCE.exact`, not of the solver's tolerance.
    """
    options = options or SlsqpOptions()
    begun = time.perf_counter()
    first, _ = project(problem, start, TOLERANCE.position)
    evaluation = _Evaluation(problem)
    optimiser = nlopt.opt(nlopt.LD_SLSQP, first.size)
    optimiser.set_min_objective(evaluation.objective)
    equal, unequal = (
        np.full(rows.m, TOLERANCE.nlopt_rows) for rows in (evaluation.equal, evaluation.unequal)
    )
    optimiser.add_equality_mconstraint(evaluation.equalities, equal)
    if len(unequal):
        optimiser.add_inequality_mconstraint(evaluation.below, unequal)
    optimiser.set_lower_bounds(np.tile(problem.lower, problem.k))
    optimiser.set_upper_bounds(np.tile(problem.upper, problem.k))
    optimiser.set_ftol_rel(options.ftol_rel)
    optimiser.set_xtol_rel(options.xtol_rel)
    optimiser.set_maxeval(options.evaluations)
    try:
        optimiser.optimize(first.ravel())
        code = optimiser.last_optimize_result()
        reason, converged = _REASONS.get(code, f"NLopt code {code}"), code in (1, 2, 3, 4)
    except nlopt.RoundoffLimited:
        reason, converged = "limited by round-off", True
    except (nlopt.ForcedStop, nlopt.runtime_error, RuntimeError, ValueError) as error:
        if evaluation.interrupted is not None:
            raise evaluation.interrupted from None
        reason, converged = f"NLopt failed: {error}", False
    best = first if evaluation.best is None else evaluation.best
    q, _ = project(problem, best, TOLERANCE.exact, _LAST_STEPS)
    residual = violation(problem, q)
    inside = bool(np.all((q >= problem.lower) & (q <= problem.upper)))
    return Solution(
        q=q,
        objective=problem.objective(q),
        residual=residual,
        feasible=inside and residual <= TOLERANCE.feasible,
        converged=converged,
        message=reason,
        start=number,
        wall_s=time.perf_counter() - begun,
        iterations=evaluation.count,
    )


class _Evaluation:
    """Values and gradients at one point at a time, shared by objective and constraints."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.count = 0
        self.best: Array | None = None
        self.interrupted: BaseException | None = None
        self._best_merit = np.inf
        self._at: Array | None = None
        self._gradient = np.zeros((problem.k, problem.n))
        self.equal = _Rows(problem.row_count, problem.n)
        self.unequal = _Rows(problem.inequalities.size, problem.n)
        self._value = 0.0

    def objective(self, x: Array, gradient: Array) -> float:
        self._evaluate(x)
        if gradient.size:
            gradient[:] = self._gradient.ravel()
        return self._value

    def equalities(self, result: Array, x: Array, gradient: Array) -> None:
        self._evaluate(x)
        result[:] = self.equal.values
        if gradient.size:
            gradient[:] = self.equal.jacobian

    def below(self, result: Array, x: Array, gradient: Array) -> None:
        """Give -g, which NLopt keeps at 0 or less."""
        self._evaluate(x)
        result[:] = -self.unequal.values
        if gradient.size:
            gradient[:] = -self.unequal.jacobian

    def _evaluate(self, x: Array) -> None:
        if self._at is not None and np.array_equal(self._at, x):
            return
        try:
            self._refresh(x.copy())
        except BaseException as error:  # NLopt swallows it, so it is kept for the caller
            self.interrupted = error
            raise

    def _refresh(self, x: Array) -> None:
        problem = self.problem
        q = x.reshape(problem.k, problem.n)
        value, gradient = coupling(problem, q)
        for i, q_i in enumerate(q):
            relative = Relative(problem.cell, q_i)
            c, dc = point_gradient(problem, i, relative)
            value += c
            gradient[i] += dc
            self.equal.put(i, *equalities(problem, i, relative))
            self.unequal.put(i, *inequalities(problem, i, relative))
        self._at, self._value, self._gradient = x, value, gradient
        self.count += 1
        below = float(np.max(-self.unequal.values, initial=0.0))
        worst = max(float(np.max(np.abs(self.equal.values))), below)
        # So near is near enough: the projection after the solve does the rest.
        merit = value if worst < TOLERANCE.near_path else np.inf
        if merit < self._best_merit:
            self._best_merit, self.best = merit, q.copy()


class _Rows:
    """Rows of all points one after another, and their dense Jacobian."""

    def __init__(self, count: NDArray[np.int64], n: int) -> None:
        self._begin = np.concatenate([[0], np.cumsum(count)])
        self._n = n
        self.m = int(self._begin[-1])
        self.values = np.zeros(self.m)
        self.jacobian = np.zeros((self.m, len(count) * n))

    def put(self, i: int, values: Array, jacobian: Array) -> None:
        """Take the rows of point i."""
        rows = slice(self._begin[i], self._begin[i + 1])
        self.values[rows] = values
        self.jacobian[rows, i * self._n : (i + 1) * self._n] = jacobian
