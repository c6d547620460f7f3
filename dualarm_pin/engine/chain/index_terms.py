"""What an index contributes at one point: value, b_e = d(value)/dJ_e, the rest of its Hessian.

The Hessian of an index is sum_e b_e . d2J_e (done in `derivatives` for every index alike) plus the
part in which b itself changes; that part is filled here, by elements, upper triangle.
"""

from __future__ import annotations

from dualarm_pin.engine.chain.directions import (
    add_direction,
    add_squares,
    halves,
    projected_columns,
    projected_slopes,
)
from dualarm_pin.engine.jit.address import call_point
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.problem import FORCE, Problem


@compiled
def index_value(problem: Problem, i: int, scratch: Scratch) -> float:
    """Return the index at point i, without its weight."""
    if problem.terms.kind == FORCE:
        return float(force_value(problem, i, scratch))
    return float(call_point(scratch.index_call[0], problem, i, scratch, False))


@compiled
def index_terms(problem: Problem, i: int, scratch: Scratch) -> None:
    """Fill b_e and the Hessian part of the weighted index at point i."""
    scratch.b[:] = 0.0
    scratch.second[:] = 0.0
    if problem.points.index_weight[i] == 0.0:
        return  # not zero times the index: an index of the user's own may be infinite here
    if problem.terms.kind == FORCE:
        force_terms(problem, i, scratch)
    else:
        call_point(scratch.index_call[0], problem, i, scratch, True)


@compiled
def force_value(problem: Problem, i: int, scratch: Scratch) -> float:
    """Return c = u^T Wt^(1/2) J W J^T Wt^(1/2) u = sum_k W_k a_k^2 (eq. 14)."""
    f, m = halves(problem, problem.points.u[i])
    projected_columns(problem, f, m, scratch, scratch.a)
    value = 0.0
    for k in range(scratch.a.shape[0]):
        value += problem.terms.joint_weights[k] * scratch.a[k] * scratch.a[k]
    return value


@compiled
def force_terms(problem: Problem, i: int, scratch: Scratch) -> None:
    """Fill b_e = 2 W_k s_e a_k Wt^(1/2) u and the Hessian part 2 sum_k W_k da_k/dq_j da_k/dq_l."""
    weight = problem.points.index_weight[i]
    f, m = halves(problem, problem.points.u[i])
    projected_columns(problem, f, m, scratch, scratch.a)
    add_direction(problem, f, m, weight, scratch.a, scratch)
    projected_slopes(problem, f, m, scratch, scratch.slope)
    add_squares(2.0 * weight, problem.terms.joint_weights, scratch.slope, scratch.second)
