"""The check of a program: its text read back, run through the kinematics, compared."""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import DualArmError
from dualarm_pin.exports.convention import Convention
from dualarm_pin.exports.format import Chord, Files, Format
from dualarm_pin.exports.interpolate import BETWEEN
from dualarm_pin.exports.motion_path import MotionPath
from dualarm_pin.exports.program import Points, Program

_PER_SAMPLE = 2.0  # postures that are looked at for each sample of the motion
_CLOCK = 1e-3  # seconds by which a point may be late: controllers count milliseconds


def error_of(
    files: Files, program: Program, target: Format, convention: Convention, path: MotionPath
) -> Chord:
    """Return the largest error of what stands in the files of a program [mm, deg].

    Raises:
        DualArmError: They cannot be read back, or hold another number of points or other times.
    """
    points = _read_back(files, program, target)
    values = convention.joints(points.values)
    read = Points(values, points.time, points.velocity, points.acceleration)
    worst = path.deviation(_run(read, target, path)).max(axis=0)
    return Chord(*worst.tolist())


def _read_back(files: Files, program: Program, target: Format) -> Points:
    try:
        points = target.read(files)
    except Exception as error:  # a reader may be the user's own
        message = f"what {target.name} wrote cannot be read back: {error}"
        raise DualArmError(message) from error
    wrote = program.points
    if not isinstance(points, Points):
        raise DualArmError(f"the reader of {target.name} returns a {type(points).__name__}")
    if points.values.shape != wrote.values.shape:
        shapes = f"{points.values.shape} for {wrote.values.shape}"
        raise DualArmError(f"what {target.name} wrote reads as other points: {shapes}")
    if points.time is not None:
        late = float(np.max(np.abs(points.time - program.time)))
        if late > _CLOCK:
            raise DualArmError(f"what {target.name} wrote reads as other times, {late:.4f} s off")
    return points


def _run(points: Points, target: Format, path: MotionPath) -> Array:
    """Return the postures that the controller runs through, several between two points (k, n)."""
    step = path.joint_step / _PER_SAMPLE
    chord = np.linalg.norm(np.diff(points.values, axis=0), axis=1)
    number = np.maximum(2, np.ceil(chord / max(step, np.finfo(float).tiny))).astype(np.int64)
    parts = [i + np.arange(n) / n for i, n in enumerate(number.tolist())]
    place = np.concatenate([*parts, [len(points) - 1.0]])
    return BETWEEN[target.between](points, place)
