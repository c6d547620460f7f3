"""Solvers: each takes a `Problem` and a start and returns a `Solution`; yours may be any function.

`InteriorPoint`, `Slsqp` and `Casadi` are ours; `judged` makes the solution of a solver of your own.
"""

from dualarm_pin.problem import Problem
from dualarm_pin.solution import Solution
from dualarm_pin.solvers.shipped import SOLVERS, Casadi, InteriorPoint, Slsqp
from dualarm_pin.solvers.solver import Solver, judged

__all__ = ["SOLVERS", "Casadi", "InteriorPoint", "Problem", "Slsqp", "Solution", "Solver", "judged"]
