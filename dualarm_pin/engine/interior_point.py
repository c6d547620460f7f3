"""The structured primal-dual interior point: one solve of one problem from one start."""

from __future__ import annotations

import math
from typing import NamedTuple

from dualarm_pin.engine.barrier import (
    add_barrier,
    all_derivatives,
    keep_multipliers_near,
    largest,
    move_inside,
    optimality,
    start_multipliers,
)
from dualarm_pin.engine.chain import Floats
from dualarm_pin.engine.compiled import compiled, copy_rows, inlined
from dualarm_pin.engine.layout import Problem
from dualarm_pin.engine.line_search import Limits, merit_of, search
from dualarm_pin.engine.newton import (
    factor_convex,
    newton_multipliers,
    newton_step,
    reduce_system,
)
from dualarm_pin.engine.restoration import restore
from dualarm_pin.engine.workspace import Workspace

CONVERGED, ITERATION_LIMIT, INFEASIBLE, STALLED, NOT_RUN = 0, 1, 2, 3, 4

_MU_FACTOR, _MU_POWER, _MU_ERROR = 0.2, 1.5, 10.0
_TAU_MIN = 0.99
_LEAST_SLACK = 1e-14  # of the range
_RESTORATIONS, _RESTORE_STEPS, _RESTORE_TOLERANCE, _RESTORE_MU = 5, 50, 1e-9, 1e-3


class Settings(NamedTuple):
    """Numbers that steer one solve, as the compiled code takes them.

    Attributes:
        tolerance: On the scaled KKT error.
        iterations: Cap.
        mu: First barrier parameter.
        push: Share of the range to which the start is moved away from the bounds.
    """

    tolerance: float
    iterations: int
    mu: float
    push: float


class Report(NamedTuple):
    """How a solve ended; everything is evaluated at the point left in q.

    Attributes:
        status: CONVERGED, ITERATION_LIMIT, INFEASIBLE or STALLED.
        iterations: Newton steps and restorations.
        objective: f.
        residual: Largest absolute entry of the pose residual.
        stationarity: Largest absolute entry of the Lagrangian's gradient.
        mu: Last barrier parameter.
    """

    status: int
    iterations: int
    objective: float
    residual: float
    stationarity: float
    mu: float


@inlined
def solve_one(
    problem: Problem,
    settings: Settings,
    work: Workspace,
    keep_multipliers: bool,
    q: Floats,
    y: Floats,
    z_l: Floats,
    z_u: Floats,
) -> Report:
    """Solve from q (k, n) in place.

    Args:
        problem: The problem of k points.
        settings: Tolerance, caps, barrier.
        work: Room for k points.
        keep_multipliers: Start from the multipliers given (a warm start).
        q: Start, overwritten by the last iterate.
        y: (k, 6) multipliers of the pose rows.
        z_l: (k, n) multipliers of the lower bounds.
        z_u: (k, n) multipliers of the upper bounds.
    """
    mu, floor = settings.mu, 0.1 * settings.tolerance
    move_inside(problem, settings.push, q)
    if not keep_multipliers:
        start_multipliers(problem, q, mu, y, z_l, z_u)
    keep_multipliers_near(problem, q, mu, z_l, z_u)
    now = merit_of(problem, work, q, work.residual)
    limits = Limits(1e-4 * max(1.0, now.violation), 1e4 * max(1.0, now.violation))
    status, iterations, restorations, filtered, shift = ITERATION_LIMIT, 0, 0, 0, 0.0
    dual = math.inf
    while True:
        all_derivatives(problem, work, q, y)
        dual, primal, high, low, scale = optimality(problem, work, q, y, z_l, z_u)
        if max(dual / scale, primal, high / scale) < settings.tolerance:
            status = CONVERGED
            break
        if iterations >= settings.iterations:
            break
        iterations += 1
        smaller = _next_mu(mu, floor, dual, primal, high, low, scale)
        if smaller < mu:
            mu, filtered = smaller, 0
        tau = max(_TAU_MIN, 1.0 - mu)

        add_barrier(problem, work, q, z_l, z_u, mu)
        reduce_system(problem, work)
        used = factor_convex(work, shift)
        length = 0.0
        if used >= 0.0:
            shift = used if used > 0.0 else shift
            copy_rows(work.residual, work.target)
            newton_step(problem, work, work.step)
            newton_multipliers(problem, work, work.step)
            length, now, filtered = search(problem, work, q, mu, tau, now, limits, filtered)
        if length > 0.0:
            _bound_multiplier_step(problem, work, q, z_l, z_u, mu, tau)
            _accept(problem, work, q, y, length)
            keep_multipliers_near(problem, q, mu, z_l, z_u)
            continue
        restorations += 1
        if restorations > _RESTORATIONS:
            status = STALLED
            break
        restore(problem, work, q, _RESTORE_STEPS, _RESTORE_TOLERANCE)
        mu, filtered = max(mu, _RESTORE_MU), 0
        start_multipliers(problem, q, mu, y, z_l, z_u)
        now = merit_of(problem, work, q, work.residual)
    residual = largest(work.residual)
    if status == STALLED and residual > max(10.0 * settings.tolerance, 1e-6):
        status = INFEASIBLE
    return Report(status, iterations, now.objective, residual, dual, mu)


@compiled
def _next_mu(
    mu: float, floor: float, dual: float, primal: float, high: float, low: float, scale: float
) -> float:
    """Lower mu while the barrier problem is solved well enough for it."""
    while mu > floor:
        complementarity = max(high - mu, mu - low)
        if max(dual / scale, primal, complementarity / scale) > _MU_ERROR * mu:
            break
        mu = max(floor, min(_MU_FACTOR * mu, mu**_MU_POWER))
    return mu


@compiled
def _bound_multiplier_step(
    problem: Problem,
    work: Workspace,
    q: Floats,
    z_l: Floats,
    z_u: Floats,
    mu: float,
    tau: float,
) -> None:
    """Move z by dz = mu / slack - z -+ z / slack dq, as far as all stay positive."""
    count, n = q.shape
    length = 1.0
    lower, upper, step = problem.lower, problem.upper, work.step
    lower_step, upper_step = work.lower_step, work.upper_step
    for i in range(count):
        for k in range(n):
            d = step[i, k]
            dz_l = (mu - z_l[i, k] * d) / (q[i, k] - lower[k]) - z_l[i, k]
            dz_u = (mu + z_u[i, k] * d) / (upper[k] - q[i, k]) - z_u[i, k]
            if length * dz_l < -tau * z_l[i, k]:
                length = -tau * z_l[i, k] / dz_l
            if length * dz_u < -tau * z_u[i, k]:
                length = -tau * z_u[i, k] / dz_u
            lower_step[i, k], upper_step[i, k] = dz_l, dz_u
    for i in range(count):
        for k in range(n):
            z_l[i, k] += length * lower_step[i, k]
            z_u[i, k] += length * upper_step[i, k]


@compiled
def _accept(problem: Problem, work: Workspace, q: Floats, y: Floats, length: float) -> None:
    """Take the trial and its residual, and the multipliers of the pose rows as far.

    A slack below rounding would be lost in q - bound, so it is kept just above.
    """
    lower, upper, trial, new_y = problem.lower, problem.upper, work.trial, work.new_y
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            least = _LEAST_SLACK * (upper[k] - lower[k])
            inside = max(trial[i, k], lower[k] + least)
            q[i, k] = min(inside, upper[k] - least)
    copy_rows(work.trial_residual, work.residual)
    for i in range(q.shape[0]):
        for r in range(6):
            y[i, r] += length * (new_y[i, r] - y[i, r])
