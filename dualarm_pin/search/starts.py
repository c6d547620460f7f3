"""Starts of a law: drawn in the parent and from one seed, before any worker exists.

A start of many points works best with one posture common to all of them; postures drawn for each
point by itself rarely lie in one basin.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def generator(seed: int, *keys: int) -> np.random.Generator:
    """Return the random generator of one stage: the same for any number of workers."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=keys))


def common_postures(
    lower: Array, upper: Array, points: int, count: int, random: np.random.Generator
) -> Array:
    """Draw starts (count, points, n): one posture within the bounds for all points of a start."""
    posture = random.uniform(lower, upper, (count, 1, len(lower)))
    return np.repeat(posture, points, axis=1)
