"""A half-space: a point of one body stays on one side of a plane of another.

    g = normal . x - offset >= 0,   x the point of b in a

With the world as a, this keeps a tip above a table or before a wall.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.arrays import Array, finite, unit
from dualarm_pin.errors import InputError
from dualarm_pin.rows.row import WORLD, Row

_AXES = ("x", "y", "z")


def half_space(
    frame: str,
    normal: ArrayLike,
    offset: float,
    *,
    of: str = WORLD,
    point: ArrayLike = (0.0, 0.0, 0.0),
    points: Sequence[int] | None = None,
    name: str | None = None,
) -> Row:
    """Keep a point of `frame` where normal . x >= offset.

    Args:
        frame: Frame that the point is fixed in, such as `arm1/tip`.
        normal: (3,) direction in axes of `of`, such as `[0, 1, 0]`; scaled to unit length.
        offset: Distance of the plane from the origin of `of`, along the normal [m], such as `0.2`.
        of: Frame that the plane is fixed in.
        point: (3,) the point in `frame` [m]: its origin by default.
        points: Points of the path, from 0; all by default.
        name: Name for tables.

    Raises:
        InputError: The normal has no length, or a number is not finite.
    """
    direction = unit(normal, "normal")
    if not np.isfinite(offset):
        raise InputError(f"a finite number is expected; given {offset}", field="offset")
    at = finite(point, "point", (3,))
    return Row(
        name=name or f"{frame} beyond {offset:g} m along {np.round(direction, 4).tolist()} of {of}",
        first=of,
        second=frame,
        phi=plane_point,
        slope=plane_point_slope,
        bend=plane_point_bend,
        parameters=np.array([*direction, offset, *at]),
        points=None if points is None else tuple(points),
        expression=_Expression(direction, float(offset), at),
    )


def above(frame: str, z: float, points: Sequence[int] | None = None) -> Row:
    """Keep the origin of `frame` at least at height z in the world [m].

    Args:
        frame: Frame whose origin it is, such as `arm1/tip`.
        z: Height in the world [m], such as `0.6`.
        points: Points of the path, from 0; all by default.
    """
    return half_space(frame, (0.0, 0.0, 1.0), z, points=points, name=f"{frame} above {z:g} m")


def below(frame: str, z: float, points: Sequence[int] | None = None) -> Row:
    """Keep the origin of `frame` at most at height z in the world [m].

    Args:
        frame: Frame whose origin it is, such as `arm1/tip`.
        z: Height in the world [m], such as `1.6`.
        points: Points of the path, from 0; all by default.
    """
    return half_space(frame, (0.0, 0.0, -1.0), -z, points=points, name=f"{frame} below {z:g} m")


def inside(
    frame: str,
    box: Mapping[Literal["x", "y", "z"], tuple[float | None, float | None]],
    points: Sequence[int] | None = None,
) -> tuple[Row, ...]:
    """Keep the origin of `frame` inside a box along the axes of the world.

    Args:
        frame: A frame, such as `arm1/tip`.
        box: The least and the most along each axis that counts [m], None where there is none, such
            as `{x: [0.7, 0.8], z: [0.6, null]}`.
        points: Points of the path, from 0; all by default.

    Raises:
        InputError: It says nothing, names another axis, or the least is not below the most.
    """
    rows: list[Row] = []
    for axis, (least, most) in box.items():
        if axis not in _AXES:
            raise InputError(f"{axis!r} is no axis of a box: x, y or z", field="box")
        if least is not None and most is not None and not least < most:
            message = f"{axis}: the least, {least:g} m, must be below the most, {most:g} m"
            raise InputError(message, field="box")
        along = np.eye(3)[_AXES.index(axis)]
        for sign, end, word in ((1.0, least, "at least"), (-1.0, most, "at most")):
            if end is not None:
                name = f"{frame} {axis} {word} {end:g} m"
                rows.append(half_space(frame, sign * along, sign * end, points=points, name=name))
    if not rows:
        raise InputError("give the least and the most along x, y or z", field="box")
    return tuple(rows)


def plane_point(R: Array, p: Array, parameters: Array) -> float:
    """Return normal . (p + R point) - offset; parameters are [normal; offset; point]."""
    x = p + np.dot(R, parameters[4:7])
    return float(np.dot(parameters[:3], x) - parameters[3])


def plane_point_slope(R: Array, p: Array, parameters: Array) -> Array:
    """Return [normal; (R point) x normal]."""
    n, c = parameters[:3], np.dot(R, parameters[4:7])
    slope = np.zeros(6)
    slope[:3] = n
    slope[3] = c[1] * n[2] - c[2] * n[1]
    slope[4] = c[2] * n[0] - c[0] * n[2]
    slope[5] = c[0] * n[1] - c[1] * n[0]
    return slope


def plane_point_bend(R: Array, p: Array, parameters: Array) -> Array:
    """Return (n c^T + c n^T) / 2 - (n . c) I for the angular part, c = R point."""
    n, c = parameters[:3], np.dot(R, parameters[4:7])
    bend = np.zeros((6, 6))
    bend[3:, 3:] = 0.5 * (np.outer(n, c) + np.outer(c, n)) - np.dot(n, c) * np.eye(3)
    return bend


class _Expression:
    """The row for CasADi; a class, so that a problem can be sent to another process."""

    def __init__(self, normal: Array, offset: float, point: Array) -> None:
        self.normal, self.offset, self.point = normal, offset, point

    def __call__(self, ca: Any, R: Any, p: Any) -> Any:
        return ca.dot(ca.DM(self.normal), p + R @ ca.DM(self.point)) - self.offset
