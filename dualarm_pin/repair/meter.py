"""How much a repair may cost, counted like the work of a search; only a time limit is measured."""

from __future__ import annotations

import time

import numpy as np

from dualarm_pin.problem import Problem
from dualarm_pin.search.work import Work

# Seconds, measured: to place the bodies of a posture, of each pair as hulls and as meshes, of each
# triangle of these; of a row in a Newton step; of what a call takes beside these.
_POSTURE, _PAIR, _MESHES, _TRIANGLE, _ROW, _CALL = 5e-5, 1.4e-5, 2e-4, 4e-8, 5e-7, 5e-4
_PATIENCE = 4.0  # times the budget, while there is no path at all


class OverError(Exception):
    """The budget is spent."""


class Meter:
    """Counts.

    Attributes:
        spent: Seconds of a usual processor so far.
        found: There is a path: the budget holds.
        cut: The time limit ended it.
    """

    def __init__(self, problem: Problem, most: float = np.inf, deadline: float = np.inf) -> None:
        self._work, self._most, self._deadline = Work(problem), most, deadline
        self.spent, self.found, self.cut = 0.0, False, False

    def solved(self, iterations: int, points: int, rows: int) -> None:
        """Count Newton steps at all points, with rows of pairs at all of them together.

        Raises:
            OverError: Enough is spent.
        """
        self._add(_CALL + iterations * (self._work.seconds(points) + _ROW * rows))

    def searched(self, seconds: float) -> None:
        """Count the work of a search.

        Raises:
            OverError: Enough is spent.
        """
        self._add(seconds)

    def measured(self, postures: int, pairs: int) -> None:
        """Count postures at which bodies were placed, and pairs that were measured.

        Raises:
            OverError: Enough is spent.
        """
        self._add(_CALL + _POSTURE * postures + _PAIR * pairs)

    def meshes(self, triangles: int) -> None:
        """Count a pair that was measured as meshes of so many triangles together.

        Raises:
            OverError: Enough is spent.
        """
        self._add(_MESHES + _TRIANGLE * triangles)

    def _add(self, seconds: float) -> None:
        self.spent += seconds
        self.cut = time.monotonic() > self._deadline
        if self.cut or self.spent > self._most * (1.0 if self.found else _PATIENCE):
            raise OverError
