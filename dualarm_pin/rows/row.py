"""The noun: a row, one number that must be zero or more (or zero) at points of the path.

A row is a function of the pose (R, p) of body b in body a, both bodies of the one chain from hand 1
over the bases to hand 2. Its derivatives are taken along the twist [v; w] of b, in axes of a:

    g(p + v, exp([w]x) R) = g + slope . [v; w] + 1/2 [v; w] . bend [v; w] + ...

Pinocchio's side calls these functions as they are (`Row.at`); the engine compiles the same ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.relative import relative_motion

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Value = Callable[[Array, Array, Array], float]
Derivative = Callable[[Array, Array, Array], Array]

WORLD = "world"
TIPS = ("arm1/tip", "arm2/tip")
_STEP = 1e-4  # of differences, rad and m: the error of a second difference is then about 1e-8


@dataclass(frozen=True, eq=False)
class Row:
    """g(T_a_b) >= 0, or = 0, at some or all points of a path.

    Attributes:
        name: Name for tables and messages.
        first: Frame a: `world`, `arm1/tip`, `arm2/tip` or a frame of the cell's model.
        second: Frame b.
        phi: (R (3, 3), p (3,), parameters) -> g.
        slope: (R, p, parameters) -> (6,) derivative of g by [v; w]; central differences if None.
        bend: (R, p, parameters) -> (6, 6) second derivative, symmetric; differences if None.
        parameters: Numbers that the functions get, so that one function serves many rows.
        points: Points at which it holds, from 0; None for all.
        equality: g = 0 instead of g >= 0.
        units: Unit of g.
        expression: (casadi, R, p) -> g as a CasADi expression; None: CasADi cannot solve it.
    """

    name: str
    first: str
    second: str
    phi: Value
    slope: Derivative | None = None
    bend: Derivative | None = None
    parameters: Array = field(default_factory=lambda: np.zeros(0))
    points: tuple[int, ...] | None = None
    equality: bool = False
    units: str = "m"
    expression: Callable[[Any, Any, Any], Any] | None = None

    def __post_init__(self) -> None:
        if not callable(self.phi):
            raise InputError(
                f"is {self.phi!r}, must be a function of (R, p, parameters)", field="phi"
            )
        numbers = np.array(self.parameters, dtype=np.float64)
        if numbers.ndim != 1 or not np.isfinite(numbers).all():
            raise InputError("must be finite numbers", field=f"{self.name}.parameters")
        numbers.flags.writeable = False
        object.__setattr__(self, "parameters", numbers)
        if self.slope is None:
            object.__setattr__(self, "slope", DifferenceSlope(self.phi))
        if self.bend is None:
            object.__setattr__(self, "bend", DifferenceBend(self.phi))

    def at(self, cell: Cell, q: ArrayLike) -> tuple[float, Array]:
        """Return g and dg/dq (n,) at joints q (n,), by Pinocchio."""
        assert self.slope is not None  # set when the row was made
        T, J = relative_motion(cell, *self.frames(cell), q)
        R, p = np.array(T.rotation), np.array(T.translation)
        slope = np.asarray(self.slope(R, p, self.parameters), dtype=np.float64)
        return float(self.phi(R, p, self.parameters)), slope @ J

    def frames(self, cell: Cell) -> tuple[int, int]:
        """Return the frame ids of a and b in the cell's model.

        Raises:
            UnknownNameError: The cell has no such frame.
        """
        return frame_id(cell, self.first, self.name), frame_id(cell, self.second, self.name)

    def holds_at(self, point: int) -> bool:
        """Tell whether the row holds at a point, from 0."""
        return self.points is None or point in self.points


def frame_id(cell: Cell, name: str, field: str) -> int:
    """Return the id of a frame: the world, a tool (`arm1/tip`), or any frame of the model.

    Raises:
        UnknownNameError: The cell has no such frame; the message names the nearest one.
    """
    known = {WORLD: 0, TIPS[0]: cell.e1, TIPS[1]: cell.e2}
    if name in known:
        return known[name]
    if cell.model.existFrame(name):
        return int(cell.model.getFrameId(name))
    frames = [*known, *(frame.name for frame in cell.model.frames)]
    raise UnknownNameError(f"no frame {name!r} in this cell: {nearest(name, frames)}", field=field)


@dataclass(frozen=True)
class DifferenceSlope:
    """dg/d[v; w] by central differences of phi; the engine compiles the same formula."""

    phi: Value

    def __call__(self, R: Array, p: Array, parameters: Array) -> Array:
        """Return the derivative (6,)."""
        return self.as_function()(R, p, parameters)

    def as_function(self) -> Derivative:
        """Return the same as a function that can be compiled."""
        return difference_slope(self.phi)


@dataclass(frozen=True)
class DifferenceBend:
    """The second derivative by central differences of phi; the engine compiles the same formula."""

    phi: Value

    def __call__(self, R: Array, p: Array, parameters: Array) -> Array:
        """Return the second derivative (6, 6)."""
        return self.as_function()(R, p, parameters)

    def as_function(self) -> Derivative:
        """Return the same as a function that can be compiled."""
        return difference_bend(self.phi)


def difference_slope(phi: Value) -> Derivative:
    """Return the central differences (6,) of phi along the six unit twists."""

    def slope_of(R: Array, p: Array, parameters: Array) -> Array:
        slope = np.zeros(6)
        for c in range(6):
            twist = np.zeros(6)
            twist[c] = _STEP
            ahead = phi(turned(R, twist), p + twist[:3], parameters)
            behind = phi(turned(R, -twist), p - twist[:3], parameters)
            slope[c] = (ahead - behind) / (2.0 * _STEP)
        return slope

    return slope_of


def difference_bend(phi: Value) -> Derivative:
    """Return the second central differences (6, 6) of phi along pairs of unit twists."""

    def bend_of(R: Array, p: Array, parameters: Array) -> Array:
        bend = np.zeros((6, 6))
        middle = phi(R, p, parameters)
        for c in range(6):
            for d in range(c + 1):
                both, apart = np.zeros(6), np.zeros(6)
                both[c] += _STEP
                both[d] += _STEP
                apart[c] += _STEP
                apart[d] -= _STEP
                same = phi(turned(R, both), p + both[:3], parameters)
                same += phi(turned(R, -both), p - both[:3], parameters)
                if c == d:
                    bend[c, c] = (same - 2.0 * middle) / (4.0 * _STEP * _STEP)
                    continue
                other = phi(turned(R, apart), p + apart[:3], parameters)
                other += phi(turned(R, -apart), p - apart[:3], parameters)
                bend[c, d] = bend[d, c] = (same - other) / (4.0 * _STEP * _STEP)
        return bend

    return bend_of


def turned(R: Array, twist: Array) -> Array:
    """Return exp([w]x) R for the angular part w of a small twist, to fourth order in w."""
    W = np.zeros((3, 3))
    W[0, 1], W[0, 2], W[1, 2] = -twist[5], twist[4], -twist[3]
    W[1, 0], W[2, 0], W[2, 1] = twist[5], -twist[4], twist[3]
    square = np.dot(W, W)
    cubic = np.dot(W, square)
    turn = np.eye(3) + W + square / 2.0 + cubic / 6.0 + np.dot(square, square) / 24.0
    result: Array = np.dot(turn, R)
    return result
