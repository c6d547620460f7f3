"""Distances between the points of a path, on straight lines in the joints, as pages play them.

Inner samples first. Then a certificate: an interval of a line is done for a pair when its ends are
so far apart that nothing in between can be too near (`travel`), and is halved until it is.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell.parts import Pair
from dualarm_pin.clearance.rule import keeps
from dualarm_pin.clearance.travel import travel
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Level = Literal["points", "samples", "certified"]

_INNER = 3  # samples inside each line: dips of a line are found to a fraction of their depth
_SHARP = 5e-4  # m; how near the bound comes to the smallest distance that was seen
_MOST = 20_000  # distances of single pairs before the certificate is given up: half a second
_MESHES = 400  # of which may be between meshes as they are: some milliseconds each


@dataclass(frozen=True, eq=False)
class Between:
    """What was found between the points of a path.

    Attributes:
        certified: Every distance was bounded, not only sampled.
        distance: Smallest distance that was seen on the line after each point (h - 1,) [m].
        place: Where on that line, 0 to 1 (h - 1,).
        pairs: Between which bodies.
        bound: No distance is below this [m]; -inf where nothing was certified.
        kept: Every pair keeps what is asked of it wherever it was looked at, or bounded.
        distances: How many distances of single pairs the certificate took.
    """

    certified: bool
    distance: Array
    place: Array
    pairs: tuple[Pair, ...]
    bound: float
    kept: bool
    distances: int

    @property
    def level(self) -> Level:
        """How it was looked at."""
        return "certified" if self.certified else "samples"

    @property
    def least(self) -> float:
        """The smallest distance that was seen [m]."""
        return float(np.min(self.distance))


def between_points(cell: Cell, q: Array, required: Array) -> Between:
    """Measure and bound the distances on the lines between postures.

    Args:
        cell: The two arms.
        q: Postures (h, n) [rad or m], at least two.
        required: What each of `Cell.pairs` must keep (p,) [m]; -inf leaves a pair out. At least
            one pair is asked for.
    """
    return _Search(cell, q, required).run()


class _Search:
    def __init__(self, cell: Cell, q: Array, required: Array) -> None:
        self.cell, self.q = cell, q
        self.asked = np.flatnonzero(required > -np.inf)
        self.required = required[self.asked]
        self.goal = np.maximum(self.required - TOLERANCE.clearance, 0.0)
        self.lines = len(q) - 1
        self.best = np.full(self.lines, np.inf)
        self.place = np.zeros(self.lines)
        self.pair = np.zeros(self.lines, dtype=np.int64)
        self.broken = np.zeros(len(self.asked), dtype=bool)
        self.count = self.meshes = 0

    def run(self) -> Between:
        at = np.linspace(0.0, 1.0, _INNER + 2)
        nodes = np.array([[self._all(i, t) for t in at] for i in range(self.lines)])
        for i, j, k in np.argwhere(nodes < self.required).tolist():
            nodes[i, j, k] = self._exact(i, float(at[j]), k, float(nodes[i, j, k]))
        for i, j in np.ndindex(self.lines, len(at)):
            k = int(np.argmin(nodes[i, j]))
            self._seen(i, float(at[j]), k, float(nodes[i, j, k]))
        self.broken |= ((nodes <= 0.0) | (nodes < self.goal)).any(axis=(0, 1))
        speed = travel(self.cell, self.q)[:, self.asked]
        bound = self._halve(nodes, at, speed)
        return Between(
            certified=bound is not None,
            distance=self.best,
            place=self.place,
            pairs=tuple(self.cell.pairs[self.asked[k]] for k in self.pair),
            bound=-np.inf if bound is None else bound,
            kept=not self.broken.any(),
            distances=self.count,
        )

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
            if self.count >= _MOST:
                return None
            middle, half = t + width / 2.0, width / 2.0
            c = self._one(i, middle, k)
            self._seen(i, middle, k, c)
            self.broken[k] |= not keeps(c, float(self.required[k]))
            for start, one, two in ((t, a, c), (middle, c, b)):
                low_half = (one + two - float(speed[i, k]) * half) / 2.0
                heapq.heappush(todo, (low_half, i, k, start, half, one, two))
        return min(proven, float(self.best.min()))

    def _seen(self, i: int, t: float, k: int, distance: float) -> None:
        if distance < self.best[i]:
            self.best[i], self.place[i], self.pair[i] = distance, t, k

    def _posture(self, i: int, t: float) -> Array:
        posture: Array = (1.0 - t) * self.q[i] + t * self.q[i + 1]
        return posture

    def _all(self, i: int, t: float) -> Array:
        return self.cell.distances(self._posture(i, t))[self.asked]

    def _one(self, i: int, t: float, k: int) -> float:
        self.count += 1
        hulls = self.cell.distance(self._posture(i, t), int(self.asked[k]))
        return hulls if hulls >= self.required[k] else self._exact(i, t, k, hulls)

    def _exact(self, i: int, t: float, k: int, hulls: float) -> float:
        """Return the distance of meshes as they are; that of the hulls is never more."""
        if self.meshes >= _MESHES:
            return hulls
        self.meshes += 1
        return self.cell.distance(self._posture(i, t), int(self.asked[k]), exact=True)
