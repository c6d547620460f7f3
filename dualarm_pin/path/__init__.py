"""The relative path: the noun, the generators that make one, the files that hold one."""

from dualarm_pin.path.path import Path

__all__ = ["Path"]
