"""`trajectory_msgs/JointTrajectory` as YAML: what ROS 2 and MoveIt share.

One controller has the joints of both arms: that is what keeps them together. All of position,
velocity and acceleration are given, so the controller interpolates by polynomials of degree 5. The
first point is not approached: the arms must stand there.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from dualarm_pin.errors import InputError
from dualarm_pin.exports.program import Points, Program
from dualarm_pin.files.source import parse_yaml
from dualarm_pin.tolerance import TOLERANCE

_NANO = 1_000_000_000  # nanoseconds in a second
_DIGITS = 9  # rad and m: a nanometre at an arm's length
_LINE = re.compile(
    r"^ *- \{positions: \[(.*?)\], velocities: \[(.*?)\], accelerations: \[(.*?)\], "
    r"time_from_start: \{sec: (\d+), nanosec: (\d+)\}\}$"
)


def trajectory_lines(program: Program, indent: str) -> Iterator[str]:
    """Yield the lines of the mapping that holds the joints and the points.

    Raises:
        InputError: The motion ends while a joint still moves: controllers refuse that.
    """
    points = program.points
    assert points.velocity is not None
    assert points.acceleration is not None
    for name, speed in zip(program.joints, points.velocity[-1], strict=True):
        if abs(speed) > TOLERANCE.stationary:
            message = f"the motion ends at {speed:.3g} rad/s or m/s: it must end at rest"
            raise InputError(message, field=name)
    yield f"{indent}joint_names: [{', '.join(quoted(name) for name in program.ros_joints)}]"
    yield f"{indent}points:"
    at_rest = points.velocity.copy()
    at_rest[-1] = 0.0
    columns = (points.values, at_rest, points.acceleration)
    for *three, time in zip(*columns, program.time, strict=True):
        position, velocity, acceleration = map(_numbers, three)
        sec, nanosec = divmod(round(float(time) * _NANO), _NANO)
        yield (
            f"{indent}- {{positions: [{position}], velocities: [{velocity}], "
            f"accelerations: [{acceleration}], "
            f"time_from_start: {{sec: {sec}, nanosec: {nanosec}}}}}"
        )


def read_trajectory(text: str, key: str, file: str) -> Points:
    """Return the points of a YAML file that holds such a mapping under `key`.

    Raises:
        ValueError: It holds no such mapping.
    """
    content: Any = parse_yaml(text, file).values
    try:
        points = content[key]["points"]
        value, velocity, acceleration = (
            np.array([point[name] for point in points], dtype=float)
            for name in ("positions", "velocities", "accelerations")
        )
        stamps = [point["time_from_start"] for point in points]
        time = np.array([stamp["sec"] + stamp["nanosec"] / _NANO for stamp in stamps])
    except (KeyError, TypeError, IndexError) as error:
        raise ValueError(f"{file} holds no joint trajectory: {error}") from error
    return Points(value, time, velocity, acceleration)


def quoted(text: str) -> str:
    """Return a text in double quotes as every version of YAML reads it, in ASCII."""
    return '"' + "".join(_letter(letter) for letter in text) + '"'


def _letter(letter: str) -> str:
    if letter in '"\\':
        return "\\" + letter
    if " " <= letter <= "~":
        return letter
    code = ord(letter)
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _numbers(row: Iterable[float]) -> str:
    return ", ".join(f"{value + 0.0:.{_DIGITS}f}" for value in row)
