"""The path: where e2 shall be, seen from e1, point by point."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Literal, TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.arrays import Array, finite, lengths, numbers, rotations, unit
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.tolerance import TOLERANCE

Counts: TypeAlias = NDArray[np.int64]

WHOLE_POSE, SPIN_FREE, POSITION_ONLY = 6, 5, 3
"""How many components of the pose a point constrains: the values of `Path.rows`."""


@dataclass(frozen=True, eq=False, init=False)
class Path:
    """A path of h relative poses T_e1_e2 (eq. 17), each with a direction u of the index.

    Arrays are read-only copies. Messages count points from 1, as the paper does.

    Attributes:
        position: Origin of e2 in e1, shape (h, 3) [m], h at least 2.
        rotation: Axes of e2 in e1, shape (h, 3, 3); (3, 3) does for all points.
        u: Directions [linear; angular] in e1 axes, shape (h, 6); [tangent; 0] unless given. One
            (6,) does for all points, and the linear part alone, (h, 3) or (3,).
        rows: Constrained components of each point, shape (h,), or one for all: 6 the whole pose,
            5 all but the turn about `spin_axis`, 3 the position alone.
        spin_axis: Axis in e2 about which the tool may turn where `rows` is 5, shape (3,); made
            unit.
        tangent: Tangents in e1 axes, shape (h, 3), made unit; by differences of the points unless
            given.
        arc_length: Length of the path up to each point, rising from 0, shape (h,) [m]; the sum of
            the chords unless given.
        name: What the path is called in messages and plots.

    Raises:
        ShapeError: An array has another shape.
        InputError: A value is not finite, a matrix is no rotation, a direction is zero, or two
            consecutive points coincide; the message names the points.
    """

    position: Array
    rotation: Array
    u: Array
    rows: Counts
    spin_axis: Array
    tangent: Array
    arc_length: Array
    name: str

    def __init__(
        self,
        position: ArrayLike,
        rotation: ArrayLike,
        *,
        u: ArrayLike | None = None,
        rows: ArrayLike = WHOLE_POSE,
        spin_axis: ArrayLike = (0.0, 0.0, 1.0),
        tangent: ArrayLike | None = None,
        arc_length: ArrayLike | None = None,
        name: str = "path",
    ) -> None:
        x = finite(position, "position", (-1, 3))
        h = len(x)
        if h < 2:
            raise InputError(f"a path needs 2 points or more; given {h}", field="position")
        R = rotations(rotation, (h, 3, 3))
        if len(twice := coincident(x, R)):
            i = twice[0] + 1
            more = f" (and {len(twice) - 1} more pairs)" if len(twice) > 1 else ""
            message = f"points {i} and {i + 1} coincide{more}: remove one of them"
            raise InputError(message, field="position")
        t = through(x) if tangent is None else finite(tangent, "tangent", (h, 3))
        t = t / lengths(t, "tangent")[:, None]
        s = _chords(x) if arc_length is None else finite(arc_length, "arc_length", (h,))
        if s[0] != 0.0 or np.any(np.diff(s) < 0.0):
            raise InputError("arc lengths must rise from 0", field="arc_length")
        directions, axis = _directions(t if u is None else u, h), unit(spin_axis, "spin_axis")
        arrays = (x, R, directions, _rows(rows, h), axis, t, s)
        for field, array in zip(fields(self), arrays, strict=False):
            array.setflags(write=False)
            object.__setattr__(self, field.name, array)
        object.__setattr__(self, "name", name)

    @property
    def h(self) -> int:
        """Number of points."""
        return len(self.position)

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return float(self.arc_length[-1])

    def pose(self, i: int) -> pin.SE3:
        """Return T_e1_e2 of point `i`, counted from 0."""
        return pin.SE3(self.rotation[i].copy(), self.position[i].copy())

    def with_direction(self, u: ArrayLike) -> Path:
        """Return this path with other directions.

        Args:
            u: Shape (h, 6) or (6,), or the linear part alone, (h, 3) or (3,); in e1 axes.

        Raises:
            ShapeError: Another shape.
            InputError: A direction is zero or not finite.
        """
        return replace(self, u=_directions(u, self.h))

    def subset(self, points: Sequence[int]) -> Path:
        """Return the path of some of the points, with the tangents they have on this one.

        Args:
            points: Rising indices, counted from 0; at least two.

        Raises:
            InputError: An index is out of range, or they do not rise.
        """
        index = np.asarray(points, dtype=np.int64).reshape(-1)
        if len(index) < 2 or np.any(np.diff(index) <= 0) or index[0] < 0 or index[-1] >= self.h:
            raise InputError(f"points must be 2 or more rising indices below {self.h}: {points}")
        every = ("position", "rotation", "u", "rows", "tangent")
        parts = {name: getattr(self, name)[index] for name in every}
        return replace(self, arc_length=self.arc_length[index] - self.arc_length[index[0]], **parts)

    def moved(self, placement: pin.SE3) -> Path:
        """Return the path moved as a rigid whole: `placement` is the old frame seen in e1."""
        R = np.asarray(placement.rotation)
        return replace(
            self,
            position=self.position @ R.T + np.asarray(placement.translation),
            rotation=R @ self.rotation,
            u=(self.u.reshape(-1, 2, 3) @ R.T).reshape(-1, 6),
            tangent=self.tangent @ R.T,
        )


def through(position: Array) -> Array:
    """Return tangents by second-order differences over the chord length, shape (h, 3).

    Points in one place (the tool turns where it stands) share the tangent of that place.

    Args:
        position: Shape (h, 3) [m].

    Raises:
        InputError: All points coincide.
    """
    s, which = np.unique(_chords(position), return_inverse=True)
    if len(s) < 2:
        message = "all points coincide: the path has no length and no tangent"
        raise InputError(message, field="position")
    places = position[np.unique(which, return_index=True)[1]]
    order: Literal[1, 2] = 2 if len(s) > 2 else 1
    tangent = np.gradient(places, s, axis=0, edge_order=order)
    # A path that turns straight back has no mean direction: it takes the one in which it leaves.
    still = np.linalg.norm(tangent, axis=1) < TOLERANCE.coincident
    ahead = np.diff(places, axis=0, append=2 * places[-1:] - places[-2:-1])
    return np.where(still[:, None], ahead, tangent)[which]


def _chords(position: Array) -> Array:
    steps = np.linalg.norm(np.diff(position, axis=0), axis=1)
    steps[steps <= TOLERANCE.coincident] = 0.0
    return np.concatenate([[0.0], np.cumsum(steps)])


def coincident(position: Array, rotation: Array) -> Counts:
    """Return each i, from 0, where point i + 1 has the same pose as point i.

    Points in one place with different rotations are no mistake: the tool turns where it stands.
    """
    still = repeated(position)
    turn = np.abs(rotation[still + 1] - rotation[still]).max(axis=(1, 2), initial=0.0)
    return np.asarray(still[turn <= TOLERANCE.coincident])


def repeated(position: Array) -> Counts:
    """Return each i, from 0, where point i + 1 is in the place of point i."""
    steps = np.linalg.norm(np.diff(position, axis=0), axis=1)
    return np.flatnonzero(steps <= TOLERANCE.coincident)


def _directions(value: ArrayLike, h: int) -> Array:
    array = numbers(value, "u")
    width = 3 if array.shape in ((3,), (h, 3)) else 6
    u = finite(array, "u", (h, width))
    lengths(u, "u")
    return np.hstack([u, np.zeros((h, 6 - width))])


def _rows(value: ArrayLike, h: int) -> Counts:
    array = np.asarray(value)
    if array.shape not in ((), (h,)):
        message = f"one value or shape ({h},) is expected; given {array.shape}"
        raise ShapeError(message, field="rows")
    if not np.isin(array, (WHOLE_POSE, SPIN_FREE, POSITION_ONLY)).all():
        raise InputError(f"6, 5 or 3 is expected; given {np.unique(array).tolist()}", field="rows")
    return np.broadcast_to(array, (h,)).astype(np.int64)
