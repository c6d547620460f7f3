"""An index with a kernel: its second-order model in A, carried to the joints.

With the vectors f_a of the model (see `engine.kernels`) and along_a = f_a . J_r, whose derivative
by element j is slope_a,j, all that is needed of dA_j is

    D_ab,j = f_a . dA_j f_b = sum_k W_k (slope_a,jk along_b,k + along_a,k slope_b,jk)

so the index is to the engine a sum of force-like terms g_a sum_k W_k along_ak^2, and squares of D.
"""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.chain.directions import (
    add_direction,
    add_squares,
    halves,
    projected_columns,
    projected_slopes,
)
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.kernels.layout import BASIS, BOTH, PAIR, SLOPE
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.problem import Problem


@compiled
def add_modelled(problem: Problem, i: int, scratch: Scratch) -> None:
    """Add b_e and the Hessian part of the index whose model is filled."""
    model, slopes, along = scratch.model, scratch.slopes, scratch.along
    weight, W = problem.points.index_weight[i], problem.terms.joint_weights
    for a in range(6):
        f, m = halves(problem, model[BASIS + a])
        projected_columns(problem, f, m, scratch, along[a])
        projected_slopes(problem, f, m, scratch, slopes[a])
        g = model[SLOPE, a]
        if g != 0.0:
            add_direction(problem, f, m, weight * g, along[a], scratch)
            add_squares(2.0 * weight * g, W, slopes[a], scratch.second)
    for a in range(6):
        for k in range(W.shape[0]):
            along[a, k] *= W[k]
    for a in range(6):
        _change(a, a, slopes, along, scratch.own[a])
        _add_product(weight * model[PAIR + a, a], scratch.own[a], scratch.own[a], scratch.second)
        for b in range(a + 1, 6):
            if model[PAIR + a, b] != 0.0:
                _change(a, b, slopes, along, scratch.change)
                pair = weight * model[PAIR + a, b]
                _add_product(pair, scratch.change, scratch.change, scratch.second)
    for a in range(6):
        if model[BOTH + a, a] != 0.0:
            scratch.change[:] = 0.0
            for b in range(6):
                for j in range(scratch.change.shape[0]):
                    scratch.change[j] += model[BOTH + a, b] * scratch.own[b, j]
            _add_product(weight, scratch.own[a], scratch.change, scratch.second)


@compiled
def _change(a: int, b: int, slopes: Floats, weighted: Floats, change: Floats) -> None:
    """Fill D_ab (E,)."""
    for j in range(change.shape[0]):
        left, right = slopes[a, j], slopes[b, j]
        entry = 0.0
        for k in range(left.shape[0]):
            entry += left[k] * weighted[b, k] + right[k] * weighted[a, k]
        change[j] = entry


@compiled
def _add_product(factor: float, left: Floats, right: Floats, second: Floats) -> None:
    """Add factor left_j right_l to the upper triangle."""
    for j in range(left.shape[0]):
        part = factor * left[j]
        for e in range(j, right.shape[0]):
            second[j, e] += part * right[e]
