"""Slowness: the reciprocal of the feed that joint limits allow, of many paths and of one curve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from dualarm_pin.arrays import Array
from dualarm_pin.motion.limits import Limits

_PER_LINK = 6  # places in a link at which limits are looked at


@dataclass(frozen=True, eq=False)
class Slowness:
    """What a steady feed asks of the joints: speed and acceleration.

    Torque and jerk are left to the motion that is made of the answer.

    Attributes:
        place: Of the points (h,) [m].
        limits: What the joints can do.
    """

    place: Array
    limits: Limits

    @property
    def accelerated(self) -> bool:
        """Whether accelerations are limited."""
        return "acceleration" in self.limits.kinds

    @property
    def between(self) -> Array:
        """Places at which it is looked at (m,)."""
        part = np.arange(_PER_LINK) / _PER_LINK
        inner = self.place[:-1, None] + np.diff(self.place)[:, None] * part
        return np.append(inner.ravel(), self.place[-1])

    def uses(self, first: Array, second: Array) -> tuple[Array, Array]:
        """Return the shares of the limits at a feed of 1 m/s, signed, from derivatives by place."""
        return first / self.limits.velocity, second / self.limits.acceleration

    def worst(self, uses: tuple[Array, Array]) -> float:
        """Return 1 / feed [s/m] that these shares come to."""
        slow = float(np.abs(uses[0]).max())
        return max(slow, float(np.sqrt(np.abs(uses[1]).max()))) if self.accelerated else slow

    def of_paths(self, q: Array) -> Array:
        """Return 1 / feed (p,) [s/m] of paths (p, h, n), by splines with straight ends."""
        basis = CubicSpline(self.place, np.eye(len(self.place)), bc_type="natural")
        slow = np.zeros(len(q))
        orders = (1, 2) if self.accelerated else (1,)
        for order in orders:
            limit = self.limits.velocity if order == 1 else self.limits.acceleration
            rate = np.abs(np.einsum("mh,phn->pmn", basis(self.between, order), q)) / limit
            slow = np.maximum(slow, rate.max(axis=(1, 2)) ** (1.0 / order))
        return slow
