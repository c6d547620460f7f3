"""`dualarm-pin check`."""

from __future__ import annotations

import json as json_text
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dualarm_pin.cli import DONE


def check(
    file: Path,
    *,
    json: bool = False,
    html: Path | None = None,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative=())] = (),
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Load a cell or a task and show what was understood.

    Args:
        file: A cell file or a task file (YAML).
        json: Print JSON for programs.
        html: Write a picture of the cell into this file.
        set_: Change a field of a task or its cell: key=value.
        allow_code: Import and run the functions that a task file names with `call`.
    """
    from dualarm_pin.inspection import inspect

    report = inspect(file, set_, allow_code=allow_code)
    print(json_text.dumps(report.as_dict(), indent=1) if json else report.as_text())
    if html is not None:
        report.draw(html)
        if not json:
            print(f"written to {html}")
    return DONE
