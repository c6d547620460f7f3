"""The paper, reproduced: its two methods on its task, its table and its figures.

Two-stage method, the polish of its answer over the whole path, and the pseudo-inverse from the
same first configuration in three variants and from three random feasible ones. Beside them the
whole path at once, which the paper thought too heavy, and the pseudo-inverse from where it begins.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from dualarm_pin.answer.folder import save_result
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.errors import DualArmError
from dualarm_pin.files.numbers import check_counts
from dualarm_pin.files.resources import urdf_folder
from dualarm_pin.files.write import write_text
from dualarm_pin.planners.local import plan_local
from dualarm_pin.planners.two_stage import plan_two_stage
from dualarm_pin.planners.unreachable import feasible_postures
from dualarm_pin.planners.whole_path import plan_global, polish
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.search.starts import generator
from dualarm_pin.search.workers import Workers
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task import Task

PAPER_MEANS = {"two-stage": 1.17, "pseudo-inverse": 1.52}
CLEAR = "whole path, clearance 0.05"
RANDOM_STARTS = 3  # the red, green and magenta curves of the paper's Fig. 5


def _metres(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"


_COLUMNS: dict[str, Callable[[Trajectory], str]] = {
    "mean c": lambda t: f"{t.mean_index:.4f}",
    "arc mean": lambda t: f"{t.arc_mean_index:.4f}",
    "max c": lambda t: f"{t.max_index:.4f}",
    "objective": lambda t: f"{t.objective:.4f}",
    "step [deg]": lambda t: f"{math.degrees(t.max_joint_step):.2f}",
    "bounds [deg]": lambda t: f"{math.degrees(t.max_bound_violation):.2f}",
    "clearance [m]": lambda t: _metres(t.min_clearance),
    "between arms [m]": lambda t: _metres(t.arm_clearance),
    "time [s]": lambda t: f"{t.timing.wall_s:.1f}",
}


@dataclass(frozen=True)
class Reproduction:
    """Everything that `paper` computes.

    Attributes:
        task: The paper's task.
        clear: The same with a clearance, which one of the trajectories keeps.
        trajectories: By label, in the order of the table.
    """

    task: Task
    clear: Task
    trajectories: dict[str, Trajectory]

    def task_of(self, label: str) -> Task:
        """Return the task that a trajectory answers."""
        return self.clear if label == CLEAR else self.task

    def rows(self) -> list[tuple[str, ...]]:
        """Return the table: the head, then one row a trajectory."""
        body = (
            (label, *(text(t) for text in _COLUMNS.values()))
            for label, t in self.trajectories.items()
        )
        return [("method", *_COLUMNS), *body]

    def table(self) -> str:
        """Return the table as text."""
        rows = self.rows()
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = [
            row[0].ljust(widths[0])
            + "".join(f"  {cell:>{w}}" for cell, w in zip(row[1:], widths[1:], strict=True))
            for row in rows
        ]
        lines.insert(1, "-" * len(lines[0]))
        return "\n".join(lines)


def reproduce(
    *,
    starts: int = 100,
    seed: int = 0,
    jobs: int | None = None,
    progress: Progress = SILENT,
) -> Reproduction:
    """Run the methods of the paper on its task.

    Args:
        starts: Starts of each problem of the two-stage method.
        seed: Seed of all starts.
        jobs: Number of processes; None takes the processors there are.
        progress: Told where the work stands.

    Raises:
        InputError: A number is out of range.
        DualArmError: The two-stage method found nothing (too few starts).
    """
    check_counts(starts, seed, jobs)
    task = Task.load(urdf_folder() / "tasks" / "paper_corner.yaml")
    trajectories: dict[str, Trajectory] = {}
    with Workers(jobs) as workers:
        two_stage = plan_two_stage(
            task, starts=starts, seed=seed, progress=progress, workers=workers
        )
    if not two_stage.found:
        raise DualArmError(f"the two-stage method found nothing: {two_stage.message}")
    trajectories["two-stage"] = two_stage
    progress.line(f"two-stage: mean c {two_stage.mean_index:.4f}")
    engine.ensure_compiled(progress.line)
    trajectories["two-stage, polished"] = polish(task, two_stage.q, seed=seed)
    progress.line(f"polished: mean c {trajectories['two-stage, polished'].mean_index:.4f}")
    whole = plan_global(task, effort="quick", seed=seed, jobs=jobs, progress=progress)
    trajectories["whole path"] = whole
    progress.line(f"whole path at once: mean c {whole.mean_index:.4f}")
    clear = Task.load(urdf_folder() / "tasks" / "paper_corner_clear.yaml")
    apart = plan_global(clear, effort="quick", seed=seed, jobs=jobs, progress=progress)
    trajectories[CLEAR] = apart
    progress.line(f"with clearance: mean c {apart.mean_index:.4f}")
    for variant in ("free", "clamped", "qp"):
        trajectories[f"pseudo-inverse, {variant}"] = plan_local(
            task, two_stage.q[0], variant=variant, seed=seed, progress=progress
        )
    trajectories["pseudo-inverse, free, best first"] = plan_local(
        task, whole.q[0], variant="free", seed=seed, progress=progress
    )
    others, _, _ = feasible_postures(
        task.problem(), 0, RANDOM_STARTS, generator(seed, 5), 50 * RANDOM_STARTS
    )
    for number, q_first in enumerate(others, 1):
        trajectories[f"pseudo-inverse, free, random {number}"] = plan_local(
            task, q_first, variant="free", seed=seed, progress=progress
        )
    return Reproduction(task, clear, trajectories)


def write(reproduction: Reproduction, folder: Path) -> list[Path]:
    """Write the table, Fig. 3, 4, 5 (PNG and SVG), the animation and the results.

    Returns:
        The files for people: table, figures, animation.
    """
    from dualarm_pin.show import plots, write_player

    task, trajectories = reproduction.task, reproduction.trajectories
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(reproduction.rows())
    write_text(folder / "table.csv", text.getvalue())
    write_text(folder / "table.txt", reproduction.table() + "\n")
    for label, trajectory in trajectories.items():
        save_result(
            folder / "results" / label.replace(", ", "-").replace(" ", "-"),
            reproduction.task_of(label),
            trajectory,
        )

    written = [folder / "table.txt", folder / "table.csv"]
    written += plots.save(plots.figure_path(task.path, task.Gamma), folder / "fig3")
    written += plots.save(
        plots.figure_index(
            {
                "two-stage": trajectories["two-stage"],
                "two-stage, polished": trajectories["two-stage, polished"],
                "whole path at once": trajectories["whole path"],
                "pseudo-inverse, from the two-stage start": trajectories["pseudo-inverse, free"],
            },
            title="Fig. 4: the whole task against step by step",
        ),
        folder / "fig4",
    )
    random = {label.rsplit(", ", 1)[1]: t for label, t in trajectories.items() if "random" in label}
    written += plots.save(
        plots.figure_index(
            {
                "from the two-stage method": trajectories["pseudo-inverse, free"],
                "from the whole path at once": trajectories["pseudo-inverse, free, best first"],
                **random,
            },
            title="Fig. 5: pseudo-inverse from several first configurations",
        ),
        folder / "fig5",
    )
    write_player(folder / "animation.html", task, trajectories, title="The paper's task")
    return [*written, folder / "animation.html"]


def notes(reproduction: Reproduction) -> list[str]:
    """Return what a reader must know beside the table."""
    free = reproduction.trajectories["pseudo-inverse, free"]
    lines = [
        f"the paper reports mean c {PAPER_MEANS['two-stage']} (two-stage) and "
        f"{PAPER_MEANS['pseudo-inverse']} (pseudo-inverse); it does not state its tool, basin or "
        "solver"
    ]
    if free.max_bound_violation > 0:
        lines.append(
            "pseudo-inverse, free, has no joint limits: it leaves the bounds by "
            f"{math.degrees(free.max_bound_violation):.1f} deg"
        )
    lowered = asked_of(reproduction.clear).lowered
    if lowered:
        pairs = "; ".join(f"{one} and {two} ({most:.3f} m)" for (one, two), most in lowered)
        lines.append(
            f"{CLEAR}: of links that are nowhere so far apart it is asked that they do not touch, "
            f"{pairs} at most"
        )
    lost = [label for label, t in reproduction.trajectories.items() if not t.found]
    if lost:
        lines.append("not a solution within bounds and on the path: " + "; ".join(lost))
    return lines
