"""From a result with a motion to the program of a controller, checked before it is written."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin import __version__
from dualarm_pin.answer.folder import load_result
from dualarm_pin.errors import InputError
from dualarm_pin.exports.check import error_of
from dualarm_pin.exports.choose_points import choose_points
from dualarm_pin.exports.convention import arm_columns, convention_of, ros_names
from dualarm_pin.exports.format import Chord, Files, Format
from dualarm_pin.exports.formats import format_of
from dualarm_pin.exports.names import comment
from dualarm_pin.exports.program import Points, Program
from dualarm_pin.exports.relative_path import RelativePath
from dualarm_pin.files.write import write_text
from dualarm_pin.motion import Motion
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.answer.trajectory import Trajectory
    from dualarm_pin.task import Task

REPORT = "export.json"
_HASHED = ("result.json", "trajectory.npz", "motion.npz", "task.yaml")


@dataclass(frozen=True)
class Exported:
    """A program and what was found when its text was read back.

    Attributes:
        format: Name of the format.
        files: What was written; () if the error is above the tolerance.
        points: Number of points of the program.
        samples: Number of samples of the motion.
        duration: [s].
        error: Largest distance from the relative path of the motion.
        tolerance: What was allowed.
        motion_error: Largest distance of the motion from the path of the task, as its own check
            found.
        draft: What no source confirmed.
    """

    format: str
    files: tuple[Path, ...]
    points: int
    samples: int
    duration: float
    error: Chord
    tolerance: Chord
    motion_error: Chord
    draft: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether the error is within the tolerance."""
        return self.error.mm <= self.tolerance.mm and self.error.deg <= self.tolerance.deg

    def as_text(self) -> str:
        """Return what a user wants to know, in some lines."""
        lines = [
            f"{self.format}: {self.points} points of {self.samples} samples, {self.duration:.3f} s",
            f"read back: {_chord(self.error)} from the path of the motion; "
            f"allowed {_chord(self.tolerance)}",
            f"the motion itself: {_chord(self.motion_error)} from the path of the task",
        ]
        return "\n".join(lines + [f"DRAFT: {note}" for note in self.draft])


def export(
    result: str | Path,
    to: str | Format,
    out: str | Path,
    *,
    name: str | None = None,
    mm: float | None = None,
    deg: float | None = None,
    allow_code: bool = False,
) -> Exported:
    """Write the motion of a result as a program for a controller.

    The text is read back and run through the kinematics first; nothing is written if it leaves the
    relative path of the motion by more than the tolerance.

    Args:
        result: A result folder with a motion.
        to: Name of a format, or one of the user's own.
        out: Folder of the program; empty, or with an earlier program of the same names.
        name: Name of the program; that of the task by default.
        mm: Largest distance from the relative path [mm]; that of the format by default.
        deg: Largest angle [deg].
        allow_code: Import and run what the task names with `call`.

    Raises:
        MissingFileError: There is no result, or it has no motion.
        UnknownNameError: There is no such format.
        InputError: The result is not found, its joints do not fit the format, or the folder holds
            something else.
        DualArmError: What was written cannot be read back.
    """
    target, folder = format_of(to), Path(result)
    tolerance = _tolerance(target, mm, deg)
    task, trajectory = load_result(folder, allow_code=allow_code)
    if not trajectory.found:
        message = f"it is not a solution, and no robot shall run it: {trajectory.message}"
        raise InputError(message, file=folder / "result.json", field="found")
    motion = Motion.load(folder)
    _refuse_another(motion, trajectory, folder)
    convention = convention_of(task.cell, target)
    path = RelativePath(task.cell, motion.q, task.path, motion.arc_length, tolerance)
    chosen = choose_points(motion, path, target)
    assert chosen.time is not None
    points = Points(
        convention.values(chosen.values), chosen.time, chosen.velocity, chosen.acceleration
    )
    program = Program(
        name=task.name if name is None else name,
        comment=tuple(_head(task, target, tolerance, points, folder)),
        joints=task.cell.joint_names,
        ros_joints=ros_names(task.cell),
        arms=arm_columns(task.cell),
        points=points,
    )
    files = target.write(program)
    summary = motion.summary
    exported = Exported(
        format=target.name,
        files=tuple(Path(out) / file for file in files),
        points=len(points),
        samples=len(motion.time),
        duration=float(chosen.time[-1]),
        error=error_of(files, program, target, convention, path),
        tolerance=tolerance,
        motion_error=Chord(summary.path_error_mm, summary.path_error_deg),
        draft=target.draft,
    )
    if not exported.passed:
        return Exported(**{**vars(exported), "files": ()})
    _write(Path(out), files, exported, _fingerprint(folder))
    return exported


def _tolerance(target: Format, mm: float | None, deg: float | None) -> Chord:
    for field, value in (("mm", mm), ("deg", deg)):
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise InputError(f"a number above 0 is expected; given {value}", field=field)
    return Chord(
        target.tolerance.mm if mm is None else mm, target.tolerance.deg if deg is None else deg
    )


def _refuse_another(motion: Motion, trajectory: Trajectory, folder: Path) -> None:
    """Refuse a motion that does not pass by the points of the trajectory."""
    from scipy.spatial import cKDTree

    room = TOLERANCE.same_joint + np.abs(np.diff(motion.q, axis=0)).max()
    away, _ = cKDTree(motion.q).query(trajectory.q, p=np.inf)
    if motion.joints != trajectory.joints or away.max() > room:
        message = (
            f"not a motion of this trajectory: make it again with `dualarm-pin motion {folder}`"
        )
        raise InputError(message, file=folder / "motion.npz")


def _fingerprint(folder: Path) -> str:
    """Return the SHA-256 of what a program was made of."""
    digest = hashlib.sha256()
    for name in _HASHED:
        digest.update((folder / name).read_bytes())
    return digest.hexdigest()


def _head(
    task: Task, target: Format, tolerance: Chord, points: Points, folder: Path
) -> Sequence[str]:
    lines = [
        f"dualarm_pin {__version__}, {target.name}",
        f"task {task.name}, cell {task.cell.name}",
        f"result sha256 {_fingerprint(folder)}",
        f"{len(points)} points in {points.duration:.3f} s",
        f"within {_chord(tolerance)} of the relative path, blending of the controller aside",
    ]
    for arm, part in arm_columns(task.cell).items():
        names = [name.partition("/")[2] for name in task.cell.joint_names[part]]
        lines.append(f"{arm}: {', '.join(names)}")
    lines += [f"DRAFT: {note}" for note in target.draft]
    return [part for line in lines for part in comment(line)]


def _write(out: Path, files: Files, exported: Exported, fingerprint: str) -> None:
    strangers = sorted(file.name for file in out.glob("*") if file.name not in (*files, REPORT))
    if out.exists() and not out.is_dir():
        raise InputError("a folder is expected; this is a file", file=out)
    if strangers:
        message = f"there is something else here ({strangers[0]}): give an empty folder as --out"
        raise InputError(message, file=out)
    for name, text in files.items():
        write_text(out / name, text)
    report = {
        "format": exported.format,
        "files": list(files),
        "result_sha256": fingerprint,
        "points": exported.points,
        "samples": exported.samples,
        "duration": exported.duration,
        "position_error": exported.error.mm * 1e-3,
        "rotation_error": math.radians(exported.error.deg),
        "position_tolerance": exported.tolerance.mm * 1e-3,
        "rotation_tolerance": math.radians(exported.tolerance.deg),
        "draft": list(exported.draft),
        "units": {"length": "m", "angle": "rad", "time": "s"},
    }
    write_text(out / REPORT, json.dumps(report, indent=1) + "\n")


def _chord(chord: Chord) -> str:
    return f"{chord.mm:.3g} mm and {chord.deg:.3g} deg"
