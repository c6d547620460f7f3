"""Arrays from users, checked: shape, finite values, lengths, rotations.

Messages count points from 1, as the paper does.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.tolerance import TOLERANCE

Array: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]

_NO_LENGTH = 1e-12  # a direction shorter than this is rounding left of a zero


def numbers(value: ArrayLike, field: str) -> Array:
    """Return `value` as a new array of numbers, of any shape.

    Raises:
        ShapeError: Not numbers, or rows of different lengths.
    """
    try:
        return np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise ShapeError(f"an array of numbers is expected: {error}", field=field) from error


def finite(value: ArrayLike, field: str, shape: tuple[int, ...]) -> Array:
    """Return `value` as a new array of `shape`; one row does for all points.

    Args:
        value: What the user gave.
        field: What it is called in messages.
        shape: Expected shape, -1 for any length; the first axis of two or more counts points.

    Raises:
        ShapeError: Another shape, or not numbers.
        InputError: A value is NaN or infinite; the message names the point.
    """
    array = numbers(value, field)
    if len(shape) > 1 and shape[0] >= 0 and array.shape == shape[1:]:
        array = np.broadcast_to(array, shape).copy()
    if array.ndim != len(shape) or any(
        want not in (-1, have) for want, have in zip(shape, array.shape, strict=True)
    ):
        wanted = ", ".join("h" if n < 0 else str(n) for n in shape)
        raise ShapeError(f"shape ({wanted}) is expected; given {array.shape}", field=field)
    if not array.size:
        return array
    rows = array.reshape(len(array) if len(shape) > 1 else 1, -1)
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if len(bad):
        where = f"point {bad[0] + 1} is" if len(shape) > 1 else "the values are"
        raise InputError(f"{where} not finite: {rows[bad[0]].tolist()}", field=field)
    return array


def checked(field: str, value: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return a finite C-contiguous copy of exactly that shape; one number fills it.

    Raises:
        ShapeError: Another shape, or not numbers.
        InputError: A value is NaN or infinite; the message says where.
    """
    array = numbers(value, field)
    if array.ndim == 0:
        array = np.full(shape, float(array))
    if array.shape != shape:
        raise ShapeError(f"has shape {array.shape}, not {shape}", field=field)
    if not np.isfinite(array).all():
        at = np.argwhere(~np.isfinite(array))[0].tolist()
        raise InputError(f"is not finite at {at}: {array[tuple(at)]}", field=field)
    return np.ascontiguousarray(array)


def lengths(vectors: Array, field: str) -> Array:
    """Return the length of each row, shape (h,).

    Raises:
        InputError: A row is zero; the message names the point.
    """
    length = np.linalg.norm(vectors, axis=1)
    zero = np.flatnonzero(length < _NO_LENGTH)
    if len(zero):
        more = f" (and {len(zero) - 1} more)" if len(zero) > 1 else ""
        message = f"point {zero[0] + 1}{more} is zero: a direction is needed at every point"
        raise InputError(message, field=field)
    return np.asarray(length)


def rotations(value: ArrayLike, shape: tuple[int, ...], field: str = "rotation") -> Array:
    """Return rotation matrices, each moved to the nearest exact rotation.

    Args:
        value: What the user gave.
        shape: (h, 3, 3); one matrix does for all points.
        field: What it is called in messages.

    Raises:
        ShapeError: Another shape, or not numbers.
        InputError: A matrix is not a rotation; the message names the point and how far it is.
    """
    R = finite(value, field, shape)
    square = R.transpose(0, 2, 1) @ R
    away = np.abs(square - np.eye(3)).max(axis=(1, 2))
    worst = int(np.argmax(away))
    if away[worst] > TOLERANCE.orthonormal:
        raise InputError(
            f"{_which(R, worst)}the matrix is not a rotation: R^T R differs from the identity "
            f"by {away[worst]:.2g}; allowed is {TOLERANCE.orthonormal:g}",
            field=field,
        )
    mirror = np.flatnonzero(np.linalg.det(R) < 0)
    if len(mirror):
        message = f"{_which(R, mirror[0])}the matrix is a mirror, not a rotation: det R = -1"
        raise InputError(message, field=field)
    rough = away > 1e-12  # exact matrices stay exactly as they were written
    if np.any(rough):
        U, _, Vt = np.linalg.svd(R[rough])
        R[rough] = U @ Vt
    return R


def unit(value: ArrayLike, field: str) -> Array:
    """Return a vector of three numbers at unit length.

    Raises:
        ShapeError: Not three numbers.
        InputError: Not finite, or of no length.
    """
    vector = finite(value, field, (3,))
    length = float(np.linalg.norm(vector))
    if length < _NO_LENGTH:
        raise InputError("the axis has no length: give a direction", field=field)
    return np.asarray(vector / length)


def _which(points: Array, i: int | np.int64) -> str:
    return f"point {i + 1}: " if len(points) > 1 else ""
