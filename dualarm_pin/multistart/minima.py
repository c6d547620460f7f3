"""Which ends of starts are one minimum.

The joints decide, never the objective alone: mirror twins share an objective and are different
starts for a longer path.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from dualarm_pin.solvers.solution import Solution
from dualarm_pin.tolerance import TOLERANCE, Tolerance


def same_minimum(a: Solution, b: Solution, tolerance: Tolerance = TOLERANCE) -> bool:
    """Tell whether two solutions are one minimum: joints within 0.02 rad, objective within 1e-5."""
    scale = tolerance.same_objective * max(1.0, abs(a.objective))
    return (
        abs(a.objective - b.objective) < scale
        and float(np.max(np.abs(a.q - b.q))) < tolerance.same_joint
    )


def distinct_minima(
    solutions: Iterable[Solution], tolerance: Tolerance = TOLERANCE
) -> list[tuple[Solution, int]]:
    """Return the distinct minima among the feasible solutions, best first, and how often each."""
    ranked = sorted((s for s in solutions if s.feasible), key=lambda s: s.objective)
    minima: list[tuple[Solution, int]] = []
    for solution in ranked:
        for position in range(len(minima) - 1, -1, -1):
            known, hits = minima[position]
            near = tolerance.same_objective * max(1.0, abs(known.objective))
            if solution.objective - known.objective >= near:
                position = -1
                break
            if same_minimum(known, solution, tolerance):
                minima[position] = (known, hits + 1)
                break
        else:
            position = -1
        if position < 0:
            minima.append((solution, 1))
    return minima
