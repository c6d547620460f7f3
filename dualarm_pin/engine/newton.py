"""The Newton step of the barrier problem, in the null space of every point's pose rows.

    [H  A^T] [dq   ]     [grad]
    [A   0 ] [y_new] = - [g   ]        H block tridiagonal, A block diagonal

With A_i = T_i B_i (triangle, basis of the row space) and Z_i the null space: dq = B^T t + Z^T r,
T t = -g, (Z H Z^T) r = -Z (grad + H B^T t), T^T y_new = -B (grad + H dq).
"""

from __future__ import annotations

from dualarm_pin.engine.chain import Floats
from dualarm_pin.engine.compiled import compiled
from dualarm_pin.engine.layout import Problem, Workspace
from dualarm_pin.engine.linear_algebra import block_cholesky, block_solve, orthonormal_basis

_SHIFT_FIRST, _SHIFT_MIN, _SHIFT_MAX = 1e-4, 1e-12, 1e12
_SHIFT_GROW_FIRST, _SHIFT_GROW, _SHIFT_SHRINK = 100.0, 8.0, 3.0


@compiled
def reduce_system(problem: Problem, work: Workspace) -> None:
    """Fill bases and reduced blocks at the current derivatives."""
    count, n = work.gradient.shape
    for i in range(count):
        work.rank[i] = orthonormal_basis(
            work.jacobian[i],
            problem.points.rows[i],
            work.basis[i],
            work.triangle[i],
            work.kept[i],
            work.mirror,
        )
        work.free[i] = n - work.rank[i]
        _reduce_diagonal(work, i)
        if i > 0:
            _reduce_coupling(problem, work, i)


@compiled
def _reduce_diagonal(work: Workspace, i: int) -> None:
    """Fill the lower triangle of Z_i H_ii Z_i^T."""
    n, rank, size = work.gradient.shape[1], work.rank[i], work.free[i]
    basis, hessian, half, block = work.basis[i], work.hessian[i], work.half, work.diagonal[i]
    for a in range(size):
        for k in range(n):
            half[a, k] = 0.0
        for c in range(n):
            t = basis[rank + a, c]
            for k in range(n):
                half[a, k] += t * hessian[c, k]
        for b in range(a + 1):
            entry = 0.0
            for k in range(n):
                entry += half[a, k] * basis[rank + b, k]
            block[a, b] = entry


@compiled
def _reduce_coupling(problem: Problem, work: Workspace, i: int) -> None:
    """Fill Z_i H_(i,i-1) Z_(i-1)^T, H_(i,i-1) = -(stiffness diag(m) + 8 w (m dq)(m dq)^T)."""
    n = work.gradient.shape[1]
    here, before = work.basis[i], work.basis[i - 1]
    rank, rank_before = work.rank[i], work.rank[i - 1]
    stiffness, bend = work.stiffness[i - 1], 8.0 * problem.points.link_weight[i - 1]
    link, half, block = work.link[i - 1], work.half, work.coupling[i]
    for b in range(work.free[i - 1]):
        along = 0.0
        for k in range(n):
            along += link[k] * before[rank_before + b, k]
        for k in range(n):
            half[b, k] = -(
                stiffness * problem.metric[k] * before[rank_before + b, k] + bend * along * link[k]
            )
    for a in range(work.free[i]):
        for b in range(work.free[i - 1]):
            entry = 0.0
            for k in range(n):
                entry += here[rank + a, k] * half[b, k]
            block[a, b] = entry


@compiled
def factor_convex(work: Workspace, last_shift: float) -> float:
    """Factor the reduced Hessian plus the smallest tried shift that makes it positive definite.

    Only this factorisation is repeated: the null space is orthonormal, so a shift of the reduced
    blocks is a shift of the Hessian.

    Returns:
        The shift used (0 if none), or -1 if none was enough.
    """
    if block_cholesky(
        work.diagonal, work.coupling, work.free, 0.0, work.factor, work.below
    ):
        return 0.0
    first = last_shift == 0.0
    shift = _SHIFT_FIRST if first else max(_SHIFT_MIN, last_shift / _SHIFT_SHRINK)
    while shift < _SHIFT_MAX:
        if block_cholesky(
            work.diagonal, work.coupling, work.free, shift, work.factor, work.below
        ):
            return shift
        shift *= _SHIFT_GROW_FIRST if first else _SHIFT_GROW
    return -1.0


@compiled
def newton_step(problem: Problem, work: Workspace, step: Floats) -> None:
    """Fill step (k, n): it removes the residual in `work.target` and minimises the model."""
    count, n = step.shape
    t = work.row
    for i in range(count):
        triangle, rank = work.triangle[i], work.rank[i]
        for r in range(rank):
            rest = -work.target[i, work.kept[i, r]]
            for c in range(r):
                rest -= triangle[r, c] * t[c]
            t[r] = rest / triangle[r, r]
        for k in range(n):
            work.normal[i, k] = 0.0
        for r in range(rank):
            for k in range(n):
                work.normal[i, k] += t[r] * work.basis[i, r, k]
    hessian_times(problem, work, work.normal, work.product)
    for i in range(count):
        rank = work.rank[i]
        for a in range(work.free[i]):
            along = 0.0
            for k in range(n):
                slope = work.product[i, k] + work.barrier_gradient[i, k]
                along -= work.basis[i, rank + a, k] * slope
            work.reduced[i, a] = along
    block_solve(work.factor, work.below, work.free, work.reduced)
    for i in range(count):
        rank = work.rank[i]
        for k in range(n):
            step[i, k] = work.normal[i, k]
        for a in range(work.free[i]):
            length = work.reduced[i, a]
            for k in range(n):
                step[i, k] += length * work.basis[i, rank + a, k]


@compiled
def newton_multipliers(problem: Problem, work: Workspace, step: Floats) -> None:
    """Fill new_y (k, 6): T^T y = -B (grad + H dq); 0 for rows that were dropped."""
    count, n = step.shape
    hessian_times(problem, work, step, work.product)
    for i in range(count):
        triangle, rank = work.triangle[i], work.rank[i]
        work.new_y[i] = 0.0
        for r in range(rank - 1, -1, -1):
            rest = 0.0
            for k in range(n):
                slope = work.product[i, k] + work.barrier_gradient[i, k]
                rest -= work.basis[i, r, k] * slope
            for c in range(r + 1, rank):
                rest -= triangle[c, r] * work.new_y[i, work.kept[i, c]]
            work.new_y[i, work.kept[i, r]] = rest / triangle[r, r]


@compiled
def hessian_times(problem: Problem, work: Workspace, x: Floats, out: Floats) -> None:
    """Fill out (k, n) with the block tridiagonal Hessian times x (k, n)."""
    count, n = x.shape
    for i in range(count):
        hessian = work.hessian[i]
        for a in range(n):
            entry = 0.0
            for b in range(n):
                entry += hessian[a, b] * x[i, b]
            out[i, a] = entry
    for i in range(count - 1):
        link, stiffness, bend = work.link[i], work.stiffness[i], 8.0 * problem.points.link_weight[i]
        here, after = 0.0, 0.0
        for k in range(n):
            here += link[k] * x[i, k]
            after += link[k] * x[i + 1, k]
        for k in range(n):
            pull = stiffness * problem.metric[k]
            out[i, k] -= pull * x[i + 1, k] + bend * after * link[k]
            out[i + 1, k] -= pull * x[i, k] + bend * here * link[k]
