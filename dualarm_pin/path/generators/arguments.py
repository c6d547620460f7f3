"""Arguments that generators share: their types, as files give them, and checks of numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, TypeAlias

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from dualarm_pin.arrays import Array, finite
from dualarm_pin.errors import InputError
from dualarm_pin.files.numbers import LARGEST, MOST_POINTS, Number, Vector
from dualarm_pin.files.signature import Count, InFile
from dualarm_pin.path.generators.piece import UP, Piece, arc_piece

Angle: TypeAlias = Annotated[float, InFile(Number, degrees=True)]
"""An angle [rad]; in files the key ends in `_deg`."""
Point2: TypeAlias = Annotated[ArrayLike, InFile(tuple[Number, Number])]
Point3: TypeAlias = Annotated[ArrayLike, InFile(Vector)]
Points3: TypeAlias = Annotated[ArrayLike, InFile(list[Vector])]
_Share = Annotated[int, Field(ge=0, le=MOST_POINTS)]
Shares: TypeAlias = Annotated[Sequence[int] | int | None, InFile(list[_Share] | Count | None)]
"""A number of points for each part of a curve, or one for all of it."""


def positive(**lengths: float) -> None:
    """Refuse a value that is not above 0, or absurdly large.

    Raises:
        InputError: The field is the name of the argument.
    """
    for name, value in lengths.items():
        if not 0.0 < value <= LARGEST:
            message = f"a number above 0 (and up to {LARGEST:g}) is expected; given {value:g}"
            raise InputError(message, field=name)


def not_zero(**values: float) -> None:
    """Refuse 0 and what is absurdly large.

    Raises:
        InputError: The field is the name of the argument.
    """
    for name, value in values.items():
        if not 0.0 < abs(value) <= LARGEST:
            message = f"a number other than 0 (and up to {LARGEST:g}) is expected; given {value:g}"
            raise InputError(message, field=name)


def middle(center: ArrayLike, height: float) -> Array:
    """Return the point above `center` (x, y) at `height` [m]."""
    return np.append(finite(center, "center", (2,)), finite(height, "height", ()))


def about_z(
    radius: float, center: ArrayLike, height: float, start: float, angle: float, rise: float = 0.0
) -> Piece:
    """Return the arc about z through `angle` from `start` [rad], lifted evenly by `rise` [m].

    Its normal is z if it does not rise.

    Raises:
        InputError: A radius that is not positive.
    """
    positive(radius=radius)
    x = radius * np.array([math.cos(start), math.sin(start), 0.0])
    y = radius * np.array([-math.sin(start), math.cos(start), 0.0])
    return arc_piece(
        middle(center, height), x, y, angle, rise=rise * UP, normal=None if rise else UP
    )
