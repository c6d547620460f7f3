"""What is minimised along the path: functions phi(A, u) of A = Wt^(1/2) J_r W J_r^T Wt^(1/2).

An index is written once, as plain functions of small arrays: Pinocchio's side calls them as they
are and the engine compiles them. Smaller is better for every index.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Index:
    """A performance index c(q) = phi(A(q), u), to be minimised.

    Attributes:
        name: Name for tables and files.
        phi: (A (6, 6), u (6,)) -> c.
        gradient: (A, u) -> dphi/dA, symmetric (6, 6).
        curvature: (A, u, D) -> directional derivative of `gradient` along symmetric D, (6, 6).
        task_weights: Diagonal of Wt (6,), weights of the task rows; None for ones.
        joint_weights: Diagonal of W (n,), weights of the joints in J_r W J_r^T; None for ones.
        joint_centre: Weight of the additive term sum_k ((q_k - mid_k) / half_range_k)^2.
        units: Unit of the value.
    """

    name: str
    phi: Callable[[Array, Array], float]
    gradient: Callable[[Array, Array], Array]
    curvature: Callable[[Array, Array, Array], Array]
    task_weights: Array | None = None
    joint_weights: Array | None = None
    joint_centre: float = 0.0
    units: str = "m^2"


def force(task_weights: Array | None = None, joint_weights: Array | None = None) -> Index:
    """Return the paper's index (8), (14): c = 1/alpha^2 = u^T A u, lower is better."""
    return Index(
        "force", _force, _force_gradient, _force_curvature, task_weights, joint_weights, units="m^2"
    )


def _force(A: Array, u: Array) -> float:
    return float(np.dot(u, np.dot(A, u)))


def _force_gradient(A: Array, u: Array) -> Array:
    return np.outer(u, u)


def _force_curvature(A: Array, u: Array, D: Array) -> Array:
    return np.zeros((6, 6))
