"""Distances between the bodies while a motion is followed: only those that can matter are measured.

From frame to frame little moves. What a pair was last seen to keep, less what its bodies have moved
against each other since, bounds it from below; so do capsules around the bodies. A pair is measured
where the bounds leave open whether it is too near, or the nearest. (How deep bodies are in each
other is said only roughly, as Coal does; that they are is not.)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.cell.parts import Pair
from dualarm_pin.clearance.extent import ball_of
from dualarm_pin.clearance.rule import keeps
from dualarm_pin.design.places import Places, placed, segment_distance
from dualarm_pin.repair.covers import cover

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

_ROUNDING = 1e-9  # m; what the bounds may be off by


@dataclass(frozen=True)
class Near:
    """The nearest two bodies at the points of a motion.

    Attributes:
        pair: Which bodies.
        distance: How far apart they are [m].
        point: At which point, from 0.
        lacking: Whether any pair is nearer than required at any point.
    """

    pair: Pair
    distance: float
    point: int
    lacking: bool


class Distances:
    """What is near what along motions of one path, and what was learnt of it before.

    Bodies of different arms, objects and what stands still count; links of one arm, which are
    always near each other, only where they lack what is required.

    Args:
        cell: The two arms where the task has them; afterwards bases and tool may move.
        h: Points of the path.
    """

    def __init__(self, cell: Cell, h: int) -> None:
        self._cell, bodies = cell, cell.collision.geometryObjects
        pairs = [(pair.first, pair.second) for pair in cell.collision.collisionPairs]
        self._pairs = np.array(pairs, dtype=np.int64).reshape(-1, 2)
        covers = [cover(body) for body in bodies]
        self._ends = np.array(
            [
                [body.placement.actInv(end) for end in c.ends]
                for body, c in zip(bodies, covers, strict=True)
            ]
        )
        self._radius = np.array([c.radius for c in covers])[self._pairs].sum(axis=1)
        balls = [ball_of(bodies[second].geometry) for _, second in pairs]
        self._centre = np.array([centre for centre, _ in balls]).reshape(-1, 3)
        self._reach = np.array([radius for _, radius in balls])
        # Last measured: the distance, and the second body in the frame of the first.
        self._seen = np.full((h, len(pairs)), -np.inf)
        self._turn, self._shift = np.zeros((h, len(pairs), 3, 3)), np.zeros((h, len(pairs), 3))
        self._last = (0, 0)
        self.measured = 0

    def near(self, cell: Cell, q: Array, required: Array) -> Near | None:
        """Return the nearest two bodies, or None where no pair counts.

        Args:
            cell: The same cell where it stands now.
            q: Postures (h, n) [rad or m].
            required: What each pair must keep (p,) [m]; -inf leaves it out.
        """
        apart, need = self._cell.apart_by_nature, np.maximum(required, 0.0)
        counts = required > -np.inf
        if not np.any(apart & counts):
            return None
        places = placed(cell, q)
        low = np.where(counts, self._capsules(places), np.inf)
        # What was nearest before is near still: of the other arm nothing farther away matters.
        i, k = self._last
        if not (apart & counts)[k]:
            i, k = divmod(int(np.argmin(np.where(apart, low, np.inf))), low.shape[1])
        far = self._measure(places, i, k, need[k], low)
        point, pair = np.nonzero(low <= np.where(apart, np.maximum(need, far), need))
        moved = self._moved(places, point, pair)
        low[point, pair] = np.maximum(low[point, pair], self._seen[point, pair] - moved)
        best, lacking = (np.inf, 0, 0), False
        order = np.argsort(low[point, pair], kind="stable")
        for i, k in zip(point[order].tolist(), pair[order].tolist(), strict=True):
            if low[i, k] >= best[0] and (lacking or low[i, k] >= need.max()):
                break
            doubtful = low[i, k] < need[k]
            if not (low[i, k] < best[0] and (apart[k] or doubtful)) and (lacking or not doubtful):
                continue
            distance = self._measure(places, i, k, need[k], low)
            short = not keeps(distance, required[k])
            lacking |= short
            if short or apart[k]:
                best = min(best, (distance, i, k))
        distance, i, k = best
        if apart[k]:
            self._last = (i, k)
        return Near(self._cell.pairs[k], distance, i, lacking)

    def _measure(self, places: Places, i: int, k: int, need: float, low: Array) -> float:
        """Return the distance of pair k at point i, exactly where the hulls are too near."""
        first, second = self._pairs[k].tolist()
        poses = places.of(i, first), places.of(i, second)
        distance = self._cell.distance_placed(k, *poses)
        if distance < need:
            distance = self._cell.distance_placed(k, *poses, exact=True)
        self.measured += 1
        back = places.rotation[i, first].T
        self._turn[i, k] = back @ places.rotation[i, second]
        self._shift[i, k] = back @ (places.translation[i, second] - places.translation[i, first])
        self._seen[i, k] = low[i, k] = distance
        return distance

    def _moved(self, places: Places, point: Integers, pair: Integers) -> Array:
        """Return how far pairs (m,) at points (m,) have moved against each other, at most [m].

        A turn by an angle a moves what is within r of a centre by 2 r sin(a / 2) beside it: twice
        the sine is the norm of the difference of the rotations over the root of 2.
        """
        first, second = self._pairs[pair].T
        R, x = places.rotation, places.translation
        back = np.swapaxes(R[point, first], 1, 2)
        turn = back @ R[point, second] - self._turn[point, pair]
        shift = (back @ (x[point, second] - x[point, first])[..., None])[..., 0]
        shift += (turn @ self._centre[pair][..., None])[..., 0] - self._shift[point, pair]
        angle = np.linalg.norm(turn, axis=(1, 2)) / np.sqrt(2.0)
        return np.asarray(np.linalg.norm(shift, axis=1) + angle * self._reach[pair] + _ROUNDING)

    def _capsules(self, places: Places) -> Array:
        """Return the distances of the capsules around all pairs at all points (h, p) [m]."""
        ends = np.einsum("hbij,bej->hbei", places.rotation, self._ends)
        ends += places.translation[:, :, None, :]
        first, second = ends[:, self._pairs[:, 0]], ends[:, self._pairs[:, 1]]
        return np.asarray(segment_distance(first, second) - self._radius - _ROUNDING)
