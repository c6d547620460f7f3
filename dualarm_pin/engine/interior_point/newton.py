"""The Newton step of the barrier problem, in the null space of every point's equality rows.

    [H  A^T] [dq   ]     [grad]
    [A   0 ] [y_new] = - [g   ]        H block tridiagonal, A block diagonal

With A_i = T_i B_i (triangle, basis of the row space) and Z_i the null space: dq = B^T t + Z^T r,
T t = -g, (Z H Z^T) r = -Z (grad + H B^T t), T^T y_new = -B (grad + H dq).
"""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.interior_point.linear_algebra import (
    block_cholesky,
    block_solve,
    orthonormal_basis,
)
from dualarm_pin.engine.interior_point.links import add_coupling
from dualarm_pin.engine.jit.compiled import compiled, inlined
from dualarm_pin.engine.workspace import Workspace
from dualarm_pin.problem import Problem

# The inertia rule and its numbers are those of Waechter and Biegler (2006), section 3.1, but for
# the smallest shift: the objective is scaled to about 1 here.
SHIFT_FIRST, SHIFT_MIN, SHIFT_MAX = 1e-4, 1e-12, 1e12
SHIFT_GROW_FIRST, SHIFT_GROW, SHIFT_SHRINK = 100.0, 8.0, 3.0


@compiled
def factor_system(problem: Problem, work: Workspace, last_shift: float) -> float:
    """Reduce the system at the current derivatives and factor it; return as `factor_convex`."""
    reduce_system(problem, work)
    return factor_convex(work, last_shift)


@inlined
def reduce_system(problem: Problem, work: Workspace) -> None:
    """Fill bases and reduced blocks at the current derivatives."""
    count, n = work.gradient.shape
    for i in range(count):
        work.rank[i] = orthonormal_basis(
            work.jacobian[i],
            problem.row_count[i],
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
        row, product = basis[rank + a], half[a]
        for k in range(n):
            product[k] = 0.0
        for c in range(n):
            t, line = row[c], hessian[c]
            for k in range(n):
                product[k] += t * line[k]
        for b in range(a + 1):
            other = basis[rank + b]
            entry = 0.0
            for k in range(n):
                entry += product[k] * other[k]
            block[a, b] = entry


@compiled
def _reduce_coupling(problem: Problem, work: Workspace, i: int) -> None:
    """Fill Z_i H_(i,i-1) Z_(i-1)^T."""
    n = work.gradient.shape[1]
    here, before = work.basis[i], work.basis[i - 1]
    rank, rank_before = work.rank[i], work.rank[i - 1]
    half, block, rows, columns = work.half, work.coupling[i], work.free[i], work.free[i - 1]
    for b in range(columns):
        half[b] = 0.0
        add_coupling(problem, work, i - 1, before[rank_before + b], half[b])
    for a in range(rows):
        row = here[rank + a]
        for b in range(columns):
            product = half[b]
            entry = 0.0
            for k in range(n):
                entry += row[k] * product[k]
            block[a, b] = entry


@inlined
def factor_convex(work: Workspace, last_shift: float) -> float:
    """Factor the reduced Hessian plus the smallest tried shift that makes it positive definite.

    Only this factorisation is repeated: the null space is orthonormal, so a shift of the reduced
    blocks is a shift of the Hessian.

    Returns:
        The shift used (0 if none), or -1 if none was enough.
    """
    if block_cholesky(work.diagonal, work.coupling, work.free, 0.0, work.factor, work.below):
        return 0.0
    first = last_shift == 0.0
    shift = SHIFT_FIRST if first else max(SHIFT_MIN, last_shift / SHIFT_SHRINK)
    while shift < SHIFT_MAX:
        if block_cholesky(work.diagonal, work.coupling, work.free, shift, work.factor, work.below):
            return shift
        shift *= SHIFT_GROW_FIRST if first else SHIFT_GROW
    return -1.0


@compiled
def newton_step(problem: Problem, work: Workspace, step: Floats) -> None:
    """Fill step (k, n): it removes the residual in `work.target` and minimises the model.

    The model's gradient is `work.pulled`; see `barrier.add_pull`.
    """
    count, n = step.shape
    basis, kept, free = work.basis, work.kept, work.free
    target, normal, reduced = work.target, work.normal, work.reduced
    slope, product = work.pulled, work.product
    t = work.row
    for i in range(count):
        triangle, rank = work.triangle[i], work.rank[i]
        for r in range(rank):
            rest = -target[i, kept[i, r]]
            for c in range(r):
                rest -= triangle[r, c] * t[c]
            t[r] = rest / triangle[r, r]
        for k in range(n):
            normal[i, k] = 0.0
        for r in range(rank):
            for k in range(n):
                normal[i, k] += t[r] * basis[i, r, k]
    hessian_times(problem, work, normal, product)
    for i in range(count):
        rank = work.rank[i]
        for a in range(free[i]):
            along = 0.0
            for k in range(n):
                along -= basis[i, rank + a, k] * (product[i, k] + slope[i, k])
            reduced[i, a] = along
    block_solve(work.factor, work.below, free, reduced)
    for i in range(count):
        rank = work.rank[i]
        for k in range(n):
            step[i, k] = normal[i, k]
        for a in range(free[i]):
            length = reduced[i, a]
            for k in range(n):
                step[i, k] += length * basis[i, rank + a, k]
        for k in problem.bounds.fixed:
            step[i, k] = 0.0  # not quite, after the mirrors


@compiled
def newton_multipliers(problem: Problem, work: Workspace, step: Floats) -> None:
    """Fill new_y (k, m): T^T y = -B (grad + H dq); 0 for rows that were dropped."""
    count, n = step.shape
    basis, kept, new_y = work.basis, work.kept, work.new_y
    slope, product = work.pulled, work.product
    hessian_times(problem, work, step, product)
    for i in range(count):
        triangle, rank = work.triangle[i], work.rank[i]
        new_y[i] = 0.0
        for r in range(rank - 1, -1, -1):
            rest = 0.0
            for k in range(n):
                rest -= basis[i, r, k] * (product[i, k] + slope[i, k])
            for c in range(r + 1, rank):
                rest -= triangle[c, r] * new_y[i, kept[i, c]]
            new_y[i, kept[i, r]] = rest / triangle[r, r]


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
        add_coupling(problem, work, i, x[i + 1], out[i])
        add_coupling(problem, work, i, x[i], out[i + 1])
