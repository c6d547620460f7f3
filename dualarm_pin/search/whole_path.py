"""The whole-path law: one random posture at all points, then the whole path at once."""

from __future__ import annotations

from dualarm_pin.problem import Problem
from dualarm_pin.search.law import Drawn
from dualarm_pin.search.starts import common_postures, generator
from dualarm_pin.solution import Solutions
from dualarm_pin.solvers.shipped import ENGINE
from dualarm_pin.solvers.solver import Solver, solve_many


class WholePathLaw:
    """A law (`law.Law`) with as many ends as starts."""

    name = "whole path"

    def __init__(
        self, problem: Problem, seed: int, *, jobs: int | None = None, solver: Solver = ENGINE
    ) -> None:
        self.problem, self.seed, self.jobs, self.solver = problem, seed, jobs, solver
        self._ends: Solutions | None = None

    def drawn(self) -> Drawn | None:
        """Return what the starts so far came to, or None before the first."""
        return None if self._ends is None else Drawn(len(self._ends), self._ends)

    def grow(self, starts: int) -> None:
        """Make starts until there are `starts`, those made before included.

        Raises:
            KeyboardInterrupt: Ctrl-C; what was finished is kept.
        """
        made = 0 if self._ends is None else len(self._ends)
        fresh = starts - made
        if fresh <= 0:
            return
        problem = self.problem
        random = generator(self.seed, 20, made)
        drawn = common_postures(problem.lower, problem.upper, problem.k, fresh, random)
        ends = solve_many(self.solver, problem, drawn, jobs=self.jobs)
        ran = ends.take(ends.ran)
        self._ends = ran if self._ends is None else Solutions.join([self._ends, ran])
        if ends.interrupted:
            raise KeyboardInterrupt
