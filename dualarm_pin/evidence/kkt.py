"""First and second order at a path, independent of the engine: gradients from Pinocchio.

With L(q) = F(q) + sum_i y_i . g_i(q), the conditions at a minimum are dL/dq = z_lower - z_upper,
z >= 0 and nonzero only at active bounds, and no negative curvature of L along the directions that
keep the pose rows and the active bounds. The pose rows couple no two points, so the multipliers
are found point by point, by least squares.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem, index_gradient
from dualarm_pin.relative import Relative

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

# The interior point leaves active joints mu / z inside their bounds: 1e-9 at z = 0.01.
ACTIVE = 1e-6
_DIFFERENCE = 1e-5  # rad or m; the error of a central difference is then about 1e-10
_RANK = 1e-9


@dataclass(frozen=True, eq=False)
class Stationarity:
    """First order at a path of k points.

    Attributes:
        objective: Objective.
        residual: Largest pose residual.
        stationarity: Largest entry of the KKT residual.
        active: Bounds that hold (k, n): -1 lower, 1 upper, 0 free.
        pose_multipliers: y (rows_i,) of each point.
        bound_multipliers: z (k, n) of active bounds, at least 0 at a minimum; 0 elsewhere.
        jacobians: Pose Jacobian (rows_i, n) of each point.
    """

    objective: float
    residual: float
    stationarity: float
    active: NDArray[np.int64]
    pose_multipliers: list[Array]
    bound_multipliers: Array
    jacobians: list[Array]

    @property
    def min_multiplier(self) -> float | None:
        """Smallest multiplier of an active bound; None if none is active."""
        held = self.active != 0
        return float(self.bound_multipliers[held].min()) if held.any() else None

    def free_jacobian(self, i: int) -> Array:
        """Return the columns (rows_i, f) of point i that no bound holds."""
        return self.jacobians[i][:, self.active[i] == 0]


def stationarity(problem: Problem, q: Array) -> Stationarity:
    """Return the first-order conditions at q (k, n), with multipliers by least squares."""
    objective, gradient = problem.objective_and_gradient(q)
    at_lower = q - problem.lower <= ACTIVE
    at_upper = problem.upper - q <= ACTIVE
    active = np.where(at_lower, -1, np.where(at_upper, 1, 0)).astype(np.int64)
    residual = error = 0.0
    pose, jacobians = [], []
    bound = np.zeros_like(q)
    for i, q_i in enumerate(q):
        g, J = problem.point_jacobian(i, Relative(problem.cell, q_i))
        y, z, left = _multipliers(gradient[i], J, active[i])
        residual = max(residual, float(np.max(np.abs(g))))
        error = max(error, float(np.max(np.abs(left), initial=0.0)))
        bound[i] = z
        pose.append(y)
        jacobians.append(J)
    return Stationarity(objective, residual, error, active, pose, bound, jacobians)


def _multipliers(
    gradient: Array, J: Array, active: NDArray[np.int64]
) -> tuple[Array, Array, Array]:
    """Return y (rows,), z (n,) and what is left of the gradient (n,) at one point."""
    free = active == 0
    y = np.linalg.lstsq(J[:, free].T, -gradient[free], rcond=_RANK)[0]
    slope = gradient + J.T @ y
    z = -active * slope
    if np.all(z >= -ACTIVE):
        return y, z, np.where(free, slope, 0.0)
    # With few free joints y is not unique, and the shortest one may give a wrong sign.
    return _signed_multipliers(gradient, J, active)


def _signed_multipliers(
    gradient: Array, J: Array, active: NDArray[np.int64]
) -> tuple[Array, Array, Array]:
    """Return the multipliers by least squares with z >= 0, and the whole residual (n,)."""
    from scipy.optimize import lsq_linear

    held = np.flatnonzero(active)
    rows = len(J)
    columns = np.zeros((len(gradient), rows + len(held)))
    columns[:, :rows] = J.T
    columns[held, rows + np.arange(len(held))] = active[held]
    least = np.concatenate([np.full(rows, -np.inf), np.zeros(len(held))])
    found = lsq_linear(columns, -gradient, (least, np.inf), method="bvls", tol=1e-14).x
    z = np.zeros(len(gradient))
    z[held] = found[rows:]
    return found[:rows], z, gradient + columns @ found


def curvature_min(problem: Problem, q: Array, first: Stationarity) -> tuple[float | None, int]:
    """Return the smallest eigenvalue of the reduced Hessian of L, and its dimension.

    The Hessian at a point is a central difference of Pinocchio gradients along the free
    directions; that of the links is in closed form.

    Returns:
        None and 0 where the pose rows and active bounds leave no direction.
    """
    bases = [_free_directions(first, i) for i in range(problem.k)]
    curved = [
        _point_curvature(problem, q, first, i, basis) + _link_curvature(problem, q, i) @ basis
        for i, basis in enumerate(bases)
    ]
    sizes = [basis.shape[1] for basis in bases]
    total = sum(sizes)
    if total == 0:
        return None, 0
    begin = np.concatenate([[0], np.cumsum(sizes)])
    band = np.zeros((2 * max(sizes) + 1, total))  # lower: band[r - c, c]
    for i, basis in enumerate(bases):
        block = basis.T @ curved[i]
        _put(band, begin[i], begin[i], 0.5 * (block + block.T))
        if i + 1 < problem.k:
            step = _coupling(problem, q, i)
            _put(band, begin[i + 1], begin[i], bases[i + 1].T @ step @ basis)
    from scipy.linalg import eigvals_banded

    values = eigvals_banded(band[:total], lower=True, select="i", select_range=(0, 0))
    return float(values[0]), total


def _put(band: Array, row: int, column: int, block: Array) -> None:
    for (r, c), value in np.ndenumerate(block):
        if row + r >= column + c:
            band[row + r - column - c, column + c] = value


def _free_directions(first: Stationarity, i: int) -> Array:
    """Return an orthonormal basis (n, d) of moves that keep the pose rows and active bounds."""
    free = np.flatnonzero(first.active[i] == 0)
    basis = np.zeros((len(first.active[i]), 0))
    if not len(free):
        return basis
    _, values, rows = np.linalg.svd(first.free_jacobian(i))
    rank = int(np.sum(values > _RANK))
    basis = np.zeros((len(first.active[i]), len(free) - rank))
    basis[free] = rows[rank:].T
    return basis


def _point_curvature(
    problem: Problem, q: Array, first: Stationarity, i: int, basis: Array
) -> Array:
    """Return the Hessian of a_i c + y_i . g_i at point i times `basis` (n, d)."""

    def slope(at: Array) -> Array:
        relative = Relative(problem.cell, at)
        c = index_gradient(problem.index, relative, problem.u[i], at, problem.bounds)[1]
        J = problem.point_jacobian(i, relative)[1]
        return np.asarray(problem.index_weight[i] * c + J.T @ first.pose_multipliers[i])

    product = np.zeros_like(basis)
    for column, direction in enumerate(basis.T):
        ahead, behind = slope(q[i] + _DIFFERENCE * direction), slope(q[i] - _DIFFERENCE * direction)
        product[:, column] = (ahead - behind) / (2.0 * _DIFFERENCE)
    return product


def _link_block(weight: float, metric: Array, step: Array) -> Array:
    """Return the Hessian (n, n) of weight (dq^T diag(m) dq)^2 with respect to dq."""
    m = metric * step
    return np.asarray(4.0 * weight * (m @ step) * np.diag(metric) + 8.0 * weight * np.outer(m, m))


def _coupling(problem: Problem, q: Array, i: int) -> Array:
    """Return the Hessian block (n, n) of points i + 1 and i."""
    return -_link_block(float(problem.link_weight[i]), problem.metric, q[i + 1] - q[i])


def _link_curvature(problem: Problem, q: Array, i: int) -> Array:
    """Return what the links of point i add to its Hessian block (n, n)."""
    block = np.zeros((problem.n, problem.n))
    if i > 0:
        block -= _coupling(problem, q, i - 1)
    elif problem.before is not None:
        block += _link_block(problem.before_weight, problem.metric, q[0] - problem.before)
    if i + 1 < problem.k:
        block -= _coupling(problem, q, i)
    elif problem.after is not None:
        block += _link_block(problem.after_weight, problem.metric, problem.after - q[-1])
    return block
