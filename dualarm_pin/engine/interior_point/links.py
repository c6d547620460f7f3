"""The links between neighbours: weight (dq^T diag(m) dq)^2, with all derivatives.

With the pull p = diag(m) dq and the stiffness s = 4 weight p . dq, the gradient by dq is s p and
the Hessian s diag(m) + 8 weight p p^T; with respect to the two points the signs follow from
dq = q_after - q_before.
"""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Workspace
from dualarm_pin.problem import Problem


@compiled
def links_value(problem: Problem, q: Floats) -> float:
    """Return what the links between the points of q (k, n) and to fixed neighbours cost."""
    links, ends, last = problem.links, problem.neighbours, q.shape[0] - 1
    total = 0.0
    for i in range(last):
        total += _value(links.weight[i], links.metric[i], q[i], q[i + 1])
    if ends.weight[0] != 0.0:
        total += _value(ends.weight[0], links.metric[0], ends.posture[0], q[0])
    if ends.weight[1] != 0.0:
        total += _value(ends.weight[1], links.metric[max(last - 1, 0)], q[last], ends.posture[1])
    return total


@compiled
def add_links(problem: Problem, work: Workspace, q: Floats) -> None:
    """Add the links to gradient and diagonal blocks; keep pull and stiffness of every link."""
    links, ends, last = problem.links, problem.neighbours, q.shape[0] - 1
    for i in range(last):
        metric = links.metric[i]
        stiffness = _pull(links.weight[i], metric, q[i], q[i + 1], work.link[i])
        work.stiffness[i] = stiffness
        _add(work, i, -1.0, links.weight[i], stiffness, work.link[i], metric)
        _add(work, i + 1, 1.0, links.weight[i], stiffness, work.link[i], metric)
    room = work.link[last]
    if ends.weight[0] != 0.0:
        metric = links.metric[0]
        stiffness = _pull(ends.weight[0], metric, ends.posture[0], q[0], room)
        _add(work, 0, 1.0, ends.weight[0], stiffness, room, metric)
    if ends.weight[1] != 0.0:
        metric = links.metric[max(last - 1, 0)]
        stiffness = _pull(ends.weight[1], metric, q[last], ends.posture[1], room)
        _add(work, last, -1.0, ends.weight[1], stiffness, room, metric)


@compiled
def add_coupling(problem: Problem, work: Workspace, i: int, x: Floats, out: Floats) -> None:
    """Add the Hessian block of points i and i + 1 times x (n,): it is symmetric."""
    link, stiffness = work.link[i], work.stiffness[i]
    metric = problem.links.metric[i]
    along = 0.0
    for k in range(x.shape[0]):
        along += link[k] * x[k]
    along *= 8.0 * problem.links.weight[i]
    for k in range(x.shape[0]):
        out[k] -= stiffness * metric[k] * x[k] + along * link[k]


@compiled
def _value(weight: float, metric: Floats, before: Floats, after: Floats) -> float:
    square = _square(metric, before, after)
    return weight * square * square


@compiled
def _square(metric: Floats, before: Floats, after: Floats) -> float:
    square = 0.0
    for k in range(metric.shape[0]):
        d = after[k] - before[k]
        square += metric[k] * d * d
    return square


@compiled
def _pull(weight: float, metric: Floats, before: Floats, after: Floats, link: Floats) -> float:
    """Fill the pull and return the stiffness.

    The sum has a loop of its own: beside a store the order in which it is summed, and with it the
    last digit, would depend on where the arrays lie in memory.
    """
    for k in range(metric.shape[0]):
        link[k] = metric[k] * (after[k] - before[k])
    return 4.0 * weight * _square(metric, before, after)


@compiled
def _add(
    work: Workspace,
    i: int,
    sign: float,
    weight: float,
    stiffness: float,
    link: Floats,
    metric: Floats,
) -> None:
    """Add a link to point i."""
    gradient, hessian = work.gradient[i], work.hessian[i]
    for k in range(metric.shape[0]):
        gradient[k] += sign * stiffness * link[k]
        line, bend = hessian[k], 8.0 * weight * link[k]
        line[k] += stiffness * metric[k]
        for c in range(metric.shape[0]):
            line[c] += bend * link[c]
