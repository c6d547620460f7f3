"""Which points of a motion a program needs: as few as the tolerance of the path allows."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.exports.format import Format
from dualarm_pin.exports.interpolate import BETWEEN, quintic_of
from dualarm_pin.exports.program import Points
from dualarm_pin.exports.relative_path import RelativePath

if TYPE_CHECKING:
    from dualarm_pin.motion import Motion

_LOOKS = 15  # places between two points; the largest error of an arc is met within 1 %
_GROW, _SHRINK = 1.5, 0.6  # how the next guess of a length differs from the last


def points_of(motion: Motion) -> Points:
    """Return every sample of a motion."""
    return Points(motion.q, motion.time, motion.velocity, motion.acceleration)


def choose_points(motion: Motion, path: RelativePath, target: Format, share: float) -> Points:
    """Return the points of a motion that a program of a format runs through.

    Args:
        motion: The motion.
        path: Its relative path, in the measure of the tolerance.
        target: The format.
        share: How much of the tolerance to use; few places are looked at.
    """
    every = points_of(motion)
    if target.period is not None:
        return _at_equal_times(every, target.period)
    if target.every_sample:
        return every
    return _some(every, _thinned(_acceptable(every, path, target, share), len(every)))


def _at_equal_times(every: Points, period: float) -> Points:
    assert every.time is not None
    end = every.time[-1]
    time = period * np.arange(math.ceil(end / period - 1e-9) + 1)
    return Points(quintic_of(every)(np.minimum(time, end)), time)


def _some(every: Points, chosen: list[int]) -> Points:
    assert every.time is not None
    assert every.velocity is not None
    assert every.acceleration is not None
    time = every.time[chosen] - every.time[chosen[0]]
    return Points(every.values[chosen], time, every.velocity[chosen], every.acceleration[chosen])


def _acceptable(
    every: Points, path: RelativePath, target: Format, share: float
) -> Callable[[int, int], bool]:
    """Return whether a program may go from sample a to sample b without those between."""
    assert every.time is not None
    time = every.time

    def fits(a: int, b: int) -> bool:
        if time[b] - time[a] > target.longest_move:
            return False
        look = np.unique(np.linspace(a, b, _LOOKS + 2).round().astype(np.int64))[1:-1]
        clock = time if target.between == "quintic" else path.length
        span = clock[b] - clock[a]
        place = (clock[look] - clock[a]) / span if span > 0.0 else np.zeros(len(look))
        q: Array = BETWEEN[target.between](_some(every, [a, b]), place)
        # A polynomial in time is compared at the same time: then its speed is near too.
        return path.within(q, look, share, slide=target.between == "linear")

    return fits


def _thinned(fits: Callable[[int, int], bool], count: int) -> list[int]:
    """Return samples, the first and the last among them, each as far from the one before as fits.

    A neighbour is always taken: the samples of the motion are as near as its own chord error asks.
    """
    chosen, length = [0], 2
    while chosen[-1] < count - 1:
        start = chosen[-1]
        room = count - 1 - start
        length = min(length, room)
        if length == 1 or fits(start, start + length):
            while length < room and fits(start, start + (more := min(_grown(length), room))):
                length = more
        else:
            while length > 1 and not fits(start, start + length):
                length = int(length * _SHRINK)
            length = max(length, 1)
        chosen.append(start + length)
    return chosen


def _grown(length: int) -> int:
    return max(length + 1, int(length * _GROW))
