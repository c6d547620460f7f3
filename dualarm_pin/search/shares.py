"""Shares: which kind of move gets the next work, by what each has won for its work so far.

On some cells only windows of a path win anything, on others only whole paths or new rounds do, and
nothing tells it beforehand.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_BEFORE = 0.15  # s of work with one win, that every kind is believed to have behind it at first


class Shares:
    """Kinds of moves, each with what it won and what that took.

    Args:
        belief: How likely each kind is to win before anything is known (kinds,).
    """

    def __init__(self, belief: list[float]) -> None:
        self._belief = np.array(belief)
        self._won, self._work = np.zeros(len(belief)), np.zeros(len(belief))

    def draw(self, random: np.random.Generator) -> int:
        """Return a kind, the likelier the more it has won for its work."""
        rate = self._belief * (1.0 + self._won) / (_BEFORE + self._work)
        return int(random.choice(len(rate), p=rate / rate.sum()))

    def record(self, kind: int, work: float, won: float) -> None:
        """Count what a move of one kind won and took."""
        self._work[kind] += work
        self._won[kind] += won

    def outdone_by(self, won: float, work: float) -> bool:
        """Tell whether a kind that is none of these has won as much for its work as all of them."""
        mine = (1.0 + self._won.sum()) / (_BEFORE + self._work.sum())
        return bool((1.0 + won) / (_BEFORE + work) >= mine)
