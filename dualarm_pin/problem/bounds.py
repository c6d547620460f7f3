"""The joint bounds of a problem, for a barrier (eq. 16)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.errors import InputError
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class Bounds(NamedTuple):
    """Bounds for a barrier: a fixed variable gets a harmless interval around its value.

    Attributes:
        lower: (n,) rad or m.
        upper: (n,).
        fixed: (f,) columns that must not move.
        fixed_value: (f,) where they stand; nan: where the start has them.
    """

    lower: Array
    upper: Array
    fixed: Integers
    fixed_value: Array


def barrier_bounds(lower: Array, upper: Array) -> Bounds:
    """Return the bounds (n,) for a barrier.

    Raises:
        InputError: They cross.
    """
    if (lower > upper).any():
        at = int(np.argmax(lower > upper))
        raise InputError(
            f"column {at} has lower bound {lower[at]} above its upper bound {upper[at]}",
            field="lower",
        )
    fixed = np.flatnonzero(upper - lower < TOLERANCE.fixed_joint)
    value = 0.5 * (lower[fixed] + upper[fixed])
    low, high = lower.copy(), upper.copy()
    low[fixed], high[fixed] = value - 1.0, value + 1.0
    return Bounds(low, high, fixed, value)
