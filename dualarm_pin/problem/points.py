"""What differs from point to point of a problem."""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.errors import InputError, ShapeError

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
R = TypeVar("R", bound=NamedTuple)


class Points(NamedTuple):
    """What differs from point to point; the first axis of every array counts points.

    Attributes:
        position: (k, 3) wanted position of e2 in e1 [m].
        rotation: (k, 3, 3) wanted rotation of e2 in e1.
        quaternion: (k, 4) the same (w, x, y, z), e2 turned so that the spin axis is its z.
        target_axes: (k, 3, 3) the transposed rotation, e2 turned likewise.
        pose_rows: (k,) 6 whole pose, 5 spin free, 3 position.
        u: (k, 6) directions in e1 axes.
        index_weight: (k,) a_i.
        linear: (k, n) theta_i.
    """

    position: Array
    rotation: Array
    quaternion: Array
    target_axes: Array
    pose_rows: Integers
    u: Array
    index_weight: Array
    linear: Array


def taken(record: R, which: slice | list[int]) -> R:
    """Return a record of arrays over some of its points: views for a slice."""
    return type(record)(*(array[which] for array in record))


def checked_rows(given: ArrayLike | None, k: int) -> Integers:
    """Return the pose rows of every point (k,), 6 by default.

    Raises:
        ShapeError: There is not one number a point.
        InputError: A number is not 6, 5 or 3.
    """
    array = np.full(k, 6) if given is None else np.array(given, dtype=np.int64)
    if array.shape != (k,):
        raise ShapeError(f"has shape {array.shape}, not ({k},)", field="pose_rows")
    if not np.isin(array, (6, 5, 3)).all():
        found = sorted(set(array.tolist()))
        raise InputError(f"has {found}: allowed are 6, 5 and 3", field="pose_rows")
    return array.astype(np.int64)
