"""Bring points back to their rows, each alone: Levenberg-Marquardt inside the bounds.

An inequality row counts where it is below a margin, by what it lacks.
"""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.chain.derivatives import point_rows
from dualarm_pin.engine.chain.kinematics import constraint_jacobian, rotation_rows
from dualarm_pin.engine.chain.row_terms import row_terms
from dualarm_pin.engine.interior_point.linear_algebra import solve_positive
from dualarm_pin.engine.jit.compiled import compiled, copy_row
from dualarm_pin.engine.workspace import Workspace
from dualarm_pin.problem import Problem

_MARGIN = 1e-3  # of the range, kept from every bound; and of an inequality row, in its unit
_DAMPING_FIRST, _DAMPING_MIN, _DAMPING_LESS, _DAMPING_MORE = 1e-3, 1e-9, 0.2, 8.0
_TRIES = 8  # dampings a step: by then it is a step of steepest descent, 8^8 times shorter


@compiled
def restore(problem: Problem, work: Workspace, q: Floats, steps: int, tolerance: float) -> float:
    """Reduce the residual of every point of q (k, n) in place; return the largest that is left."""
    worst = 0.0
    for i in range(q.shape[0]):
        worst = max(worst, _restore_point(problem, work, i, q[i], steps, tolerance))
    return worst


@compiled
def _restore_point(
    problem: Problem, work: Workspace, i: int, q: Floats, steps: int, tolerance: float
) -> float:
    """Minimise |g|^2: dq = -A^T (A A^T + damping I)^-1 g, joints at a bound held.

    Returns:
        The norm of what is left; 0 if it is below the tolerance.
    """
    n, bounds = q.shape[0], problem.bounds
    residual, trial_residual = work.stack[0], work.stack[1]
    jacobian, trial = work.stack_jacobian, work.trial[i]
    damping = _DAMPING_FIRST
    square = _residual(problem, work, i, q, residual)
    for _ in range(steps):
        if square < tolerance * tolerance:
            return 0.0
        _jacobian(problem, work, i, q, residual, jacobian)
        _hold_at_bounds(problem, q, residual, jacobian)
        better = False
        for _ in range(_TRIES):
            if _damped_row_step(work, i, damping, jacobian, residual):
                for k in range(n):
                    margin = _MARGIN * (bounds.upper[k] - bounds.lower[k])
                    moved = q[k] - work.normal[i, k]
                    trial[k] = min(max(moved, bounds.lower[k] + margin), bounds.upper[k] - margin)
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
            break
    if square < tolerance * tolerance:
        return 0.0
    return float(square**0.5)


@compiled
def _residual(problem: Problem, work: Workspace, i: int, q: Floats, stack: Floats) -> float:
    """Fill what every row of point i lacks (m + r,), and return the square."""
    m, gap = work.residual.shape[1], work.gap[i]
    point_rows(problem, i, q, work.scratch, work.residual[i], work.error[i], gap)
    square = 0.0
    for r in range(stack.shape[0]):
        if r < m:
            stack[r] = work.residual[i, r]
        else:
            active = r - m < problem.inequalities.size[i]
            stack[r] = min(gap[r - m] - _MARGIN, 0.0) if active else 0.0
        square += stack[r] * stack[r]
    return square


@compiled
def _jacobian(
    problem: Problem, work: Workspace, i: int, q: Floats, stack: Floats, jacobian: Floats
) -> None:
    """Fill the Jacobian (m + r, n) of what the rows lack at q."""
    scratch, m = work.scratch, work.residual.shape[1]
    pose_rows = problem.points.pose_rows[i]
    point_rows(problem, i, q, scratch, work.residual[i], work.error[i], work.gap[i])
    rotation_rows(work.error[i], problem.points.target_axes[i], scratch.B)
    constraint_jacobian(problem.chain, scratch.w, scratch.v, scratch.B, jacobian)
    for r in range(pose_rows, 6):
        jacobian[r] = 0.0
    for j in range(problem.equalities.size[i]):
        row_terms(problem.equalities, i, j, 0.0, problem.chain, scratch, jacobian[pose_rows + j])
    for j in range(problem.inequalities.size[i]):
        if stack[m + j] < 0.0:
            row_terms(problem.inequalities, i, j, 0.0, problem.chain, scratch, jacobian[m + j])


@compiled
def _hold_at_bounds(problem: Problem, q: Floats, residual: Floats, jacobian: Floats) -> None:
    """Zero the columns of fixed joints and of joints at a bound that would move outwards."""
    rows, bounds = residual.shape[0], problem.bounds
    for k in range(q.shape[0]):
        slope = 0.0
        for r in range(rows):
            slope += jacobian[r, k] * residual[r]
        margin = 1.01 * _MARGIN * (bounds.upper[k] - bounds.lower[k])
        at_lower = q[k] <= bounds.lower[k] + margin and slope > 0.0
        at_upper = q[k] >= bounds.upper[k] - margin and slope < 0.0
        if at_lower or at_upper:
            for r in range(rows):
                jacobian[r, k] = 0.0
    for k in bounds.fixed:
        for r in range(rows):
            jacobian[r, k] = 0.0


@compiled
def _damped_row_step(
    work: Workspace, i: int, damping: float, jacobian: Floats, residual: Floats
) -> bool:
    """Fill normal[i] with A^T (A A^T + damping I)^-1 g."""
    rows, n = jacobian.shape
    square, x = work.stack_square, work.stack_row
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
