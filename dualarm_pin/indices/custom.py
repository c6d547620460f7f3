"""The user's own index, with derivatives of his own or by differences."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.indices.index import Index, weighted

FIRST_STEP, SECOND_STEP = 1e-6, 1e-4  # of the size of A; the second where phi is differenced twice


@dataclass(frozen=True, eq=False)
class DifferenceGradient:
    """dphi/dA by central differences of phi; the engine compiles the same formula.

    Attributes:
        phi: (A, u) -> value.
        step: Of the size of A.
    """

    phi: Callable[[Array, Array], float]
    step: float = FIRST_STEP

    def __call__(self, A: Array, u: Array) -> Array:
        """Return dphi/dA (6, 6), symmetric."""
        return self.as_function()(A, u)

    def as_function(self) -> Callable[[Array, Array], Array]:
        """Return the same as a function that can be compiled."""
        return difference_gradient(self.phi, self.step)


@dataclass(frozen=True, eq=False)
class DifferenceCurvature:
    """Directional derivative of a gradient by central differences.

    Attributes:
        gradient: (A, u) -> (6, 6).
        step: Of the size of A.
    """

    gradient: Callable[[Array, Array], Array]
    step: float = FIRST_STEP

    def __call__(self, A: Array, u: Array, D: Array) -> Array:
        """Return the change of the gradient along D (6, 6)."""
        return self.as_function()(A, u, D)

    def as_function(self) -> Callable[[Array, Array, Array], Array]:
        """Return the same as a function that can be compiled."""
        return difference_curvature(self.gradient, self.step)


def custom(
    name: str,
    phi: Callable[[Array, Array], float],
    gradient: Callable[[Array, Array], Array] | None = None,
    curvature: Callable[[Array, Array, Array], Array] | None = None,
    *,
    task_weights: ArrayLike | None = None,
    joint_weights: ArrayLike | None = None,
    joint_centre: float = 0.0,
    units: str = "",
) -> Index:
    """Return an index of your own, to be minimised.

    Plain Python over numpy arrays is enough, or functions compiled by numba. What numba cannot
    compile runs as Python, some hundred times slower, with a warning. Check derivatives of your
    own with `check_derivatives`.

    Args:
        name: Name for tables and files.
        phi: (A (6, 6), u (6,)) -> value.
        gradient: (A, u) -> dphi/dA, symmetric (6, 6); central differences of phi if None.
        curvature: (A, u, D) -> change of the gradient along symmetric D, (6, 6); central
            differences of the gradient if None.
        task_weights: (6,) weights of the task rows, ones if None.
        joint_weights: (n,) weights of the joints, ones if None.
        joint_centre: Weight of the additive term of the joint centres.
        units: Unit of the value.

    Raises:
        InputError: phi is not a function, or a curvature comes without a gradient.
    """
    if not callable(phi):
        raise InputError(f"is {phi!r}, must be a function of (A, u)", field="phi")
    if gradient is None and curvature is not None:
        raise InputError("needs a gradient to be the derivative of", field="curvature")
    twice = DifferenceCurvature(DifferenceGradient(phi, SECOND_STEP), SECOND_STEP)
    curvature = curvature or (twice if gradient is None else DifferenceCurvature(gradient))
    return weighted(
        Index(name, phi, gradient or DifferenceGradient(phi), curvature, units=units),
        {
            "task_weights": task_weights,
            "joint_weights": joint_weights,
            "joint_centre": joint_centre,
        },
    )


def difference_gradient(
    phi: Callable[[Array, Array], float], step: float
) -> Callable[[Array, Array], Array]:
    """Return (A, u) -> dphi/dA: entry (i, j) from changing A_ij and A_ji together."""

    def gradient(A: Array, u: Array) -> Array:
        h = step * max(np.max(np.abs(A)), 1e-12)
        G, B = np.zeros((6, 6)), A.copy()
        for i in range(6):
            for j in range(i + 1):
                share = 1.0 if i == j else 0.5
                B[i, j] = B[j, i] = A[i, j] + h
                plus = phi(B, u)
                B[i, j] = B[j, i] = A[i, j] - h
                minus = phi(B, u)
                B[i, j] = B[j, i] = A[i, j]
                G[i, j] = G[j, i] = share * (plus - minus) / (2.0 * h)
        return G

    return gradient


def difference_curvature(
    gradient: Callable[[Array, Array], Array], step: float
) -> Callable[[Array, Array, Array], Array]:
    """Return (A, u, D) -> (G(A + h D) - G(A - h D)) / (2 h)."""

    def curvature(A: Array, u: Array, D: Array) -> Array:
        size = np.max(np.abs(D))
        if size == 0.0:
            return np.zeros((6, 6))
        h = step * max(np.max(np.abs(A)), 1e-12) / size
        result: Array = (gradient(A + h * D, u) - gradient(A - h * D, u)) / (2.0 * h)
        return result

    return curvature
