"""Law: one way of drawing starts. A search mixes laws without knowing how each of them draws.

Every law grows: more starts, those made before included, so that the same seed draws the same
starts for any number of threads and any number of rounds. What the starts came to is `Drawn`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.solution import Solutions

Array = NDArray[np.float64]
Labels = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Drawn:
    """What the starts of a law came to.

    Attributes:
        starts: Starts in all, those included that led to no end.
        ends: Where they ended, paths of all points (s, k, n).
        weight: How many starts led to each end (s,); None for one each, in their order.
    """

    starts: int
    ends: Solutions
    weight: Labels | None = None

    @property
    def best(self) -> Array | None:
        """The lowest end (k, n): of those that converged, else of those on the path, else None."""
        ends = self.ends
        usable = ends.converged if ends.converged.any() else ends.feasible
        if not usable.any():
            return None
        q: Array = ends.q[int(np.argmin(np.where(usable, ends.objective, np.inf)))]
        return q


class Law(Protocol):
    """A way of drawing starts; each is one file of this folder."""

    name: str

    def grow(self, starts: int) -> None:
        """Make starts until there are `starts`, those made before included.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """

    def drawn(self) -> Drawn | None:
        """Return what the starts so far came to, or None before the first."""
