"""Curves on surfaces, with the direction that the tool should face: dome and tube seam."""

from __future__ import annotations

import math
from typing import Unpack

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.path import Path
from dualarm_pin.path.generators.arguments import Angle, Point2, middle, not_zero, positive
from dualarm_pin.path.generators.follow import Follow, follow
from dualarm_pin.path.generators.piece import spans

_INNER, _OUTER, _TILT = math.radians(10.0), math.radians(45.0), math.radians(45.0)


def dome_spiral(
    radius: float,
    *,
    turns: float = 3.0,
    inner: Angle = _INNER,
    outer: Angle = _OUTER,
    center: Point2 = (0.0, 0.0),
    height: float = 0.2,
    **how: Unpack[Follow],
) -> Path:
    """Return a spiral down a dome, as polishing runs; the tool stands on the dome by default.

    Args:
        radius: Radius of the sphere [m], such as `0.15`.
        turns: How often it goes round; negative for clockwise seen from +z.
        inner: Angle between z and the first point, seen from the centre [rad].
        outer: The same for the last point [rad].
        center: x and y of the centre of the sphere [m].
        height: z of the centre of the sphere [m].
        **how: See `Follow`; `orientation` is "normal" unless given.

    Raises:
        InputError: A radius that is not positive, no turn, or angles out of order.
    """
    positive(radius=radius)
    not_zero(turns=turns)
    if not 0.0 <= inner < outer < math.pi:
        message = "0 <= inner < outer < 180 degrees is expected; given "
        message += f"{math.degrees(inner):g} and {math.degrees(outer):g}"
        raise InputError(message, field="outer")
    origin, turn, span = middle(center, height), 2 * math.pi * turns, outer - inner

    def normal(t: Array) -> Array:
        polar, a = inner + span * t, turn * t
        flat = np.sin(polar)
        return np.column_stack([flat * np.cos(a), flat * np.sin(a), np.cos(polar)])

    def point(t: Array) -> Array:
        return np.asarray(origin + radius * normal(t))

    def derivative(t: Array) -> Array:
        polar, a = inner + span * t, turn * t
        down = np.column_stack(
            [np.cos(polar) * np.cos(a), np.cos(polar) * np.sin(a), -np.sin(polar)]
        )
        round_ = np.column_stack([-np.sin(a), np.cos(a), np.zeros_like(a)])
        return np.asarray(radius * (span * down + (turn * np.sin(polar))[:, None] * round_))

    pieces = spans(point, derivative, math.ceil(2 * abs(turns)), normal)
    return follow(pieces, "dome spiral", {"orientation": "normal", **how})


def tube_seam(
    radius: float,
    tube_radius: float,
    *,
    tilt: Angle = _TILT,
    turns: float = 1.0,
    start: Angle = 0.0,
    center: Point2 = (0.0, 0.0),
    height: float = 0.25,
    **how: Unpack[Follow],
) -> Path:
    """Return the seam where an upright branch tube meets a tube that lies along x.

    The seam is x = r cos a, y = r sin a, z = height + sqrt(R^2 - y^2). The tool leans outwards from
    the branch by `tilt`, in the plane across the seam (the work angle of a weld).

    Args:
        radius: Radius r of the branch [m], such as `0.05`.
        tube_radius: Radius R of the lying tube, larger than r [m], such as `0.09`.
        tilt: Angle between the tool and the wall of the branch [rad]; 0 runs along the wall.
        turns: How often it goes round; negative for clockwise seen from +z.
        start: Angle a of the first point [rad].
        center: x and y of the axis of the branch [m].
        height: z of the axis of the lying tube [m].
        **how: See `Follow`; `orientation` is "normal" unless given.

    Raises:
        InputError: A radius that is not positive, a branch not thinner than the tube, or no turn.
    """
    positive(radius=radius, tube_radius=tube_radius)
    if radius >= tube_radius:
        message = f"a branch thinner than the tube ({tube_radius:g}) is expected; given {radius:g}"
        raise InputError(message, field="radius")
    not_zero(turns=turns)
    if not abs(tilt) <= 0.5 * math.pi:
        message = f"an angle within 90 degrees is expected; given {math.degrees(tilt):g}"
        raise InputError(message, field="tilt")
    origin, turn = middle(center, height), 2 * math.pi * turns

    def outward(t: Array) -> Array:
        a = start + turn * t
        return np.column_stack([np.cos(a), np.sin(a), np.zeros_like(a)])

    def top(t: Array) -> Array:
        return np.sqrt(tube_radius**2 - (radius * np.sin(start + turn * t)) ** 2)

    def point(t: Array) -> Array:
        above = np.column_stack([np.zeros_like(t), np.zeros_like(t), top(t)])
        return np.asarray(origin + radius * outward(t) + above)

    def derivative(t: Array) -> Array:
        a = start + turn * t
        fall = -(radius**2) * np.sin(a) * np.cos(a) / top(t)
        return turn * np.column_stack([-radius * np.sin(a), radius * np.cos(a), fall])

    def normal(t: Array) -> Array:
        tangent = derivative(t)
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        # z and the seam both touch the wall of the branch: across the seam, along the wall.
        wall = np.array([0.0, 0.0, 1.0]) - tangent[:, 2:] * tangent
        wall /= np.linalg.norm(wall, axis=1, keepdims=True)
        return np.asarray(math.cos(tilt) * wall + math.sin(tilt) * outward(t))

    pieces = spans(point, derivative, math.ceil(4 * abs(turns)), normal)
    return follow(pieces, "tube seam", {"orientation": "normal", **how})
