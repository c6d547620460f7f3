"""Result folders: a task as solved and the trajectory that answers it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.errors import MissingFileError
from dualarm_pin.files.write import write_text

if TYPE_CHECKING:
    from dualarm_pin.task import Task


def save_result(folder: Path, task: Task, trajectory: Trajectory) -> None:
    """Write `task.yaml` (complete, as solved), then the files of the trajectory.

    Raises:
        InputError: The folder cannot be written.
    """
    if task.record is not None:
        write_text(folder / "task.yaml", task.as_yaml())
    trajectory.save(folder)


def load_result(folder: str | Path) -> tuple[Task, Trajectory]:
    """Read a result folder.

    Raises:
        MissingFileError: It holds no result, or its task names files that are gone.
        InputError: Its files do not fit together.
    """
    from dualarm_pin.task import Task

    folder = Path(folder)
    trajectory = Trajectory.load(folder)
    if not (folder / "task.yaml").is_file():
        raise MissingFileError("the task of this result is missing", file=folder / "task.yaml")
    return Task.load(folder / "task.yaml"), trajectory


def labels(folders: Sequence[Path]) -> list[str]:
    """Return a label for each folder: its name, or as much of its path as tells them apart."""
    parts = [folder.resolve().parts[::-1] for folder in folders]
    for depth in range(1, max(map(len, parts)) + 1):
        names = ["/".join(reversed(part[:depth])) for part in parts]
        if len(set(names)) == len(names):
            return names
    return [f"{name} ({number})" for number, name in enumerate(names, 1)]


def summary(task: Task, trajectory: Trajectory) -> str:
    """Return a result as a few lines of text."""
    t = trajectory
    clearance = (
        "unknown (meshes are missing)"
        if t.min_clearance is None
        else f"{t.min_clearance:.3f} m" + (" (IN COLLISION)" if t.min_clearance <= 0 else "")
    )
    if t.arm_clearance is not None:
        clearance += f", between the arms {t.arm_clearance:.3f} m"
    units = task.index.units
    lines = [
        f"{'found' if t.found else 'NOT FOUND'} by {t.method} ({t.solver})",
        f"index        mean {t.mean_index:.4f}, over the arc length {t.arc_mean_index:.4f}, "
        f"largest {t.max_index:.4f} {units}",
        f"objective    {t.objective:.4f} with lambda {task.smoothness:g}",
        f"pose error   {t.max_position_error:.1e} m, {t.max_rotation_error:.1e} rad",
        f"bounds       violated by {t.max_bound_violation:.1e}, "
        f"largest joint step {t.max_joint_step:.3f} (rad or m)",
        f"clearance    {clearance}",
        f"time         {t.timing.wall_s:.2f} s wall, {t.timing.cpu_s:.2f} s processor"
        + (f", {t.timing.compile_s:.1f} s of it compiling" if t.timing.compile_s else ""),
    ]
    sentences = t.extra.get("evidence_text")
    if sentences:
        lines += ["evidence     " + str(sentences).replace("\n", "\n" + " " * 13)]
    return "\n".join(lines)
