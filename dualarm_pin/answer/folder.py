"""Result folders: a task as solved and the trajectory that answers it.

A folder holds `task.yaml`, `trajectory.csv`, `trajectory.npz` (no pickle) and
`result.json`; scripts rely on their keys and columns. `alternatives/2` and on are folders like it.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from pydantic import ValidationError

from dualarm_pin.answer.alternatives import FOLDER, place_of
from dualarm_pin.answer.result_json import read_result_json, result_json
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.errors import InputError, MissingFileError
from dualarm_pin.files.npz import npz_bytes, read_npz
from dualarm_pin.files.read import read_file
from dualarm_pin.files.write import write_files

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_LARGEST_JSON = 50_000_000  # bytes; of the longest path 20 MB
_OF_AN_OLDER = ("motion.csv", "motion.npz", "sensitivity.json", FOLDER)  # trajectory: they go
_DONE = ("method=null", "solver=null")  # have done their work: none of their code is needed
_NOT_OURS = "not a result of this program"


def save_result(folder: str | Path, task: Task, trajectory: Trajectory) -> None:
    """Write a result folder: the task (complete, as solved) and its trajectory.

    A task made in Python has no file: then the trajectory is written alone.

    Raises:
        InputError: The folder cannot be written.
    """
    save_trajectory(folder, trajectory, None if task.record is None else task.as_yaml())


def save_trajectory(folder: str | Path, trajectory: Trajectory, task: str | None = None) -> None:
    """Write a trajectory into a folder; the old files stay until all new ones are on the disk.

    What belongs to an older trajectory goes with it: its motion, its costs and its alternatives.

    Args:
        folder: Where to.
        trajectory: The answer.
        task: Content of `task.yaml`, if there is one.

    Raises:
        InputError: The folder cannot be written.
    """
    others = {place_of(i): a.trajectory for i, a in enumerate(trajectory.alternatives, 2)}
    files = {
        f"{place}/{name}": content
        for place, other in others.items()
        for name, content in _files(other, task).items()
    }
    write_files(Path(folder), files | _files(trajectory, task), stale=_OF_AN_OLDER)


def _files(t: Trajectory, task: str | None) -> dict[str, bytes]:
    """Return the files of one trajectory, `result.json` last."""
    arrays = {"q": t.q, "index": t.index, "arc_length": t.arc_length}
    return ({} if task is None else {"task.yaml": task.encode()}) | {
        "trajectory.csv": _csv(t).encode(),
        "trajectory.npz": npz_bytes(arrays, t.joints),
        "result.json": (json.dumps(result_json(t), indent=1) + "\n").encode(),
    }


def with_alternatives(folder: Path) -> list[Path]:
    """Return a result folder and those of its alternatives, in order."""
    others = [each.parent for each in (folder / FOLDER).glob("*/result.json")]
    numbered = [each for each in others if each.name.isdecimal()]
    return [folder, *sorted(numbered, key=lambda each: int(each.name))]


def load_result(
    folder: str | Path, changes: Sequence[str] = (), *, allow_code: bool = False
) -> tuple[Task, Trajectory]:
    """Read a result folder.

    Args:
        folder: What `save_result` wrote.
        changes: `key=value` changes of its task, of what its answer does not hang on.
        allow_code: Import and run the index or the path that the task names with `call`; its
            method and its solver have done their work and are left alone.

    Raises:
        MissingFileError: It holds no result, or its task names files that are gone.
        InputError: Its files are damaged or do not fit together.
    """
    from dualarm_pin.task import Task

    folder = Path(folder)
    trajectory = load_trajectory(folder)
    if not (folder / "task.yaml").is_file():
        raise MissingFileError("the task of this result is missing", file=folder / "task.yaml")
    task = Task.load(folder / "task.yaml", [*_DONE, *changes], allow_code=allow_code)
    if (len(trajectory.q), trajectory.joints) != (task.path.h, task.cell.joint_names):
        raise InputError(
            f"it answers another task: {len(trajectory.q)} points of {len(trajectory.joints)} "
            f"joints; the task has {task.path.h} points of {task.cell.n} joints",
            file=folder / "result.json",
        )
    return task, trajectory


def load_trajectory(folder: str | Path) -> Trajectory:
    """Read the trajectory of a result folder, of this version or one before.

    Raises:
        MissingFileError: It holds no result.
        InputError: Its files are damaged or do not fit together.
    """
    file, archive = Path(folder) / "result.json", Path(folder) / "trajectory.npz"
    text = read_file(file, _LARGEST_JSON, "give the folder that `solve --out` wrote")
    arrays = read_npz(archive, {"q": 2, "index": 1, "arc_length": 1}, what="a trajectory")
    try:
        return read_result_json(text, **arrays)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        given = (
            ""
            if first["type"] in ("missing", "json_invalid")
            else f"; given {first['input']!r:.80}"
        )
        field = ".".join(map(str, first["loc"])) or None
        raise InputError(f"{_NOT_OURS}: {first['msg']}{given}", file=file, field=field) from error
    except InputError as error:
        raise InputError(
            f"it does not fit trajectory.npz: {error.message}", file=file, field=error.field
        ) from error


def _csv(trajectory: Trajectory) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["point", "arc_length", *trajectory.joints, "index"])
    t = trajectory
    for i, row in enumerate(np.column_stack([t.arc_length, t.q, t.index]).tolist(), 1):
        writer.writerow([i, *row])
    return text.getvalue()


def labels(folders: Sequence[Path]) -> list[str]:
    """Return a label for each folder: its name, or as much of its path as tells it apart."""
    full = [folder.resolve().parts for folder in folders]
    found = []
    for number, parts in enumerate(full, 1):
        for depth in range(1, len(parts) + 1):
            if sum(other[-depth:] == parts[-depth:] for other in full) == 1:
                found.append("/".join(parts[-depth:]))
                break
        else:
            found.append(f"{parts[-1]} ({number})")  # the same folder twice
    return found
