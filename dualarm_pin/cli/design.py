"""`dualarm-pin design`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dualarm_pin.cli import DONE
from dualarm_pin.cli.terminal import TerminalProgress


def design(
    task: Path,
    *,
    out: Path | None = None,
    port: int = 0,
    browser: bool = True,
    seed: int = 0,
    jobs: int | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative=())] = (),
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Move base 2 and the workpiece in the browser; the best motion follows.

    Args:
        task: A task file (YAML).
        out: Folder into which the page saves; results/TASK-design by default.
        port: Port of the local page; a free one by default.
        browser: Open the page in the browser.
        seed: Seed of the searches.
        jobs: Threads of a search; all processors but one by default.
        set_: Change a field of the task or cell: key=value, such as smoothness=30.
        allow_code: Import and run the functions that the task file names with `call`.
    """
    from dualarm_pin.design.server import Pages
    from dualarm_pin.show import serve
    from dualarm_pin.task import Task

    loaded = Task.load(task, set_, allow_code=allow_code)
    with TerminalProgress() as progress:
        for warning in loaded.cell.warnings:
            progress.line(f"warning: {warning}")
        progress.stage("first motion")
        pages = Pages(loaded, out or Path("results") / f"{task.stem}-design", seed=seed, jobs=jobs)
    with pages:
        serve(
            pages.open,
            port,
            browser,
            talk=pages.talk,
            ready=lambda address: print(f"{address} (Ctrl-C ends it)", flush=True),
        )
    return DONE
