"""Which trajectories of a batch are kept, and where."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dualarm_pin.answer.folder import save_trajectory
from dualarm_pin.bench.run import BenchRun, RunOutcome, digest

Problem = tuple[str, str]


@dataclass
class Keeper:
    """Writes result folders: the best of each task and variant, all, or none.

    The best is the lowest objective among the runs that were found; of two alike the first of the
    table, so that the order in which runs end does not matter.

    Attributes:
        folder: Folder of the batch.
        keep: `best`, `all` or `none`.
        order: Place of each run in the table, by key.
    """

    folder: Path
    keep: str
    order: Mapping[str, int]
    _best: dict[Problem, tuple[float, int]] = field(default_factory=dict)

    def recall(self, rows: Iterable[Mapping[str, Any]]) -> None:
        """Learn what the rows of an earlier session hold."""
        for row in rows:
            if row["found"] and row.get("objective") is not None:
                self._better((row["task"], row["variant"]), row["objective"], row["key"])

    def consider(self, run: BenchRun, outcome: RunOutcome) -> None:
        """Write the trajectory of a run if it is one to keep.

        Raises:
            InputError: The folder cannot be written.
        """
        trajectory = outcome.trajectory
        if trajectory is None or self.keep == "none":
            return
        if self.keep == "all":
            save_trajectory(all_folder(self.folder, run), trajectory, outcome.task_file)
        if trajectory.found and self._better(run.problem, trajectory.objective, run.key):
            folder = best_folder(self.folder, run.problem)
            save_trajectory(folder, trajectory, outcome.task_file)

    def _better(self, problem: Problem, objective: float, key: str) -> bool:
        score = (objective, self.order[key])
        if score >= self._best.get(problem, (float("inf"), 0)):
            return False
        self._best[problem] = score
        return True


def best_folder(folder: Path, problem: Problem) -> Path:
    """Return where the best result of a task and variant is."""
    task, variant = problem
    mark = f"-{digest(variant)[:10]}" if variant else ""
    return folder / "best" / f"{_safe(task)}{mark}"


def all_folder(folder: Path, run: BenchRun) -> Path:
    """Return where the result of a run is, with `keep: all`."""
    return folder / "runs" / f"{_safe(run.task)}-{_safe(run.method.name)}-{run.key[:10]}"


def _safe(name: str) -> str:
    """Return a name that is a file name everywhere; unlike names stay unlike."""
    plain = re.sub(r"[^\w.-]+", "-", name).strip(".-")[:60]
    return plain if plain == name else f"{plain}-{digest(name)[:6]}"
