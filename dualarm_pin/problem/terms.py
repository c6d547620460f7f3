"""The index of a problem by value, and its typical size."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dualarm_pin import reference
from dualarm_pin.arrays import checked
from dualarm_pin.indices import Index
from dualarm_pin.problem.bounds import Bounds
from dualarm_pin.relative import Relative

Array = NDArray[np.float64]
FORCE, CALLED = 0, 1

_SIZES = 9  # postures: enough for a median within a factor of two
_NEAR_ONE = 50.0  # the tolerances of the solvers were tried on indices from 1/50 to 50


class IndexTerms(NamedTuple):
    """The index by value.

    Attributes:
        kind: FORCE is part of the engine; every other index is CALLED, compiled by itself.
        task_scale: (6,) square roots of the task weights.
        joint_weights: (n,) diagonal of W.
        centre: (n,) middle of the bounds.
        centre_weight: (n,) weight of (q - centre)^2, with the index.
    """

    kind: int
    task_scale: Array
    joint_weights: Array
    centre: Array
    centre_weight: Array


def index_terms(index: Index, bounds: Bounds) -> IndexTerms:
    """Return an index by value, its centring weighed by the ranges."""
    n = len(bounds.lower)
    weights = np.ones(6) if index.task_weights is None else index.task_weights
    joints = 1.0 if index.joint_weights is None else index.joint_weights
    half = 0.5 * (bounds.upper - bounds.lower)
    half[bounds.fixed] = np.inf
    return IndexTerms(
        kind=FORCE if index.kernel == "force" else CALLED,
        task_scale=np.sqrt(weights),
        joint_weights=checked("joint_weights", joints, (n,)),
        centre=0.5 * (bounds.lower + bounds.upper),
        centre_weight=index.joint_centre / half**2,
    )


def typical_size(cell: Any, index: Index, u: Array, lower: Array, upper: Array) -> float:
    """Return the median of |c| over a few postures, or 1 where that is near enough.

    A solver's tolerances are absolute: an index of size 1e-3 would stop early, one of 1e4 would
    never be done.
    """
    draw = np.random.default_rng(0).uniform(lower, upper, (_SIZES, len(lower)))
    at = np.linspace(0, len(u) - 1, _SIZES).astype(int)
    values = [
        reference.index_value(index, Relative(cell, q), u[i], q, (lower, upper))
        for q, i in zip(draw, at, strict=True)
    ]
    finite = np.abs([value for value in values if np.isfinite(value)])
    size = float(np.median(finite)) if len(finite) else 1.0
    near_enough = 1.0 / _NEAR_ONE <= size <= _NEAR_ONE
    return 1.0 if near_enough or not size > 0.0 else size
