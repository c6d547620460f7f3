"""Which points of a motion a program needs: as few as the tolerance of the path allows."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.exports.format import Format
from dualarm_pin.exports.interpolate import linear, quintic_of
from dualarm_pin.exports.motion_path import MotionPath
from dualarm_pin.exports.program import Points

if TYPE_CHECKING:
    from dualarm_pin.motion import Motion

_LOOKS = 15  # places between two points; the largest error of an arc is met within 1 %
_FASTER = 1.05  # times the largest speed and acceleration of the motion, on a polynomial
_HARDLY = 0.01  # of what the fastest joint reaches
_GROW, _SHRINK = 1.5, 0.6  # how the next guess of a length differs from the last

Fits = Callable[[int, int], bool]


def points_of(motion: Motion) -> Points:
    """Return every sample of a motion."""
    return Points(motion.q, motion.time, motion.velocity, motion.acceleration)


def choose_points(motion: Motion, path: MotionPath, target: Format, share: float) -> Points:
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
    keeps = {"linear": _straight, "quintic": _smooth}[target.between](every, path, share)
    time, _, _ = _timed(every)

    def fits(a: int, b: int) -> bool:
        return bool(time[b] - time[a] <= target.longest_move) and keeps(a, b)

    return _some(every, _thinned(fits, len(every)))


def _at_equal_times(every: Points, period: float) -> Points:
    end = _timed(every)[0][-1]
    time = period * np.arange(math.ceil(end / period - 1e-9) + 1)
    return Points(quintic_of(every)(np.minimum(time, end)), time)


def _timed(every: Points) -> tuple[Array, Array, Array]:
    """Return time, velocity and acceleration, which the samples of a motion have."""
    assert every.time is not None
    assert every.velocity is not None
    assert every.acceleration is not None
    return every.time, every.velocity, every.acceleration


def _some(every: Points, chosen: list[int]) -> Points:
    time, velocity, acceleration = (part[chosen] for part in _timed(every))
    return Points(every.values[chosen], time - time[0], velocity, acceleration)


def _straight(every: Points, path: MotionPath, share: float) -> Fits:
    """Return whether straight joints from sample a to sample b keep to the path."""

    def fits(a: int, b: int) -> bool:
        look, length = _looks(a, b), path.length
        if not length[b] > length[a]:
            return False
        place = (length[look] - length[a]) / (length[b] - length[a])
        return path.within(linear(_some(every, [a, b]), place), look, share, slide=True)

    return fits


def _smooth(every: Points, path: MotionPath, share: float) -> Fits:
    """Return whether a polynomial does, at the same times and no faster than the motion."""
    time, velocity, acceleration = _timed(every)
    limits = [_limit(rate) for rate in (velocity, acceleration)]

    def fits(a: int, b: int) -> bool:
        look, curve = _looks(a, b), quintic_of(_some(every, [a, b]))
        at = time[look] - time[a]
        for order, limit in enumerate(limits, 1):
            if np.any(np.abs(curve(at, order)) > limit):
                return False
        return path.within(curve(at), look, share, slide=False)

    return fits


def _limit(rate: Array) -> Array:
    """Return what each joint may reach (n,); one that hardly moves beside the others is free."""
    largest = np.abs(rate).max(axis=0)
    return np.asarray(np.maximum(_FASTER * largest, _HARDLY * largest.max()))


def _looks(a: int, b: int) -> Integers:
    return np.unique(np.linspace(a, b, _LOOKS + 2).round().astype(np.int64))[1:-1]


def _thinned(fits: Fits, count: int) -> list[int]:
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
