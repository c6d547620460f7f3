"""How one start is solved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dualarm_pin.engine.interior_point.solve_one import Settings
from dualarm_pin.errors import InputError
from dualarm_pin.tolerance import TOLERANCE


@dataclass(frozen=True)
class Options:
    """How one start is solved.

    Attributes:
        tolerance: On stationarity, rows and complementarity, of an objective of size 1.
        iterations: Cap on Newton steps.
        mu0: First barrier parameter.
        push: Share of every range to which the start is moved away from its bounds.
    """

    tolerance: float = TOLERANCE.search
    iterations: int = 150
    mu0: float = 0.1
    push: float = 1e-2

    @classmethod
    def warm(cls, tolerance: float = TOLERANCE.search, iterations: int = 150) -> Options:
        """Return options for a start that is nearly the answer, multipliers kept."""
        return cls(tolerance, iterations, 1e-6, 1e-6)

    def settings(self) -> Settings:
        """Return the numbers as the compiled code takes them, checked.

        Raises:
            InputError: A number is out of its range.
        """
        for name in ("tolerance", "mu0", "push"):
            value = getattr(self, name)
            if not 0.0 < value < np.inf:
                raise InputError(f"is {value}, must be above 0", field=name)
        if self.push >= 0.5:
            raise InputError(f"is {self.push}, must be below 0.5", field="push")
        return Settings(
            float(self.tolerance), int(self.iterations), float(self.mu0), float(self.push), np.inf
        )
