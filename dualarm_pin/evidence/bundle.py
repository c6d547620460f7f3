"""The cutting-plane method that raises the multipliers: a model from above, a box to stay in.

Every known path x of a piece bounds that piece's minimum from above by a plane in theta,
f(x) + s(x) . theta. Their lower envelope, summed over the pieces, is a model that never lies
below the sum of the minima; its highest point within a box is tried next.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.arrays import Array

_MOST_PLANES = 800  # a piece; the linear programme of a step grows with them


@dataclass
class Planes:
    """The planes of one piece.

    Attributes:
        offset: f(x) (p,).
        slope: s(x) (p, d), d the number of multipliers.
        path: x (p, points, n).
    """

    offset: Array
    slope: Array
    path: Array

    def add(self, other: Planes) -> None:
        """Add planes; the oldest but the first fall out when there are too many."""
        first = max(1, len(self.offset) + len(other.offset) - _MOST_PLANES + 1)
        for name in ("offset", "slope", "path"):
            mine = getattr(self, name)
            setattr(self, name, np.concatenate([mine[:1], mine[first:], getattr(other, name)]))

    def take(self, which: Sequence[int] | NDArray[np.int64]) -> Planes:
        """Return some of the planes."""
        at = np.asarray(which, dtype=np.int64)
        return Planes(self.offset[at], self.slope[at], self.path[at])

    def height(self, theta: Array) -> Array:
        """Return the height (p,) of each plane at theta (d,)."""
        height: Array = self.offset + self.slope @ theta
        return height

    def lowest(self, theta: Array) -> float:
        """Return the height of the lowest plane at theta (d,)."""
        return float(np.min(self.height(theta)))

    def lowest_path(self, theta: Array) -> Array:
        """Return the path (points, n) of the lowest plane at theta (d,)."""
        path: Array = self.path[int(np.argmin(self.height(theta)))]
        return path


def highest(pieces: list[Planes], centre: Array, radius: float) -> tuple[Array, float]:
    """Return the highest point of the model within a box, and its height.

    Among all of them the one nearest to the centre is taken (a second programme): once the model
    is as high as the incumbent there are many, and corners of that set lead far away.

    Args:
        pieces: The planes of each piece.
        centre: Middle of the box (d,).
        radius: Half its width.
    """
    from scipy.optimize import linprog
    from scipy.sparse import csr_matrix

    d, m = len(centre), len(pieces)
    offset = np.concatenate([piece.height(centre) for piece in pieces])
    slope = np.concatenate([piece.slope for piece in pieces])
    own = np.repeat(np.eye(m), [len(piece.offset) for piece in pieces], axis=0)
    matrix = np.concatenate([-slope, own], axis=1)
    box = [(-radius, radius)] * d + [(None, None)] * m
    up = np.concatenate([np.zeros(d), -np.ones(m)])
    first = linprog(up, csr_matrix(matrix), offset, bounds=box, method="highs")
    if first.status != 0:
        return centre.copy(), sum(piece.lowest(centre) for piece in pieces)
    height = -float(first.fun)
    # min w, |x| <= w, sum of t >= height: as near to the centre as that height allows.
    wide = np.zeros((len(matrix) + 2 * d + 1, d + m + 1))
    wide[: len(matrix), :-1] = matrix
    wide[len(matrix) : -1, :d] = np.concatenate([np.eye(d), -np.eye(d)])
    wide[len(matrix) : -1, -1] = -1.0
    wide[-1, d : d + m] = -1.0
    slack = 1e-9 * max(1.0, abs(height))
    limit = np.concatenate([offset, np.zeros(2 * d), [slack - height]])
    nearest = np.zeros(d + m + 1)
    nearest[-1] = 1.0
    second = linprog(nearest, csr_matrix(wide), limit, bounds=[*box, (0.0, radius)], method="highs")
    x = first.x if second.status != 0 else second.x
    return centre + x[:d], height
