"""What the generators share: checks of their numbers, and where a curve stands in e1."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array, finite
from dualarm_pin.errors import InputError
from dualarm_pin.path.generators.curve import Along, Piece, constant

UP = np.array([0.0, 0.0, 1.0])
_LARGEST = 1e6
_MOST = 10_000


def positive(**lengths: float) -> None:
    """Refuse a value that is not above 0, or absurdly large.

    Raises:
        InputError: The field is the name of the argument.
    """
    for name, value in lengths.items():
        if not 0.0 < value <= _LARGEST:
            message = f"a number above 0 (and up to {_LARGEST:g}) is expected; given {value:g}"
            raise InputError(message, field=name)


def not_zero(**values: float) -> None:
    """Refuse 0 and what is absurdly large.

    Raises:
        InputError: The field is the name of the argument.
    """
    for name, value in values.items():
        if not 0.0 < abs(value) <= _LARGEST:
            message = f"a number other than 0 (and up to {_LARGEST:g}) is expected; given {value:g}"
            raise InputError(message, field=name)


def middle(center: ArrayLike, height: float) -> Array:
    """Return the point above `center` (x, y) at `height` [m]."""
    return np.append(finite(center, "center", (2,)), finite(height, "height", ()))


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
