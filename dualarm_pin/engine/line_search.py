"""Filter line search (Waechter and Biegler 2006) with one second-order correction.

A point is judged by two numbers: the violation of the pose rows and the barrier objective. A trial
must improve one of them against the current point and against every pair in the filter.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dualarm_pin.engine.barrier import log_barrier, objective, violation
from dualarm_pin.engine.chain import Floats
from dualarm_pin.engine.compiled import compiled, inlined
from dualarm_pin.engine.layout import Problem
from dualarm_pin.engine.newton import newton_step
from dualarm_pin.engine.workspace import FILTER_SIZE, Workspace

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
        violation: 1-norm of the pose residual.
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
def merit_of(problem: Problem, work: Workspace, q: Floats, residual: Floats) -> Merit:
    """Evaluate a point and fill its pose residual."""
    value = objective(problem, work, q, residual)
    return Merit(value, log_barrier(problem, q), violation(residual))


@compiled
def step_to_bounds(problem: Problem, q: Floats, step: Floats, tau: float) -> float:
    """Return the largest step length up to 1 that keeps the share 1 - tau of every slack."""
    length = 1.0
    lower, upper = problem.lower, problem.upper
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            d = step[i, k]
            room = tau * (q[i, k] - lower[k]) if d < 0.0 else tau * (upper[k] - q[i, k])
            if length * abs(d) > room:  # a division only where it shortens the step
                length = room / abs(d)
    return length


@inlined
def search(
    problem: Problem,
    work: Workspace,
    q: Floats,
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
    slope = 0.0
    gradient, step = work.barrier_gradient, work.step
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            slope += gradient[i, k] * step[i, k]
    full = step_to_bounds(problem, q, step, tau)
    length = full
    for attempt in range(_HALVINGS):
        _move(q, length, step, work.trial)
        trial = merit_of(problem, work, work.trial, work.trial_residual)
        verdict = judge(work.filter, filtered, mu, now, trial, slope, length, limits)
        if verdict == REJECTED and attempt == 0 and trial.violation >= now.violation:
            trial = _correct(problem, work, q, tau, full)
            verdict = judge(work.filter, filtered, mu, now, trial, slope, length, limits)
        if verdict != REJECTED:
            if verdict == FEASIBILITY:
                filtered = remember(work.filter, filtered, mu, now)
            return length, trial, filtered
        length *= 0.5
    return 0.0, now, filtered


@compiled
def _move(q: Floats, length: float, step: Floats, trial: Floats) -> None:
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            trial[i, k] = q[i, k] + length * step[i, k]


@compiled
def _correct(problem: Problem, work: Workspace, q: Floats, tau: float, length: float) -> Merit:
    """Try the second-order correction: a step that also removes the residual of the full trial."""
    for i in range(q.shape[0]):
        for r in range(problem.points.rows[i]):
            work.target[i, r] = length * work.residual[i, r] + work.trial_residual[i, r]
    newton_step(problem, work, work.correction)
    corrected = step_to_bounds(problem, q, work.correction, tau)
    _move(q, corrected, work.correction, work.trial)
    return merit_of(problem, work, work.trial, work.trial_residual)


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
    """Add the current point to the filter and return the new number of pairs."""
    if filtered < FILTER_SIZE:
        pairs[filtered, 0] = (1.0 - _GAMMA_VIOLATION) * now.violation
        pairs[filtered, 1] = now.objective - mu * now.logs - _GAMMA_OBJECTIVE * now.violation
        filtered += 1
    return filtered
