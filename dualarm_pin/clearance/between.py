"""Distances between the points of a path, on straight lines in the joints, as pages play them.

Inner samples first. Then a certificate: an interval of a line is done for a pair when its ends are
so far apart that nothing in between can be too near (`travel`), and is halved until it is.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell.parts import Pair
from dualarm_pin.clearance.rule import keeps
from dualarm_pin.clearance.travel import travel
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

_INNER = 3  # samples inside each line: dips of a line are found to a fraction of their depth
_SHARP = 5e-4  # m; how near the bound comes to the smallest distance that was seen
_MOST = 20_000  # distances of single pairs before the certificate is given up: half a second
_MESHES = 1_000  # distances between meshes as they are, of pairs that are too near anyway
_MOST_MESHES = 20_000  # the same of all pairs: a few seconds


@dataclass(frozen=True, eq=False)
class Between:
    """What was found between the points of a path.

    Attributes:
        distance: Smallest distance that was seen on the line after each point (h - 1,) [m].
        place: Where on that line, 0 to 1 (h - 1,).
        pairs: Between which bodies.
        bound: No distance is below this [m]; None where they were sampled only.
    """

    distance: Array
    place: Array
    pairs: tuple[Pair, ...]
    bound: float | None

    @property
    def least(self) -> float:
        """The smallest distance that was seen [m]."""
        return float(np.min(self.distance))

    @property
    def line(self) -> int:
        """After which point, from 0, it was seen."""
        return int(np.argmin(self.distance))


class Search:
    """Looks at the lines between postures, and keeps the smallest and the worst that it sees.

    Args:
        cell: The two arms.
        q: Postures (h, n) [rad or m], at least two.
        required: What each of `Cell.pairs` must keep (p,) [m]; -inf leaves a pair out. At least
            one pair is asked for.

    Attributes:
        points: Distance of each asked pair at each posture (h, a) [m]; meshes as they are where
            their hulls are too near.
        asked: Which pairs of the cell these are (a,).
        worst: What lacks most to what is required: (lack [m], line, place, which of `asked`).
        distances: How many distances of single pairs the certificate took.
    """

    def __init__(self, cell: Cell, q: Array, required: Array) -> None:
        self.cell, self.q = cell, q
        self.asked = np.flatnonzero(required > -np.inf)
        self.required = required[self.asked]
        self.goal = np.maximum(self.required - TOLERANCE.clearance, 0.0)
        self.broken = np.zeros(len(self.asked), dtype=bool)
        self.worst = (-np.inf, 0, 0.0, 0)
        self.distances = self._meshes = 0
        self.points = np.array([self._all(q_i) for q_i in q])
        for i, k in np.ndindex(*self.points.shape):
            last = i == len(q) - 1
            self._judge(i - last, float(last), k, float(self.points[i, k]))

    @property
    def kept(self) -> bool:
        """Whether every pair keeps what is asked of it wherever it was looked at, or bounded."""
        return not self.broken.any()

    def between(self) -> Between:
        """Sample the lines, then bound what lies between the samples."""
        lines, at = len(self.q) - 1, np.linspace(0.0, 1.0, _INNER + 2)
        nodes = np.stack([self.points[:-1]] * len(at), axis=1)
        nodes[:, -1] = self.points[1:]
        for i in range(lines):
            for j in range(1, _INNER + 1):
                nodes[i, j] = self._all(self._posture(i, at[j]))
        self.best = np.full(lines, np.inf)
        self.place, self.pair = np.zeros(lines), np.zeros(lines, dtype=np.int64)
        for i, j in np.ndindex(lines, len(at)):
            k = int(np.argmin(nodes[i, j]))
            self._seen(i, float(at[j]), k, float(nodes[i, j, k]))
            if 0 < j <= _INNER:
                for near in np.flatnonzero(nodes[i, j] < self.required).tolist():
                    self._judge(i, float(at[j]), near, float(nodes[i, j, near]))
        bound = self._halve(nodes, at, travel(self.cell, self.q)[:, self.asked])
        pairs = tuple(self.cell.pairs[self.asked[k]] for k in self.pair)
        return Between(self.best, self.place, pairs, bound)

    def _halve(self, nodes: Array, at: Array, speed: Array) -> float | None:
        """Return the bound of all distances, or None if it takes too long."""
        width, near = float(at[1]), float(self.best.min()) - _SHARP
        low = (nodes[:, :-1] + nodes[:, 1:] - speed[:, None] * width) / 2.0
        open_ = (low <= self.goal) | (low < near)
        todo: list[tuple[float, int, int, float, float, float, float]] = [
            (float(low[i, j, k]), i, k, j * width, width, nodes[i, j, k], nodes[i, j + 1, k])
            for i, j, k in np.argwhere(open_).tolist()
        ]
        heapq.heapify(todo)
        proven = float(np.min(low, where=~open_, initial=np.inf))
        while todo:
            bound, i, k, t, width, a, b = heapq.heappop(todo)
            sure = bound > self.goal[k] or self.broken[k]
            if sure and bound >= self.best.min() - _SHARP:
                proven = min(proven, bound)
                continue
            if self.distances >= _MOST:
                return None
            middle, half = t + width / 2.0, width / 2.0
            c = self._one(i, middle, k)
            self._seen(i, middle, k, c)
            self._judge(i, middle, k, c)
            for start, one, two in ((t, a, c), (middle, c, b)):
                low_half = (one + two - float(speed[i, k]) * half) / 2.0
                heapq.heappush(todo, (low_half, i, k, start, half, one, two))
        return min(proven, float(self.best.min()))

    def _seen(self, i: int, t: float, k: int, distance: float) -> None:
        if distance < self.best[i]:
            self.best[i], self.place[i], self.pair[i] = distance, t, k

    def _judge(self, i: int, t: float, k: int, distance: float) -> None:
        required = float(self.required[k])
        self.broken[k] |= not keeps(distance, required)
        if required - distance > self.worst[0]:
            self.worst = (required - distance, i, t, k)

    def _posture(self, i: int, t: float) -> Array:
        posture: Array = (1.0 - t) * self.q[i] + t * self.q[i + 1]
        return posture

    def _all(self, q: Array) -> Array:
        """Return the distances of all asked pairs at one posture (a,)."""
        found = self.cell.distances(q)[self.asked]
        for k in np.flatnonzero(found < self.required):
            found[k] = self._exact(q, int(k), float(found[k]))
        return found

    def _one(self, i: int, t: float, k: int) -> float:
        self.distances += 1
        q = self._posture(i, t)
        hulls = self.cell.distance(q, int(self.asked[k]))
        return hulls if hulls >= self.required[k] else self._exact(q, k, hulls)

    def _exact(self, q: Array, k: int, hulls: float) -> float:
        """Return the distance of meshes as they are; that of the hulls is never more."""
        if self._meshes >= (_MESHES if self.broken[k] else _MOST_MESHES):
            return hulls
        self._meshes += 1
        distance = self.cell.distance(q, int(self.asked[k]), exact=True)
        self.broken[k] |= not keeps(distance, float(self.required[k]))
        return distance
