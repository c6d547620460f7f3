"""The local check: polish, then first and second order, nearby starts and costly limits.

It shows a strict local minimum, within floating point, and nothing beyond its own basin.
"""

from __future__ import annotations

from dataclasses import replace
from math import nan
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.evidence import LocalCheck
from dualarm_pin.arrays import Array
from dualarm_pin.evidence.curvature import curvature_min
from dualarm_pin.evidence.kkt import Stationarity, stationarity
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import generator
from dualarm_pin.search.work import Work
from dualarm_pin.solution import same_path
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.engine.solve import Options


# Starts a shift at most, and largest shifts of a posture [rad or m], from wide to still one path.
RETURNS = 20
SHIFTS = (0.2, 0.1, 0.05, 0.02)
_FAR = 1e-2  # of the objective: a nearby start that stays above by more has left for elsewhere
_LEAST_RETURNS, _ITERATIONS = 5, 25  # fewer say nothing; what one of them takes as a rule
_POLISH = 0.3  # s that one polish may take, as `search.work.Work` counts them ...
_POLISH_SHARE = 5.0  # ... or this many times what the starts of a shift may
_POLISH_ITERATIONS = (40, 400)  # on a thousand points some three hundred are needed
_SKIPPED = 4.0  # fewest starts that cost this many times what they may are not made
_MOST_ADOPTIONS = 5  # the paper's best path needs none; a search that needs more goes on for long


def check_minimum(
    problem: Problem, q: Array, *, seed: int, jobs: int | None = None, work: float = 0.5
) -> tuple[Array, LocalCheck]:
    """Polish a path and check it independently of the solver.

    Args:
        problem: The problem.
        q: A path (k, n), nearly a minimum.
        seed: Seed of the shifts.
        jobs: Threads; None takes the processors there are.
        work: What the starts of one shift may cost, as `search.work.Work` counts seconds: on long
            paths there are fewer of them.

    Returns:
        The polished path (k, n), or a better one that a nearby start led to; its check.
    """
    q, settled = _polished(problem, q, max(_POLISH, _POLISH_SHARE * work))
    each = Work(problem).seconds(_ITERATIONS * problem.k)
    count = max(_LEAST_RETURNS, min(RETURNS, int(work / each)))
    if count * each > work * (_SKIPPED if settled else 1.0):
        # A long path: to one that is no minimum nothing returns, and where starts cost so much
        # they are left to an effort that has more.
        return q, _local(problem, q, None, nan, 0, curved=settled)
    best = problem.objective(q)
    adopted = 0
    while True:
        radius, share, better = _returns(problem, q, best, seed + adopted, jobs, count)
        if better is None or adopted == _MOST_ADOPTIONS:
            break
        q, adopted = better, adopted + 1
        best = problem.objective(q)
    return q, _local(problem, q, radius, share, adopted)


def check_held(problem: Problem, q: Array) -> LocalCheck:
    """Check a path (k, n) without trying starts nearby: rows that hold it there are right there."""
    return _local(problem, q, None, nan, 0)


def _local(
    problem: Problem,
    q: Array,
    radius: float | None,
    share: float,
    adopted: int,
    curved: bool = True,
) -> LocalCheck:
    first = stationarity(problem, q)
    curvature, directions = curvature_min(problem, q, first) if curved else (None, 0)
    cost = np.sum(first.bound_multipliers, axis=0)
    return LocalCheck(
        objective=float(first.objective),
        feasibility=first.residual,
        stationarity=first.stationarity,
        min_multiplier=first.min_multiplier,
        active_bounds=int(np.count_nonzero(first.active)),
        curvature_min=curvature,
        free_directions=directions,
        sigma_min=_sigma_min(first),
        return_radius=radius,
        return_share=share,
        adopted_from_nearby=adopted,
        limit_cost=dict(zip(problem.cell.joint_names, cost.tolist(), strict=True)),
    )


def polished(problem: Problem, q: Array) -> Array:
    """Return q (k, n) at the polish tolerance, or q itself where the solver did worse."""
    return _polished(problem, q)[0]


def _polished(problem: Problem, q: Array, work: float = _POLISH) -> tuple[Array, bool]:
    """Return `polished`, and whether the solver came to an end there.

    `work` is what it may cost, in seconds as `search.work.Work` counts them.
    """
    least, most = _POLISH_ITERATIONS
    iterations = max(least, min(most, int(work / Work(problem).seconds(problem.k))))
    settled = False
    for tolerance in (TOLERANCE.search, TOLERANCE.polish):  # round-off may bar the second
        options = replace(near(tolerance), iterations=iterations)
        end = engine.solve(problem, q, options=options)
        same_level = end.objective <= problem.objective(q) + TOLERANCE.same_objective
        if not (end.converged and end.feasible and same_level):
            break
        q, settled = end.q, True
    return q, settled


def near(tolerance: float, mu0: float = 1e-4) -> Options:
    """Return options for a start close to its minimum, which should stay near its bounds."""
    from dualarm_pin.engine.solve import Options

    return Options(tolerance=tolerance, mu0=mu0, push=mu0)


def _returns(
    problem: Problem, q: Array, best: float, seed: int, jobs: int | None, count: int
) -> tuple[float | None, float, Array | None]:
    """Return the largest shift that all re-solves came back from, their share, a better path.

    The share is that of the largest shift. Smaller ones are tried only where some do not return.
    """
    share = -1.0
    level = TOLERANCE.same_objective * max(1.0, abs(best))
    # Few starts mean a long path: there one that is not back soon is not waited for.
    options = replace(near(TOLERANCE.search, 0.1), push=1e-2)
    if count == _LEAST_RETURNS:
        options = replace(options, iterations=2 * _ITERATIONS)
    for number, shift in enumerate(SHIFTS):
        direction = generator(seed, 30, number).standard_normal((count, *q.shape))
        direction /= np.linalg.norm(direction, axis=2, keepdims=True)
        # A joint with little room, such as a short prismatic one, moves less.
        room = np.minimum(1.0, (problem.upper - problem.lower) / 2.0)
        starts = np.clip(q + shift * direction * room, problem.lower, problem.upper)
        ends = engine.solve_many(
            problem, starts, jobs=jobs, options=options, limit=best + _FAR * max(1.0, abs(best))
        )
        value = np.where(ends.converged, ends.objective, np.inf)
        lowest = int(np.argmin(value))
        if value[lowest] < best - level:
            return None, 0.0, polished(problem, ends.q[lowest])
        back = [ok and same_path(end, q) for end, ok in zip(ends.q, ends.converged, strict=True)]
        here = float(np.mean(back))
        share = here if share < 0.0 else share
        if here == 1.0:
            return shift, share, None
    return None, share, None


def _sigma_min(first: Stationarity) -> float:
    """Return the smallest singular value of any point's free pose Jacobian."""
    smallest = np.inf
    for i, J in enumerate(first.jacobians):
        free = first.free_jacobian(i)
        if free.shape[1] < len(J):
            return 0.0  # more pose rows than joints that may move
        smallest = min(smallest, float(np.linalg.svd(free, compute_uv=False)[-1]))
    return smallest
