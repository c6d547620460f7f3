"""The report as one page."""

from __future__ import annotations

import pathlib
from collections.abc import Sequence

import numpy as np

from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.files.write import write_bytes
from dualarm_pin.show.page import render_page
from dualarm_pin.show.report_result import Result
from dualarm_pin.show.report_tables import tables_of
from dualarm_pin.show.scene import Run, Scene


def report_page(results: Sequence[Result], *, title: str = "dualarm_pin report") -> bytes:
    """Return the report as one page that needs no network.

    Raises:
        InputError: There is no result, or one is not finite.
        ShapeError: The arrays of a result do not fit its cell or path.
    """
    if not results:
        raise InputError("there is no result to report", field="results")
    scene = Scene()
    for result in results:
        run = scene.add_run(result.cell, result.path, Run(result.label, result.q, result.index))
        for name in ("clearance", "between_arms", "singular_value"):
            values = getattr(result, name)
            if values is not None and np.shape(values) != (result.path.h,):
                raise ShapeError(
                    f"result {result.label!r}: ({result.path.h},) is expected; "
                    f"given {np.shape(values)}",
                    field=name,
                )
            run[name] = None if values is None else scene.blob.add(values)
        run |= {"quantity": result.quantity, "units": result.units, "task": result.task}
        run["found"] = result.summary.get("found")
    scene.head["title"] = title
    scene.head["results"] = [
        {"title": name, "rows": rows} for name, rows in tables_of(results).items()
    ]
    return render_page(
        title, scene.pack(), body="report.html", scripts=("report.js",), styles=("report.css",)
    )


def write_report(
    file: str | pathlib.Path, results: Sequence[Result], *, title: str = "dualarm_pin report"
) -> None:
    """Write the report of one or several results as one HTML file.

    Args:
        file: Where it goes.
        results: At least one; several are compared on the same axes.
        title: Title of the page, any text.

    Raises:
        InputError: There is no result, one is not finite, or the file cannot be written.
        ShapeError: The arrays of a result do not fit its cell or path.
    """
    write_bytes(pathlib.Path(file), report_page(results, title=title))
