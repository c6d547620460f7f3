"""The typical approach: follow the path (eq. 12) and slide down the index in null space (eq. 13).

Three variants, since the paper's has no joint limits: `free` (report how far it leaves the
bounds), `clamped` (joints are cut at their bounds) and `qp` (the same step as a quadratic
programme within the bounds: without active bounds its solution is exactly (eq. 12)).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
import quadprog

from dualarm_pin.answer.notes import LocalNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
from dualarm_pin.errors import UnknownNameError, nearest
from dualarm_pin.planners.unreachable import feasible_postures, unreachable
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.reference import index_gradient
from dualarm_pin.relative import Relative
from dualarm_pin.rows.pose import pose_residual
from dualarm_pin.search.starts import generator
from dualarm_pin.solvers import slsqp as nlopt_slsqp
from dualarm_pin.solvers.projection import project_point
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Variant = Literal["free", "clamped", "qp"]
VARIANTS: tuple[Variant, ...] = ("free", "clamped", "qp")


def plan_local(
    task: Task,
    q_first: Array | None = None,
    *,
    variant: Variant = "qp",
    k0: float = 1.0,
    duration: float = 1.0,
    substeps: int = 10,
    seed: int = 0,
    starts: int = 20,
    progress: Progress = SILENT,
) -> Trajectory:
    """Plan point after point with the pseudo-inverse, (eq. 12) and (eq. 13).

    Args:
        task: What is asked.
        q_first: Joints at the first point (n,); None takes the best of `starts` for that point.
        variant: `free`, `clamped` or `qp`.
        k0: Gain of the null-space step (eq. 13).
        duration: Time in which the whole path is followed [s]; each interval takes an equal share.
        substeps: Integration steps an interval.
        seed: Seed of the starts for the first point.
        starts: How many of them.
        progress: Told where the work stands.

    Raises:
        UnknownNameError: There is no such variant.
    """
    clock = Clock.start()
    if variant not in VARIANTS:
        raise UnknownNameError(f"no such variant: {nearest(variant, VARIANTS)}", field=variant)
    problem = task.problem()
    if q_first is None:
        q_first = best_first_posture(problem, starts, seed)
        if q_first is None:
            return unreachable(task, problem, "local", f"pseudo-inverse-{variant}", seed, clock)
    progress.stage(f"pseudo-inverse, {variant}", problem.k - 1)
    walk = problem
    if variant == "free":
        endless = np.full(problem.n, np.inf)
        walk = replace(problem, lower=-endless, upper=endless)
    step = _qp_step if variant == "qp" else _pseudo_inverse_step
    gain = k0 * duration / (problem.k - 1) / substeps

    def lead(i: int, q: Array) -> tuple[Array, bool]:
        return _interval(problem, walk, i, q, gain, substeps, step)

    q, gave_way = follow(walk, q_first, lead, progress)
    return verified(
        task,
        q,
        method="local",
        solver=f"pseudo-inverse-{variant}",
        timing=clock.read(),
        seed=seed,
        notes=LocalNotes(
            k0=k0,
            damped_at=() if variant == "qp" else gave_way,
            infeasible_at=gave_way if variant == "qp" else (),
        ),
    )


def best_first_posture(problem: Problem, starts: int, seed: int) -> Array | None:
    """Return the joints (n,) with the best index at the first point alone, or None."""
    first = problem.subset([0], 0.0)
    postures, _, _ = feasible_postures(problem, 0, starts, generator(seed, 3), 10 * starts)
    ends = [nlopt_slsqp.solve(first, posture[None]) for posture in postures]
    feasible = [end for end in ends if end.feasible]
    return min(feasible, key=lambda end: end.objective).q[0] if feasible else None


def follow(
    problem: Problem,
    q_first: Array,
    lead: Callable[[int, Array], tuple[Array, bool]],
    progress: Progress,
) -> tuple[Array, tuple[int, ...]]:
    """Go from point to point and put each end onto the path exactly.

    Args:
        problem: The problem.
        q_first: Joints at the first point (n,).
        lead: (i, joints at point i - 1) -> joints near point i, and whether it had to give way.
        progress: Told of each point.

    Returns:
        Joints (k, n), and the points, from 1, at which `lead` gave way.
    """
    q = [project_point(problem, 0, q_first)[0]]
    gave_way = []
    for i in range(1, problem.k):
        near, gave = lead(i, q[-1])
        if gave:
            gave_way.append(i + 1)
        q.append(project_point(problem, i, near)[0])
        progress.advance()
    return np.array(q), tuple(gave_way)


def pose_between(problem: Problem, i: int, share: float) -> tuple[Array, Array]:
    """Return position (3,) and rotation (3, 3) `share` of the way from point i - 1 to point i."""
    import pinocchio as pin

    position, rotation = problem.points.position, problem.points.rotation
    turn = pin.exp3(share * pin.log3(rotation[i - 1].T @ rotation[i]))
    return (1.0 - share) * position[i - 1] + share * position[i], rotation[i - 1] @ turn


Step = Callable[[Problem, Array, Array, Array, Array], tuple[Array, bool]]


def _interval(
    problem: Problem, walk: Problem, i: int, q: Array, gain: float, substeps: int, step: Step
) -> tuple[Array, bool]:
    """Integrate from point i - 1 to point i; return the joints and whether a step gave way."""
    points, bounds, gave_way = problem.points, (problem.lower, problem.upper), False
    for share in np.arange(1, substeps + 1) / substeps:
        relative = Relative(problem.cell, q)
        # The residual against the next pose is feed-forward and drift correction in one.
        residual, J = pose_residual(
            relative, *pose_between(problem, i, share), int(points.pose_rows[i]), problem.spin_axis
        )
        u = (1.0 - share) * points.u[i - 1] + share * points.u[i]
        _, slope = index_gradient(problem.index, relative, u, q, bounds)
        dq, gave = step(walk, q, J, residual, -gain * slope)
        gave_way |= gave
        q = np.clip(q + dq, walk.lower, walk.upper)
    return q, gave_way


def _pseudo_inverse_step(
    walk: Problem, q: Array, J: Array, residual: Array, down: Array
) -> tuple[Array, bool]:
    """Return (eq. 12): J+ v + (I - J+ J) q0, damped below a smallest singular value of 1e-3."""
    U, sigma, Vt = np.linalg.svd(J, full_matrices=False)
    damped = bool(sigma[-1] < TOLERANCE.singular)
    inverse = sigma / (sigma**2 + TOLERANCE.singular**2) if damped else 1.0 / sigma
    return Vt.T @ (inverse * (U.T @ -residual)) + down - Vt.T @ (Vt @ down), damped


def _qp_step(walk: Problem, q: Array, J: Array, residual: Array, down: Array) -> tuple[Array, bool]:
    """Return the step nearest to `down` that follows the path within the bounds."""
    n = len(q)
    constraints = np.vstack([J, np.eye(n), -np.eye(n)]).T
    limits = np.concatenate([-residual, walk.lower - q, q - walk.upper])
    try:
        return quadprog.solve_qp(np.eye(n), down, constraints, limits, len(residual))[0], False
    except ValueError:  # the path cannot be followed within the bounds: come as near as possible
        normal, target = J.T @ J + 1e-6 * np.eye(n), -J.T @ residual + 1e-6 * down
        bounds = constraints[:, len(residual) :], limits[len(residual) :]
        try:
            return quadprog.solve_qp(normal, target, *bounds, 0)[0], True
        except ValueError:
            return np.zeros(n), True
