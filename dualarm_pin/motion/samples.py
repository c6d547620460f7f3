"""Samples of a schedule at a steady rate, dense enough for the relative path between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.motion.joint_curve import JointCurve
from dualarm_pin.motion.schedule import Schedule
from dualarm_pin.motion.use import JointMotion, joints_at
from dualarm_pin.task.motion_spec import MotionSpec

_MOST = 200_000  # samples: 100 MB of CSV
_ROUNDS = 6  # of refinement; the chord error falls with the square, so two do


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples, and how far they and the chords between them are from the path.

    Attributes:
        time: (m,) [s].
        motion: Joints there.
        path_error: Largest distance [m] and angle [rad] of a sample.
        chord_error: The same halfway between samples, joints taken as straight there.
    """

    time: Array
    motion: JointMotion
    path_error: tuple[float, float]
    chord_error: tuple[float, float]


def samples_of(curve: JointCurve, schedule: Schedule, spec: MotionSpec) -> Samples:
    """Return samples no farther apart than the rate, and closer where the chords ask for it.

    Raises:
        InputError: There would be too many.
    """
    step = spec.rate
    for _ in range(_ROUNDS):
        count = int(np.ceil(schedule.duration / step - 1e-9)) + 1
        if count > _MOST:
            raise InputError(
                f"{schedule.duration:.0f} s make {count} samples, more than {_MOST}: give a larger "
                "motion.rate, chord or feed",
                field="motion.rate",
            )
        time = np.linspace(0.0, schedule.duration, max(count, 3))
        motion = joints_at(curve, schedule, time)
        between = 0.5 * (motion.q[1:] + motion.q[:-1])
        chord = _largest(curve, 0.5 * (motion.place[1:] + motion.place[:-1]), between)
        over = max(1e3 * chord[0] / spec.chord.mm, np.rad2deg(chord[1]) / spec.chord.deg)
        if over <= 1.0:
            return Samples(time, motion, _largest(curve, motion.place, motion.q), chord)
        step = schedule.duration / (len(time) - 1) / np.ceil(np.sqrt(over))
    raise InputError(
        f"samples leave the path by {1e3 * chord[0]:.2g} mm between them, however dense: set "
        "motion.chord higher",
        field="motion.chord",
    )


def _largest(curve: JointCurve, place: Array, q: Array) -> tuple[float, float]:
    position, rotation = curve.errors(place, q)
    return float(position.max()), float(rotation.max())
