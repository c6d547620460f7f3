"""Solution: one local solve, judged by residuals recomputed at the point it returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Solution:
    """The end of one start.

    Attributes:
        q: Joints (k, n).
        objective: Objective at q.
        residual: Largest pose residual at q, recomputed.
        feasible: The residual is within tolerance and the bounds hold.
        converged: The solver met its own stop criterion of optimality.
        message: Why the solver stopped.
        start: Number of the start within its law.
        law: Name of the law that drew the start.
        wall_s: Seconds.
        iterations: Iterations, or evaluations where the solver counts those.
        extra: What else the solver knows, such as multipliers.
    """

    q: Array
    objective: float
    residual: float
    feasible: bool
    converged: bool
    message: str
    start: int = 0
    law: str = ""
    wall_s: float = 0.0
    iterations: int = 0
    extra: dict[str, Any] = field(default_factory=dict)
