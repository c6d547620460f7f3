"""First order at a path, independent of the engine: gradients from Pinocchio.

With L(q) = F(q) + sum_i y_i . g_i(q) over the equality rows and the active inequality rows, the
conditions at a minimum are dL/dq = z_lower - z_upper, z >= 0 and nonzero only at active bounds,
and y <= 0 for an inequality. The rows couple no two points, so the multipliers are found point by
point, by least squares.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.arrays import Array
from dualarm_pin.problem import Problem
from dualarm_pin.reference import equalities, inequalities, objective_and_gradient
from dualarm_pin.relative import Relative
from dualarm_pin.tolerance import TOLERANCE

Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Stationarity:
    """First order at a path of k points.

    Attributes:
        objective: Objective.
        residual: Largest violation of a row.
        stationarity: Largest entry of the KKT residual.
        active: Bounds that hold (k, n): -1 lower, 1 upper, 0 free.
        active_rows: Inequality rows of each point that hold, as numbers among its own.
        row_multipliers: y (m_i,) of each point: equality rows, then the active inequalities.
        bound_multipliers: z (k, n) of active bounds, at least 0 at a minimum; 0 elsewhere.
        jacobians: Jacobian (m_i, n) of these rows.
    """

    objective: float
    residual: float
    stationarity: float
    active: NDArray[np.int64]
    active_rows: list[NDArray[np.int64]]
    row_multipliers: list[Array]
    bound_multipliers: Array
    jacobians: list[Array]

    @property
    def min_multiplier(self) -> float | None:
        """Smallest multiplier of an active bound or inequality row; None if none is active."""
        held = [self.bound_multipliers[self.active != 0]]
        for y, rows in zip(self.row_multipliers, self.active_rows, strict=True):
            held.append(-y[len(y) - len(rows) :])
        every = np.concatenate(held)
        return float(every.min()) if len(every) else None

    def free_jacobian(self, i: int) -> Array:
        """Return the columns (rows_i, f) of point i that no bound holds."""
        return self.jacobians[i][:, self.active[i] == 0]


def stationarity(problem: Problem, q: Array) -> Stationarity:
    """Return the first-order conditions at q (k, n), with multipliers by least squares."""
    objective, gradient = objective_and_gradient(problem, q)
    at_lower = q - problem.lower <= TOLERANCE.active
    at_upper = problem.upper - q <= TOLERANCE.active
    active = np.where(at_lower, -1, np.where(at_upper, 1, 0)).astype(np.int64)
    residual = error = 0.0
    rows, multipliers, jacobians = [], [], []
    bound = np.zeros_like(q)
    for i, q_i in enumerate(q):
        relative = Relative(problem.cell, q_i)
        gap, slopes = inequalities(problem, i, relative)
        held = np.flatnonzero(gap <= TOLERANCE.active)
        equal, J = equalities(problem, i, relative)
        if len(held):
            J = np.vstack([J, slopes[held]])
        y, z, left = _multipliers(gradient[i], J, active[i], len(held))
        below = float(np.max(-gap, initial=0.0))
        residual = max(residual, float(np.max(np.abs(equal))), below)
        error = max(error, float(np.max(np.abs(left), initial=0.0)))
        bound[i] = z
        rows.append(held)
        multipliers.append(y)
        jacobians.append(J)
    return Stationarity(objective, residual, error, active, rows, multipliers, bound, jacobians)


def _multipliers(
    gradient: Array, J: Array, active: NDArray[np.int64], unequal: int
) -> tuple[Array, Array, Array]:
    """Return y (m,), z (n,) and what is left of the gradient (n,) at one point.

    The last `unequal` rows are inequalities.
    """
    free = active == 0
    y = np.linalg.lstsq(J[:, free].T, -gradient[free], rcond=TOLERANCE.rank)[0]
    slope = gradient + J.T @ y
    z = -active * slope
    if np.all(z >= -TOLERANCE.active) and np.all(y[len(y) - unequal :] <= TOLERANCE.active):
        return y, z, np.where(free, slope, 0.0)
    # With few free joints y is not unique, and the shortest one may give a wrong sign.
    return _signed_multipliers(gradient, J, active, unequal)


def _signed_multipliers(
    gradient: Array, J: Array, active: NDArray[np.int64], unequal: int
) -> tuple[Array, Array, Array]:
    """Return the multipliers by least squares with z >= 0, and the whole residual (n,)."""
    from scipy.optimize import lsq_linear

    held = np.flatnonzero(active)
    rows = len(J)
    columns = np.zeros((len(gradient), rows + len(held)))
    columns[:, :rows] = J.T
    columns[held, rows + np.arange(len(held))] = active[held]
    least = np.concatenate([np.full(rows, -np.inf), np.zeros(len(held))])
    most = np.full(len(least), np.inf)
    most[rows - unequal : rows] = 0.0
    found = lsq_linear(columns, -gradient, (least, most), method="bvls", tol=1e-14).x
    z = np.zeros(len(gradient))
    z[held] = found[rows:]
    return found[:rows], z, gradient + columns @ found
