"""Starts, workers and distinct minima."""

from dualarm_pin.multistart.minima import distinct_minima, same_minimum
from dualarm_pin.multistart.starts import common_postures, independent_postures
from dualarm_pin.multistart.workers import Workers

__all__ = [
    "Workers",
    "common_postures",
    "distinct_minima",
    "independent_postures",
    "same_minimum",
]
