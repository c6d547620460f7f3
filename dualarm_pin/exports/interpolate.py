"""What a controller does between the points of a program."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import BPoly

from dualarm_pin.arrays import Array
from dualarm_pin.exports.program import Points


def linear(points: Points, place: Array) -> Array:
    """Return joints (k, n) straight between points.

    Args:
        points: Joints, the unit of time does not matter.
        place: Where between them (k,): 1.5 is halfway between the second point and the third.
    """
    before = np.minimum(place.astype(np.int64), len(points) - 2)
    share = (place - before)[:, None]
    return np.asarray((1.0 - share) * points.values[before] + share * points.values[before + 1])


def quintic(points: Points, place: Array) -> Array:
    """Return joints (k, n) on polynomials of degree 5 through position, velocity, acceleration.

    Args:
        points: Joints, with all three and a time.
        place: As for `linear`.
    """
    assert points.time is not None
    time = np.interp(place, np.arange(len(points)), points.time)
    return np.asarray(quintic_of(points)(time))


def quintic_of(points: Points) -> BPoly:
    """Return the polynomials as a function of time.

    Raises:
        ValueError: The points have no time, velocity or acceleration.
    """
    if points.time is None or points.velocity is None or points.acceleration is None:
        raise ValueError("the file lacks times, velocities or accelerations")
    three = np.stack([points.values, points.velocity, points.acceleration], axis=1)
    return BPoly.from_derivatives(points.time, three)


BETWEEN = {"linear": linear, "quintic": quintic}
