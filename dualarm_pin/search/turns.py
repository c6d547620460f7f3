"""Full turns: postures that differ by them are one posture, if the bounds allow both."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem

Array = NDArray[np.float64]
_TURN = 2.0 * math.pi


def wide_joints(problem: Problem) -> NDArray[np.bool_]:
    """Tell which columns (n,) are revolute joints that can make more than a full turn."""
    revolute = np.array([joint.kind == "revolute" for joint in problem.cell.joints])
    wide: NDArray[np.bool_] = revolute & (problem.upper - problem.lower > _TURN)
    return wide


def fold(problem: Problem, q: Array) -> Array:
    """Return paths (s, k, n) shifted by whole turns so that each wide joint lies centrally.

    A joint whose path spans too much to be shifted inside its bounds stays where it is.
    """
    wide = wide_joints(problem)
    if not wide.any():
        return q
    middle = (problem.lower + problem.upper) / 2.0
    away = (q.min(axis=1) + q.max(axis=1)) / 2.0 - middle
    shift = np.where(wide, np.round(away / _TURN) * _TURN, 0.0)
    moved = q - shift[:, None]
    inside = np.all((moved >= problem.lower) & (moved <= problem.upper), axis=1)
    return np.where(inside[:, None], moved, q)


def draw_postures(problem: Problem, count: int, random: np.random.Generator) -> Array:
    """Draw postures (count, n) within the bounds, of wide joints within one turn."""
    middle = (problem.lower + problem.upper) / 2.0
    half = (problem.upper - problem.lower) / 2.0
    half = np.where(wide_joints(problem), _TURN / 2.0, half)
    return random.uniform(middle - half, middle + half, (count, len(half)))
