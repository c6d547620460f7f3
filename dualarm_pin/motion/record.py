"""The noun: joints over time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from dualarm_pin.arrays import Array, finite
from dualarm_pin.errors import InputError
from dualarm_pin.files.numbers import LARGEST
from dualarm_pin.motion.store import has_motion, read_motion, write_motion
from dualarm_pin.motion.summary import Law, MotionSummary


@dataclass(frozen=True, eq=False)
class Motion:
    """Joints over time, along the path of a task.

    Attributes:
        law: `constant_feed` or `time_optimal`.
        joints: Names of the columns, `arm1/<name>` and `arm2/<name>`.
        time: From 0, rising (m,) [s].
        arc_length: Length of the path up to each sample (m,) [m].
        q: Joints (m, n) [rad or m].
        velocity: (m, n) [rad/s or m/s].
        acceleration: (m, n) [rad/s^2 or m/s^2].
        torque: (m, n) [N m or N]; None where it is unknown.
        summary: What it comes to.

    Raises:
        ShapeError: The arrays do not belong together.
        InputError: A value is not finite, or time does not rise.
    """

    law: Law
    joints: tuple[str, ...]
    time: Array
    arc_length: Array
    q: Array
    velocity: Array
    acceleration: Array
    torque: Array | None
    summary: MotionSummary

    def __post_init__(self) -> None:
        m, n = len(self.time), len(self.joints)
        finite(self.time, "time", (m,))
        finite(self.arc_length, "arc_length", (m,))
        for name in ("q", "velocity", "acceleration"):
            finite(getattr(self, name), name, (m, n))
        if np.abs(self.q).max(initial=0.0) > LARGEST:
            raise InputError(f"rad or m up to {LARGEST:g} are expected", field="q")
        if self.torque is not None:
            finite(self.torque, "torque", (m, n))
        if m < 2 or self.time[0] != 0.0 or np.any(np.diff(self.time) <= 0.0):
            raise InputError("times must rise from 0, two or more", field="time")
        if np.any(np.diff(self.arc_length) < 0.0):
            raise InputError("arc lengths must not fall", field="arc_length")

    @classmethod
    def load(cls, folder: str | Path) -> Motion:
        """Read the motion of a result folder.

        Raises:
            MissingFileError: It holds no result, or no motion was made of it.
            InputError: Its files are damaged or do not fit together.
        """
        law, joints, arrays, summary = read_motion(Path(folder))
        try:
            torque = arrays.pop("torque", None)
            return cls(law, joints, **arrays, torque=torque, summary=summary)
        except InputError as error:
            file = Path(folder) / "motion.npz"
            raise InputError(error.message, file=file, field=error.field) from error

    def write(self, folder: str | Path) -> None:
        """Write it into the folder of its result: `motion.csv`, `motion.npz`, and result.json.

        Raises:
            MissingFileError: The folder holds no result.
            InputError: The result has other joints, or the folder cannot be written.
        """
        content = {"law": self.law, "has_torque": self.torque is not None, **asdict(self.summary)}
        write_motion(Path(folder), self.joints, self.arrays, content)

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return float(self.time[-1])

    @property
    def arrays(self) -> Mapping[str, Array]:
        """What `motion.npz` holds, by name."""
        named = ("time", "arc_length", "q", "velocity", "acceleration")
        found = {name: getattr(self, name) for name in named}
        return found if self.torque is None else found | {"torque": self.torque}


def motions_of(folders: Mapping[str, Path]) -> dict[str, Motion]:
    """Return the motions of result folders by label; those without one are left out.

    Raises:
        InputError: A motion is damaged.
    """
    return {label: Motion.load(folder) for label, folder in folders.items() if has_motion(folder)}
