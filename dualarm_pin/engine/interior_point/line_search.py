"""Filter line search (Waechter and Biegler 2006) with one second-order correction.

A point is judged by two numbers: the violation of the rows and the barrier objective. A trial must
improve one of them against the current point and against every pair in the filter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dualarm_pin.chain import Floats
from dualarm_pin.engine.interior_point.barrier import (
    add_pull,
    log_barrier,
    slack_steps,
    violation,
)
from dualarm_pin.engine.interior_point.objective import objective
from dualarm_pin.engine.interior_point.system import newton
from dualarm_pin.engine.jit.compiled import compiled, inlined
from dualarm_pin.engine.workspace import FILTER_SIZE, Iterate, Workspace
from dualarm_pin.problem import Problem

# gamma_theta, gamma_phi, eta_phi, s_phi and s_theta of Waechter and Biegler (2006), section 2.3
_GAMMA_VIOLATION, _GAMMA_OBJECTIVE, _ARMIJO = 1e-5, 1e-8, 1e-4
_SWITCH_SLOPE, _SWITCH_VIOLATION = 2.3, 1.1
_ROUNDING = 1e-13  # of 1 + |barrier objective|
_HALVINGS = 25

REJECTED, DESCENT, FEASIBILITY = 0, 1, 2


class Merit(NamedTuple):
    """Where a point stands.

    Attributes:
        objective: f.
        logs: Sum of the logarithms of all slacks; the barrier objective is f - mu logs.
        violation: 1-norm of the residual of all rows.
    """

    objective: float
    logs: float
    violation: float


class Limits(NamedTuple):
    """Violations between which the line search switches its rules, fixed at the start.

    Attributes:
        small: At most this: descent of the barrier objective may be asked for.
        large: More than this is never accepted.
    """

    small: float
    large: float


@compiled
def merit_of(
    problem: Problem, work: Workspace, q: Floats, residual: Floats, gap: Floats, slack: Floats
) -> Merit:
    """Evaluate a point and fill its rows; a slack below its row is raised to it."""
    value = objective(problem, work, q, residual, gap)
    for i in range(q.shape[0]):
        for r in range(problem.inequalities.size[i]):
            slack[i, r] = max(slack[i, r], gap[i, r])
    logs = log_barrier(problem, q, slack)
    return Merit(value, logs, violation(problem, residual, gap, slack))


@compiled
def step_to_bounds(
    problem: Problem, work: Workspace, at: Iterate, step: Floats, tau: float
) -> float:
    """Return the largest step length up to 1 that keeps the share 1 - tau of every slack."""
    length, q = 1.0, at.q
    lower, upper = problem.bounds.lower, problem.bounds.upper
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            d = step[i, k]
            room = tau * (q[i, k] - lower[k]) if d < 0.0 else tau * (upper[k] - q[i, k])
            if length * abs(d) > room:  # a division only where it shortens the step
                length = room / abs(d)
        for r in range(problem.inequalities.size[i]):
            if length * work.slack_step[i, r] < -tau * at.slack[i, r]:
                length = -tau * at.slack[i, r] / work.slack_step[i, r]
    return length


@compiled
def merit_slope(problem: Problem, work: Workspace, at: Iterate, mu: float) -> float:
    """Return the derivative of the barrier objective along the step of q and of the slacks."""
    slope = 0.0
    for i in range(at.q.shape[0]):
        for k in range(at.q.shape[1]):
            slope += work.barrier_gradient[i, k] * work.step[i, k]
        for r in range(problem.inequalities.size[i]):
            slope -= mu * work.slack_step[i, r] / at.slack[i, r]
    return slope


@inlined
def search(
    problem: Problem,
    work: Workspace,
    at: Iterate,
    mu: float,
    tau: float,
    now: Merit,
    limits: Limits,
    filtered: int,
) -> tuple[float, Merit, int]:
    """Walk along `work.step` until a trial is acceptable; it is left in `work.trial`.

    Returns:
        Step length (0 if none was acceptable), merit there, number of pairs in the filter.
    """
    slope = merit_slope(problem, work, at, mu)
    full = step_to_bounds(problem, work, at, work.step, tau)
    length = full
    for attempt in range(_HALVINGS):
        trial = _try(problem, work, at, length, work.step)
        verdict = judge(work.filter, filtered, mu, now, trial, slope, length, limits)
        if verdict == REJECTED and attempt == 0 and trial.violation >= now.violation:
            trial = _correct(problem, work, at, mu, tau, full)
            verdict = judge(work.filter, filtered, mu, now, trial, slope, length, limits)
        if verdict != REJECTED:
            if verdict == FEASIBILITY:
                filtered = remember(work.filter, filtered, mu, now)
            return length, trial, filtered
        length *= 0.5
    return 0.0, now, filtered


@compiled
def _try(problem: Problem, work: Workspace, at: Iterate, length: float, step: Floats) -> Merit:
    """Evaluate the point `length` along the steps of q and of the slacks."""
    for i in range(step.shape[0]):
        for k in range(step.shape[1]):
            work.trial[i, k] = at.q[i, k] + length * step[i, k]
        for r in range(problem.inequalities.size[i]):
            work.trial_slack[i, r] = at.slack[i, r] + length * work.slack_step[i, r]
    return merit_of(
        problem, work, work.trial, work.trial_residual, work.trial_gap, work.trial_slack
    )


@compiled
def _correct(
    problem: Problem, work: Workspace, at: Iterate, mu: float, tau: float, length: float
) -> Merit:
    """Try the second-order correction: a step that also removes the residual of the full trial.

    The steps of the multipliers follow from that of the slacks, so it is put back afterwards where
    the correction is not taken: see `Workspace.plain_slack_step`.
    """
    for i in range(at.q.shape[0]):
        for r in range(problem.row_count[i]):
            work.target[i, r] = length * work.residual[i, r] + work.trial_residual[i, r]
        for r in range(problem.inequalities.size[i]):
            here = work.gap[i, r] - at.slack[i, r]
            there = work.trial_gap[i, r] - work.trial_slack[i, r]
            work.target_gap[i, r] = length * here + there
            work.plain_slack_step[i, r] = work.slack_step[i, r]
    add_pull(problem, work, at, mu)
    newton(problem, work, work.correction)
    slack_steps(problem, work, work.correction)
    corrected = step_to_bounds(problem, work, at, work.correction, tau)
    merit = _try(problem, work, at, corrected, work.correction)
    for i in range(at.q.shape[0]):
        for r in range(problem.inequalities.size[i]):
            work.slack_step[i, r] = work.plain_slack_step[i, r]
    return merit


@compiled
def judge(
    pairs: Floats,
    filtered: int,
    mu: float,
    now: Merit,
    trial: Merit,
    slope: float,
    length: float,
    limits: Limits,
) -> int:
    """Return REJECTED, DESCENT (Armijo holds) or FEASIBILITY (better in one of the two)."""
    before = now.objective - mu * now.logs
    after = trial.objective - mu * trial.logs
    if not (trial.violation <= limits.large and math.isfinite(after)):
        return REJECTED
    rounding = _ROUNDING * (1.0 + abs(before))
    for pair in range(filtered):
        if trial.violation >= pairs[pair, 0] and after - rounding >= pairs[pair, 1]:
            return REJECTED
    promising = slope < 0.0 and (
        length * (-slope) ** _SWITCH_SLOPE > now.violation**_SWITCH_VIOLATION
    )
    descends = after - before - rounding <= _ARMIJO * length * slope
    if promising and descends:
        return DESCENT
    if promising and now.violation <= limits.small:
        return REJECTED
    nearer = trial.violation <= (1.0 - _GAMMA_VIOLATION) * now.violation
    lower = after - rounding <= before - _GAMMA_OBJECTIVE * now.violation
    return FEASIBILITY if nearer or lower else REJECTED


@compiled
def remember(pairs: Floats, filtered: int, mu: float, now: Merit) -> int:
    """Add the current point to the filter and return the new number of pairs.

    A full filter forgets the pair of the largest violation, which bars least.
    """
    at = filtered
    if filtered == FILTER_SIZE:
        at = 0
        for pair in range(1, FILTER_SIZE):
            if pairs[pair, 0] > pairs[at, 0]:
                at = pair
    pairs[at, 0] = (1.0 - _GAMMA_VIOLATION) * now.violation
    pairs[at, 1] = now.objective - mu * now.logs - _GAMMA_OBJECTIVE * now.violation
    return min(filtered + 1, FILTER_SIZE)
