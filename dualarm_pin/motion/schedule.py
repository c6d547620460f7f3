"""Schedules: the place along the path as piecewise polynomials of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline, PPoly

from dualarm_pin.arrays import Array

_PER_PIECE = 4  # samples a piece of the dense check
_STEADY = 4000  # times between which the place is taken as straight to find when it is reached


@dataclass(frozen=True, eq=False)
class Schedule:
    """When the tool is where.

    Attributes:
        place: Place along the path [m] over time [s], from 0 to `duration`.
    """

    place: PPoly

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return float(self.place.x[-1])

    def at(self, time: Array) -> tuple[Array, Array, Array, Array]:
        """Return place, speed, acceleration and jerk along the path at times (m,), each (m,)."""
        found = tuple(np.asarray(self.place(time, order)) for order in range(4))
        return found[0], found[1], found[2], found[3]

    def slower(self, factor: float) -> Schedule:
        """Return the same in `factor` times the time."""
        degree = len(self.place.c) - 1
        scale = factor ** -np.arange(degree, -1, -1.0)
        return Schedule(PPoly(self.place.c * scale[:, None], self.place.x * factor))

    def dense(self) -> Array:
        """Return times at which a check sees every piece, at both its ends and inside."""
        x = self.place.x
        inside = np.linspace(1e-6, 1.0 - 1e-6, _PER_PIECE)
        return np.asarray((x[:-1, None] + np.diff(x)[:, None] * inside).ravel())

    def times_of(self, place: Array) -> Array:
        """Return when the tool is at places (m,), to what a check needs."""
        steady = np.linspace(0.0, self.duration, _STEADY)
        time = np.unique(np.concatenate([self.dense(), steady]))
        found: Array = np.interp(place, np.maximum.accumulate(self.place(time)), time)
        return found

    @classmethod
    def of_squares(cls, s: Array, x: Array) -> Schedule:
        """Return the schedule of constant accelerations between grid points.

        Args:
            s: Grid (m,) [m].
            x: Squares of the speeds there (m,), never 0 at two neighbours [m^2/s^2].
        """
        speed, ds = np.sqrt(x), np.diff(s)
        step = 2.0 * ds / (speed[1:] + speed[:-1])
        acceleration = np.diff(x) / (2.0 * ds)
        time = np.concatenate([[0.0], np.cumsum(step)])
        return cls(PPoly(np.array([0.5 * acceleration, speed[:-1], s[:-1]]), time))

    def smoothed(self, window: float) -> Schedule:
        """Return this schedule with its speed averaged over a sliding window of time [s].

        The acceleration becomes continuous, the jerk finite; it takes `window` longer.
        """
        count = int(np.clip(np.ceil(40 * self.duration / window), 400, 4000))
        time = np.linspace(0.0, self.duration + window, count)
        held = np.clip([time - window, time], 0.0, self.duration)
        area = self.place.antiderivative()(held)
        end = float(self.place(self.duration))
        after = np.maximum(time - self.duration, 0.0) * end  # it waits at the end
        place = (area[1] + after - area[0]) / window
        return Schedule(CubicSpline(time, place, bc_type="clamped"))
