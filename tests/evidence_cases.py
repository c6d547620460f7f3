"""Problems and paths that the tests of the evidence share: the paper's cell, few points."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from paper_case import problem as whole

from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import common_postures
from dualarm_pin.solution import Minima, distinct
from dualarm_pin.solvers import interior_point as engine

Array = NDArray[np.float64]


@cache
def six_points() -> Problem:
    """Return six points of the corner, linked as strongly as the paper's first stage."""
    return whole().subset([0, 6, 12, 18, 24, 30], 1.5)


@cache
def minima_of_six(starts: int = 300) -> Minima:
    """Return what many random starts of the six points came to, best first."""
    problem = six_points()
    random = np.random.default_rng(5)
    drawn = common_postures(problem.lower, problem.upper, problem.k, starts, random)
    return distinct(engine.solve_many(problem, drawn, jobs=2))


def random_path(problem: Problem, seed: int = 0) -> Array:
    random = np.random.default_rng(seed)
    return random.uniform(problem.lower, problem.upper, (problem.k, problem.n))
