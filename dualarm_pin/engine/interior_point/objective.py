"""The objective of the whole path: points and links, with all derivatives."""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.chain.derivatives import point_derivatives, point_value
from dualarm_pin.engine.interior_point.links import add_links, links_value
from dualarm_pin.engine.jit.compiled import compiled, copy_rows
from dualarm_pin.engine.workspace import Iterate, Workspace
from dualarm_pin.problem import Problem


@compiled
def objective(problem: Problem, work: Workspace, q: Floats, residual: Floats, gap: Floats) -> float:
    """Return f(q), fill the rows (k, m) and (k, r) and keep the frames for `all_derivatives`."""
    count = q.shape[0]
    scratch = work.scratch
    total = 0.0
    for i in range(count):
        total += point_value(problem, i, q[i], scratch, residual[i], work.error[i], gap[i])
        copy_rows(scratch.w, work.axes[i])
        copy_rows(scratch.v, work.columns[i])
    return total + links_value(problem, q)


@compiled
def all_derivatives(problem: Problem, work: Workspace, at: Iterate) -> None:
    """Fill jacobians, gradient and the Hessian's diagonal blocks.

    The posture must be the one that `objective` evaluated last, with its rows in `work`.
    """
    count, q = at.q.shape[0], at.q
    for i in range(count):
        copy_rows(work.axes[i], work.scratch.w)
        copy_rows(work.columns[i], work.scratch.v)
        point_derivatives(
            problem,
            i,
            q[i],
            at.y[i],
            at.push[i],
            work.scratch,
            work.residual[i],
            work.error[i],
            work.jacobian[i],
            work.row_jacobian[i],
            work.gradient[i],
            work.hessian[i],
        )
    _freeze(problem, work)
    add_links(problem, work, q)
    for i in range(count):
        for k in problem.bounds.fixed:
            work.gradient[i, k] = 0.0


@compiled
def _freeze(problem: Problem, work: Workspace) -> None:
    """Cut fixed variables off, so that no step ever moves them."""
    for i in range(work.gradient.shape[0]):
        for k in problem.bounds.fixed:
            for r in range(work.jacobian.shape[1]):
                work.jacobian[i, r, k] = 0.0
            for r in range(work.row_jacobian.shape[1]):
                work.row_jacobian[i, r, k] = 0.0
            for c in range(work.hessian.shape[1]):
                work.hessian[i, k, c] = 0.0
                work.hessian[i, c, k] = 0.0
            work.hessian[i, k, k] = 1.0
