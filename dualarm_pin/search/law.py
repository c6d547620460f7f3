"""Law: one way of drawing starts. A search mixes laws without knowing how each of them draws.

Every law grows: more starts, those made before included, so that the same seed draws the same
starts for any number of threads and any number of rounds. What the starts came to is `Drawn`.
"""

from __future__ import annotations

from collections.abc import Sequence
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
    def weights(self) -> Labels:
        """How many starts led to each end (s,)."""
        return np.ones(len(self.ends), dtype=np.int64) if self.weight is None else self.weight

    @property
    def best(self) -> Array | None:
        """The lowest end (k, n): of those that converged, else of those on the path, else None."""
        ends = self.ends
        usable = ends.converged if ends.converged.any() else ends.feasible
        if not usable.any():
            return None
        q: Array = ends.q[int(np.argmin(np.where(usable, ends.objective, np.inf)))]
        return q


class Counted(Protocol):
    """What has drawn starts under a name."""

    @property
    def name(self) -> str:
        """What the law is called in results."""

    def drawn(self) -> Drawn | None:
        """Return what the starts so far came to, or None before the first."""


class Law(Counted, Protocol):
    """A way of drawing starts; each is one file of this folder."""

    def grow(self, starts: int) -> None:
        """Make starts until there are `starts`, those made before included.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """


@dataclass(frozen=True)
class Joined:
    """Several searches by one law, counted as one law (without `grow`)."""

    laws: Sequence[Law]

    @property
    def name(self) -> str:
        """That of the law."""
        return self.laws[0].name

    def drawn(self) -> Drawn | None:
        """Return what the starts of all came to, or None before the first."""
        parts = [part for law in self.laws if (part := law.drawn()) is not None]
        if not parts:
            return None
        return Drawn(
            sum(part.starts for part in parts),
            Solutions.join([part.ends for part in parts]),
            np.concatenate([part.weights for part in parts]),
        )
