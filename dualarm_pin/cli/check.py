"""`dualarm-pin check`."""

from __future__ import annotations

import json as json_text
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dualarm_pin.cli import DONE, NOT_FOUND


def check(
    file: Path,
    *,
    json: bool = False,
    html: Path | None = None,
    deep: Annotated[bool, Parameter(negative=())] = False,
    set_: Annotated[tuple[str, ...], Parameter(name="--set", negative=())] = (),
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Load a cell or a task and show what was understood.

    Args:
        file: A cell file or a task file (YAML).
        json: Print JSON for programs.
        html: Write a picture of the cell into this file.
        deep: Compare both tips with what yourdfpy, an extra, makes of the same files.
        set_: Change a field of a task or its cell: key=value.
        allow_code: Import and run the functions that a task file names with `call`.
    """
    from dualarm_pin.inspection import inspect

    report = inspect(file, set_, allow_code=allow_code)
    content, text, agrees = report.as_dict(), report.as_text(), True
    if deep:
        from dualarm_pin.second_opinion import compare

        opinion = compare(report.whole_cell)
        content["yourdfpy"], text = asdict(opinion), f"{text}\n\n{opinion}"
        agrees = opinion.agrees
    print(json_text.dumps(content, indent=1) if json else text)
    if html is not None:
        report.draw(html)
        if not json:
            print(f"written to {html}")
    return DONE if agrees else NOT_FOUND
