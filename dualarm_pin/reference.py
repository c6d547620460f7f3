"""The objective and the rows of a problem by Pinocchio, at one point or at all.

The reference that the engine is checked against, and what a solver that asks Python gets.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.indices import Index
from dualarm_pin.relative import Relative
from dualarm_pin.relatives import Relatives
from dualarm_pin.rows.pose import pose_residual

if TYPE_CHECKING:
    from dualarm_pin.problem import Problem

Array = NDArray[np.float64]


def objective(problem: Problem, q: Array) -> float:
    """Return the objective at q (k, n)."""
    held = problem.points.index_weight != 0.0
    bounds = problem.lower, problem.upper
    relatives = Relatives(problem.cell, q[held])
    values = index_values(problem.index, relatives, problem.points.u[held], bounds)
    return float(problem.points.index_weight[held] @ values) + coupling(problem, q)[0]


def objective_and_gradient(problem: Problem, q: Array) -> tuple[float, Array]:
    """Return the objective at q (k, n) and its gradient (k, n)."""
    value, gradient = coupling(problem, q)
    held = np.flatnonzero(problem.points.index_weight)
    c, dc = point_gradients(problem, held, Relatives(problem.cell, q[held]))
    gradient[held] += dc
    return value + float(np.sum(c)), gradient


def point_gradients(
    problem: Problem, points: NDArray[np.int64], relatives: Relatives
) -> tuple[Array, Array]:
    """Return a_i c (s,) at some points (s,), and the gradients (s, n); see `point_gradient`."""
    weight, bounds = problem.points.index_weight[points], (problem.lower, problem.upper)
    c, dc = index_gradients(problem.index, relatives, problem.points.u[points], bounds)
    c[weight == 0.0], dc[weight == 0.0] = 0.0, 0.0  # it may be infinite where it does not count
    return weight * c, weight[:, None] * dc


def point_gradient(problem: Problem, i: int, relative: Relative) -> tuple[float, Array]:
    """Return a_i c at point i and its gradient (n,)."""
    weight = float(problem.points.index_weight[i])
    if weight == 0.0:
        return 0.0, np.zeros(problem.n)
    bounds = problem.lower, problem.upper
    c, dc = index_gradient(problem.index, relative, problem.points.u[i], relative.q, bounds)
    return weight * c, weight * dc


def coupling(problem: Problem, q: Array) -> tuple[float, Array]:
    """Return the linear and link terms at q (k, n), and their gradient (k, n)."""
    linear, links, ends = problem.points.linear, problem.links, problem.neighbours
    postures = np.concatenate([ends.posture[:1], q, ends.posture[1:]])
    weight = np.concatenate([ends.weight[:1], links.weight[:-1], ends.weight[1:]])
    step = np.diff(postures, axis=0)
    pull = np.array([links.metric_of(i - 1) * d for i, d in enumerate(step)])
    squared = np.sum(pull * step, axis=1)
    slope = (4.0 * weight * squared)[:, None] * pull
    value = float(np.sum(weight * squared**2)) + float(np.sum(linear * q))
    return value, linear + slope[:-1] - slope[1:]


def equalities(problem: Problem, i: int, relative: Relative) -> tuple[Array, Array]:
    """Return the rows of point i that must be zero (m_i,) and their Jacobian (m_i, n).

    The pose rows come first: position [m], then rotation.
    """
    points = problem.points
    values, jacobian = pose_residual(
        relative,
        points.position[i],
        points.rotation[i],
        int(points.pose_rows[i]),
        problem.spin_axis,
    )
    if not problem.equalities.size[i]:
        return values, jacobian
    more, slopes = _rows(
        problem, problem.equalities.source[i, : problem.equalities.size[i]], relative
    )
    return np.append(values, more), np.vstack([jacobian, slopes])


def inequalities(problem: Problem, i: int, relative: Relative) -> tuple[Array, Array]:
    """Return the rows of point i that must be zero or more (r_i,) and their Jacobian (r_i, n)."""
    table = problem.inequalities
    return _rows(problem, table.source[i, : table.size[i]], relative)


def violation(problem: Problem, q: Array) -> float:
    """Return the largest violation of a row at q (k, n): pose, other equalities, inequalities."""
    worst = 0.0
    for i, q_i in enumerate(q):
        relative = Relative(problem.cell, q_i)
        below, _ = inequalities(problem, i, relative)
        zero, _ = equalities(problem, i, relative)
        worst = max(worst, float(np.max(np.abs(zero))), float(np.max(-below, initial=0.0)))
    return worst


def further_slopes(problem: Problem, i: int, q: Array, held: NDArray[np.int64]) -> Array:
    """Return the Jacobian (m, n) of the rows of point i beside the pose, at q (n,).

    Args:
        problem: The problem.
        i: The point.
        q: Joints (n,).
        held: Which of its inequality rows; all its equality rows come first.
    """
    equal, unequal = problem.equalities, problem.inequalities
    which = np.append(equal.source[i, : equal.size[i]], unequal.source[i, : unequal.size[i]][held])
    return np.array([problem.rows[number].at(problem.cell, q)[1] for number in which])


def _rows(problem: Problem, which: NDArray[np.int64], relative: Relative) -> tuple[Array, Array]:
    found = [problem.rows[number].at(problem.cell, relative.q) for number in which]
    values = np.array([value for value, _ in found])
    return values, np.array([slope for _, slope in found]).reshape(len(found), problem.n)


def index_matrix(index: Index, J: Array) -> Array:
    """Return A = Wt^(1/2) J W J^T Wt^(1/2) (..., 6, 6) (eq. 8) for J (..., 6, n)."""
    rows = J if index.task_weights is None else np.sqrt(index.task_weights)[:, None] * J
    weighted = rows if index.joint_weights is None else rows * index.joint_weights
    return np.asarray(rows @ weighted.swapaxes(-1, -2))


def index_value(
    index: Index, relative: Relative, u: Array, q: Array, bounds: tuple[Array, Array]
) -> float:
    """Return c at one point, the additive joint-centre term included.

    Args:
        index: The index.
        relative: The pair of arms at q.
        u: Direction (6,) in e1 axes.
        q: Joints (n,).
        bounds: Lower and upper bounds (n,), whose middle is the joint centre.
    """
    value = float(index.phi(index_matrix(index, relative.J_r), u))
    return value + _joint_centre(index, q, bounds)[0]


def index_values(
    index: Index,
    relatives: Relatives,
    u: Array,
    bounds: tuple[Array, Array],
    *,
    reported: bool = False,
) -> Array:
    """Return c (s,) at several q, as `index_value` or, if `reported`, as `reported_value`."""
    phi = index.exact if reported and index.exact is not None else index.phi
    matrices = index_matrix(index, relatives.J_r)
    values = np.array([float(phi(A, u_i)) for A, u_i in zip(matrices, u, strict=True)])
    centre = np.array([_joint_centre(index, q, bounds)[0] for q in relatives.q])
    return np.asarray(values + centre, dtype=np.float64)


def index_gradients(
    index: Index, relatives: Relatives, u: Array, bounds: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return c (s,) at several q and dc/dq (s, n); the arguments are those of `index_value`."""
    J, matrices = relatives.J_r, index_matrix(index, relatives.J_r)
    slope = np.array([index.gradient(A, u_i) for A, u_i in zip(matrices, u, strict=True)])
    slope = slope.reshape(len(relatives), 6, 6)
    if index.task_weights is not None:
        root = np.sqrt(index.task_weights)
        slope = root[:, None] * slope * root
    P = slope @ J if index.joint_weights is None else slope @ J * index.joint_weights
    centre = [_joint_centre(index, q, bounds)[1] for q in relatives.q]
    gradient = 2.0 * relatives.along(P) + np.reshape(centre, J[:, 0].shape)
    return index_values(index, relatives, u, bounds), gradient


def reported_value(
    index: Index, relative: Relative, u: Array, q: Array, bounds: tuple[Array, Array]
) -> float:
    """Return the index that an answer reports: `index_value` without what smoothing changes."""
    value = index_value(index, relative, u, q, bounds)
    if index.exact is None:
        return value
    A = index_matrix(index, relative.J_r)
    return value + float(index.exact(A, u)) - float(index.phi(A, u))


def index_gradient(
    index: Index, relative: Relative, u: Array, q: Array, bounds: tuple[Array, Array]
) -> tuple[float, Array]:
    """Return c at one point and dc/dq (n,); the arguments are those of `index_value`."""
    J = relative.J_r
    A = index_matrix(index, J)
    slope = index.gradient(A, u)
    if index.task_weights is not None:
        root = np.sqrt(index.task_weights)
        slope = root[:, None] * slope * root
    P = slope @ J if index.joint_weights is None else slope @ J * index.joint_weights
    # dc/dq_l = tr(slope dA_l) = 2 sum_k W_k (slope J_k) . dJ_k/dq_l
    gradient = 2.0 * (P.ravel() @ relative.dJ_r.reshape(P.size, -1))
    extra, slope_extra = _joint_centre(index, q, bounds)
    return float(index.phi(A, u)) + extra, gradient + slope_extra


def _joint_centre(index: Index, q: Array, bounds: tuple[Array, Array]) -> tuple[float, Array]:
    if index.joint_centre == 0.0:
        return 0.0, np.zeros_like(q)
    half = np.maximum((bounds[1] - bounds[0]) / 2.0, 1e-12)
    offset = (q - (bounds[0] + bounds[1]) / 2.0) / half
    return index.joint_centre * float(offset @ offset), 2.0 * index.joint_centre * offset / half
