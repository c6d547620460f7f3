"""Barrier and optimality: what keeps an iterate inside, and how far it is from a minimum.

Barrier problem, with slacks s of the inequality rows g:

    min f(q) - mu sum (log(q - l) + log(u - q)) - mu sum log s,   s.t. c(q) = 0, g(q) - s = 0

Lagrangian: f + y . c - push . (g - s) - z_l . (q - l) - z_u . (u - q) - push . s. The slacks are
eliminated from the Newton system: with sigma = push / s a row adds sigma J^T J to the Hessian and
J^T (sigma (g - s) - mu / s) to the gradient.
"""

from __future__ import annotations

import math

from dualarm_pin.chain import Floats
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Iterate, Workspace
from dualarm_pin.problem import Bounds, Problem

_LOG_SAFE = 1e-200  # a product of slacks below this is turned into a logarithm before it is lost
_ROUNDING = 1e-14  # m, or 2 sin(angle / 2): no row is met more closely than this
_MULTIPLIER_SPREAD = 1e10  # kappa_Sigma of Waechter and Biegler: z may leave mu / slack by this
_LEAST_MULTIPLIER_SCALE = 100.0  # s_max of Waechter and Biegler
LEAST_SLACK = 1e-14  # of the range


@compiled
def move_inside(bounds: Bounds, push: float, q: Floats) -> None:
    """Move q (k, n) at least push * range away from every bound; fixed variables to their value.

    A fixed variable without a value (nan) stays where the start has it.
    """
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            margin = push * (bounds.upper[k] - bounds.lower[k])
            q[i, k] = min(max(q[i, k], bounds.lower[k] + margin), bounds.upper[k] - margin)
        for f in range(bounds.fixed.shape[0]):
            if not math.isnan(bounds.fixed_value[f]):
                q[i, bounds.fixed[f]] = bounds.fixed_value[f]


@compiled
def log_barrier(problem: Problem, q: Floats, slack: Floats) -> float:
    """Return the sum of the logarithms of all slacks, many factors to one logarithm."""
    lower, upper = problem.bounds.lower, problem.bounds.upper
    total = 0.0
    for i in range(q.shape[0]):
        product = 1.0
        for k in range(q.shape[1]):
            product *= (q[i, k] - lower[k]) * (upper[k] - q[i, k])
            if product < _LOG_SAFE:
                total += math.log(product)
                product = 1.0
        for r in range(problem.inequalities.size[i]):
            product *= slack[i, r]
            if product < _LOG_SAFE:
                total += math.log(product)
                product = 1.0
        total += math.log(product)
    return total


@compiled
def violation(problem: Problem, residual: Floats, gap: Floats, slack: Floats) -> float:
    """Return the 1-norm of the residual of all rows, rounding left out."""
    total = 0.0
    for i in range(residual.shape[0]):
        for r in range(residual.shape[1]):
            total += max(abs(residual[i, r]) - _ROUNDING, 0.0)
        for r in range(problem.inequalities.size[i]):
            total += max(abs(gap[i, r] - slack[i, r]) - _ROUNDING, 0.0)
    return total


@compiled
def largest(problem: Problem, residual: Floats, gap: Floats) -> float:
    """Return how far the worst row is from holding: |c|, or -g where g is below zero."""
    top = 0.0
    for i in range(residual.shape[0]):
        for r in range(residual.shape[1]):
            top = max(top, abs(residual[i, r]))
        for r in range(problem.inequalities.size[i]):
            top = max(top, -gap[i, r])
    return top


@compiled
def start_slacks(problem: Problem, gap: Floats, least: float, slack: Floats) -> None:
    """Set s = g where that is inside, else to `least` (in the unit of the row)."""
    for i in range(gap.shape[0]):
        for r in range(problem.inequalities.size[i]):
            slack[i, r] = max(gap[i, r], least)


@compiled
def start_multipliers(problem: Problem, mu: float, at: Iterate) -> None:
    """Set y = 0 and every other multiplier to mu / slack."""
    lower, upper = problem.bounds.lower, problem.bounds.upper
    at.y[:] = 0.0
    for i in range(at.q.shape[0]):
        for k in range(at.q.shape[1]):
            at.lower[i, k] = mu / (at.q[i, k] - lower[k])
            at.upper[i, k] = mu / (upper[k] - at.q[i, k])
        for r in range(problem.inequalities.size[i]):
            at.push[i, r] = mu / at.slack[i, r]


@compiled
def keep_multipliers_near(problem: Problem, mu: float, at: Iterate) -> None:
    """Keep every multiplier of a slack within a wide factor of mu / slack, for convergence."""
    lower, upper = problem.bounds.lower, problem.bounds.upper
    for i in range(at.q.shape[0]):
        for k in range(at.q.shape[1]):
            at.lower[i, k] = _near_central(at.lower[i, k], at.q[i, k] - lower[k], mu)
            at.upper[i, k] = _near_central(at.upper[i, k], upper[k] - at.q[i, k], mu)
        for r in range(problem.inequalities.size[i]):
            at.push[i, r] = _near_central(at.push[i, r], at.slack[i, r], mu)


@compiled
def _near_central(z: float, slack: float, mu: float) -> float:
    if z * slack > _MULTIPLIER_SPREAD * mu:
        return _MULTIPLIER_SPREAD * mu / slack
    if z * slack < mu / _MULTIPLIER_SPREAD:
        return mu / (_MULTIPLIER_SPREAD * slack)
    return z


@compiled
def optimality(
    problem: Problem, work: Workspace, at: Iterate
) -> tuple[float, float, float, float, float]:
    """Return (stationarity, residual, largest and smallest z * slack, scale of the multipliers).

    Stationarity is max |grad f + J_c^T y - J_g^T push - z_l + z_u|; the scale is at least 1 and
    grows with the mean multiplier over 100.
    """
    count, n = at.q.shape
    lower, upper = problem.bounds.lower, problem.bounds.upper
    dual, primal, total = 0.0, 0.0, 0.0
    high, low = -math.inf, math.inf
    rows = 0
    for i in range(count):
        equal, unequal = problem.row_count[i], problem.inequalities.size[i]
        jacobian, slopes = work.jacobian[i], work.row_jacobian[i]
        rows += unequal
        for k in range(n):
            rest = work.gradient[i, k] - at.lower[i, k] + at.upper[i, k]
            for r in range(equal):
                rest += jacobian[r, k] * at.y[i, r]
            for r in range(unequal):
                rest -= slopes[r, k] * at.push[i, r]
            dual = max(dual, abs(rest))
            below = at.lower[i, k] * (at.q[i, k] - lower[k])
            above = at.upper[i, k] * (upper[k] - at.q[i, k])
            high = max(high, below, above)
            low = min(low, below, above)
            total += at.lower[i, k] + at.upper[i, k]
        for r in range(equal):
            primal = max(primal, abs(work.residual[i, r]))
            total += abs(at.y[i, r])
        for r in range(unequal):
            primal = max(primal, abs(work.gap[i, r] - at.slack[i, r]))
            pressed = at.push[i, r] * at.slack[i, r]
            high = max(high, pressed)
            low = min(low, pressed)
            total += at.push[i, r]
    mean = total / (count * (2 * n + 6) + rows)
    scale = max(_LEAST_MULTIPLIER_SCALE, mean) / _LEAST_MULTIPLIER_SCALE
    return dual, primal, high, low, scale


@compiled
def add_barrier(problem: Problem, work: Workspace, at: Iterate, mu: float) -> None:
    """Fill the barrier gradient and add z / slack to the Hessian, of bounds and rows."""
    lower, upper = problem.bounds.lower, problem.bounds.upper
    gradient, slope, hessian = work.gradient, work.barrier_gradient, work.hessian
    for i in range(at.q.shape[0]):
        for k in range(at.q.shape[1]):
            below = 1.0 / (at.q[i, k] - lower[k])
            above = 1.0 / (upper[k] - at.q[i, k])
            slope[i, k] = gradient[i, k] - mu * below + mu * above
            hessian[i, k, k] += at.lower[i, k] * below + at.upper[i, k] * above
        for k in problem.bounds.fixed:
            slope[i, k] = 0.0
        for r in range(problem.inequalities.size[i]):
            J, sigma = work.row_jacobian[i, r], at.push[i, r] / at.slack[i, r]
            for k in range(J.shape[0]):
                pull = sigma * J[k]
                for c in range(J.shape[0]):
                    hessian[i, k, c] += pull * J[c]


@compiled
def add_pull(problem: Problem, work: Workspace, at: Iterate, mu: float) -> None:
    """Fill `pulled`: the barrier gradient plus J^T (sigma target_gap - mu / s) of the rows."""
    for i in range(at.q.shape[0]):
        for k in range(at.q.shape[1]):
            work.pulled[i, k] = work.barrier_gradient[i, k]
        for r in range(problem.inequalities.size[i]):
            J, s = work.row_jacobian[i, r], at.slack[i, r]
            force = (at.push[i, r] * work.target_gap[i, r] - mu) / s
            for k in range(J.shape[0]):
                work.pulled[i, k] += force * J[k]


@compiled
def slack_steps(problem: Problem, work: Workspace, step: Floats) -> None:
    """Fill the step of the slacks: ds = J dq + target_gap."""
    for i in range(step.shape[0]):
        for r in range(problem.inequalities.size[i]):
            J, ds = work.row_jacobian[i, r], work.target_gap[i, r]
            for k in range(J.shape[0]):
                ds += J[k] * step[i, k]
            work.slack_step[i, r] = ds
