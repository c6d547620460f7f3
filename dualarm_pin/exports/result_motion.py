"""What a program is made of: a result that holds, and its motion."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from dualarm_pin.answer.folder import load_result
from dualarm_pin.errors import InputError
from dualarm_pin.motion import Motion
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.answer.trajectory import Trajectory
    from dualarm_pin.task import Task

_HASHED = ("result.json", "trajectory.npz", "motion.npz", "task.yaml")


@dataclass(frozen=True, eq=False)
class ResultMotion:
    """A task, the motion that answers it, and the SHA-256 of the files of both."""

    task: Task
    motion: Motion
    sha256: str

    @classmethod
    def load(cls, folder: Path, *, allow_code: bool) -> ResultMotion:
        """Read a result folder.

        Args:
            folder: A result folder with a motion.
            allow_code: Import and run what the task names with `call`.

        Raises:
            MissingFileError: There is no result, or it has no motion.
            InputError: The result is not found, or the motion is not one of its trajectory.
        """
        task, trajectory = load_result(folder, allow_code=allow_code)
        if not trajectory.found:
            message = f"it is no solution, and no robot shall run it: {trajectory.message}"
            raise InputError(message, file=folder / "result.json", field="found")
        motion = Motion.load(folder)
        _refuse_another(motion, trajectory, folder)
        return cls(task, motion, sha256_of(folder))

    @property
    def cautions(self) -> tuple[str, ...]:
        """What to know before a robot runs it."""
        clearance = self.motion.summary.least_clearance
        if clearance is None:
            return ("the clearance along this motion is unknown.",)
        if clearance <= 0.0:
            return (f"links touch along this motion: clearance {clearance:.3f} m.",)
        return ()


def sha256_of(folder: Path) -> str:
    """Return the SHA-256 of the files of a result, those of its motion too if it has one."""
    digest = hashlib.sha256()
    for file in (folder / name for name in _HASHED):
        if file.is_file():
            digest.update(file.read_bytes())
    return digest.hexdigest()


def _refuse_another(motion: Motion, trajectory: Trajectory, folder: Path) -> None:
    """Refuse a motion that does not pass by the points of the trajectory."""
    room = TOLERANCE.same_joint + np.abs(np.diff(motion.q, axis=0)).max()
    fits = motion.joints == trajectory.joints
    if not fits or cKDTree(motion.q).query(trajectory.q, p=np.inf)[0].max() > room:
        how = f"make it again with `dualarm-pin motion {folder}`"
        message = f"it does not pass by the points of this trajectory: {how}"
        raise InputError(message, file=folder / "motion.npz")
