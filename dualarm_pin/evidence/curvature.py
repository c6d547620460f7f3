"""Second order at a path, independent of the engine: differences of Pinocchio gradients.

At a minimum L(q) = F(q) + sum_i y_i . g_i(q) has no negative curvature along the directions that
keep the equality rows, the active rows and the active bounds: the reduced Hessian has no
negative eigenvalue.
"""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.evidence.kkt import Stationarity
from dualarm_pin.problem import Problem
from dualarm_pin.reference import further_slopes, point_gradients
from dualarm_pin.relatives import Relatives
from dualarm_pin.rows.pose import pose_pulls
from dualarm_pin.tolerance import TOLERANCE

_RESOLVED = 1e-12  # of the size of the matrix: where rounding leaves no more
_DIFFERENCE = 1e-5  # rad or m; the error of a central difference is then about 1e-10


def curvature_min(problem: Problem, q: Array, first: Stationarity) -> tuple[float | None, int]:
    """Return the smallest eigenvalue of the reduced Hessian of L, and its dimension.

    The Hessian at a point is a central difference of Pinocchio gradients along the free
    directions; that of the links is in closed form.

    Returns:
        None and 0 where the pose rows and active bounds leave no direction.
    """
    bases = [_free_directions(first, i) for i in range(problem.k)]
    curved = [
        product + _link_curvature(problem, q, i) @ basis
        for i, (product, basis) in enumerate(
            zip(_point_curvatures(problem, q, first, bases), bases, strict=True)
        )
    ]
    sizes = [basis.shape[1] for basis in bases]
    total = sum(sizes)
    if total == 0:
        return None, 0
    begin = np.concatenate([[0], np.cumsum(sizes)])
    band = np.zeros((2 * max(sizes) + 1, total))  # lower: band[r - c, c]
    for i, basis in enumerate(bases):
        block = basis.T @ curved[i]
        blocks = [0.5 * (block + block.T)]
        if i + 1 < problem.k:
            blocks.append(bases[i + 1].T @ _coupling(problem, q, i) @ basis)
        for (r, c), value in np.ndenumerate(np.concatenate(blocks)):
            if r >= c:
                band[r - c, begin[i] + c] = value
    return _smallest(band[:total]), total


def _smallest(band: Array) -> float:
    """Return the smallest eigenvalue of a symmetric matrix by its lower band (b, m).

    By bisection: shifted by less than it, the matrix has a Cholesky factor. That takes time linear
    in the number of points, where a reduction of all eigenvalues takes the square.
    """
    from scipy.linalg import LinAlgError, cholesky_banded

    high = float(band[0].min())
    size = float(np.abs(band).sum(axis=0).max()) * 2.0
    low, shifted = high - size, band.copy()
    while high - low > _RESOLVED * max(1.0, size):
        middle = 0.5 * (low + high)
        shifted[0] = band[0] - middle
        try:
            cholesky_banded(shifted, lower=True, check_finite=False)
            low = middle
        except LinAlgError:
            high = middle
    return 0.5 * (low + high)


def _free_directions(first: Stationarity, i: int) -> Array:
    """Return an orthonormal basis (n, d) of moves that keep the pose rows and active bounds."""
    free = np.flatnonzero(first.active[i] == 0)
    basis = np.zeros((len(first.active[i]), 0))
    if not len(free):
        return basis
    _, values, rows = np.linalg.svd(first.free_jacobian(i))
    rank = int(np.sum(values > TOLERANCE.rank))
    basis = np.zeros((len(first.active[i]), len(free) - rank))
    basis[free] = rows[rank:].T
    return basis


def _point_curvatures(
    problem: Problem, q: Array, first: Stationarity, bases: list[Array]
) -> list[Array]:
    """Return the Hessian of a_i c + y_i . g_i at each point i times its basis (n, d_i)."""
    products = [np.zeros_like(basis) for basis in bases]
    for column in range(max(basis.shape[1] for basis in bases)):
        points = np.array([i for i, basis in enumerate(bases) if basis.shape[1] > column])
        move = _DIFFERENCE * np.array([bases[i][:, column] for i in points])
        ahead, behind = (_slopes(problem, points, q[points] + s * move, first) for s in (1.0, -1.0))
        for i, slope in zip(points, (ahead - behind) / (2.0 * _DIFFERENCE), strict=True):
            products[i][:, column] = slope
    return products


def _slopes(problem: Problem, points: Integers, q: Array, first: Stationarity) -> Array:
    """Return the gradients of a_i c + y_i . g_i at points i (s,) in postures q (s, n)."""
    relatives, data = Relatives(problem.cell, q), problem.points
    y = np.zeros((len(points), 6))
    for number, i in enumerate(points):
        rows = data.pose_rows[i]
        y[number, :rows] = first.row_multipliers[i][:rows]
    slopes = point_gradients(problem, points, relatives)[1]
    pose_rows, rotation = data.pose_rows[points], data.rotation[points]
    slopes += pose_pulls(relatives, rotation, pose_rows, problem.spin_axis, y)
    for number, i in enumerate(points):
        more = first.row_multipliers[i][data.pose_rows[i] :]
        if len(more):
            slopes[number] += more @ further_slopes(problem, i, q[number], first.active_rows[i])
    return slopes


def _link_block(weight: float, metric: Array, step: Array) -> Array:
    """Return the Hessian (n, n) of weight (dq^T diag(m) dq)^2 with respect to dq."""
    m = metric * step
    return np.asarray(4.0 * weight * (m @ step) * np.diag(metric) + 8.0 * weight * np.outer(m, m))


def _coupling(problem: Problem, q: Array, i: int) -> Array:
    """Return the Hessian block (n, n) of points i + 1 and i."""
    links = problem.links
    return -_link_block(float(links.weight[i]), links.metric_of(i), q[i + 1] - q[i])


def _link_curvature(problem: Problem, q: Array, i: int) -> Array:
    """Return what the links of point i add to its Hessian block (n, n)."""
    ends, metric_of, last = problem.neighbours, problem.links.metric_of, problem.k - 1
    if i > 0:
        block = -_coupling(problem, q, i - 1)
    else:
        block = _link_block(float(ends.weight[0]), metric_of(-1), q[0] - ends.posture[0])
    if i + 1 < problem.k:
        return block - _coupling(problem, q, i)
    return block + _link_block(float(ends.weight[1]), metric_of(last), ends.posture[1] - q[-1])
