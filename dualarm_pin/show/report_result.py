"""What a report shows of one result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.path import Path
from dualarm_pin.relative import Relative

if TYPE_CHECKING:
    from dualarm_pin.answer.trajectory import Trajectory
    from dualarm_pin.task import Task


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


def _complete(values: Sequence[float], count: int) -> Array | None:
    return np.array(values) if len(values) == count else None
