"""The Newton step of a problem whose last p columns are shared by all points: an arrow system.

Every point has a copy of the shared columns in its posture. The copies start equal and every step
moves them alike, so all sums over the points are those of one set of shared values p:

    [H     H_p   A^T] [dq   ]     [grad  ]
    [H_p^T H_pp  C^T] [dp   ] = - [grad_p]     H block tridiagonal, H_pp and grad_p summed
    [A     C     0  ] [y_new]     [g     ]

With V, Y the answer of the upper system to C and H_p, dq = dq_0 + V dp and y = y_0 + Y dp, where

    S = H_pp + H_p^T V + C^T Y,   S dp = -(grad_p + H_p^T dq_0 + C^T y_0).

At a minimum S is the Hessian of the optimal value by p, and V = dq/dp.
"""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.arrow_problem import ArrowProblem
from dualarm_pin.engine.interior_point import newton as plain
from dualarm_pin.engine.interior_point.linear_algebra import block_cholesky, solve_positive
from dualarm_pin.engine.interior_point.objective import all_derivatives
from dualarm_pin.engine.interior_point.restoration import restore
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Iterate, Workspace


@compiled
def derivatives(problem: ArrowProblem, work: Workspace, at: Iterate) -> None:
    """Fill all derivatives; the slope of a shared column stands at the first point alone.

    Only its sum over the points counts anywhere. What every later point adds to the Lagrangian's
    slope goes to the first, so that there it is the slope by the shared value.
    """
    all_derivatives(problem, work, at)
    n, gradient = problem.border.step.shape[1], work.gradient
    for e in range(n, gradient.shape[1]):
        for i in range(1, gradient.shape[0]):
            rest = gradient[i, e] - at.lower[i, e] + at.upper[i, e]
            for r in range(problem.row_count[i]):
                rest += work.jacobian[i, r, e] * at.y[i, r]
            for r in range(problem.inequalities.size[i]):
                rest -= work.row_jacobian[i, r, e] * at.push[i, r]
            gradient[i, e] -= rest
            gradient[0, e] += rest


@compiled
def factor_system(problem: ArrowProblem, work: Workspace, last_shift: float) -> float:
    """Factor the system plus the smallest tried shift at which it is convex; -1 if none is."""
    inner, border = problem.border.inner, problem.border
    _take_inner(work, inner)
    plain.reduce_system(problem.alone, inner)
    first = last_shift == 0.0
    shift = 0.0
    while shift < plain.SHIFT_MAX:
        if block_cholesky(
            inner.diagonal, inner.coupling, inner.free, shift, inner.factor, inner.below
        ):
            _fill_border(problem, work)
            if _solve_border(problem, shift):
                border.shift[0] = shift
                return shift
        if shift > 0.0:
            shift *= plain.SHIFT_GROW_FIRST if first else plain.SHIFT_GROW
        else:
            shift = (
                plain.SHIFT_FIRST
                if first
                else max(plain.SHIFT_MIN, last_shift / plain.SHIFT_SHRINK)
            )
    return -1.0


@compiled
def differentiate(problem: ArrowProblem, work: Workspace) -> bool:
    """Fill V, Y and S at the current derivatives; False where the joints are at no strict minimum.

    S may have any sign here: the shared values need not be the best ones.
    """
    inner = problem.border.inner
    _take_inner(work, inner)
    plain.reduce_system(problem.alone, inner)
    if not block_cholesky(
        inner.diagonal, inner.coupling, inner.free, 0.0, inner.factor, inner.below
    ):
        return False
    _fill_border(problem, work)
    return True


@compiled
def _take_inner(work: Workspace, inner: Workspace) -> None:
    """Copy what belongs to the columns of the joints."""
    count, n = inner.gradient.shape
    for i in range(count):
        inner.stiffness[i] = work.stiffness[i]
        for k in range(n):
            inner.link[i, k] = work.link[i, k]
            for c in range(n):
                inner.hessian[i, k, c] = work.hessian[i, k, c]
            for r in range(inner.jacobian.shape[1]):
                inner.jacobian[i, r, k] = work.jacobian[i, r, k]


@compiled
def _fill_border(problem: ArrowProblem, work: Workspace) -> None:
    """Fill V (p, k, n), Y (p, k, m) and S (p, p) with the factors at hand."""
    border, inner = problem.border, problem.border.inner
    count, n = inner.gradient.shape
    for e in range(border.S.shape[0]):
        for i in range(count):
            for k in range(n):
                inner.pulled[i, k] = work.hessian[i, k, n + e]
            for r in range(inner.target.shape[1]):
                inner.target[i, r] = work.jacobian[i, r, n + e]
        plain.newton_step(problem.alone, inner, border.V[e])
        plain.newton_multipliers(problem.alone, inner, border.V[e])
        for i in range(count):
            for r in range(inner.target.shape[1]):
                border.Y[e, i, r] = inner.new_y[i, r]
    for d in range(border.S.shape[0]):
        for e in range(d + 1):
            entry = 0.0
            for i in range(count):
                entry += work.hessian[i, n + d, n + e]
                for k in range(n):
                    entry += work.hessian[i, k, n + d] * border.V[e, i, k]
                for r in range(problem.row_count[i]):
                    entry += work.jacobian[i, r, n + d] * border.Y[e, i, r]
            border.S[d, e] = entry
            border.S[e, d] = entry


@compiled
def _solve_border(problem: ArrowProblem, shift: float) -> bool:
    """Solve (S + shift I) dp = dp in place; False if that matrix is not positive definite."""
    border = problem.border
    size = border.S.shape[0]
    for d in range(size):
        for e in range(size):
            border.room[d, e] = border.S[d, e]
        border.room[d, d] += shift
    return solve_positive(border.room, size, border.dp)


@compiled
def newton_step(problem: ArrowProblem, work: Workspace, step: Floats) -> None:
    """Fill step (k, n + p): it removes the residual in `work.target` and minimises the model."""
    border, inner = problem.border, problem.border.inner
    count, n = inner.gradient.shape
    for i in range(count):
        for k in range(n):
            inner.pulled[i, k] = work.pulled[i, k]
        for r in range(inner.target.shape[1]):
            inner.target[i, r] = work.target[i, r]
    plain.newton_step(problem.alone, inner, border.step)
    plain.newton_multipliers(problem.alone, inner, border.step)
    for e in range(border.dp.shape[0]):
        slope = 0.0
        for i in range(count):
            slope += work.pulled[i, n + e]
            for k in range(n):
                slope += work.hessian[i, k, n + e] * border.step[i, k]
            for r in range(problem.row_count[i]):
                slope += work.jacobian[i, r, n + e] * inner.new_y[i, r]
        border.dp[e] = -slope
    _solve_border(problem, border.shift[0])
    for i in range(count):
        for k in range(n):
            step[i, k] = border.step[i, k]
            for e in range(border.dp.shape[0]):
                step[i, k] += border.V[e, i, k] * border.dp[e]
        for e in range(border.dp.shape[0]):
            step[i, n + e] = border.dp[e]


@compiled
def newton_multipliers(problem: ArrowProblem, work: Workspace, step: Floats) -> None:
    """Fill new_y (k, m) after the step that `newton_step` made last."""
    border, new_y = problem.border, work.new_y
    for i in range(new_y.shape[0]):
        for r in range(new_y.shape[1]):
            new_y[i, r] = border.inner.new_y[i, r]
            for e in range(border.dp.shape[0]):
                new_y[i, r] += border.Y[e, i, r] * border.dp[e]


@compiled
def restore_held(
    problem: ArrowProblem, work: Workspace, q: Floats, steps: int, tolerance: float
) -> float:
    """Bring every point back to its rows with the shared columns held; as `restore`."""
    return restore(problem.held, work, q, steps, tolerance)
