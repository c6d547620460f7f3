"""The whole-path law: one random posture at all points, then the whole path at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import Solutions
from dualarm_pin.solvers.shipped import ENGINE
from dualarm_pin.solvers.solver import Solver, solve_many

Array = NDArray[np.float64]
NAME = "whole path"


class WholePathSearch:
    """A search that can grow; the same seed draws the same starts for any number of threads."""

    def __init__(
        self, problem: Problem, seed: int, *, jobs: int | None = None, solver: Solver = ENGINE
    ) -> None:
        self.problem, self.seed, self.jobs, self.solver = problem, seed, jobs, solver
        self.ends: Solutions | None = None

    @property
    def starts(self) -> int:
        """How many starts were made."""
        return 0 if self.ends is None else len(self.ends)

    def grow(self, starts: int) -> None:
        """Make starts until there are `starts`, those made before included.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        fresh = starts - self.starts
        if fresh <= 0:
            return
        problem = self.problem
        random = generator(self.seed, 20, self.starts)
        drawn = common_postures(problem.lower, problem.upper, problem.k, fresh, random)
        ends = solve_many(self.solver, problem, drawn, jobs=self.jobs)
        ran = ends.take(ends.ran)
        self.ends = ran if self.ends is None else Solutions.join([self.ends, ran])
        if ends.interrupted:
            raise KeyboardInterrupt
