"""Gamma: the points of the first stage, denser where curve and direction change (Remark 2)."""

from __future__ import annotations

import math

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.path import Path

_WEIGHT_OF_TURN = 0.2 / (0.5 * math.pi)
"""A quarter turn weighs as much as a fifth of the length: for the paper's corner and 6 points this
gives back the paper's own Gamma."""


def choose_Gamma(path: Path, count: int) -> tuple[int, ...]:
    """Return `count` points of the path, first and last among them, counted from 0.

    Between two neighbours lies the same share of length and of turning, as nearly as the points
    allow. What turns is the tangent or the unit direction u, whichever turns more.

    Args:
        path: The path.
        count: From 2 to h.

    Returns:
        Rising indices; the paper's Gamma is these plus 1.

    Raises:
        InputError: Another count.
    """
    if not 2 <= count <= path.h:
        raise InputError(f"2 to {path.h} points are expected; given {count}", field="Gamma")
    u = path.u / np.linalg.norm(path.u, axis=1, keepdims=True)
    turn = np.maximum(_angles(path.tangent), _angles(u))
    # A path that only turns where it stands has no length; its points then count alike.
    length = np.diff(path.arc_length) if path.length > 0 else np.ones(path.h - 1)
    weight = length / length.sum() + _WEIGHT_OF_TURN * turn
    passed = np.concatenate([[0.0], np.cumsum(weight)])
    chosen = [0]
    for k in range(1, count - 1):
        wanted = passed[-1] * k / (count - 1)
        best = int(np.argmin(np.abs(passed - wanted)))
        chosen.append(min(max(best, chosen[-1] + 1), path.h - count + k))
    return (*chosen, path.h - 1)


def _angles(vectors: Array) -> Array:
    cosine = np.sum(vectors[:-1] * vectors[1:], axis=1)
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)))
