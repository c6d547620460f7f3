"""Plan the rest of a path again from a measured posture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.engine.solve import Options, solve
from dualarm_pin.problem import Neighbours, Problem
from dualarm_pin.solution import Multipliers, Solution

_WARM = Options.warm(tolerance=1e-6, iterations=60)  # rad or m: finer than what is measured
_AGAIN = Options(iterations=150, mu0=1e-2, push=1e-3)  # where a warm solve failed


def rest_of_path(problem: Problem, best: Solution, posture: Array, remaining: int) -> Solution:
    """Return the best motion for the points that are left, near the one that was followed.

    Args:
        problem: The whole path where things stand.
        best: Its motion, with multipliers.
        posture: (n,) where the joints are; the step from there to the next point counts.
        remaining: Points left, from the end.
    """
    first = problem.k - remaining
    rest = problem.window(first, remaining, linked=True)
    ends = np.vstack([posture, posture])
    rest = replace(rest, neighbours=Neighbours(ends, rest.neighbours.weight))
    known = best.multipliers
    assert known is not None  # the engine knows them
    each = (known.equalities, known.lower, known.upper, known.inequalities)
    warm = Multipliers(*(array[first:] for array in each))
    end = solve(rest, best.q[first:], _WARM, warm=warm)
    return end if end.converged else solve(rest, best.q[first:], _AGAIN)
