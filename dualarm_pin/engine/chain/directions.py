"""The weighted J_r along a direction of the task space, and A = J_r W J_r^T."""

from __future__ import annotations

from dualarm_pin.chain import VARIABLE, Floats
from dualarm_pin.engine.chain.kinematics import relative_jacobian
from dualarm_pin.engine.chain.vectors import Vector, cross, dot
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.problem import Problem


@compiled
def halves(problem: Problem, direction: Floats) -> tuple[Vector, Vector]:
    """Return Wt^(1/2) f of a direction f (6,): what meets linear, and what meets angular rows."""
    s, f = problem.terms.task_scale, direction
    return (s[0] * f[0], s[1] * f[1], s[2] * f[2]), (s[3] * f[3], s[4] * f[4], s[5] * f[5])


@compiled
def projected_columns(
    problem: Problem, f: Vector, m: Vector, scratch: Scratch, along: Floats
) -> None:
    """Fill along (n,): [f; m] . J_k, summed over the elements of variable k."""
    chain, w, v = problem.chain, scratch.w, scratch.v
    along[:] = 0.0
    for e in range(w.shape[1]):
        if chain.role[e] == VARIABLE:
            part = dot(f, (v[0, e], v[1, e], v[2, e])) + dot(m, (w[0, e], w[1, e], w[2, e]))
            along[chain.source[e]] += chain.scale[e] * part


@compiled
def projected_slopes(
    problem: Problem, f: Vector, m: Vector, scratch: Scratch, slope: Floats
) -> None:
    """Fill slope (E, n): [f; m] . dJ_k/dq_j = f . (w_min x v_max) + m . (w_j x w_e) for j < e."""
    chain, w, v, C = problem.chain, scratch.w, scratch.v, scratch.chain_slope
    elements = w.shape[1]
    turning = m[0] != 0.0 or m[1] != 0.0 or m[2] != 0.0
    for j in range(elements):
        g = cross(f, (w[0, j], w[1, j], w[2, j]))
        for e in range(j, elements):
            C[j, e] = g[0] * v[0, e] + g[1] * v[1, e] + g[2] * v[2, e]
    for j in range(elements):
        for e in range(j):
            C[j, e] = C[e, j]
    if turning:
        for j in range(elements):
            g = cross(m, (w[0, j], w[1, j], w[2, j]))
            for e in range(j + 1, elements):
                C[e, j] += g[0] * w[0, e] + g[1] * w[1, e] + g[2] * w[2, e]
    for j in range(elements):
        for k in range(slope.shape[1]):
            slope[j, k] = 0.0
        for e in range(elements):
            if chain.role[e] == VARIABLE:
                slope[j, chain.source[e]] += chain.scale[e] * C[e, j]


@compiled
def add_squares(factor: float, weights: Floats, slope: Floats, second: Floats) -> None:
    """Add factor sum_k weights_k slope_jk slope_lk to the upper triangle (E, E)."""
    for e in range(slope.shape[0]):
        right = slope[e]
        for j in range(e + 1):
            left = slope[j]
            entry = 0.0
            for k in range(weights.shape[0]):
                entry += weights[k] * left[k] * right[k]
            second[j, e] += factor * entry


@compiled
def add_direction(
    problem: Problem, f: Vector, m: Vector, factor: float, along: Floats, scratch: Scratch
) -> None:
    """Add b_e of the term factor sum_k W_k along_k^2, along = [f; m] . J_r."""
    chain, b, W = problem.chain, scratch.b, problem.terms.joint_weights
    for e in range(chain.kind.shape[0]):
        if chain.role[e] != VARIABLE:
            continue
        k = chain.source[e]
        part = 2.0 * factor * W[k] * chain.scale[e] * along[k]
        for c in range(3):
            b[c, e] += part * f[c]
            b[3 + c, e] += part * m[c]


@compiled
def task_matrix(problem: Problem, scratch: Scratch) -> None:
    """Fill J_r (6, n) with scaled rows, and A = J_r W J_r^T (6, 6)."""
    J_r, A = scratch.J_r, scratch.A
    relative_jacobian(problem.chain, scratch.w, scratch.v, J_r)
    for r in range(6):
        for k in range(J_r.shape[1]):
            J_r[r, k] *= problem.terms.task_scale[r]
    for r in range(6):
        for c in range(r, 6):
            entry = 0.0
            for k in range(J_r.shape[1]):
                entry += problem.terms.joint_weights[k] * J_r[r, k] * J_r[c, k]
            A[r, c] = entry
            A[c, r] = entry
