"""Objective, barrier and optimality: what the interior point minimises and how far it is.

Barrier problem: min f(q) - mu sum (log(q - l) + log(u - q)), s.t. g(q) = 0.
Lagrangian: f + y . g - z_l . (q - l) - z_u . (u - q).
"""

from __future__ import annotations

import math

from dualarm_pin.engine.chain import Floats
from dualarm_pin.engine.compiled import compiled, copy_rows, inlined
from dualarm_pin.engine.derivatives import point_derivatives, point_value
from dualarm_pin.engine.layout import Problem
from dualarm_pin.engine.workspace import Workspace

_LOG_SAFE = 1e-200
_ROUNDING = 1e-14  # m, or 2 sin(angle / 2): no posture is met more closely than this
_MULTIPLIER_SPREAD = 1e10  # z may leave mu / slack by this factor, no more


@compiled
def move_inside(problem: Problem, push: float, q: Floats) -> None:
    """Move q (k, n) at least push * range away from every bound; fixed variables to their value."""
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            margin = push * (problem.upper[k] - problem.lower[k])
            q[i, k] = min(max(q[i, k], problem.lower[k] + margin), problem.upper[k] - margin)
        for f in range(problem.fixed.shape[0]):
            q[i, problem.fixed[f]] = problem.fixed_value[f]


@compiled
def link_value(weight: float, metric: Floats, before: Floats, after: Floats) -> float:
    """Return weight (dq^T diag(metric) dq)^2."""
    square = 0.0
    for k in range(metric.shape[0]):
        d = after[k] - before[k]
        square += metric[k] * d * d
    return weight * square * square


@compiled
def objective(problem: Problem, work: Workspace, q: Floats, residual: Floats) -> float:
    """Return f(q), fill the pose residual (k, 6) and keep the frames for `all_derivatives`."""
    count = q.shape[0]
    scratch = work.scratch
    total = 0.0
    for i in range(count):
        total += point_value(problem, i, q[i], scratch, residual[i], work.error[i])
        copy_rows(scratch.w, work.axes[i])
        copy_rows(scratch.v, work.columns[i])
    for i in range(count - 1):
        total += link_value(problem.points.link_weight[i], problem.metric, q[i], q[i + 1])
    if problem.points.end_weight[0] != 0.0:
        total += link_value(problem.points.end_weight[0], problem.metric, problem.end[0], q[0])
    if problem.points.end_weight[1] != 0.0:
        total += link_value(
            problem.points.end_weight[1], problem.metric, q[count - 1], problem.end[1]
        )
    return total


@compiled
def log_barrier(problem: Problem, q: Floats) -> float:
    """Return sum log(q - l) + log(u - q), many factors to one logarithm."""
    lower, upper = problem.lower, problem.upper
    total = 0.0
    for i in range(q.shape[0]):
        product = 1.0
        for k in range(q.shape[1]):
            product *= (q[i, k] - lower[k]) * (upper[k] - q[i, k])
            if product < _LOG_SAFE:
                total += math.log(product)
                product = 1.0
        total += math.log(product)
    return total


@compiled
def violation(residual: Floats) -> float:
    """Return the 1-norm of the pose residual, rounding left out."""
    total = 0.0
    for i in range(residual.shape[0]):
        for r in range(6):
            total += max(abs(residual[i, r]) - _ROUNDING, 0.0)
    return total


@compiled
def largest(residual: Floats) -> float:
    """Return the largest absolute entry of the pose residual."""
    top = 0.0
    for i in range(residual.shape[0]):
        for r in range(6):
            top = max(top, abs(residual[i, r]))
    return top


@compiled
def start_multipliers(
    problem: Problem, q: Floats, mu: float, y: Floats, z_l: Floats, z_u: Floats
) -> None:
    """Set y = 0 and the bound multipliers to mu / slack."""
    lower, upper = problem.lower, problem.upper
    y[:] = 0.0
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            z_l[i, k] = mu / (q[i, k] - lower[k])
            z_u[i, k] = mu / (upper[k] - q[i, k])


@compiled
def keep_multipliers_near(problem: Problem, q: Floats, mu: float, z_l: Floats, z_u: Floats) -> None:
    """Keep every bound multiplier within a wide factor of mu / slack, for convergence."""
    lower, upper = problem.lower, problem.upper
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            z_l[i, k] = _near_central(z_l[i, k], q[i, k] - lower[k], mu)
            z_u[i, k] = _near_central(z_u[i, k], upper[k] - q[i, k], mu)


@compiled
def _near_central(z: float, slack: float, mu: float) -> float:
    if z * slack > _MULTIPLIER_SPREAD * mu:
        return _MULTIPLIER_SPREAD * mu / slack
    if z * slack < mu / _MULTIPLIER_SPREAD:
        return mu / (_MULTIPLIER_SPREAD * slack)
    return z


@inlined
def all_derivatives(problem: Problem, work: Workspace, q: Floats, y: Floats) -> None:
    """Fill jacobian, gradient and the Hessian's diagonal blocks at q (k, n).

    The posture must be the one that `objective` evaluated last, with its residual in `work`.
    """
    count = q.shape[0]
    for i in range(count):
        copy_rows(work.axes[i], work.scratch.w)
        copy_rows(work.columns[i], work.scratch.v)
        point_derivatives(
            problem,
            i,
            q[i],
            y[i],
            work.scratch,
            work.residual[i],
            work.error[i],
            work.jacobian[i],
            work.gradient[i],
            work.hessian[i],
        )
    _freeze(problem, work)
    for i in range(count - 1):
        weight = problem.points.link_weight[i]
        work.stiffness[i] = _link_terms(weight, problem.metric, q[i], q[i + 1], work.link[i])
        _add_link(work, i, -1.0, weight, work.stiffness[i], work.link[i], problem.metric)
        _add_link(work, i + 1, 1.0, weight, work.stiffness[i], work.link[i], problem.metric)
    last = count - 1
    room = work.link[last]
    if problem.points.end_weight[0] != 0.0:
        weight = problem.points.end_weight[0]
        stiffness = _link_terms(weight, problem.metric, problem.end[0], q[0], room)
        _add_link(work, 0, 1.0, weight, stiffness, room, problem.metric)
    if problem.points.end_weight[1] != 0.0:
        weight = problem.points.end_weight[1]
        stiffness = _link_terms(weight, problem.metric, q[last], problem.end[1], room)
        _add_link(work, last, -1.0, weight, stiffness, room, problem.metric)
    for i in range(count):
        for k in problem.fixed:
            work.gradient[i, k] = 0.0


@compiled
def _freeze(problem: Problem, work: Workspace) -> None:
    """Cut fixed variables off, so that no step ever moves them."""
    for i in range(work.gradient.shape[0]):
        for k in problem.fixed:
            for r in range(6):
                work.jacobian[i, r, k] = 0.0
            for c in range(work.hessian.shape[1]):
                work.hessian[i, k, c] = 0.0
                work.hessian[i, c, k] = 0.0
            work.hessian[i, k, k] = 1.0


@compiled
def _link_terms(
    weight: float, metric: Floats, before: Floats, after: Floats, link: Floats
) -> float:
    """Fill link = diag(metric) dq and return the stiffness 4 weight dq^T diag(metric) dq."""
    square = 0.0
    for k in range(metric.shape[0]):
        d = after[k] - before[k]
        link[k] = metric[k] * d
        square += link[k] * d
    return 4.0 * weight * square


@compiled
def _add_link(
    work: Workspace,
    i: int,
    sign: float,
    weight: float,
    stiffness: float,
    link: Floats,
    metric: Floats,
) -> None:
    """Add a link to point i: stiffness m dq, and stiffness diag(m) + 8 w (m dq)(m dq)^T."""
    gradient, hessian = work.gradient[i], work.hessian[i]
    for k in range(metric.shape[0]):
        gradient[k] += sign * stiffness * link[k]
        line, bend = hessian[k], 8.0 * weight * link[k]
        line[k] += stiffness * metric[k]
        for c in range(metric.shape[0]):
            line[c] += bend * link[c]


@compiled
def optimality(
    problem: Problem, work: Workspace, q: Floats, y: Floats, z_l: Floats, z_u: Floats
) -> tuple[float, float, float, float, float]:
    """Return (stationarity, residual, largest and smallest z * slack, scale of the multipliers).

    Stationarity is max |grad f + jacobian^T y - z_l + z_u|; the scale is at least 1 and grows
    with the mean multiplier over 100.
    """
    count, n = q.shape
    gradient, jacobian, residual = work.gradient, work.jacobian, work.residual
    lower, upper, rows = problem.lower, problem.upper, problem.points.rows
    dual, primal, total = 0.0, 0.0, 0.0
    high, low = -math.inf, math.inf
    for i in range(count):
        for k in range(n):
            rest = gradient[i, k] - z_l[i, k] + z_u[i, k]
            for r in range(rows[i]):
                rest += jacobian[i, r, k] * y[i, r]
            dual = max(dual, abs(rest))
            below = z_l[i, k] * (q[i, k] - lower[k])
            above = z_u[i, k] * (upper[k] - q[i, k])
            high = max(high, below, above)
            low = min(low, below, above)
            total += z_l[i, k] + z_u[i, k]
        for r in range(rows[i]):
            primal = max(primal, abs(residual[i, r]))
            total += abs(y[i, r])
    scale = max(100.0, total / (count * (2 * n + 6))) / 100.0
    return dual, primal, high, low, scale


@compiled
def add_barrier(
    problem: Problem, work: Workspace, q: Floats, z_l: Floats, z_u: Floats, mu: float
) -> None:
    """Fill the barrier gradient and add z / slack to the Hessian's diagonal."""
    lower, upper = problem.lower, problem.upper
    gradient, slope, hessian = work.gradient, work.barrier_gradient, work.hessian
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            below = 1.0 / (q[i, k] - lower[k])
            above = 1.0 / (upper[k] - q[i, k])
            slope[i, k] = gradient[i, k] - mu * below + mu * above
            hessian[i, k, k] += z_l[i, k] * below + z_u[i, k] * above
        for k in problem.fixed:
            slope[i, k] = 0.0
