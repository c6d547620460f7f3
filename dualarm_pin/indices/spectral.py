"""The classical indices of all directions: manipulability, condition, smallest singular value.

They mix metres and radians unless `task_weights` brings a length or leaves rows out. Eigenvalues
lam of A are squared singular values of the weighted J_r; rows weighted 0 do not count.

Where two eigenvalues meet, the extreme ones have a kink, and the best postures lie on it. So smooth
extremes are minimised instead, with P = POWER:

    low  = (sum_a lam_a^-P)^(-1/P)      6^(-1/P) lam_min <= low <= lam_min
    high = (sum_a lam_a^P)^(1/P)        lam_max <= high <= 6^(1/P) lam_max

They scale as the eigenvalues do. `Index.exact` is the index without smoothing; answers report it.
"""

from __future__ import annotations

from typing import Any, Unpack

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.indices.index import Index, Weights, weighted

DOUBLINGS = 6  # P = 2^6: an error of 1.4 %, and starts converge as often as with force
POWER = 2.0**DOUBLINGS  # a power of two, so that it is a few squares
SMOOTHING_ERROR = 1.0 - 6.0 ** (-0.5 / POWER)  # of a singular value, where all six are equal
SINGULAR = 1e-14  # of the largest eigenvalue: what rounding leaves of a zero


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
            kernel="yoshikawa",
        ),
        weights,
    )


def yoshikawa_expression(ca: Any, A: Any, u: Any) -> Any:
    """Return -sqrt(det A) for CasADi."""
    return -ca.sqrt(ca.det(A))


def inverse_condition_number(**weights: Unpack[Weights]) -> Index:
    """Return minus the inverse condition number, -sigma_min / sigma_max, to be minimised.

    What is minimised has both extremes smoothed: it is nearer to 0 than the true index by at most
    SMOOTHING_ERROR twice, 2.8 %, where all singular values are equal.
    """
    return weighted(
        Index(
            "inverse_condition_number",
            condition_phi,
            condition_gradient,
            condition_curvature,
            units="1",
            expression=condition_expression,
            kernel="inverse_condition_number",
            exact=exact_condition,
        ),
        weights,
    )


def smallest_singular_value(**weights: Unpack[Weights]) -> Index:
    """Return minus the smallest singular value of the weighted J_r, to be minimised.

    What is minimised is smoothed: it is nearer to 0 than the true index by at most
    SMOOTHING_ERROR, 1.4 %, where all singular values are equal, and 0.6 % where two are.
    """
    return weighted(
        Index(
            "smallest_singular_value",
            smallest_phi,
            smallest_gradient,
            smallest_curvature,
            units="m or rad, as weighted",
            expression=smallest_expression,
            kernel="smallest_singular_value",
            exact=exact_smallest,
        ),
        weights,
    )


def smallest_expression(ca: Any, A: Any, u: Any) -> Any:
    """Return -sqrt(low) for CasADi, by the trace of a power of A^-1."""
    return -1.0 / ca.sqrt(_power_norm(ca, ca.inv(A)))


def condition_expression(ca: Any, A: Any, u: Any) -> Any:
    """Return -sqrt(low / high) for CasADi, by the traces of powers of A^-1 and A."""
    return -1.0 / ca.sqrt(_power_norm(ca, ca.inv(A)) * _power_norm(ca, A))


def _power_norm(ca: Any, A: Any) -> Any:
    """Return tr(A^P)^(1/P); A is divided by its trace first, so that no power overflows."""
    size = ca.trace(A)
    power = A / size
    for _ in range(DOUBLINGS):
        power = power @ power
    return size * ca.trace(power) ** (1.0 / POWER)


# A row of weight 0 is a zero row and column of A. For the determinant a 1 on its diagonal cuts it
# off; for the extreme eigenvalues it is left out.


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


def exact_smallest(A: Array, u: Array) -> float:
    """Return -sqrt(lam_min)."""
    return -float(np.sqrt(max(_spectrum(A)[0][0], 0.0)))


def exact_condition(A: Array, u: Array) -> float:
    """Return -sqrt(lam_min / lam_max)."""
    lam, _ = _spectrum(A)
    return -float(np.sqrt(max(lam[0], 0.0) / max(lam[-1], 1e-300)))


def smallest_phi(A: Array, u: Array) -> float:
    """Return -sqrt(low)."""
    return _value(_clear_of_zero(_spectrum(A)[0]), top=False)


def smallest_gradient(A: Array, u: Array) -> Array:
    """Return its derivative by A."""
    return _gradient(A, top=False)


def smallest_curvature(A: Array, u: Array, D: Array) -> Array:
    """Return the change of its derivative along D."""
    return _curvature(A, D, top=False)


def condition_phi(A: Array, u: Array) -> float:
    """Return -sqrt(low / high)."""
    return _value(_clear_of_zero(_spectrum(A)[0]), top=True)


def condition_gradient(A: Array, u: Array) -> Array:
    """Return its derivative by A."""
    return _gradient(A, top=True)


def condition_curvature(A: Array, u: Array, D: Array) -> Array:
    """Return the change of its derivative along D."""
    return _curvature(A, D, top=True)


def _spectrum(A: Array) -> tuple[Array, Array]:
    """Return eigenvalues (r,), lowest first, and eigenvectors (6, r) on the r rows that count."""
    left = np.flatnonzero(np.diag(A) > 0.0)
    if not len(left):
        return np.zeros(1), np.zeros((6, 1))
    lam, vectors = np.linalg.eigh(A[np.ix_(left, left)])
    V = np.zeros((6, len(left)))
    V[left] = vectors
    return lam, V


def _clear_of_zero(lam: Array) -> Array:
    """Return eigenvalues not below what rounding leaves of a zero."""
    return np.maximum(lam, max(SINGULAR * lam[-1], 1e-300))


def _extremes(lam: Array) -> tuple[float, float]:
    """Return low and high."""
    low = lam[0] * np.sum((lam[0] / lam) ** POWER) ** (-1.0 / POWER)
    high = lam[-1] * np.sum((lam / lam[-1]) ** POWER) ** (1.0 / POWER)
    return float(low), float(high)


def _value(lam: Array, *, top: bool) -> float:
    low, high = _extremes(lam)
    return -float(np.sqrt(low / high if top else low))


def _slopes(lam: Array, *, top: bool) -> tuple[float, Array, Array]:
    """Return phi, d(log low)/dlam (r,) and, if it counts, d(log high)/dlam (r,)."""
    low, high = _extremes(lam)
    return _value(lam, top=top), (low / lam) ** POWER / lam, top * (lam / high) ** POWER / lam


def _gradient(A: Array, *, top: bool) -> Array:
    lam, V = _spectrum(A)
    value, p, r = _slopes(_clear_of_zero(lam), top=top)
    result: Array = (V * (0.5 * value * (p - r))) @ V.T
    return result


def _curvature(A: Array, D: Array, *, top: bool) -> Array:
    """Return the change of `_gradient` along D, with divided differences in the eigenvectors.

    The divided difference of lam^e, by the logarithm of the quotient, is exact where two meet.
    """
    lam, V = _spectrum(A)
    lam = _clear_of_zero(lam)
    value, p, r = _slopes(lam, top=top)
    inner = V.T @ D @ V
    along = np.diag(inner)
    d_value = 0.5 * value * ((p - r) @ along)
    change = np.diag(d_value * (p - r) + value * POWER * (p * (p @ along) + r * (r @ along)))
    rows, columns = np.broadcast_arrays(lam[:, None], lam[None, :])
    for slope, exponent, sign in ((p, -POWER - 1.0, 1.0), (r, POWER - 1.0, -1.0)):
        # (lam_a^e - lam_b^e) / (lam_a - lam_b), from the side where the power is the larger one
        first = rows < columns if exponent < 0.0 else rows > columns
        apart = np.log(np.where(first, columns / rows, rows / columns))
        larger = np.where(first, slope[:, None] / rows, slope[None, :] / columns)
        safe = np.where(apart == 0.0, 1.0, apart)
        ratio = np.expm1(exponent * safe) / np.expm1(safe)
        change += sign * value * inner * larger * np.where(apart == 0.0, exponent, ratio)
    result: Array = V @ (0.5 * change) @ V.T
    return result
