"""Waves in a plane of constant height: sine and figure eight.

Their normal is the z axis of e1, so a tool with the default rotation stands on the plane.
"""

from __future__ import annotations

import math
from typing import Unpack

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.path import Path
from dualarm_pin.path.generators.arguments import Point2, middle, positive
from dualarm_pin.path.generators.follow import Follow, follow
from dualarm_pin.path.generators.piece import spans


def sine(
    length: float,
    *,
    amplitude: float = 0.01,
    periods: float = 4.0,
    center: Point2 = (0.0, 0.0),
    height: float = 0.3,
    **how: Unpack[Follow],
) -> Path:
    """Return a sine wave along x, as a weaving weld runs.

    Args:
        length: Extent along x [m], such as `0.2`.
        amplitude: Half of the extent along y [m].
        periods: Number of waves.
        center: x and y of the middle [m].
        height: z of the plane [m].
        **how: See `Follow`.

    Raises:
        InputError: A length, amplitude or number of waves that is not positive.
    """
    positive(length=length, amplitude=amplitude, periods=periods)
    origin, turn = middle(center, height), 2 * math.pi * periods

    def point(t: Array) -> Array:
        x, y = length * (t - 0.5), amplitude * np.sin(turn * t)
        return origin + np.column_stack([x, y, np.zeros_like(t)])

    def derivative(t: Array) -> Array:
        y = amplitude * turn * np.cos(turn * t)
        return np.column_stack([np.full_like(t, length), y, np.zeros_like(t)])

    return follow(spans(point, derivative, math.ceil(periods)), "sine", how)


def figure_eight(
    radius: float,
    *,
    center: Point2 = (0.0, 0.0),
    height: float = 0.3,
    **how: Unpack[Follow],
) -> Path:
    """Return a figure eight along x, closed: x = a sin t, y = a sin t cos t.

    Args:
        radius: Half of its extent along x, a [m], such as `0.1`; along y it reaches half as far.
        center: x and y of the crossing, where it starts [m].
        height: z of the plane [m].
        **how: See `Follow`.

    Raises:
        InputError: A radius that is not positive.
    """
    positive(radius=radius)
    origin, turn = middle(center, height), 2 * math.pi

    def point(t: Array) -> Array:
        x, y = radius * np.sin(turn * t), 0.5 * radius * np.sin(2 * turn * t)
        return origin + np.column_stack([x, y, np.zeros_like(t)])

    def derivative(t: Array) -> Array:
        x, y = radius * turn * np.cos(turn * t), radius * turn * np.cos(2 * turn * t)
        return np.column_stack([x, y, np.zeros_like(t)])

    return follow(spans(point, derivative, 4), "figure eight", how)
