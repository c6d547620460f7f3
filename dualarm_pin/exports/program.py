"""The noun that writers and readers share: points of the joints, and when each is reached."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dualarm_pin.arrays import Array, finite
from dualarm_pin.errors import InputError, ShapeError


@dataclass(frozen=True, eq=False)
class Points:
    """Points of n joints that a program runs through.

    Attributes:
        values: (k, n), in the units and the convention of the format.
        time: From 0, rising (k,) [s]; None where a program cannot say.
        velocity: (k, n) [rad/s or m/s]; None where the format has none.
        acceleration: (k, n) [rad/s^2 or m/s^2]; None where the format has none.

    Raises:
        ShapeError: The arrays do not belong together.
        InputError: A value is not finite, or time does not rise from 0.
    """

    values: Array
    time: Array | None
    velocity: Array | None = None
    acceleration: Array | None = None

    def __post_init__(self) -> None:
        if np.ndim(self.values) != 2 or len(self.values) < 2:
            raise ShapeError("two points or more are expected", field="values")
        for name in ("values", "velocity", "acceleration"):
            if getattr(self, name) is not None:
                finite(getattr(self, name), name, self.values.shape)
        if self.time is None:
            return
        finite(self.time, "time", (len(self.values),))
        if self.time[0] != 0.0 or np.any(np.diff(self.time) <= 0.0):
            raise InputError("times must rise from 0", field="time")

    def __len__(self) -> int:
        return len(self.values)

    @property
    def duration(self) -> float | None:
        """How long it takes [s]; None where a program cannot say."""
        return None if self.time is None else float(self.time[-1])


@dataclass(frozen=True, eq=False)
class Program:
    """What a writer is given.

    Attributes:
        name: What the user calls it: any text; `names.identifier` makes a name of it.
        comment: Lines for the head of the file, in letters that no syntax minds.
        joints: Names of the columns, `arm1/<name>`: any text after the slash.
        ros_joints: The same as a ROS controller calls them: any text.
        arms: The columns of each arm that moves, `arm1` and `arm2`, base to tip.
        points: What it runs through; there is always a time.
    """

    name: str
    comment: tuple[str, ...]
    joints: tuple[str, ...]
    ros_joints: tuple[str, ...]
    arms: Mapping[str, slice]
    points: Points

    @cached_property
    def time(self) -> Array:
        """Time of each point (k,) [s]."""
        assert self.points.time is not None  # what is written has a time
        return self.points.time

    def axes(self, arm: str) -> list[list[float]]:
        """Return the values of one arm, a row for each point."""
        rows: list[list[float]] = self.points.values[:, self.arms[arm]].tolist()
        return rows

    def pieces(self, longest: int, start: int = 0) -> list[range]:
        """Return the points from `start` on in pieces of at most `longest`, alike in length."""
        count = len(self.points) - start
        number = -(-count // longest)
        cuts = [start + count * piece // number for piece in range(number + 1)]
        return [range(a, b) for a, b in itertools.pairwise(cuts)]
