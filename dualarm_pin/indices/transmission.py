"""The paper's indices along a direction u: force and velocity transmission."""

from __future__ import annotations

import dataclasses
from typing import Any, Unpack

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.indices.index import Index, Weights, weighted


def force(**weights: Unpack[Weights]) -> Index:
    """Return the paper's index (eq. 14): c = 1/alpha^2 = u^T A u, lower is better.

    alpha is the force transmission ratio (eq. 6), weighted (eq. 8).
    """
    return weighted(
        Index(
            "force",
            force_phi,
            force_gradient,
            force_curvature,
            expression=force_expression,
            kernel="force",
        ),
        weights,
    )


def torque(**weights: Unpack[Weights]) -> Index:
    """Return the joint torques that a unit force along u costs, as shares of their limits.

    c is the sum of their squares: the force index with 1 / limit^2 as joint weights. A task sets
    them from the torque limits of its cell; in Python give `joint_weights`.
    """
    return dataclasses.replace(force(**weights), name="torque", units="1/N^2")


def velocity(**weights: Unpack[Weights]) -> Index:
    """Return 1/beta^2 = u^T A^-1 u (eq. 9), lower is better: more speed along u per joint speed.

    beta is the velocity transmission ratio (eq. 7). Where task rows are weighted 0, A is inverted
    on the rows that are left and u counts there alone. At a singular A the value is infinite.
    """
    return weighted(
        Index(
            "velocity",
            velocity_phi,
            velocity_gradient,
            velocity_curvature,
            units="1/m^2",
            expression=velocity_expression,
            kernel="velocity",
        ),
        weights,
    )


def force_expression(ca: Any, A: Any, u: Any) -> Any:
    """Return u^T A u for CasADi."""
    return u.T @ A @ u


def velocity_expression(ca: Any, A: Any, u: Any) -> Any:
    """Return u^T A^-1 u for CasADi."""
    return u.T @ ca.inv(A) @ u


def force_phi(A: Array, u: Array) -> float:
    """Return u^T A u."""
    return float(np.dot(u, np.dot(A, u)))


def force_gradient(A: Array, u: Array) -> Array:
    """Return u u^T."""
    return np.outer(u, u)


def force_curvature(A: Array, u: Array, D: Array) -> Array:
    """Return 0: the index is linear in A."""
    return np.zeros((6, 6))


# A row of weight 0 makes a zero row and column of A. A 1 on its diagonal cuts it off.


def velocity_phi(A: Array, u: Array) -> float:
    """Return u^T A^-1 u by the eigenvalues of A."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam, V = np.linalg.eigh(A + np.diag(1.0 - left))
    if not lam[0] > 1e-14 * lam[-1]:
        return np.inf
    along = np.dot(V.T, u * left)
    return float(np.sum(along * along / lam))


def velocity_gradient(A: Array, u: Array) -> Array:
    """Return -x x^T, x = A^-1 u."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam, V = np.linalg.eigh(A + np.diag(1.0 - left))
    x = np.dot(V, np.dot(V.T, u * left) / np.maximum(lam, 1e-14 * lam[-1]))
    return -np.outer(x, x)


def velocity_curvature(A: Array, u: Array, D: Array) -> Array:
    """Return y x^T + x y^T, y = A^-1 D x."""
    left = np.where(np.diag(A) > 0.0, 1.0, 0.0)
    lam, V = np.linalg.eigh(A + np.diag(1.0 - left))
    lam = np.maximum(lam, 1e-14 * lam[-1])
    x = np.dot(V, np.dot(V.T, u * left) / lam)
    y = np.dot(V, np.dot(V.T, np.dot(D, x)) / lam) * left
    return np.outer(y, x) + np.outer(x, y)
