"""What an index contributes at one point: value, b_e = d(value)/dJ_e, the rest of its Hessian.

The Hessian of an index is sum_e b_e . d2J_e (done in `derivatives` for every index alike) plus the
part in which b itself changes; that part is filled here, by elements, upper triangle.
"""

from __future__ import annotations

from dualarm_pin.chain import VARIABLE, Chain, Floats
from dualarm_pin.engine.chain.kinematics import relative_jacobian
from dualarm_pin.engine.chain.vectors import cross, dot
from dualarm_pin.engine.jit.address import call_address
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.problem import Problem


@compiled
def projected_columns(problem: Problem, i: int, scratch: Scratch) -> None:
    """Fill a (n,): a_k = (Wt^(1/2) u) . J_k, summed over the elements of variable k."""
    chain, w, v, a = problem.chain, scratch.w, scratch.v, scratch.a
    s, u = problem.terms.task_scale, problem.points.u[i]
    f = (s[0] * u[0], s[1] * u[1], s[2] * u[2])
    m = (s[3] * u[3], s[4] * u[4], s[5] * u[5])
    a[:] = 0.0
    for e in range(w.shape[1]):
        if chain.role[e] == VARIABLE:
            along = dot(f, (v[0, e], v[1, e], v[2, e])) + dot(m, (w[0, e], w[1, e], w[2, e]))
            a[chain.source[e]] += chain.scale[e] * along


@compiled
def force_value(problem: Problem, i: int, scratch: Scratch) -> float:
    """Return c = u^T Wt^(1/2) J W J^T Wt^(1/2) u = sum_k W_k a_k^2 (eq. 14)."""
    projected_columns(problem, i, scratch)
    value = 0.0
    for k in range(scratch.a.shape[0]):
        value += problem.terms.joint_weights[k] * scratch.a[k] * scratch.a[k]
    return value


@compiled
def force_terms(problem: Problem, i: int, scratch: Scratch) -> None:
    """Fill b_e = 2 W_k s_e a_k Wt^(1/2) u and the Hessian part 2 sum_k W_k da_k/dq_j da_k/dq_l."""
    chain, weight = problem.chain, problem.points.index_weight[i]
    projected_columns(problem, i, scratch)
    s, u, b = problem.terms.task_scale, problem.points.u[i], scratch.b
    for e in range(chain.kind.shape[0]):
        factor = 0.0
        if chain.role[e] == VARIABLE:
            k = chain.source[e]
            factor = 2.0 * weight * problem.terms.joint_weights[k] * chain.scale[e] * scratch.a[k]
        for c in range(6):
            b[c, e] = factor * s[c] * u[c]
    _slopes(problem, i, scratch)
    _fill_squares(2.0 * weight, problem.terms.joint_weights, scratch.slope, scratch.second)


@compiled
def _slopes(problem: Problem, i: int, scratch: Scratch) -> None:
    """Fill slope (E, n) = da_k/dq_j: f . (w_min x v_max), and m . (w_j x w_e) for j < e."""
    chain, w, v, C = problem.chain, scratch.w, scratch.v, scratch.chain_slope
    s, u = problem.terms.task_scale, problem.points.u[i]
    f = (s[0] * u[0], s[1] * u[1], s[2] * u[2])
    m = (s[3] * u[3], s[4] * u[4], s[5] * u[5])
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
    slope = scratch.slope
    for j in range(elements):
        for k in range(slope.shape[1]):
            slope[j, k] = 0.0
        for e in range(elements):
            if chain.role[e] == VARIABLE:
                slope[j, chain.source[e]] += chain.scale[e] * C[e, j]


@compiled
def _fill_squares(factor: float, weights: Floats, slope: Floats, second: Floats) -> None:
    """Fill the upper triangle with factor sum_k weights_k slope_jk slope_lk."""
    for e in range(slope.shape[0]):
        right = slope[e]
        for j in range(e + 1):
            left = slope[j]
            entry = 0.0
            for k in range(weights.shape[0]):
                entry += weights[k] * left[k] * right[k]
            second[j, e] = factor * entry


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


@compiled
def called_value(problem: Problem, i: int, scratch: Scratch) -> float:
    """Return phi(A, u)."""
    task_matrix(problem, scratch)
    A = scratch.A.ctypes.data
    call_address(
        scratch.index_calls[0], A, problem.points.u[i].ctypes.data, A, scratch.value.ctypes.data
    )
    return float(scratch.value[0])


@compiled
def called_terms(problem: Problem, i: int, scratch: Scratch) -> None:
    """Fill b_e and the Hessian part for c = phi(A, u), with G = dphi/dA.

    dc = tr(G dA), dA_j = dJ_j W J^T + J W dJ_j^T, so b_e = 2 W_k s_e G J_k and the part left is
    tr(dA_j dG[dA_l]) + 2 sum_k W_k dJ_k/dq_j . G dJ_k/dq_l.
    """
    chain, weight = problem.chain, problem.points.index_weight[i]
    W, G, J_r, u = problem.terms.joint_weights, scratch.G, scratch.J_r, problem.points.u[i]
    b, s = scratch.b, problem.terms.task_scale
    task_matrix(problem, scratch)
    A = scratch.A.ctypes.data
    call_address(scratch.index_calls[1], A, u.ctypes.data, A, G.ctypes.data)
    for e in range(chain.kind.shape[0]):
        b[:, e] = 0.0
        if chain.role[e] == VARIABLE:
            k = chain.source[e]
            for r in range(6):
                along = 0.0
                for c in range(6):
                    along += G[r, c] * J_r[c, k]
                b[r, e] = 2.0 * weight * W[k] * chain.scale[e] * s[r] * along
    _jacobian_slopes(chain, s, scratch)
    _task_matrix_slopes(W, scratch)
    scratch.second[:] = 0.0
    _add_curvature(problem, i, weight, scratch)


@compiled
def _jacobian_slopes(chain: Chain, task_scale: Floats, scratch: Scratch) -> None:
    """Fill dJ (E, 6, n): derivative of the scaled J_r by every element."""
    w, v, dJ = scratch.w, scratch.v, scratch.dJ
    elements = w.shape[1]
    dJ[:] = 0.0
    for e in range(elements):
        if chain.role[e] != VARIABLE:
            continue
        k, scale = chain.source[e], chain.scale[e]
        for j in range(elements):
            first, last = min(j, e), max(j, e)
            wf = (w[0, first], w[1, first], w[2, first])
            linear = cross(wf, (v[0, last], v[1, last], v[2, last]))
            for c in range(3):
                dJ[j, c, k] += scale * task_scale[c] * linear[c]
            if j < e:
                angular = cross(wf, (w[0, e], w[1, e], w[2, e]))
                for c in range(3):
                    dJ[j, 3 + c, k] += scale * task_scale[3 + c] * angular[c]


@compiled
def _task_matrix_slopes(W: Floats, scratch: Scratch) -> None:
    """Fill dA_j = dJ_j W J^T + its transpose, (E, 6, 6)."""
    J_r, dJ, dA = scratch.J_r, scratch.dJ, scratch.dA
    for j in range(dA.shape[0]):
        for r in range(6):
            for c in range(6):
                entry = 0.0
                for k in range(J_r.shape[1]):
                    entry += W[k] * dJ[j, r, k] * J_r[c, k]
                dA[j, r, c] = entry
        for r in range(6):
            for c in range(r, 6):
                entry = dA[j, r, c] + dA[j, c, r]
                dA[j, r, c] = entry
                dA[j, c, r] = entry


@compiled
def _add_curvature(problem: Problem, i: int, weight: float, scratch: Scratch) -> None:
    """Add tr(dA_j dG[dA_l]) + 2 sum_k W_k dJ_k/dq_j . G dJ_k/dq_l to the upper triangle."""
    W, A, G, dG, GdJ = problem.terms.joint_weights, scratch.A, scratch.G, scratch.dG, scratch.GdJ
    dJ, dA, second = scratch.dJ, scratch.dA, scratch.second
    n = dJ.shape[2]
    for e in range(dA.shape[0]):
        call_address(
            scratch.index_calls[2],
            A.ctypes.data,
            problem.points.u[i].ctypes.data,
            dA[e].ctypes.data,
            dG.ctypes.data,
        )
        for r in range(6):
            for k in range(n):
                along = 0.0
                for c in range(6):
                    along += G[r, c] * dJ[e, c, k]
                GdJ[r, k] = 2.0 * W[k] * along
        for j in range(e + 1):
            entry = 0.0
            for r in range(6):
                for c in range(6):
                    entry += dA[j, r, c] * dG[r, c]
                for k in range(n):
                    entry += dJ[j, r, k] * GdJ[r, k]
            second[j, e] += weight * entry
