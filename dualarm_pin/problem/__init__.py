"""The nonlinear programme over the points of a path: one record, made once a task."""

from dualarm_pin.problem.bounds import Bounds
from dualarm_pin.problem.links import Links, Neighbours
from dualarm_pin.problem.points import Points
from dualarm_pin.problem.problem import Problem
from dualarm_pin.problem.terms import CALLED, FORCE, IndexTerms

__all__ = [
    "CALLED",
    "FORCE",
    "Bounds",
    "IndexTerms",
    "Links",
    "Neighbours",
    "Points",
    "Problem",
]
