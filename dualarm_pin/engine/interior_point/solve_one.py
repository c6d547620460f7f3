"""The structured primal-dual interior point: one solve of one problem from one start."""

from __future__ import annotations

import math
from typing import NamedTuple

from dualarm_pin.engine.interior_point.barrier import (
    LEAST_SLACK,
    add_barrier,
    add_pull,
    keep_multipliers_near,
    largest,
    move_inside,
    optimality,
    slack_steps,
    start_multipliers,
    start_slacks,
)
from dualarm_pin.engine.interior_point.line_search import Limits, Merit, merit_of, remember, search
from dualarm_pin.engine.interior_point.system import (
    derivatives,
    factor,
    new_multipliers,
    newton,
    restoration,
)
from dualarm_pin.engine.jit.compiled import compiled, copy_rows, inlined
from dualarm_pin.engine.workspace import Iterate, Workspace
from dualarm_pin.problem import Problem

CONVERGED, ITERATION_LIMIT, INFEASIBLE, STALLED, NOT_RUN, DROPPED = 0, 1, 2, 3, 4, 5

# kappa_mu, theta_mu, kappa_epsilon and tau_min of Waechter and Biegler (2006), table 3
_MU_FACTOR, _MU_POWER, _MU_ERROR = 0.2, 1.5, 10.0
_TAU_MIN = 0.99
# A restoration starts its barrier problem anew; five were never passed by a start that converged.
_RESTORATIONS, _RESTORE_STEPS, _RESTORE_TOLERANCE, _RESTORE_MU = 5, 50, 1e-9, 1e-3
_FEASIBLE = 1e-6  # m, 2 sin(angle / 2) or unit of a row: a residual below it is on the path
_ROUGH = 1e-5  # a solve to a larger tolerance says nothing of what can be reached: not looked into
# A start is dropped if falling on as fast as in the last _LOOK iterations would not bring it below
# its limit within _PATIENCE times as many: halves the price of starts, and loses few slow ones.
_LOOK, _PATIENCE = 4, 8.0
_SADDLE_SHIFT = 1e-6  # a larger shift was needed because some direction leads down


class Settings(NamedTuple):
    """Numbers that steer one solve, as the compiled code takes them.

    Attributes:
        tolerance: On the scaled KKT error.
        iterations: Cap.
        mu: First barrier parameter.
        push: Share of the range to which the start is moved away from the bounds.
        limit: Dropped once it is clear that it will not come below this objective.
    """

    tolerance: float
    iterations: int
    mu: float
    push: float
    limit: float


class Report(NamedTuple):
    """How a solve ended; everything is evaluated at the iterate left in `work.at`.

    Attributes:
        status: CONVERGED, ITERATION_LIMIT, INFEASIBLE, STALLED or DROPPED.
        iterations: Newton steps and restorations.
        objective: f.
        residual: Largest violation of a row.
        stationarity: Largest absolute entry of the Lagrangian's gradient.
        mu: Last barrier parameter.
        saddle: Whether the last Hessian had a direction that leads down.
    """

    status: int
    iterations: int
    objective: float
    residual: float
    stationarity: float
    mu: float
    saddle: bool


@inlined
def solve_one(  # noqa: PLR0915  one loop, in the order of algorithm A of Waechter and Biegler
    problem: Problem, settings: Settings, work: Workspace, keep_multipliers: bool
) -> Report:
    """Solve from `work.at` in place.

    Args:
        problem: The problem of k points.
        settings: Tolerance, caps, barrier.
        work: Room for k points; `work.at.q` is the start.
        keep_multipliers: Start from the multipliers in `work.at` (a warm start).
    """
    mu, floor = settings.mu, 0.1 * settings.tolerance
    at, best = work.at, work.best
    _begin(problem, settings, work, keep_multipliers)
    now = merit_of(problem, work, at.q, work.residual, work.gap, at.slack)
    best_merit = Merit(math.inf, 0.0, math.inf)
    limits = Limits(1e-4 * max(1.0, now.violation), 1e4 * max(1.0, now.violation))
    status, iterations, restorations, filtered = ITERATION_LIMIT, 0, 0, 0
    shift, used, dual, left, looked = 0.0, 0.0, math.inf, 0.0, math.inf
    while True:
        derivatives(problem, work, at)
        dual, primal, high, low, scale = optimality(problem, work, at)
        if max(dual / scale, primal, high / scale) < settings.tolerance:
            status = CONVERGED
            break
        if _is_better(now, best_merit):
            best_merit = now
            copy_iterate(at, best)
        if iterations >= settings.iterations:
            break
        if iterations % _LOOK == 0:
            fall, looked = looked - now.objective, now.objective
            if iterations > _LOOK and looked - _PATIENCE * max(fall, 0.0) > settings.limit:
                status = DROPPED
                break
        iterations += 1
        smaller = _next_mu(mu, floor, dual, primal, high, low, scale)
        if smaller < mu:
            mu, filtered = smaller, 0
        tau = max(_TAU_MIN, 1.0 - mu)

        add_barrier(problem, work, at, mu)
        used = factor(problem, work, shift)
        length = 0.0
        if used >= 0.0:
            shift = used if used > 0.0 else shift
            _newton(problem, work, at, mu)
            length, now, filtered = search(problem, work, at, mu, tau, now, limits, filtered)
        if length > 0.0:
            _multiplier_step(problem, work, at, mu, tau)
            _accept(problem, work, at, length)
            keep_multipliers_near(problem, mu, at)
            continue
        restorations += 1
        if restorations > _RESTORATIONS:
            status = STALLED
            break
        if mu >= _RESTORE_MU:
            filtered = remember(work.filter, filtered, mu, now)
        else:
            mu, filtered = _RESTORE_MU, 0  # another barrier problem: the pairs say nothing of it
        left, now = _begin_again(problem, settings, work, mu)
        if left > _FEASIBLE:
            status = INFEASIBLE  # some point comes no nearer to its rows by itself
            break
    if status != CONVERGED and _is_better(best_merit, now):
        copy_iterate(best, at)
        now = merit_of(problem, work, at.q, work.residual, work.gap, at.slack)
        derivatives(problem, work, at)
        dual = optimality(problem, work, at)[0]
    residual = largest(problem, work.residual, work.gap)
    if status == ITERATION_LIMIT and residual > _FEASIBLE and settings.tolerance < _ROUGH:
        status = _reachable(problem, work, at)
    return Report(status, iterations, now.objective, residual, dual, mu, used > _SADDLE_SHIFT)


@compiled
def _begin_again(
    problem: Problem, settings: Settings, work: Workspace, mu: float
) -> tuple[float, Merit]:
    """Bring every point back to its rows and set slacks and multipliers; return what is left."""
    at = work.at
    left = restoration(problem, work, at.q, _RESTORE_STEPS, _RESTORE_TOLERANCE)
    merit_of(problem, work, at.q, work.residual, work.gap, at.slack)
    start_slacks(problem, work.gap, settings.push, at.slack)
    start_multipliers(problem, mu, at)
    return left, merit_of(problem, work, at.q, work.residual, work.gap, at.slack)


@compiled
def _begin(problem: Problem, settings: Settings, work: Workspace, keep_multipliers: bool) -> None:
    """Move the start inside its bounds and set slacks and multipliers."""
    at, mu = work.at, settings.mu
    move_inside(problem.bounds, settings.push, at.q)
    at.slack[:] = 0.0
    merit_of(problem, work, at.q, work.residual, work.gap, at.slack)
    start_slacks(problem, work.gap, settings.push, at.slack)
    if not keep_multipliers:
        start_multipliers(problem, mu, at)
    keep_multipliers_near(problem, mu, at)


@compiled
def copy_iterate(source: Iterate, target: Iterate) -> None:
    """Copy an iterate."""
    copy_rows(source.q, target.q)
    copy_rows(source.y, target.y)
    copy_rows(source.lower, target.lower)
    copy_rows(source.upper, target.upper)
    copy_rows(source.slack, target.slack)
    copy_rows(source.push, target.push)


@compiled
def _is_better(one: Merit, other: Merit) -> bool:
    """Tell whether one point is to be returned rather than the other: on the path, then lower."""
    if one.violation <= _FEASIBLE and other.violation <= _FEASIBLE:
        return one.objective < other.objective
    return one.violation < other.violation


@compiled
def _newton(problem: Problem, work: Workspace, at: Iterate, mu: float) -> None:
    """Fill the steps of the joints and slacks, and the multipliers after a full step."""
    copy_rows(work.residual, work.target)
    for i in range(at.q.shape[0]):
        for r in range(problem.inequalities.size[i]):
            work.target_gap[i, r] = work.gap[i, r] - at.slack[i, r]
    add_pull(problem, work, at, mu)
    newton(problem, work, work.step)
    new_multipliers(problem, work, work.step)
    slack_steps(problem, work, work.step)


@compiled
def _reachable(problem: Problem, work: Workspace, at: Iterate) -> int:
    """Tell an iteration limit from a point that comes no nearer to its rows by itself."""
    copy_rows(at.q, work.correction)
    left = restoration(problem, work, work.correction, _RESTORE_STEPS, _RESTORE_TOLERANCE)
    return INFEASIBLE if left > _FEASIBLE else ITERATION_LIMIT


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
def _multiplier_step(problem: Problem, work: Workspace, at: Iterate, mu: float, tau: float) -> None:
    """Move every z by dz = mu / slack - z - z / slack dslack, as far as all stay positive."""
    count, n = at.q.shape
    length = 1.0
    lower, upper, step = problem.bounds.lower, problem.bounds.upper, work.step
    lower_step, upper_step, push_step = work.lower_step, work.upper_step, work.push_step
    for i in range(count):
        for k in range(n):
            d = step[i, k]
            dz_l = (mu - at.lower[i, k] * d) / (at.q[i, k] - lower[k]) - at.lower[i, k]
            dz_u = (mu + at.upper[i, k] * d) / (upper[k] - at.q[i, k]) - at.upper[i, k]
            if length * dz_l < -tau * at.lower[i, k]:
                length = -tau * at.lower[i, k] / dz_l
            if length * dz_u < -tau * at.upper[i, k]:
                length = -tau * at.upper[i, k] / dz_u
            lower_step[i, k], upper_step[i, k] = dz_l, dz_u
        for r in range(problem.inequalities.size[i]):
            z, s = at.push[i, r], at.slack[i, r]
            push_step[i, r] = (mu - z * work.slack_step[i, r]) / s - z
            if length * push_step[i, r] < -tau * z:
                length = -tau * z / push_step[i, r]
    for i in range(count):
        for k in range(n):
            at.lower[i, k] += length * lower_step[i, k]
            at.upper[i, k] += length * upper_step[i, k]
        for r in range(problem.inequalities.size[i]):
            at.push[i, r] += length * push_step[i, r]


@compiled
def _accept(problem: Problem, work: Workspace, at: Iterate, length: float) -> None:
    """Take the trial and its rows, and the multipliers of the equality rows as far.

    A slack below rounding would be lost in q - bound, so it is kept just above.
    """
    lower, upper, trial, new_y = problem.bounds.lower, problem.bounds.upper, work.trial, work.new_y
    for i in range(at.q.shape[0]):
        for k in range(at.q.shape[1]):
            least = LEAST_SLACK * (upper[k] - lower[k])
            inside = max(trial[i, k], lower[k] + least)
            at.q[i, k] = min(inside, upper[k] - least)
        for r in range(at.y.shape[1]):
            at.y[i, r] += length * (new_y[i, r] - at.y[i, r])
    copy_rows(work.trial_residual, work.residual)
    copy_rows(work.trial_gap, work.gap)
    copy_rows(work.trial_slack, at.slack)
