"""`dualarm-pin solve`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from dualarm_pin.cli import DONE, NOT_FOUND
from dualarm_pin.cli.terminal import TerminalProgress


def solve(
    task: Path,
    *,
    method: Literal["global", "feed", "two-stage", "local", "casadi", "pink"] | None = None,
    effort: Literal["quick", "normal", "thorough"] = "normal",
    solver: str | None = None,
    starts: int | None = None,
    time_limit: float | None = None,
    seed: int = 0,
    jobs: int | None = None,
    warm: Path | None = None,
    alternatives: int = 1,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative=())] = (),
    allow_code: Annotated[bool, Parameter(negative=())] = False,
    out: Path | None = None,
) -> int:
    """Solve a task and write the result into a folder.

    Args:
        task: A task file (YAML).
        method: The whole path at once, the largest feed, the paper's two stages, or step by step;
            casadi and pink are peers for comparison and need their extras. That of the task file
            by default, else that of its aim.
        effort: How much evidence to gather; for global and feed.
        solver: Solver of the method: engine, nlopt-slsqp, ipopt or fatrop for global and
            two-stage; free, clamped or qp for local.
        starts: Number of starts.
        time_limit: Seconds after which the search is cut; for the global method.
        seed: Seed of the starts: the same seed gives the same answer.
        jobs: Threads or processes to use; all processors by default.
        warm: Folder of an earlier result with the same joints, to start from too; for global.
        alternatives: How many answers that differ in posture, the best among them; for global.
        set_: Change a field of the task or cell: key=value, such as smoothness=30.
        allow_code: Import and run the functions that the task file names with `call`.
        out: Folder of the result; results/TASK-METHOD by default.
    """
    from dualarm_pin.answer.folder import load_trajectory, save_result
    from dualarm_pin.answer.summary import alternatives_text, summary
    from dualarm_pin.files.write import reserved, uninterrupted
    from dualarm_pin.motion.limits import limits_of
    from dualarm_pin.motion.make import make_motion
    from dualarm_pin.motion.text import motion_text
    from dualarm_pin.planners.methods import AIMS, plan
    from dualarm_pin.solvers.solver import name_of
    from dualarm_pin.task import Task

    loaded = Task.load(task, set_, allow_code=allow_code)
    if loaded.motion is not None:
        limits_of(loaded.cell, loaded.motion.limits)  # what is missing is said before the search
    earlier = None if warm is None else load_trajectory(warm)
    how = method or name_of(loaded.method or AIMS[loaded.aim])
    folder = out or Path("results") / f"{task.stem}-{how.replace(':', '-')}"
    with reserved(folder), TerminalProgress() as progress:
        for warning in loaded.cell.warnings:
            progress.line(f"warning: {warning}")
        trajectory = plan(
            loaded,
            method,
            effort=effort,
            solver=solver,
            starts=starts,
            time_limit=time_limit,
            seed=seed,
            jobs=jobs,
            warm=earlier,
            alternatives=alternatives,
            progress=progress,
        )
        made = None
        try:
            if loaded.motion is not None and trajectory.found:
                made = make_motion(loaded, trajectory)
        finally:  # a motion that cannot be made, or Ctrl-C, does not cost the answer
            with uninterrupted():
                save_result(folder, loaded, trajectory)
                if made is not None:
                    made.write(folder)
    print(summary(loaded, trajectory))
    if alternatives > 1 and trajectory.found:
        print(alternatives_text(trajectory))
    if made is not None:
        print(motion_text(made))
    print(f"written to {folder}")
    if not trajectory.found:
        print(f"dualarm-pin: no solution was found: {trajectory.message}", file=sys.stderr)
    return DONE if trajectory.found else NOT_FOUND
