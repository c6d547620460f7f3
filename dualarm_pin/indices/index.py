"""The noun: a performance index with its derivatives."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, ShapeError


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
        expression: (casadi, A, u) -> c as a CasADi expression; None: CasADi cannot solve it.
        kernel: Name of the engine's closed form of the same function; without one the engine calls
            phi, gradient and curvature.
        exact: (A, u) -> the index that answers report, where phi is a smooth one near it.
    """

    name: str
    phi: Callable[[Array, Array], float]
    gradient: Callable[[Array, Array], Array]
    curvature: Callable[[Array, Array, Array], Array]
    task_weights: Array | None = None
    joint_weights: Array | None = None
    joint_centre: float = 0.0
    units: str = "m^2"
    expression: Callable[[Any, Any, Any], Any] | None = None
    kernel: str = ""
    exact: Callable[[Array, Array], float] | None = None

    def __post_init__(self) -> None:
        for name, size in (("task_weights", 6), ("joint_weights", None)):
            object.__setattr__(self, name, _weights(name, getattr(self, name), size))
        if not 0.0 <= self.joint_centre < np.inf:
            raise InputError(f"is {self.joint_centre}, must be 0 or more", field="joint_centre")

    def with_joint_centre(self, weight: float) -> Index:
        """Return this index plus weight * sum_k ((q_k - mid_k) / half_range_k)^2.

        Raises:
            InputError: The weight is negative or not finite.
        """
        return dataclasses.replace(self, joint_centre=float(weight))


class Weights(TypedDict, total=False):
    """What every index of ours takes; see `Index`."""

    task_weights: ArrayLike | None
    joint_weights: ArrayLike | None
    joint_centre: float


def weighted(index: Index, weights: Weights) -> Index:
    """Return an index with these weights."""
    given: dict[str, Any] = {**weights}
    return dataclasses.replace(index, **given)


def _weights(name: str, value: ArrayLike | None, size: int | None) -> Array | None:
    """Return a checked read-only copy."""
    if value is None:
        return None
    array = np.array(value, dtype=np.float64)
    if array.ndim != 1 or (size is not None and len(array) != size):
        raise ShapeError(f"has shape {array.shape}, not ({size or 'n'},)", field=name)
    if not np.isfinite(array).all() or (array < 0.0).any():
        raise InputError(f"must be finite and 0 or more, is {array.tolist()}", field=name)
    array.flags.writeable = False
    return array
