"""The classical indices of all directions: manipulability, condition, smallest singular value.

They mix metres and radians unless `task_weights` brings a length or leaves rows out. Eigenvalues
lam of A are squared singular values of the weighted J_r; rows weighted 0 do not count. Where two
eigenvalues cross, the extreme ones have a kink: the derivatives there are those of one branch,
with the gap kept away from zero.
"""

from __future__ import annotations

from typing import Any, Unpack

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.indices.index import Index, Weights, weighted


def yoshikawa(**weights: Unpack[Weights]) -> Index:
    """Return minus Yoshikawa's manipulability, -sqrt(det A), to be minimised."""
    return weighted(
        Index(
            "yoshikawa",
            yoshikawa_phi,
            yoshikawa_gradient,
            yoshikawa_curvature,
            units="m^3 for all six rows",
            expression=yoshikawa_expression,
        ),
        weights,
    )


def yoshikawa_expression(ca: Any, A: Any, u: Any) -> Any:
    """Return -sqrt(det A) for CasADi."""
    return -ca.sqrt(ca.det(A))


def inverse_condition_number(**weights: Unpack[Weights]) -> Index:
    """Return minus the inverse condition number, -sigma_min / sigma_max, to be minimised."""
    return weighted(
        Index(
            "inverse_condition_number",
            condition_phi,
            condition_gradient,
            condition_curvature,
            units="1",
        ),
        weights,
    )


def smallest_singular_value(**weights: Unpack[Weights]) -> Index:
    """Return minus the smallest singular value of the weighted J_r, to be minimised."""
    return weighted(
        Index(
            "smallest_singular_value",
            smallest_phi,
            smallest_gradient,
            smallest_curvature,
            units="m or rad, as weighted",
        ),
        weights,
    )


# Each function below stands alone, so that it compiles as it is. A row of weight 0 is a zero row
# and column of A: for the determinant a 1 on its diagonal cuts it off; for the extreme
# eigenvalues a value between the others does, the mean of the diagonal.


def yoshikawa_phi(A: Array, u: Array) -> float:
    """Return -sqrt(prod lam)."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam = np.linalg.eigvalsh(A + np.diag(1.0 - left))
    return -float(np.sqrt(np.prod(np.maximum(lam, 0.0))))


def yoshikawa_gradient(A: Array, u: Array) -> Array:
    """Return phi A^-1 / 2 (from d det A = det A tr(A^-1 dA))."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam, V = np.linalg.eigh(A + np.diag(1.0 - left))
    lam = np.maximum(lam, 1e-14 * lam[-1])
    value = -np.sqrt(np.prod(lam))
    result: Array = 0.5 * value * (np.dot(V / lam, V.T) - np.diag(1.0 - left))
    return result


def yoshikawa_curvature(A: Array, u: Array, D: Array) -> Array:
    """Return phi (tr(A^-1 D) A^-1 / 2 - A^-1 D A^-1) / 2."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam, V = np.linalg.eigh(A + np.diag(1.0 - left))
    lam = np.maximum(lam, 1e-14 * lam[-1])
    value = -np.sqrt(np.prod(lam))
    inverse = np.dot(V / lam, V.T) - np.diag(1.0 - left)
    change = np.dot(inverse, D)
    result: Array = 0.5 * value * (0.5 * np.trace(change) * inverse - np.dot(change, inverse))
    return result


def smallest_phi(A: Array, u: Array) -> float:
    """Return -sqrt(lam_min)."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam = np.linalg.eigvalsh(A + np.diag((1.0 - left) * np.trace(A)))
    return -float(np.sqrt(max(lam[0], 0.0)))


def smallest_gradient(A: Array, u: Array) -> Array:
    """Return -x x^T / (2 sigma), x the eigenvector of lam_min."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam, V = np.linalg.eigh(A + np.diag((1.0 - left) * np.trace(A)))
    sigma = np.sqrt(max(lam[0], 1e-14 * lam[-1]))
    x = V[:, 0].copy()
    result: Array = np.outer(x, x) / (-2.0 * sigma)
    return result


def smallest_curvature(A: Array, u: Array, D: Array) -> Array:
    """Return the change of -x x^T / (2 sigma) along D.

    dx = sum_(k>0) v_k (v_k . D x) / (lam_0 - lam_k), dlam = x . D x.
    """
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam, V = np.linalg.eigh(A + np.diag((1.0 - left) * np.trace(A)))
    sigma = np.sqrt(max(lam[0], 1e-14 * lam[-1]))
    x = V[:, 0].copy()
    Dx = np.dot(D, x)
    dx = np.zeros(6)
    for k in range(1, 6):
        v = V[:, k].copy()
        dx += v * np.dot(v, Dx) / min(lam[0] - lam[k], -1e-9 * lam[-1])
    turned = np.outer(dx, x) + np.outer(x, dx)
    result: Array = turned / (-2.0 * sigma) + np.outer(x, x) * (np.dot(x, Dx) / (4.0 * sigma**3))
    return result


def condition_phi(A: Array, u: Array) -> float:
    """Return -sqrt(lam_min / lam_max)."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    cut = (1.0 - left) * np.trace(A) / max(np.sum(left), 1.0)
    lam = np.linalg.eigvalsh(A + np.diag(cut))
    return -float(np.sqrt(max(lam[0], 0.0) / max(lam[-1], 1e-300)))


def condition_gradient(A: Array, u: Array) -> Array:
    """Return phi / 2 (x x^T / lam_min - z z^T / lam_max), x and z their eigenvectors."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    cut = (1.0 - left) * np.trace(A) / max(np.sum(left), 1.0)
    lam, V = np.linalg.eigh(A + np.diag(cut))
    low = max(lam[0], 1e-14 * lam[-1])
    x, z = V[:, 0].copy(), V[:, -1].copy()
    value = -np.sqrt(low / lam[-1])
    result: Array = 0.5 * value * (np.outer(x, x) / low - np.outer(z, z) / lam[-1])
    return result


def condition_curvature(A: Array, u: Array, D: Array) -> Array:
    """Return the change of phi / 2 (x x^T / lam_min - z z^T / lam_max) along D."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    cut = (1.0 - left) * np.trace(A) / max(np.sum(left), 1.0)
    lam, V = np.linalg.eigh(A + np.diag(cut))
    high = lam[-1]
    low = max(lam[0], 1e-14 * high)
    x, z = V[:, 0].copy(), V[:, -1].copy()
    Dx, Dz = np.dot(D, x), np.dot(D, z)
    dx, dz = np.zeros(6), np.zeros(6)
    for k in range(6):
        v = V[:, k].copy()
        if k > 0:
            dx += v * np.dot(v, Dx) / min(lam[0] - lam[k], -1e-9 * high)
        if k < 5:
            dz += v * np.dot(v, Dz) / max(high - lam[k], 1e-9 * high)
    value = -np.sqrt(low / high)
    d_low, d_high = np.dot(x, Dx), np.dot(z, Dz)
    d_value = 0.5 * value * (d_low / low - d_high / high)
    inner = np.outer(x, x) / low - np.outer(z, z) / high
    d_inner = (np.outer(dx, x) + np.outer(x, dx)) / low - np.outer(x, x) * (d_low / low**2)
    d_inner -= (np.outer(dz, z) + np.outer(z, dz)) / high - np.outer(z, z) * (d_high / high**2)
    result: Array = 0.5 * (d_value * inner + value * d_inner)
    return result
