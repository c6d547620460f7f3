"""The report: one HTML file with the robots in motion, plots linked to them, and the evidence."""

from __future__ import annotations

import math
import pathlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.files.write import write_bytes
from dualarm_pin.path import Path
from dualarm_pin.relative import Relative
from dualarm_pin.viewer.page import render_page
from dualarm_pin.viewer.scene import Run, Scene

if TYPE_CHECKING:
    from dualarm_pin.task import Task
    from dualarm_pin.trajectory import Trajectory

Rows = list[tuple[str, list[str]]]

_VERDICTS = {
    "local_only": "a local minimum; too little was searched to say more",
    "best_known": "best known of the starts below",
    "best_known_bounded": "best known, with a lower bound that holds as far as its search went",
}


@dataclass(frozen=True, eq=False)
class Result:
    """What a report shows of one result.

    Attributes:
        label: Its name on the page, any text.
        cell: The two arms.
        path: What e2 does in e1.
        q: Joints (h, n) in the columns of the cell [rad or m].
        index: Index at each point (h,).
        clearance: Smallest distance between links at each point (h,) [m], or None.
        between_arms: Smallest distance between the two arms at each point (h,) [m], or None.
        nearest: The two links that come nearest.
        singular_value: Smallest singular value of J_r at each point (h,), or None.
        summary: The keys of result.json; what is missing stays blank.
        quantity: Name of the index.
        units: Its units.
        task: The task file as solved, to be read on the page.
    """

    label: str
    cell: Cell
    path: Path
    q: Array
    index: Array
    clearance: Array | None = None
    between_arms: Array | None = None
    nearest: str = ""
    singular_value: Array | None = None
    summary: Mapping[str, Any] = field(default_factory=dict)
    quantity: str = "index"
    units: str = ""
    task: str = ""


def result_of(label: str, task: Task, trajectory: Trajectory) -> Result:
    """Return what a report shows of a solved task; what is not stored is computed here."""
    cell, q = task.cell, trajectory.q
    near = [c for row in q if (c := cell.clearance(row)) is not None]
    apart = [c.distance for row in q if (c := cell.clearance(row, between_arms=True)) is not None]
    worst = min(near, key=lambda c: c.distance, default=None)
    singular = [np.linalg.svd(Relative(cell, row).J_r, compute_uv=False)[-1] for row in q]
    return Result(
        label=label,
        cell=cell,
        path=task.path,
        q=q,
        index=trajectory.index,
        clearance=_complete([c.distance for c in near], len(q)),
        between_arms=_complete(apart, len(q)),
        nearest="" if worst is None else f"{worst.first} - {worst.second}",
        singular_value=np.array(singular),
        summary=trajectory.as_dict(),
        quantity=f"index: {task.index.name}",
        units=task.index.units.replace("^2", "²"),
        task=task.as_yaml() if task.record is not None else "",
    )


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
        {"title": name, "rows": rows} for name, rows in _tables(results).items()
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


def _tables(results: Sequence[Result]) -> dict[str, Rows]:
    def rows(*lines: tuple[str, Callable[[Result], str]]) -> Rows:
        filled = [(name, [text(result) for result in results]) for name, text in lines]
        return [line for line in filled if any(line[1])]

    return {
        "Result": rows(
            ("found", lambda r: {True: "yes", False: "NO", None: ""}[r.summary.get("found")]),
            ("method", lambda r: str(r.summary.get("method", ""))),
            ("solver", lambda r: str(r.summary.get("solver", ""))),
            ("mean index", lambda r: _number(r.summary.get("mean_index"), r.units)),
            ("mean over arc length", lambda r: _number(r.summary.get("arc_mean_index"), r.units)),
            ("largest index", lambda r: _number(r.summary.get("max_index"), r.units)),
            ("objective", lambda r: _number(r.summary.get("objective"), digits=7)),
            ("smallest clearance", _clearance),
            ("arms apart by", lambda r: _least(r.between_arms)),
            ("largest joint step", lambda r: _number(r.summary.get("max_joint_step"), "rad or m")),
            ("bounds violated by", lambda r: _number(r.summary.get("max_bound_violation"), "")),
            ("position error", lambda r: _number(r.summary.get("max_position_error"), "m")),
            ("rotation error", lambda r: _number(r.summary.get("max_rotation_error"), "rad")),
            ("message", lambda r: str(r.summary.get("message") or "")),
        ),
        "Evidence": rows(
            ("verdict", lambda r: _VERDICTS.get(str(_evidence(r, "verdict")), "")),
            ("in words", _sentences),
            ("starts", _laws),
            (
                "a better optimum draws less than",
                lambda r: _share(_evidence(r, "missed_share_95"), " of the starts (95 %)"),
            ),
            ("lower bound", lambda r: _number(_evidence(r, "lower_bound"), digits=7)),
            ("gap to it", lambda r: _share(_evidence(r, "gap"))),
            ("stationarity", lambda r: _number(_evidence(r, "stationarity"))),
            ("smallest curvature", lambda r: _number(_evidence(r, "curvature_min"))),
            ("bounds that hold", lambda r: _number(_evidence(r, "active_bounds"))),
        ),
        "Provenance": rows(
            ("seed", lambda r: _number(r.summary.get("seed"), digits=20)),
            ("time", _time),
            ("versions", lambda r: _pairs(r.summary.get("versions"))),
            (
                "files read (SHA-256)",
                lambda r: "\n".join(f"{s.path.name} {s.sha256[:16]}…" for s in r.cell.sources),
            ),
        ),
    }


def _evidence(result: Result, key: str) -> Any:
    evidence = result.summary.get("evidence")
    return evidence.get(key) if isinstance(evidence, Mapping) else None


def _sentences(result: Result) -> str:
    extra = result.summary.get("extra")
    sentences = extra.get("evidence_text") if isinstance(extra, Mapping) else None
    return " ".join(str(sentences).split()) if sentences else ""


def _laws(result: Result) -> str:
    laws = _evidence(result, "laws")
    return "\n".join(
        f"{name}: {law['starts']} starts, {law['converged']} converged, "
        f"{law['minima']} minima, best hit {law['best_hits']}×"
        for name, law in (laws or {}).items()
    )


def _clearance(result: Result) -> str:
    if result.clearance is None:
        return "unknown"
    least = float(np.min(result.clearance))
    return "\n".join(
        text
        for text in (
            _number(least, "m") + (" IN COLLISION" if least < 0 else ""),
            result.nearest,
        )
        if text
    )


def _complete(values: Sequence[float], count: int) -> Array | None:
    return np.array(values) if len(values) == count else None


def _least(values: Array | None) -> str:
    return "" if values is None else _number(float(np.min(values)), "m")


def _time(result: Result) -> str:
    timing = result.summary.get("timing")
    if not isinstance(timing, Mapping):
        return ""
    names = {"wall_s": "wall", "cpu_s": "processor", "compile_s": "compiling"}
    return "\n".join(
        f"{text} {_number(timing[k], 's')}" for k, text in names.items() if k in timing
    )


def _pairs(values: object) -> str:
    return "\n".join(f"{k} {v}" for k, v in values.items()) if isinstance(values, Mapping) else ""


def _share(value: object, text: str = "") -> str:
    return f"{100 * float(value):.2g} %{text}" if isinstance(value, int | float) else ""


def _number(value: object, units: str = "", digits: int = 4) -> str:
    if not isinstance(value, int | float) or not math.isfinite(value):
        return ""
    text = f"{value:.{digits}g}" if isinstance(value, float) else str(value)
    return f"{text} {units}".strip()
