"""The joint limits of a session, which may differ from those of its cell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, UnknownNameError, nearest

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Range = tuple[float, float]


class Limits:
    """Bounds of all joints.

    Args:
        cell: The cell, whose bounds they are at first.
        ranges: Bounds of each joint [rad or m]; those of the cell if None.
    """

    def __init__(self, cell: Cell, ranges: tuple[Range, ...] | None = None) -> None:
        self._cell = cell
        self._own = tuple(zip(cell.lower.tolist(), cell.upper.tolist(), strict=True))
        self._ranges = self._own if ranges is None else ranges

    def changed(self, given: Mapping[str, Range]) -> Limits:
        """Return the limits with others for some joints.

        Raises:
            UnknownNameError: There is no such joint.
            InputError: Bounds are not finite or crossed.
        """
        names, ranges = self._cell.joint_names, list(self._ranges)
        for joint, (low, high) in given.items():
            if joint not in names:
                hint = nearest(joint, names)
                raise UnknownNameError(f"there is no joint {joint!r}; {hint}", field="limits")
            if not (np.isfinite([low, high]).all() and low < high):
                raise InputError(f"from {low} to {high} is no range", field=f"limits.{joint}")
            ranges[names.index(joint)] = (low, high)
        return Limits(self._cell, tuple(ranges))

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds (n,) [rad or m]."""
        lower, upper = np.array(self._ranges).T
        return lower, upper

    @property
    def new(self) -> dict[str, Range]:
        """The ranges that are not those of the cell, by joint."""
        every = zip(self._cell.joint_names, self._ranges, self._own, strict=True)
        return {name: now for name, now, own in every if now != own}
