"""Rows on angles: an axis stays near a direction, a joint inside a range.

axis in b, direction d in a:   g = d . R axis - cos(largest angle) >= 0
joint from its middle m:       g = (m - least) + t >= 0 and (most - m) - t >= 0,
                               t = atan2(e2 . R e, e1 . R e)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array, unit
from dualarm_pin.chain import REVOLUTE, joint_axis
from dualarm_pin.errors import InputError, UnknownNameError, nearest
from dualarm_pin.rows.half_space import half_space
from dualarm_pin.rows.row import WORLD, Row

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Vector = tuple[float, float, float]
Range = tuple[float, float]
_TURN = 2.0 * math.pi + 1e-6  # rad; a joint that goes further has two values for one pose
_LEAST = 0.1  # deg; nearer to 0 or 180 the cosine says too little about the angle


def axis_within(
    frame: str,
    axis: Vector,
    of: Vector,
    deg: float,
    *,
    seen_from: str = WORLD,
    points: Sequence[int] | None = None,
    name: str | None = None,
) -> Row:
    """Keep an axis of `frame` within an angle of a direction.

    Args:
        frame: Frame that the axis is fixed in, such as `arm2/tip`.
        axis: (3,) the axis in that frame, of any length, such as `[0, 0, 1]`.
        of: (3,) the direction in `seen_from`, of any length, such as `[0, 0, -1]`.
        deg: Largest angle between them [deg], above 0 and below 180, such as `30`.
        seen_from: Frame that the direction is fixed in.
        points: Points of the path, from 0; all by default.
        name: Name for tables.

    Raises:
        InputError: A direction has no length, or the angle is out of range.
    """
    if not _LEAST <= deg <= 180.0 - _LEAST:
        message = f"an angle from {_LEAST:g} to {180.0 - _LEAST:g} deg is expected; given {deg}"
        raise InputError(message, field="deg")
    turning, direction = unit(axis, "axis"), unit(of, "of")
    least = math.cos(math.radians(deg))
    return Row(
        name=name or f"axis {list(axis)} of {frame} within {deg:g} deg of {list(of)}",
        first=seen_from,
        second=frame,
        phi=cosine,
        slope=cosine_slope,
        bend=cosine_bend,
        parameters=np.array([*direction, *turning, least]),
        points=None if points is None else tuple(points),
        units="1",
        expression=_Cosine(direction, turning, least),
    )


def joint_range(
    cell: Cell,
    joint: str,
    *,
    deg: Range | None = None,
    to: Range | None = None,
    points: Sequence[int] | None = None,
) -> tuple[Row, Row]:
    """Keep a joint inside a range, which only makes sense inside its bounds.

    Args:
        cell: The two arms.
        joint: A joint between the two tools, such as `arm1/joint_5`.
        deg: Least and most [deg] of a revolute joint, such as `[-80, 80]`.
        to: Least and most [rad or m] instead, such as `[-1.4, 1.4]`.
        points: Points of the path, from 0; all by default.

    Raises:
        UnknownNameError: The cell has no such joint.
        InputError: The range is empty, of the wrong unit, or the joint turns further than once.
    """
    if joint not in cell.joint_names:
        message = f"no joint {joint!r} in this cell: {nearest(joint, cell.joint_names)}"
        raise UnknownNameError(message, field="joint")
    number = cell.model.getJointId(joint)
    kind, axis = joint_axis(cell.model, number)
    if deg is not None and to is None:
        field, given, unit_shown, scale = "deg", deg, "deg", math.pi / 180.0
    elif to is not None and deg is None:
        field, given, unit_shown, scale = "to", to, "rad" if kind == REVOLUTE else "m", 1.0
    else:
        raise InputError("give one of deg and to: the least and the most", field="deg")
    if field == "deg" and kind != REVOLUTE:
        raise InputError(f"{joint} slides: give `to` in metres", field=field)
    least, most = given
    if not (math.isfinite(least) and math.isfinite(most) and least < most):
        message = f"the least must be below the most; given {list(given)}"
        raise InputError(message, field=field)
    words = ("at least", "at most")
    names = [f"{joint} {w} {end:g} {unit_shown}" for w, end in zip(words, given, strict=True)]
    ends = (scale * least, scale * most)
    make = _turning if kind == REVOLUTE else _sliding
    rows = make(cell, joint, axis, ends)
    held = None if points is None else tuple(points)
    lower, upper = (replace(row, name=n, points=held) for row, n in zip(rows, names, strict=True))
    return lower, upper


def _sliding(cell: Cell, joint: str, axis: Array, ends: Range) -> tuple[Row, Row]:
    """Return the rows of a prismatic joint: two planes across its axis."""
    first, placement = _before(cell, joint)
    along = placement.rotation @ axis
    start = float(along @ placement.translation)
    return (
        half_space(joint, along, start + ends[0], of=first),
        half_space(joint, -along, -start - ends[1], of=first),
    )


def _turning(cell: Cell, joint: str, axis: Array, ends: Range) -> tuple[Row, Row]:
    """Return the rows of a revolute joint, which turns once at most: its angle has one value."""
    column = cell.joint_names.index(joint)
    low, high = float(cell.lower[column]), float(cell.upper[column])
    if high - low > _TURN:
        raise InputError(
            f"{joint} may turn further than once, from {math.degrees(low):g} to "
            f"{math.degrees(high):g} deg, and one pose has several values of it: limit it in the "
            "cell (limits_deg) to one turn",
            field="joint",
        )
    first, placement = _before(cell, joint)
    middle, across = (low + high) / 2.0, np.eye(3)[int(np.argmin(np.abs(axis)))]
    across = unit(across - (across @ axis) * axis, "axis")
    one = placement.rotation @ pin.AngleAxis(middle, axis).toRotationMatrix() @ across
    two = np.cross(placement.rotation @ axis, one)
    lower, upper = (
        Row(
            name=joint,
            first=first,
            second=joint,
            phi=turn,
            slope=turn_slope,
            bend=turn_bend,
            parameters=np.array([*one, *two, *across, sign, room]),
            units="rad",
            expression=_Turn(one, two, across, sign, room),
        )
        for sign, room in ((1.0, middle - ends[0]), (-1.0, ends[1] - middle))
    )
    return lower, upper


def _before(cell: Cell, joint: str) -> tuple[str, Any]:
    """Return the frame of the joint before one, and the pose of this one in it at 0."""
    number = cell.model.getJointId(joint)
    parent = cell.model.parents[number]
    frame = WORLD if parent == 0 else str(cell.model.names[parent])
    return frame, cell.model.jointPlacements[number]


def cosine(R: Array, _p: Array, parameters: Array) -> float:
    """Return d . R axis - least; parameters are [d; axis; least]."""
    return float(np.dot(parameters[:3], np.dot(R, parameters[3:6])) - parameters[6])


def cosine_slope(R: Array, _p: Array, parameters: Array) -> Array:
    """Return [0; (R axis) x d]."""
    slope = np.zeros(6)
    slope[3:] = np.cross(np.dot(R, parameters[3:6]), parameters[:3])
    return slope


def cosine_bend(R: Array, _p: Array, parameters: Array) -> Array:
    """Return (d c^T + c d^T) / 2 - (d . c) I for the angular part, c = R axis."""
    d, c = parameters[:3], np.dot(R, parameters[3:6])
    bend = np.zeros((6, 6))
    bend[3:, 3:] = 0.5 * (np.outer(d, c) + np.outer(c, d)) - np.dot(d, c) * np.eye(3)
    return bend


def turn(R: Array, _p: Array, parameters: Array) -> float:
    """Return room + sign t; parameters are [e1; e2; e; sign; room]."""
    u = np.dot(R, parameters[6:9])
    t = np.arctan2(np.dot(parameters[3:6], u), np.dot(parameters[:3], u))
    return float(parameters[10] + parameters[9] * t)


def turn_slope(R: Array, _p: Array, parameters: Array) -> Array:
    """Return sign dt / d[v; w] by the chain rule through c = e1 . u and s = e2 . u."""
    u = np.dot(R, parameters[6:9])
    c, s = np.dot(parameters[:3], u), np.dot(parameters[3:6], u)
    along = c * np.cross(u, parameters[3:6]) - s * np.cross(u, parameters[:3])
    slope = np.zeros(6)
    slope[3:] = parameters[9] / (c * c + s * s) * along
    return slope


def turn_bend(R: Array, _p: Array, parameters: Array) -> Array:
    """Return sign d2t / d[v; w]2 by the chain rule through c = e1 . u and s = e2 . u."""
    e1, e2, u = parameters[:3], parameters[3:6], np.dot(R, parameters[6:9])
    c, s = np.dot(e1, u), np.dot(e2, u)
    dc, ds, square = np.cross(u, e1), np.cross(u, e2), c * c + s * s
    # c d2s - s d2c: the parts along the identity cancel.
    across = c * e2 - s * e1
    total = 0.5 / square * (np.outer(across, u) + np.outer(u, across))
    total += 2.0 * s * c / square**2 * (np.outer(dc, dc) - np.outer(ds, ds))
    total += (s * s - c * c) / square**2 * (np.outer(ds, dc) + np.outer(dc, ds))
    bend = np.zeros((6, 6))
    bend[3:, 3:] = parameters[9] * total
    return bend


class _Cosine:
    """The row for CasADi; a class, so that a problem can be sent to another process."""

    def __init__(self, direction: Array, axis: Array, least: float) -> None:
        self.direction, self.axis, self.least = direction, axis, least

    def __call__(self, ca: Any, R: Any, _p: Any) -> Any:
        return ca.dot(ca.DM(self.direction), R @ ca.DM(self.axis)) - self.least


class _Turn:
    """The row for CasADi; a class, so that a problem can be sent to another process."""

    def __init__(self, one: Array, two: Array, axis: Array, sign: float, room: float) -> None:
        self.one, self.two, self.axis, self.sign, self.room = one, two, axis, sign, room

    def __call__(self, ca: Any, R: Any, _p: Any) -> Any:
        u = R @ ca.DM(self.axis)
        t = ca.atan2(ca.dot(ca.DM(self.two), u), ca.dot(ca.DM(self.one), u))
        return self.room + self.sign * t
