"""`dualarm-pin place`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from dualarm_pin.cli import DONE, NOT_FOUND
from dualarm_pin.cli.terminal import TerminalProgress


def place(
    task: Path,
    *,
    effort: Literal["quick", "normal", "thorough"] = "quick",
    seed: int = 0,
    jobs: int | None = None,
    map_: Annotated[int, Parameter(name="--map")] = 15,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative=())] = (),
    allow_code: Annotated[bool, Parameter(negative=())] = False,
    out: Path | None = None,
) -> int:
    """Find where base, workpiece and tool should stand, and the motion there.

    Args:
        task: A task file (YAML) with a `placement:` section.
        effort: How much evidence to gather for the motion at the place found.
        seed: Seed of the places and starts: the same seed gives the same answer.
        jobs: Threads to use; all processors by default.
        map_: Columns of the map of the objective over x and y, and over x and z; 0 for none.
        set_: Change a field of the task or cell: key=value.
        allow_code: Import and run the functions that the task file names with `call`.
        out: Folder of the result; results/TASK-placement by default.
    """
    from dualarm_pin.answer.notes import PlacementNotes
    from dualarm_pin.answer.summary import summary
    from dualarm_pin.planners.placement import plan_placement, said
    from dualarm_pin.planners.placement_map import maps_around
    from dualarm_pin.show.placement import save_placement
    from dualarm_pin.task import Task

    loaded = Task.load(task, set_, allow_code=allow_code)
    folder = out or Path("results") / f"{task.stem}-placement"
    with TerminalProgress() as progress:
        for warning in loaded.cell.warnings:
            progress.line(f"warning: {warning}")
        found = plan_placement(loaded, effort=effort, seed=seed, jobs=jobs, progress=progress)
        maps = maps_around(loaded, found, columns=map_, jobs=jobs, progress=progress)
    save_placement(folder, found, maps)
    print(summary(found.task, found.trajectory))
    notes = found.trajectory.notes
    if isinstance(notes, PlacementNotes):
        print(f"place        {said(loaded, notes.change)}")
        if notes.at_bound:
            print(f"at a bound   {', '.join(notes.at_bound)}: a wider box may hold a better place")
    for direction in found.flat:
        print(f"flat         {direction} changes nothing")
    print(f"written to {folder}")
    if not found.trajectory.found:
        print(f"dualarm-pin: no solution was found: {found.trajectory.message}", file=sys.stderr)
    return DONE if found.trajectory.found else NOT_FOUND
