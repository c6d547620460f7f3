"""An index with a kernel: its second-order model in A, carried to the joints.

With the vectors f_a of the model (see `engine.kernels`) the index is to the engine a sum of
force-like terms g_a sum_k W_k along_ak^2, along_a = f_a . J_r, and a quadratic form in

    D_ab = f_a . dA_j f_b = f_a . M_bj + f_b . M_aj,    M_bj = sum_e dJ_e/dq_j c_eb

for every element j, with c_eb = scale_e W_k along_bk. By running sums over the elements M_bj is

    [w_j x sum_{e>=j} v_e c_eb - v_j x sum_{e<j} w_e c_eb;  w_j x sum_{e>j} w_e c_eb]
"""

from __future__ import annotations

from dualarm_pin.chain import VARIABLE, Floats
from dualarm_pin.engine.chain.directions import (
    add_direction,
    add_squares,
    halves,
    projected_columns,
    projected_slopes,
)
from dualarm_pin.engine.chain.vectors import cross
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.kernels.layout import BASIS, BOTH, PAIR, SLOPE
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.problem import Problem


@compiled
def add_modelled(problem: Problem, i: int, scratch: Scratch) -> None:
    """Add b_e and the Hessian part of the index whose model is filled."""
    weight, W = problem.points.index_weight[i], problem.terms.joint_weights
    model, along = scratch.model, scratch.along
    for a in range(6):
        f, m = halves(problem, model[BASIS + a])
        projected_columns(problem, f, m, scratch, along[a])
        g = model[SLOPE, a]
        if g != 0.0:
            add_direction(problem, f, m, weight * g, along[a], scratch)
            projected_slopes(problem, f, m, scratch, scratch.slope)
            add_squares(2.0 * weight * g, W, scratch.slope, scratch.second)
        _fill_moments(problem, scratch, along[a], scratch.moments[a])
    for a in range(6):
        _fill_change(problem, scratch, a, a, scratch.own[a])
        for b in range(a + 1, 6):
            if model[PAIR + a, b] != 0.0:
                _fill_change(problem, scratch, a, b, scratch.change)
                pair = weight * model[PAIR + a, b]
                _add_product(pair, scratch.change, scratch.change, scratch.second)
    for a in range(6):
        _add_own(weight, scratch, a)


@compiled
def _fill_moments(problem: Problem, scratch: Scratch, along: Floats, moments: Floats) -> None:
    """Fill M_b (6, E) of one vector of the model."""
    chain, W, w, v = problem.chain, problem.terms.joint_weights, scratch.w, scratch.v
    elements, c = w.shape[1], scratch.change
    for e in range(elements):
        c[e] = 0.0
        if chain.role[e] == VARIABLE:
            k = chain.source[e]
            c[e] = chain.scale[e] * W[k] * along[k]
    p0 = p1 = p2 = r0 = r1 = r2 = 0.0
    for j in range(elements - 1, -1, -1):
        x, y, z = w[0, j], w[1, j], w[2, j]
        p0, p1, p2 = p0 + c[j] * v[0, j], p1 + c[j] * v[1, j], p2 + c[j] * v[2, j]
        linear, angular = cross((x, y, z), (p0, p1, p2)), cross((x, y, z), (r0, r1, r2))
        for i in range(3):
            moments[i, j], moments[3 + i, j] = linear[i], angular[i]
        r0, r1, r2 = r0 + c[j] * x, r1 + c[j] * y, r2 + c[j] * z
    r0 = r1 = r2 = 0.0
    for j in range(elements):
        turned = cross((v[0, j], v[1, j], v[2, j]), (r0, r1, r2))
        for i in range(3):
            moments[i, j] -= turned[i]
        r0, r1, r2 = r0 + c[j] * w[0, j], r1 + c[j] * w[1, j], r2 + c[j] * w[2, j]


@compiled
def _fill_change(problem: Problem, scratch: Scratch, a: int, b: int, change: Floats) -> None:
    """Fill D_ab (E,)."""
    left, right = scratch.moments[a], scratch.moments[b]
    f, m = halves(problem, scratch.model[BASIS + a])
    g, h = halves(problem, scratch.model[BASIS + b])
    for j in range(change.shape[0]):
        entry = f[0] * right[0, j] + f[1] * right[1, j] + f[2] * right[2, j]
        entry += m[0] * right[3, j] + m[1] * right[4, j] + m[2] * right[5, j]
        entry += g[0] * left[0, j] + g[1] * left[1, j] + g[2] * left[2, j]
        entry += h[0] * left[3, j] + h[1] * left[4, j] + h[2] * left[5, j]
        change[j] = entry


@compiled
def _add_own(weight: float, scratch: Scratch, a: int) -> None:
    """Add D_aa (pair_aa D_aa + sum_b both_ab D_bb) to the upper triangle."""
    model, own, change = scratch.model, scratch.own, scratch.change
    change[:] = 0.0
    some = False
    for b in range(6):
        factor = model[BOTH + a, b] + (model[PAIR + a, a] if a == b else 0.0)
        if factor != 0.0:
            some = True
            for j in range(change.shape[0]):
                change[j] += factor * own[b, j]
    if some:
        _add_product(weight, own[a], change, scratch.second)


@compiled
def _add_product(factor: float, left: Floats, right: Floats, second: Floats) -> None:
    """Add factor left_j right_l to the upper triangle."""
    for j in range(left.shape[0]):
        part = factor * left[j]
        line = second[j]
        for e in range(j, right.shape[0]):
            line[e] += part * right[e]
