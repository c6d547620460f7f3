"""An index of the user's own, by the addresses of its functions: phi, dphi/dA and its change."""

from __future__ import annotations

from dualarm_pin.chain import VARIABLE, Chain, Floats
from dualarm_pin.engine.chain.directions import task_matrix
from dualarm_pin.engine.chain.vectors import cross
from dualarm_pin.engine.jit.address import call_address
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.problem import Problem


@compiled
def called(problem: Problem, i: int, scratch: Scratch, wanted: bool) -> float:
    """Return phi(A, u), or where `wanted` add b_e and the Hessian part and return 0."""
    task_matrix(problem, scratch)
    A = scratch.A.ctypes.data
    if wanted:
        _add_terms(problem, i, scratch)
        return 0.0
    call_address(
        scratch.index_calls[0], A, problem.points.u[i].ctypes.data, A, scratch.value.ctypes.data
    )
    return float(scratch.value[0])


@compiled
def _add_terms(problem: Problem, i: int, scratch: Scratch) -> None:
    """Add b_e and the Hessian part for c = phi(A, u), with G = dphi/dA.

    dc = tr(G dA), dA_j = dJ_j W J^T + J W dJ_j^T, so b_e = 2 W_k s_e G J_k and the part left is
    tr(dA_j dG[dA_l]) + 2 sum_k W_k dJ_k/dq_j . G dJ_k/dq_l.
    """
    chain, weight = problem.chain, problem.points.index_weight[i]
    W, G, J_r, u = problem.terms.joint_weights, scratch.G, scratch.J_r, problem.points.u[i]
    b, s = scratch.b, problem.terms.task_scale
    A = scratch.A.ctypes.data
    call_address(scratch.index_calls[1], A, u.ctypes.data, A, G.ctypes.data)
    for e in range(chain.kind.shape[0]):
        if chain.role[e] == VARIABLE:
            k = chain.source[e]
            for r in range(6):
                along = 0.0
                for c in range(6):
                    along += G[r, c] * J_r[c, k]
                b[r, e] += 2.0 * weight * W[k] * chain.scale[e] * s[r] * along
    _jacobian_slopes(chain, s, scratch)
    _task_matrix_slopes(W, scratch)
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
