"""Where bodies come near each other along a path: as they are found, and as columns."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.chain import Integers
from dualarm_pin.solution import Flags
from dualarm_pin.tolerance import TOLERANCE


class Contacts(NamedTuple):
    """Pairs that come near at points of a path; c of them.

    Attributes:
        point: (c,) where.
        pair: (c,) which of the pairs that were asked for.
        distance: (c,) [m], negative in collision.
        lack: (c,) what is missing to the distance that is required [m].
        first: (c, 3) nearest point of the first body, in the frame of its joint [m].
        second: (c, 3) nearest point of the second body, in the frame of its joint [m].
        normal: (c, 3) unit vector from the first to the second body, in the frame of the first.
        exact: (c,) the nearest points of meshes, whose hulls are nearer.
    """

    point: Integers
    pair: Integers
    distance: Array
    lack: Array
    first: Array
    second: Array
    normal: Array
    exact: Flags

    def take(self, which: Flags | Integers) -> Contacts:
        """Return some of the contacts."""
        return Contacts._make([array[which] for array in self])

    def joined(self, other: Contacts) -> Contacts:
        """Return these contacts and others, by points."""
        both = [np.concatenate(pair) for pair in zip(self, other, strict=True)]
        order = np.argsort(both[0], kind="stable")
        return Contacts._make([array[order] for array in both])

    @property
    def kept(self) -> Flags:
        """Which contacts keep what is required, within the tolerance (c,)."""
        enough = self.lack <= TOLERANCE.clearance
        return np.asarray((self.distance > 0.0) & enough)

    @property
    def worst(self) -> float:
        """The largest lack [m]; minus infinity where no pair is near."""
        return float(np.max(self.lack, initial=-np.inf))


class Found(NamedTuple):
    """One contact; points and direction in the world."""

    point: int
    pair: int
    distance: float
    exact: bool
    first: Array
    second: Array
    normal: Array
