"""First order at a path, independent of the engine: gradients from Pinocchio.

With L(q) = F(q) + sum_i y_i . g_i(q), the conditions at a minimum are dL/dq = z_lower - z_upper,
z >= 0 and nonzero only at active bounds. The pose rows couple no two points, so the multipliers
are found point by point, by least squares.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.relative import Relative

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

# The interior point leaves active joints mu / z inside their bounds: 1e-9 at z = 0.01.
ACTIVE = 1e-6
RANK = 1e-9


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
    y = np.linalg.lstsq(J[:, free].T, -gradient[free], rcond=RANK)[0]
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
