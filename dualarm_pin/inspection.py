"""Inspection: what was understood of a cell or task file, in words, for programs, as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dualarm_pin.cell import Cell
from dualarm_pin.cell.describe import describe
from dualarm_pin.cell.report import CellReport
from dualarm_pin.cell.report_text import text_of
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.errors import InputError
from dualarm_pin.files.source import read_yaml
from dualarm_pin.files.write import write_bytes
from dualarm_pin.planners.unreachable import feasible_postures
from dualarm_pin.search.starts import generator
from dualarm_pin.task import Task
from dualarm_pin.tolerance import TOLERANCE

_TRIES = 20  # random postures; a reachable point is met from most of them


@dataclass(frozen=True)
class Inspection:
    """A cell, and the task around it if the file was a task.

    Attributes:
        cell: What `describe` says of the cell.
        task: Facts of the task by name, or None.
        subject: The cell or task itself.
    """

    cell: CellReport
    task: dict[str, Any] | None
    subject: Cell | Task

    @property
    def whole_cell(self) -> Cell:
        """The cell itself."""
        return self.subject.cell if isinstance(self.subject, Task) else self.subject

    def as_dict(self) -> dict[str, Any]:
        """Return everything as JSON values."""
        return {"cell": self.cell.as_dict(), "task": self.task}

    def as_text(self) -> str:
        """Return everything as text."""
        if self.task is None:
            return text_of(self.cell)
        lines = [
            f"  {key.replace('_', ' '):<18}{_shown(value)}" for key, value in self.task.items()
        ]
        return "\n".join([text_of(self.cell), "", "task", *lines])

    def draw(self, file: Path) -> None:
        """Write a page with the cell, on the path where there is one."""
        from dualarm_pin.show import posture_page

        subject = self.subject
        if isinstance(subject, Task):
            q, _ = _first_posture(subject)
            page = posture_page("first point", subject.cell, q, subject.path)
        else:
            page = posture_page(
                "middle of the bounds", subject, (subject.lower + subject.upper) / 2
            )
        write_bytes(file, page)


def inspect(file: Path, overrides: Sequence[str] = (), *, allow_code: bool = False) -> Inspection:
    """Load a cell file or a task file and say what was understood.

    Raises:
        InputError: The file is neither, or something in it is wrong.
    """
    source = read_yaml(file)
    if "cell" in source.data or "path" in source.data:
        task = Task.load(file, overrides, allow_code=allow_code)
        return Inspection(describe(task.cell), _facts(task), task)
    if overrides:
        raise InputError("--set changes a task file; this is a cell file", file=file)
    cell = Cell.from_source(source)
    return Inspection(describe(cell), None, cell)


def _facts(task: Task) -> dict[str, Any]:
    path = task.path
    _, residual = _first_posture(task)
    reached = residual < TOLERANCE.position
    return {
        "name": task.name,
        "points": path.h,
        "length_m": float(path.arc_length[-1]),
        "pose_rows": sorted({int(rows) for rows in path.rows}),
        "index": task.index.name,
        "smoothness": task.smoothness,
        "Gamma": [point + 1 for point in task.Gamma],
        "constraints": [row.name for row in task.rows],
        **_clearance(task),
        "first_point_error": residual,
        "first_point": "reached" if reached else "not reached by random postures",
    }


def _clearance(task: Task) -> dict[str, Any]:
    """Return what is asked of distances, and what the path and the arms say to that."""
    rule, asked = task.clearance, asked_of(task)
    if rule is None:
        return {"clearance": "off"}
    if not asked.any:
        return {"clearance": "unknown: no two bodies can be compared"}
    held, counts = np.unique(asked.required[asked.required > -np.inf], return_counts=True)
    parts = [f"{r:g} m of {n} pairs" for r, n in zip(held[::-1], counts[::-1], strict=True)]
    return {
        "clearance": ", ".join(parts) + ("" if rule.between_points else ", at the points alone"),
        "fixed_by_path": [pair.text for pair in asked.fixed],
        "asked_0_m_only": [
            f"{' and '.join(pair)} are nowhere more than {most:.3f} m apart"
            for pair, most in asked.lowered
        ],
        "forbidden_by_path": [pair.text for pair in asked.forbidden],
    }


def _first_posture(task: Task) -> tuple[Any, float]:
    """Return the posture nearest to the first point of `_TRIES` random ones, and its error."""
    found, closest, residual = feasible_postures(task.problem(), 0, 1, generator(0, 30), _TRIES)
    return (found[0], residual) if found else (closest, residual)


def _shown(value: Any) -> str:
    if isinstance(value, list):
        words = any(isinstance(each, str) for each in value)
        return ("\n" + " " * 20 if words else ", ").join(map(str, value)) or "none"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
