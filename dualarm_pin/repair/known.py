"""Distances of a pair that are known from nearby poses: measuring bodies is dear.

Between two relative poses a distance changes by at most what the second body moves against the
first, and no point of a body moves more than the corners of a box around it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.repair.contacts import Contacts
from dualarm_pin.solution import Flags

_KEPT = 64  # poses of each pair, the newest
_SAME = 1e-4  # m: a body that moves less has the same nearest points, well within the tolerance
_NEARLY = 5e-3  # m: meshes that met are taken to meet, so that their hulls say how deep


class Measured(NamedTuple):
    """What was measured of two meshes.

    Attributes:
        distance: [m]; 0 or less where they meet.
        first: Nearest point of the first body, in its joint's frame (3,) [m].
        second: The same of the second body.
    """

    distance: float
    first: Array
    second: Array


class Known:
    """What was measured between two bodies.

    Args:
        box: Corners (8, 3) of a box around the second body, in its joint's frame [m].
    """

    def __init__(self, box: Array) -> None:
        self._box = np.ascontiguousarray(box.T)
        self._at = np.full((3, 8, _KEPT), np.inf)
        self._distance = np.full(_KEPT, -np.inf)
        self._measured: list[Measured | None] = [None] * _KEPT
        self._next = 0

    def least(self, pose: Array) -> tuple[float, bool, Measured | None, bool]:
        """Say what is known at a pose (4, 4) of the second body in the first.

        Returns:
            A distance [m] that they keep, whether they met at nearly this pose, what was measured
            at the nearest one, and whether it is the same.
        """
        moved = self._at - self._corners(pose)
        moved *= moved
        away = np.sqrt((moved[0] + moved[1] + moved[2]).max(axis=0))
        nearest = int(np.argmin(away))
        last = self._measured[nearest]
        met = (self._distance <= 0.0) & (away < _NEARLY)
        same = last is not None and bool(away[nearest] < _SAME)
        return float(np.max(self._distance - away)), bool(met.any()), last, same

    def add(self, pose: Array, distance: float, measured: Measured | None) -> None:
        """Keep what was measured at a pose (4, 4): a distance that they keep [m], and where."""
        self._at[:, :, self._next] = self._corners(pose)[:, :, 0]
        self._distance[self._next] = distance
        self._measured[self._next] = measured
        self._next = (self._next + 1) % _KEPT

    def _corners(self, pose: Array) -> Array:
        return np.asarray(pose[:3, :3] @ self._box + pose[:3, 3:])[:, :, None]


class _Last(NamedTuple):
    """What was measured last of p pairs at each of m postures.

    Attributes:
        corners: (m, p, 8, 3) of the box around the second body then, seen from the first [m].
        distance: (m, p) that the two kept [m]; minus infinity where nothing was measured.
        near: (m, p) they were so near that there is a contact.
        exact: (m, p) of the contact, as in `Contacts`.
        where: (m, p, 3, 3) its `first`, `second` and `normal`.
    """

    corners: Array
    distance: Array
    near: Flags
    exact: Flags
    where: Array


class Recent:
    """Distances and contacts from the last postures of the same number.

    Args:
        boxes: Corners (p, 8, 3) of boxes around the second bodies, in their joints' frames [m].
    """

    def __init__(self, boxes: Array) -> None:
        self._boxes = boxes
        self._last: dict[int, _Last] = {}

    def least(
        self, poses: Array, many: int, i: Integers, pair: Integers
    ) -> tuple[Array, Flags, Array]:
        """Say what pairs keep at postures i of `many`.

        Args:
            poses: (c, 4, 4) of the second bodies in the first.
            many: How many postures.
            i: (c,) which.
            pair: (c,) which.

        Returns:
            Distances (c,) [m], where the last contact is recorded, and what `keep` takes.
        """
        corners = np.matmul(self._boxes[pair], np.swapaxes(poses[:, :3, :3], 1, 2))
        corners += poses[:, None, :3, 3]
        if many not in self._last:
            shape = (many, len(self._boxes))
            self._last[many] = _Last(
                np.full((*shape, 8, 3), np.inf),
                np.full(shape, -np.inf),
                np.zeros(shape, dtype=bool),
                np.zeros(shape, dtype=bool),
                np.zeros((*shape, 3, 3)),
            )
        last = self._last[many]
        moved = last.corners[i, pair] - corners
        away = np.sqrt(np.einsum("cki,cki->ck", moved, moved).max(axis=1))
        return last.distance[i, pair] - away, last.near[i, pair], corners

    def keep(
        self, corners: Array, many: int, i: Integers, pair: Integers, distance: ArrayLike
    ) -> None:
        """Keep distances (c,) [m] of pairs at postures i of `many`, with corners (c, 8, 3)."""
        last = self._last[many]
        last.corners[i, pair], last.distance[i, pair] = corners, distance
        last.near[i, pair] = False

    def record(self, many: int, contacts: Contacts) -> None:
        """Keep contacts at some of `many` postures, after their distances."""
        at, last = (contacts.point, contacts.pair), self._last[many]
        last.near[at], last.exact[at] = True, contacts.exact
        last.where[at] = np.stack([contacts.first, contacts.second, contacts.normal], axis=1)

    def recorded(
        self, many: int, i: Integers, pair: Integers, bound: Array, required: Array
    ) -> Contacts:
        """Return the recorded contacts of pairs at postures i of `many`, with what they keep now.

        Args:
            many: How many postures.
            i: (c,) which.
            pair: (c,) which.
            bound: (c,) distance that each keeps, as of `least` [m].
            required: (c,) of each [m].
        """
        last = self._last[many]
        first, second, normal = np.moveaxis(last.where[i, pair], 1, 0)
        exact = last.exact[i, pair]
        return Contacts(i, pair, bound, required - bound, first, second, normal, exact)
