"""Pieces: the smooth parts of which a curve is made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError

Along = Callable[[Array], Array]
"""A function of the parameter t in [0, 1], shape (k,), with values of shape (k, 3)."""

UP = np.array([0.0, 0.0, 1.0])
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_MOST = 10_000  # pieces; more is a slip of the pen


@dataclass(frozen=True, eq=False)
class Piece:
    """One smooth piece of a curve.

    Attributes:
        point: Position in e1 [m].
        derivative: Its derivative with respect to t, never zero.
        normal: Outward unit normal of the surface it lies on, where there is one.
        even: The derivative has constant length, so t is the share of the arc length.
        panels: Panels of the quadrature of the arc length where it is not even.
    """

    point: Along
    derivative: Along
    normal: Along | None = None
    even: bool = True
    panels: int = 32

    @property
    def length(self) -> float:
        """Arc length [m]."""
        return float(self._table[-1])

    def parameter(self, s: Array) -> Array:
        """Return t at the arc lengths `s` from the start of the piece, shape (k,)."""
        table = self._table
        if self.even:
            return np.asarray(np.clip(s / table[-1], 0.0, 1.0))
        grid = np.linspace(0.0, 1.0, len(table))
        t = np.interp(s, table, grid)
        panel = np.clip((t * self.panels).astype(int), 0, self.panels - 1)
        for _ in range(8):  # Newton on the exact length; the table is within 1 % already
            missing = s - table[panel] - self._lengths(grid[panel], t)
            t = np.clip(t + missing / np.linalg.norm(self.derivative(t), axis=1), 0.0, 1.0)
        return np.asarray(t)

    @cached_property
    def _table(self) -> Array:
        """Return the arc length up to each of the grid points."""
        if self.even:
            return np.array([0.0, np.linalg.norm(self.derivative(np.zeros(1)))])
        grid = np.linspace(0.0, 1.0, self.panels + 1)
        return np.concatenate([[0.0], np.cumsum(self._lengths(grid[:-1], grid[1:]))])

    def _lengths(self, start: Array, stop: Array) -> Array:
        half = 0.5 * (stop - start)
        t = (0.5 * (stop + start))[:, None] + half[:, None] * _NODES
        speed = np.linalg.norm(self.derivative(t.reshape(-1)), axis=1).reshape(t.shape)
        return np.asarray(half * (speed @ _WEIGHTS))


def line_piece(start: Array, stop: Array) -> Piece:
    """Return the straight piece from `start` to `stop`, shape (3,) each [m]."""
    way = stop - start
    return Piece(lambda t: start + t[:, None] * way, constant(way))


def arc_piece(
    center: Array,
    x: Array,
    y: Array,
    angle: float,
    *,
    rise: Array | None = None,
    normal: Array | None = None,
) -> Piece:
    """Return center + x cos(a) + y sin(a) for a from 0 to `angle`, lifted evenly by `rise`.

    Args:
        center: Shape (3,) [m].
        x: From the centre to the start, shape (3,) [m].
        y: The same length, at a right angle, towards positive angles, shape (3,) [m].
        angle: How far it turns [rad].
        rise: Shape (3,), at a right angle to x and y [m].
        normal: Unit normal of the surface it lies on, shape (3,).
    """
    lift = np.zeros(3) if rise is None else rise

    def point(t: Array) -> Array:
        a = (angle * t)[:, None]
        return np.asarray(center + x * np.cos(a) + y * np.sin(a) + t[:, None] * lift)

    def derivative(t: Array) -> Array:
        a = (angle * t)[:, None]
        return np.asarray(angle * (y * np.cos(a) - x * np.sin(a)) + lift)

    return Piece(point, derivative, None if normal is None else constant(normal))


def constant(vector: Array) -> Along:
    """Return the function that is `vector` everywhere."""
    return lambda t: np.broadcast_to(vector, (len(t), 3)).copy()


def flat(piece: Piece) -> Piece:
    """Return the piece with z of e1 as its normal."""
    return replace(piece, normal=constant(UP))


def spans(point: Along, derivative: Along, count: int, normal: Along | None = None) -> list[Piece]:
    """Return a curve over t in [0, 1] as `count` pieces, each short enough for its quadrature.

    Raises:
        InputError: So many that it is a slip of the pen.
    """
    if count > _MOST:
        raise InputError("more turns or periods than any path has: take fewer")

    def span(k: int) -> Piece:
        return Piece(
            lambda t: point((k + t) / count),
            lambda t: derivative((k + t) / count) / count,
            constant(UP) if normal is None else lambda t: normal((k + t) / count),
            even=False,
        )

    return [span(k) for k in range(count)]
