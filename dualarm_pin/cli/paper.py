"""`dualarm-pin paper`."""

from __future__ import annotations

from pathlib import Path

from dualarm_pin.cli import DONE, NOT_FOUND
from dualarm_pin.cli.terminal import TerminalProgress
from dualarm_pin.files.write import reserved


def paper(
    *,
    out: Path = Path("paper"),
    starts: int = 100,
    seed: int = 0,
    jobs: int | None = None,
) -> int:
    """Reproduce the paper: its table, Fig. 3 to 5 and an animation.

    Args:
        out: Folder of the table, the figures and the results.
        starts: Starts of each problem of the two-stage method.
        seed: Seed of the starts.
        jobs: Number of processes; all processors by default.
    """
    from dualarm_pin.paper import notes, reproduce, write

    with reserved(out), TerminalProgress() as progress:
        reproduction = reproduce(starts=starts, seed=seed, jobs=jobs, progress=progress)
        files = write(reproduction, out)
    print(reproduction.table())
    for note in notes(reproduction):
        print(f"note: {note}")
    print("written: " + ", ".join(str(file) for file in files))
    best = reproduction.trajectories["two-stage, polished"]
    return DONE if best.found else NOT_FOUND
