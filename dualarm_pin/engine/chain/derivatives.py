r"""Value, gradient and exact Hessian of index and pose constraint at one point.

Elements are numbered from e1 to e2. With p_j = v_j, every derivative of the position of e2 is a
nest of cross products in chain order, and the axes turn with the elements before them:

    d2 p / dq_j dq_l        = w_j x v_l                          (j <= l)
    d3 p / dq_i dq_j dq_l   = w_i x (w_j x v_l)                  (i <= j <= l)
    d w_l / dq_j            = w_j x w_l  (j < l),  0  (j >= l)

An index enters by b_e = d(value)/d(column e of J_r), six numbers [f_e; m_e]. With the running sums

    K_j = sum_{e<=j} w_e f_e^T - (w_e . f_e) I
    L_l = sum_{e>l}  v_e f_e^T + w_e m_e^T - (v_e . f_e + w_e . m_e) I

the gradient is g_j = sum_e b_e . dJ_e/dq_j in O(n), and the second derivatives contracted with b
are semi-separable, six multiplications an entry:

    sum_e b_e . d2J_e/dq_j dq_l = w_j . (L_l w_l - K_l v_l) + (K_j w_j) . v_l        (j <= l)

The pose constraint with multipliers y = [y_p; y_r] has the same shape, with t = B^T y_r / 2:

    y . d2g/dq_j dq_l = w_j . (v_l x y_p + w_l x t - (y_r . g_r) w_l / 4)            (j <= l)
"""

from __future__ import annotations

from dualarm_pin.chain import VARIABLE, Chain, Floats
from dualarm_pin.engine.chain.index_terms import index_terms, index_value
from dualarm_pin.engine.chain.kinematics import (
    constraint_jacobian,
    place_chain,
    place_segments,
    pose_residual,
    rotation_rows,
)
from dualarm_pin.engine.chain.row_terms import row_terms, row_values
from dualarm_pin.engine.chain.vectors import cross, dot
from dualarm_pin.engine.jit.compiled import compiled, inlined
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.problem import Problem


@compiled
def point_rows(
    problem: Problem,
    i: int,
    q: Floats,
    scratch: Scratch,
    residual: Floats,
    error: Floats,
    gap: Floats,
) -> None:
    """Fill the equality rows (m,) and the inequality rows (r,) of point i.

    The frames are left in the scratch and the error quaternion in `error` (4,).
    """
    p, Q = place_chain(problem.chain, q, scratch.w, scratch.v)
    points = problem.points
    pose_residual(p, Q, points.position[i], points.quaternion[i], residual, error)
    residual[points.pose_rows[i] :] = 0.0
    if problem.equalities.size[i] + problem.inequalities.size[i] > 0:
        place_segments(problem.chain, q, scratch.place)
        row_values(problem.equalities, i, scratch, residual[points.pose_rows[i] :])
        row_values(problem.inequalities, i, scratch, gap)


@compiled
def point_value(
    problem: Problem,
    i: int,
    q: Floats,
    scratch: Scratch,
    residual: Floats,
    error: Floats,
    gap: Floats,
) -> float:
    """Return the objective of point i without links; fill its rows as `point_rows` does."""
    point_rows(problem, i, q, scratch, residual, error, gap)
    value = 0.0 if problem.points.index_weight[i] == 0.0 else index_value(problem, i, scratch)
    total: float = 0.0
    for k in range(q.shape[0]):
        away = q[k] - problem.terms.centre[k]
        value += problem.terms.centre_weight[k] * away * away
        total += problem.points.linear[i, k] * q[k]
    return float(total + problem.points.index_weight[i] * value)


@inlined
def point_derivatives(
    problem: Problem,
    i: int,
    q: Floats,
    y: Floats,
    push: Floats,
    scratch: Scratch,
    residual: Floats,
    error: Floats,
    jacobian: Floats,
    row_jacobian: Floats,
    gradient: Floats,
    hessian: Floats,
) -> None:
    """Fill all derivatives of point i, whose frames are in the scratch.

    Args:
        problem: The problem.
        i: Point.
        q: (n,) posture.
        y: (m,) multipliers of the equality rows.
        push: (r,) multipliers of the inequality rows.
        scratch: Room.
        residual: (m,) at q.
        error: (4,) error quaternion at q.
        jacobian: (m, n) filled.
        row_jacobian: (r, n) filled.
        gradient: (n,) filled: of the objective without links.
        hessian: (n, n) filled: of the objective without links plus y . residual - push . g.
    """
    chain, w, v = problem.chain, scratch.w, scratch.v
    pose_rows = problem.points.pose_rows[i]
    rotation_rows(error, problem.points.target_axes[i], scratch.B)
    constraint_jacobian(chain, w, v, scratch.B, jacobian)
    index_terms(problem, i, scratch)
    index_sums(scratch, gradient, chain)
    add_constraint_factors(pose_rows, y, residual, scratch)
    fill_second(scratch)
    equal, unequal = problem.equalities.size[i], problem.inequalities.size[i]
    if equal + unequal > 0:
        place_segments(chain, q, scratch.place)
        for j in range(equal):
            at = pose_rows + j
            row_terms(problem.equalities, i, j, y[at], chain, scratch, jacobian[at])
        for j in range(unequal):
            row_terms(problem.inequalities, i, j, -push[j], chain, scratch, row_jacobian[j])
    by_variable(chain, scratch.second, hessian)
    weight = problem.points.index_weight[i]
    for k in range(q.shape[0]):
        slope = 2.0 * weight * problem.terms.centre_weight[k]
        gradient[k] += slope * (q[k] - problem.terms.centre[k]) + problem.points.linear[i, k]
        hessian[k, k] += slope


@compiled
def index_sums(scratch: Scratch, gradient: Floats, chain: Chain) -> None:
    """Fill the index's gradient (n,) and the factors alpha, beta (3, E) of its second derivatives.

    alpha_l = L_l w_l - K_l v_l and beta_j = K_j w_j, by running sums over the elements.
    """
    w, v, b = scratch.w, scratch.v, scratch.b
    alpha, beta = scratch.alpha, scratch.beta
    elements = w.shape[1]
    gradient[:] = 0.0
    k00 = k01 = k02 = k10 = k11 = k12 = k20 = k21 = k22 = 0.0
    for j in range(elements):
        wj = (w[0, j], w[1, j], w[2, j])
        vj = (v[0, j], v[1, j], v[2, j])
        f = (b[0, j], b[1, j], b[2, j])
        trace = dot(wj, f)
        k00 += wj[0] * f[0] - trace
        k01 += wj[0] * f[1]
        k02 += wj[0] * f[2]
        k10 += wj[1] * f[0]
        k11 += wj[1] * f[1] - trace
        k12 += wj[1] * f[2]
        k20 += wj[2] * f[0]
        k21 += wj[2] * f[1]
        k22 += wj[2] * f[2] - trace
        beta[0, j] = k00 * wj[0] + k01 * wj[1] + k02 * wj[2]
        beta[1, j] = k10 * wj[0] + k11 * wj[1] + k12 * wj[2]
        beta[2, j] = k20 * wj[0] + k21 * wj[1] + k22 * wj[2]
        alpha[0, j] = -(k00 * vj[0] + k01 * vj[1] + k02 * vj[2])
        alpha[1, j] = -(k10 * vj[0] + k11 * vj[1] + k12 * vj[2])
        alpha[2, j] = -(k20 * vj[0] + k21 * vj[1] + k22 * vj[2])
        # sum_{e<=j} f_e . (w_e x v_j); the antisymmetric part of K is sum f_e x w_e
        if chain.role[j] == VARIABLE:
            turned = (k21 - k12, k02 - k20, k10 - k01)
            gradient[chain.source[j]] += chain.scale[j] * dot(turned, vj)
    k00 = k01 = k02 = k10 = k11 = k12 = k20 = k21 = k22 = 0.0
    for j in range(elements - 1, -1, -1):
        wj = (w[0, j], w[1, j], w[2, j])
        vj = (v[0, j], v[1, j], v[2, j])
        alpha[0, j] += k00 * wj[0] + k01 * wj[1] + k02 * wj[2]
        alpha[1, j] += k10 * wj[0] + k11 * wj[1] + k12 * wj[2]
        alpha[2, j] += k20 * wj[0] + k21 * wj[1] + k22 * wj[2]
        # sum_{e>j} w_j . (v_e x f_e + w_e x m_e), the antisymmetric part of L
        if chain.role[j] == VARIABLE:
            turned = (k12 - k21, k20 - k02, k01 - k10)
            gradient[chain.source[j]] += chain.scale[j] * dot(turned, wj)
        f = (b[0, j], b[1, j], b[2, j])
        m = (b[3, j], b[4, j], b[5, j])
        trace = dot(vj, f) + dot(wj, m)
        k00 += vj[0] * f[0] + wj[0] * m[0] - trace
        k01 += vj[0] * f[1] + wj[0] * m[1]
        k02 += vj[0] * f[2] + wj[0] * m[2]
        k10 += vj[1] * f[0] + wj[1] * m[0]
        k11 += vj[1] * f[1] + wj[1] * m[1] - trace
        k12 += vj[1] * f[2] + wj[1] * m[2]
        k20 += vj[2] * f[0] + wj[2] * m[0]
        k21 += vj[2] * f[1] + wj[2] * m[1]
        k22 += vj[2] * f[2] + wj[2] * m[2] - trace


@compiled
def add_constraint_factors(rows: int, y: Floats, residual: Floats, scratch: Scratch) -> None:
    """Add v_l x y_p + w_l x t - (y_r . g_r) w_l / 4 to alpha_l, with t = B^T y_r / 2."""
    w, v, B, alpha = scratch.w, scratch.v, scratch.B, scratch.alpha
    y_p = (y[0], y[1], y[2])
    r0 = y[3] if rows > 3 else 0.0
    r1 = y[4] if rows > 4 else 0.0
    r2 = y[5] if rows > 5 else 0.0
    t = (
        0.5 * (B[0, 0] * r0 + B[1, 0] * r1 + B[2, 0] * r2),
        0.5 * (B[0, 1] * r0 + B[1, 1] * r1 + B[2, 1] * r2),
        0.5 * (B[0, 2] * r0 + B[1, 2] * r1 + B[2, 2] * r2),
    )
    stretch = 0.25 * (r0 * residual[3] + r1 * residual[4] + r2 * residual[5])
    for e in range(w.shape[1]):
        we = (w[0, e], w[1, e], w[2, e])
        linear = cross((v[0, e], v[1, e], v[2, e]), y_p)
        angular = cross(we, t)
        for c in range(3):
            alpha[c, e] += linear[c] + angular[c] - stretch * we[c]


@compiled
def fill_second(scratch: Scratch) -> None:
    """Add w_j . alpha_l + beta_j . v_l to the upper triangle of the second derivatives (E, E)."""
    w, v, alpha, beta = scratch.w, scratch.v, scratch.alpha, scratch.beta
    second = scratch.second
    elements = w.shape[1]
    for j in range(elements):
        w0, w1, w2 = w[0, j], w[1, j], w[2, j]
        b0, b1, b2 = beta[0, j], beta[1, j], beta[2, j]
        for e in range(j, elements):
            second[j, e] += (
                w0 * alpha[0, e]
                + w1 * alpha[1, e]
                + w2 * alpha[2, e]
                + b0 * v[0, e]
                + b1 * v[1, e]
                + b2 * v[2, e]
            )


@compiled
def by_variable(chain: Chain, second: Floats, hessian: Floats) -> None:
    """Fill the symmetric Hessian (n, n) by variables from the upper triangle by elements."""
    hessian[:] = 0.0
    elements = chain.kind.shape[0]
    for j in range(elements):
        if chain.role[j] != VARIABLE:
            continue
        row, scale = chain.source[j], chain.scale[j]
        hessian[row, row] += scale * scale * second[j, j]
        for e in range(j + 1, elements):
            if chain.role[e] == VARIABLE:
                entry = scale * chain.scale[e] * second[j, e]
                hessian[row, chain.source[e]] += entry
                hessian[chain.source[e], row] += entry
