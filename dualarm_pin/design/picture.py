"""What a page is told of a desk: the frame it draws, as a head of JSON and arrays of float32."""

from __future__ import annotations

from typing import Any

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.clearance.nearest import nearest_along
from dualarm_pin.design.desk import Desk, Found
from dualarm_pin.reference import reported_value
from dualarm_pin.relative import Relative
from dualarm_pin.show.packing import Blob
from dualarm_pin.task import Task
from dualarm_pin.task.changed import changed_task


class Pictures:
    """Frames of one desk; what does not change from frame to frame is kept."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self._required: dict[float | None, Array] = {}

    def frame(self) -> bytes:
        """Return the motion where things stand, with all that the panels say."""
        desk = self.desk
        with desk.lock:
            answer, here, task = desk.answer, desk.here, desk.task_here()
            searching, clearance = desk.searching, desk.state.clearance
        found = here is not None and here.trajectory.found
        q = here.trajectory.q if here is not None and found else answer.q
        blob = Blob()
        head: dict[str, Any] = {
            "valid": found or answer.valid,
            "why": answer.why if not answer.valid else "",
            "objective": float(answer.objective),
            "basin": answer.basin,
            "pool": [float(value) for value in answer.pool],
            "searching": searching,
            "found": None if here is None else _said(here),
            "q": blob.add(q),
            "index": blob.add(index_along(task, q)),
            "near": None,
        }
        if here is not None:
            if found:
                head["objective"] = float(here.trajectory.objective)
            else:
                head["valid"], head["why"] = False, here.trajectory.message
        if head["valid"]:
            head["near"] = self._near(task, q, clearance)
        return blob.pack(head)

    def _near(self, task: Task, q: Array, clearance: float | None) -> dict[str, Any] | None:
        """Return the nearest two bodies at the points of the path."""
        cell, rule = task.cell, task.clearance
        if cell.missing_meshes or not cell.pairs:
            return None
        if clearance not in self._required:
            # Which pairs the path fixes is asked where the task stands: it does not change.
            asked = asked_of(changed_task(self.desk.session.task, clearance=clearance))
            self._required[clearance] = asked.required if asked.any else np.zeros(len(cell.pairs))
        found = nearest_along(cell, q, self._required[clearance], inner=0)
        if found is None:
            return None
        at = int(np.argmin(found.distance))
        return {
            "names": list(cell.pairs[int(found.pair[at])]),
            "distance": float(found.distance[at]),
            "point": at + 1,
            "required": None if rule is None else rule.distance,
            "lacking": any(found.lacking),
        }


def index_along(task: Task, q: Array) -> Array:
    """Return the index at every point of a motion (h,), as reports show it."""
    bounds = (task.cell.lower, task.cell.upper)
    values = [
        reported_value(task.index, Relative(task.cell, q_i), u, q_i, bounds)
        for q_i, u in zip(q, task.path.u, strict=True)
    ]
    return np.asarray(np.nan_to_num(np.array(values), posinf=0.0, neginf=0.0))


def _said(here: Found) -> dict[str, Any]:
    trajectory = here.trajectory
    return {
        "found": bool(trajectory.found),
        "motion": here.number,
        "objective": float(trajectory.objective) if trajectory.found else None,
        "verdict": trajectory.evidence.verdict,
        "sentences": trajectory.evidence.sentences or "",
        "message": trajectory.message,
        "slopes": here.slopes,
    }
