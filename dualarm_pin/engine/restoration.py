"""Bring points back to their pose, each alone: Levenberg-Marquardt inside the bounds."""

from __future__ import annotations

from dualarm_pin.engine.chain import Floats
from dualarm_pin.engine.compiled import compiled, copy_row, inlined
from dualarm_pin.engine.kinematics import (
    constraint_jacobian,
    place_chain,
    pose_residual,
    rotation_rows,
)
from dualarm_pin.engine.layout import Problem
from dualarm_pin.engine.linear_algebra import solve_positive
from dualarm_pin.engine.workspace import Workspace

_MARGIN = 1e-3  # of the range, kept from every bound
_DAMPING_FIRST, _DAMPING_MIN, _DAMPING_LESS, _DAMPING_MORE = 1e-3, 1e-9, 0.2, 8.0
_TRIES = 8


@inlined
def restore(problem: Problem, work: Workspace, q: Floats, steps: int, tolerance: float) -> None:
    """Reduce the pose residual of every point of q (k, n) in place."""
    for i in range(q.shape[0]):
        _restore_point(problem, work, i, q[i], steps, tolerance)


@compiled
def _restore_point(
    problem: Problem, work: Workspace, i: int, q: Floats, steps: int, tolerance: float
) -> None:
    """Minimise |g|^2: dq = -A^T (A A^T + damping I)^-1 g, joints at a bound held."""
    n = q.shape[0]
    residual, trial_residual = work.residual[i], work.trial_residual[i]
    jacobian, trial = work.jacobian[i], work.trial[i]
    damping = _DAMPING_FIRST
    square = _residual(problem, work, i, q, residual)
    for _ in range(steps):
        if square < tolerance * tolerance:
            return
        _jacobian(problem, work, i, q, jacobian)
        _hold_at_bounds(problem, q, residual, jacobian, problem.points.rows[i])
        better = False
        for _ in range(_TRIES):
            if _damped_row_step(work, i, problem.points.rows[i], damping, jacobian, residual):
                for k in range(n):
                    margin = _MARGIN * (problem.upper[k] - problem.lower[k])
                    moved = q[k] - work.normal[i, k]
                    trial[k] = min(max(moved, problem.lower[k] + margin), problem.upper[k] - margin)
                trial_square = _residual(problem, work, i, trial, trial_residual)
                better = trial_square < square
            if better:
                copy_row(trial, q)
                copy_row(trial_residual, residual)
                square = trial_square
                damping = max(_DAMPING_LESS * damping, _DAMPING_MIN)
                break
            damping *= _DAMPING_MORE
        if not better:
            return


@compiled
def _residual(problem: Problem, work: Workspace, i: int, q: Floats, residual: Floats) -> float:
    """Fill the residual of point i and return its square."""
    p, Q = place_chain(problem.chain, q, work.scratch.w, work.scratch.v)
    points = problem.points
    pose_residual(p, Q, points.position[i], points.quaternion[i], residual, work.error[i])
    square = 0.0
    for r in range(6):
        if r >= problem.points.rows[i]:
            residual[r] = 0.0
        square += residual[r] * residual[r]
    return square


@compiled
def _jacobian(problem: Problem, work: Workspace, i: int, q: Floats, jacobian: Floats) -> None:
    """Fill the Jacobian of point i at q."""
    scratch = work.scratch
    p, Q = place_chain(problem.chain, q, scratch.w, scratch.v)
    points = problem.points
    pose_residual(p, Q, points.position[i], points.quaternion[i], work.row, work.error[i])
    rotation_rows(work.error[i], problem.points.target_axes[i], scratch.B)
    constraint_jacobian(problem.chain, scratch.w, scratch.v, scratch.B, jacobian)


@compiled
def _hold_at_bounds(
    problem: Problem, q: Floats, residual: Floats, jacobian: Floats, rows: int
) -> None:
    """Zero the columns of fixed joints and of joints at a bound that would move outwards."""
    for k in range(q.shape[0]):
        slope = 0.0
        for r in range(rows):
            slope += jacobian[r, k] * residual[r]
        margin = 1.01 * _MARGIN * (problem.upper[k] - problem.lower[k])
        at_lower = q[k] <= problem.lower[k] + margin and slope > 0.0
        at_upper = q[k] >= problem.upper[k] - margin and slope < 0.0
        if at_lower or at_upper:
            for r in range(rows):
                jacobian[r, k] = 0.0
    for k in problem.fixed:
        for r in range(rows):
            jacobian[r, k] = 0.0


@compiled
def _damped_row_step(
    work: Workspace, i: int, rows: int, damping: float, jacobian: Floats, residual: Floats
) -> bool:
    """Fill normal[i] with A^T (A A^T + damping I)^-1 g."""
    n = jacobian.shape[1]
    square, x = work.triangle[i], work.row
    for r in range(rows):
        for c in range(r + 1):
            entry = 0.0
            for k in range(n):
                entry += jacobian[r, k] * jacobian[c, k]
            square[r, c] = entry
        square[r, r] += damping
        x[r] = residual[r]
    if not solve_positive(square, rows, x):
        return False
    for k in range(n):
        moved = 0.0
        for r in range(rows):
            moved += jacobian[r, k] * x[r]
        work.normal[i, k] = moved
    return True
