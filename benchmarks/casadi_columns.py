"""CasADi as a column of the benchmark: built once, before the clock starts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dualarm_pin.problem import Problem
from dualarm_pin.solution import Solution
from dualarm_pin.solvers import casadi_ipopt


def casadi_solver(
    problem: Problem, plugin: str, expand: bool
) -> Callable[[Problem, np.ndarray], Solution]:
    """Return the solver.

    Raises:
        MissingExtraError: CasADi is not installed.
    """
    programme = casadi_ipopt.build(problem, plugin, expand=expand)
    return lambda _, start: programme.solve(start)
