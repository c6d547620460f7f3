"""The report: one or several results on one page, with plots, tables and the robots in motion."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.errors import InputError
from dualarm_pin.files.write import write_bytes
from dualarm_pin.motion.record import Motion
from dualarm_pin.show.motion_data import motion_data, tip_traces
from dualarm_pin.show.motion_table import motion_rows
from dualarm_pin.show.page import render_page
from dualarm_pin.show.report_tables import tables_of, units_of
from dualarm_pin.show.scene import Scene
from dualarm_pin.show.sensitivity import rows_of

if TYPE_CHECKING:
    from dualarm_pin.evidence.sensitivity import Costs
    from dualarm_pin.task import Task


def report_page(
    results: Mapping[str, tuple[Task, Trajectory]],
    *,
    title: str = "dualarm_pin report",
    motions: Mapping[str, Motion] | None = None,
    costs: Mapping[str, Costs] | None = None,
) -> bytes:
    """Return the report as one page that needs no network.

    Args:
        results: Task and answer by label, at least one; several are compared on the same axes.
        title: Title of the page, any text.
        motions: Motions in time, by the label of their result.
        costs: What errors and limits cost, by label, where that was computed.

    Raises:
        InputError: There is no result.
        ShapeError: A trajectory does not fit its task.
    """
    if not results:
        raise InputError("there is no result to report", field="results")
    scene = Scene()
    for label, (task, trajectory) in results.items():
        checked = trajectory.checked
        run = scene.add(label, task, trajectory)
        run["tips"] = tip_traces(scene.blob, task.cell, trajectory.q)
        motion = (motions or {}).get(label)
        if motion is not None:
            run["motion"] = motion_data(scene.blob, task.cell, task.path, trajectory.q, motion)
        near, arms = checked.clearance, checked.arm_clearance
        unknown = np.isnan(checked.singular_value).all()
        run |= {
            "clearance": None if near is None else scene.blob.add(near.distance),
            "between_arms": None if arms is None else scene.blob.add(arms.distance),
            "singular_value": None if unknown else scene.blob.add(checked.singular_value),
            "quantity": f"index: {task.index.name}",
            "units": units_of(task),
            "task": task.as_yaml() if task.record is not None else "",
            "found": trajectory.found,
        }
    scene.head["title"] = title
    tables = tables_of(list(results.values()))
    if costs:
        tables["Sensitivity"] = rows_of([costs.get(label) for label in results])
    scene.head["results"] = [{"title": name, "rows": rows} for name, rows in tables.items()]
    if motions:
        rows = motion_rows([motions.get(label) for label in results])
        scene.head["results"].insert(1, {"title": "Motion", "rows": rows})
    return render_page(
        title, scene.pack(), body="report.html", scripts=("report.js",), styles=("report.css",)
    )


def write_report(
    file: str | pathlib.Path,
    results: Mapping[str, tuple[Task, Trajectory]],
    *,
    title: str = "dualarm_pin report",
    motions: Mapping[str, Motion] | None = None,
    costs: Mapping[str, Costs] | None = None,
) -> None:
    """Write the report of one or several results as one HTML file.

    Args:
        file: Where it goes.
        results: Task and answer by label, at least one; several are compared on the same axes.
        title: Title of the page, any text.
        motions: Motions in time, by the label of their result.
        costs: What errors and limits cost, by label, where that was computed.

    Raises:
        InputError: There is no result, or the file cannot be written.
        ShapeError: A trajectory does not fit its task.
    """
    page = report_page(results, title=title, motions=motions, costs=costs)
    write_bytes(pathlib.Path(file), page)
