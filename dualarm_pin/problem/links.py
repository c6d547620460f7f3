"""What joins the points of a problem: links between neighbours, and to fixed ones at the ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.arrays import checked

Array = NDArray[np.float64]


class Links(NamedTuple):
    """The link after each point; that after the last one leads nowhere.

    Attributes:
        weight: (k,) lambda_i.
        metric: (k, n) diagonal m_i; the fixed neighbours take that of the nearest link.
    """

    weight: Array
    metric: Array

    def metric_of(self, i: int) -> Array:
        """Return the metric (n,) of the link from point i to i + 1; -1 is that before the first."""
        return np.asarray(self.metric[min(max(i, 0), max(len(self.metric) - 2, 0))])


class Neighbours(NamedTuple):
    """Fixed postures before the first point and after the last.

    Attributes:
        posture: (2, n).
        weight: (2,) lambda of the links to them, 0 for none.
    """

    posture: Array
    weight: Array


def metric_rows(given: ArrayLike, k: int, n: int) -> Array:
    """Return the metric of the link after each point (k, n)."""
    shape = (k - 1, n) if np.ndim(given) == 2 else (n,)
    rows = np.broadcast_to(checked("metric", given, shape), (k - 1, n))
    last = rows[-1:] if k > 1 else np.ones((1, n))
    return np.ascontiguousarray(np.vstack([rows, last]))
