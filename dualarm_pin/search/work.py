"""Work: what a search has spent, in seconds of a usual processor, counted and not measured.

So a budget ends at the same start on every machine and for any number of threads.
"""

from __future__ import annotations

from dualarm_pin.problem import CALLED, Problem

# Microseconds of a Newton step at one point of n joints, measured from 9 to 14 joints with the
# force index: about linear. An index that is called as a function costs about fifteen times that.
_PER_JOINT, _LESS, _LEAST, _CALLED = 0.62, 2.4, 1.5, 15.0
_ROW = 0.5  # microseconds of an inequality row in such a step


class Work:
    """Counts Newton steps of one point.

    Attributes:
        spent: Seconds so far.
    """

    def __init__(self, problem: Problem) -> None:
        called = _CALLED if problem.terms.kind == CALLED else 1.0
        rows = _ROW * float(problem.inequalities.size.mean())
        self._step = 1e-6 * (called * max(_LEAST, _PER_JOINT * problem.n - _LESS) + rows)
        self.spent = 0.0

    def add(self, steps: float) -> None:
        """Count Newton steps of one point: iterations times points."""
        self.spent += self.seconds(steps)

    def seconds(self, steps: float) -> float:
        """Return what Newton steps of one point cost."""
        return self._step * float(steps)
