"""The solvers that ship with the package, as instances that a planner takes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Unpack

from dualarm_pin.arrays import Array
from dualarm_pin.solution import Solution, Solutions
from dualarm_pin.solvers.solver import ManyOptions, Solver

if TYPE_CHECKING:
    from dualarm_pin.engine.solve import Options
    from dualarm_pin.problem import Problem
    from dualarm_pin.solvers.casadi_ipopt import Plugin
    from dualarm_pin.solvers.slsqp import SlsqpOptions


@dataclass(frozen=True)
class InteriorPoint:
    """The compiled engine: closed-form derivatives, structured interior point, many threads.

    Attributes:
        options: Stop criteria; None for those of the engine.
    """

    options: Options | None = None
    name: ClassVar[str] = "engine"

    def __call__(self, problem: Problem, start: Array, /) -> Solution:
        """Minimise `problem` from `start` (k, n)."""
        from dualarm_pin.solvers import interior_point

        return interior_point.solve(problem, start, self.options)

    def solve_many(self, problem: Problem, starts: Array, **how: Unpack[ManyOptions]) -> Solutions:
        """Minimise from many starts over threads; see `ManyStarts`."""
        from dualarm_pin.engine.solve import Options
        from dualarm_pin.solvers import interior_point

        options, most = self.options, how.get("iterations")
        if most is not None:
            options = replace(options or Options(), iterations=most)
        jobs, points = how.get("jobs"), how.get("points")
        return interior_point.solve_many(problem, starts, jobs=jobs, options=options, points=points)


@dataclass(frozen=True)
class Slsqp:
    """NLopt's SLSQP with values and gradients from Pinocchio: the paper's solver.

    Attributes:
        options: Stop criteria; None for the defaults.
    """

    options: SlsqpOptions | None = None
    name: ClassVar[str] = "nlopt-slsqp"

    def __call__(self, problem: Problem, start: Array, /) -> Solution:
        """Minimise `problem` from `start` (k, n)."""
        from dualarm_pin.solvers import slsqp

        return slsqp.solve(problem, start, self.options)


@dataclass(frozen=True)
class Casadi:
    """CasADi's automatic differentiation with IPOPT or fatrop; needs the extra `casadi`.

    Attributes:
        plugin: `ipopt` or `fatrop`.
    """

    plugin: Plugin = "ipopt"

    @property
    def name(self) -> str:
        """What it is called in results."""
        return f"casadi-{self.plugin}"

    def __call__(self, problem: Problem, start: Array, /) -> Solution:
        """Minimise `problem` from `start` (k, n)."""
        from dualarm_pin.solvers import casadi_ipopt

        return casadi_ipopt.solve(problem, start, self.plugin)


ENGINE, SLSQP = InteriorPoint(), Slsqp()
SOLVERS: dict[str, Solver] = {
    "engine": ENGINE,
    "nlopt-slsqp": SLSQP,
    "ipopt": Casadi("ipopt"),
    "fatrop": Casadi("fatrop"),
}
"""The solvers by their names in files and on the command line."""
