"""The objective of the whole path: points and links, with all derivatives."""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.chain.derivatives import point_derivatives, point_value
from dualarm_pin.engine.jit.compiled import compiled, copy_rows, inlined
from dualarm_pin.engine.workspace import Iterate, Workspace
from dualarm_pin.problem import Problem


@compiled
def link_value(weight: float, metric: Floats, before: Floats, after: Floats) -> float:
    """Return weight (dq^T diag(metric) dq)^2."""
    square = 0.0
    for k in range(metric.shape[0]):
        d = after[k] - before[k]
        square += metric[k] * d * d
    return weight * square * square


@compiled
def objective(problem: Problem, work: Workspace, q: Floats, residual: Floats, gap: Floats) -> float:
    """Return f(q), fill the rows (k, m) and (k, r) and keep the frames for `all_derivatives`."""
    count = q.shape[0]
    scratch, links, ends = work.scratch, problem.links, problem.neighbours
    total = 0.0
    for i in range(count):
        total += point_value(problem, i, q[i], scratch, residual[i], work.error[i], gap[i])
        copy_rows(scratch.w, work.axes[i])
        copy_rows(scratch.v, work.columns[i])
    for i in range(count - 1):
        total += link_value(links.weight[i], links.metric, q[i], q[i + 1])
    if ends.weight[0] != 0.0:
        total += link_value(ends.weight[0], links.metric, ends.posture[0], q[0])
    if ends.weight[1] != 0.0:
        total += link_value(ends.weight[1], links.metric, q[count - 1], ends.posture[1])
    return total


@inlined
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
    links, ends, last = problem.links, problem.neighbours, count - 1
    for i in range(last):
        work.stiffness[i] = _link_terms(links.weight[i], links.metric, q[i], q[i + 1], work.link[i])
        _add_link(work, i, -1.0, links.weight[i], work.stiffness[i], work.link[i], links.metric)
        _add_link(work, i + 1, 1.0, links.weight[i], work.stiffness[i], work.link[i], links.metric)
    room = work.link[last]
    if ends.weight[0] != 0.0:
        stiffness = _link_terms(ends.weight[0], links.metric, ends.posture[0], q[0], room)
        _add_link(work, 0, 1.0, ends.weight[0], stiffness, room, links.metric)
    if ends.weight[1] != 0.0:
        stiffness = _link_terms(ends.weight[1], links.metric, q[last], ends.posture[1], room)
        _add_link(work, last, -1.0, ends.weight[1], stiffness, room, links.metric)
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


@compiled
def _link_terms(
    weight: float, metric: Floats, before: Floats, after: Floats, link: Floats
) -> float:
    """Fill link = diag(metric) dq and return the stiffness 4 weight dq^T diag(metric) dq."""
    square = 0.0
    for k in range(metric.shape[0]):
        d = after[k] - before[k]
        link[k] = metric[k] * d
        square += link[k] * d
    return 4.0 * weight * square


@compiled
def _add_link(
    work: Workspace,
    i: int,
    sign: float,
    weight: float,
    stiffness: float,
    link: Floats,
    metric: Floats,
) -> None:
    """Add a link to point i: stiffness m dq, and stiffness diag(m) + 8 w (m dq)(m dq)^T."""
    gradient, hessian = work.gradient[i], work.hessian[i]
    for k in range(metric.shape[0]):
        gradient[k] += sign * stiffness * link[k]
        line, bend = hessian[k], 8.0 * weight * link[k]
        line[k] += stiffness * metric[k]
        for c in range(metric.shape[0]):
            line[c] += bend * link[c]
