"""What a page is told of a desk: the frame it draws, as a head of JSON and arrays of float32."""

from __future__ import annotations

from typing import Any

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.design.desk import Desk, Found
from dualarm_pin.design.distances import Distances
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
        cell, h = desk.session.task.cell, desk.session.task.path.h
        known = bool(cell.pairs) and not cell.missing_meshes
        self._distances = Distances(cell, h) if known else None

    def frame(self, known: int | None = None) -> bytes:
        """Return the motion where things stand, with all that the panels say.

        Args:
            known: Number of a frame that the page has: if that is still all, only this is said.
        """
        desk = self.desk
        with desk.lock:
            number, searching = desk.frame, desk.searching
            if number == known:
                return Blob().pack({"frame": number, "same": True, "searching": searching})
            answer, here, task = desk.answer, desk.here, desk.task_here()
            clearance = desk.state.clearance
        found = here is not None and here.outcome.trajectory.found
        q = here.outcome.trajectory.q if here is not None and found else answer.q
        blob = Blob()
        head: dict[str, Any] = {
            "frame": number,
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
                head["objective"] = float(here.outcome.trajectory.objective)
            else:
                head["valid"], head["why"] = False, here.outcome.trajectory.message
        if head["valid"]:
            head["near"] = self._near(task, q, clearance)
        return blob.pack(head)

    def _near(self, task: Task, q: Array, clearance: float | None) -> dict[str, Any] | None:
        """Return the nearest two bodies at the points of the path."""
        if self._distances is None:
            return None
        if clearance not in self._required:
            # Which pairs the path fixes is asked where the task stands: it does not change.
            asked = asked_of(changed_task(self.desk.session.task, clearance=clearance))
            every = np.zeros(len(task.cell.pairs))
            self._required[clearance] = asked.required if asked.any else every
        near = self._distances.near(task.cell, q, self._required[clearance])
        if near is None:
            return None
        return {
            "names": list(near.pair),
            "distance": near.distance,
            "point": near.point + 1,
            "required": None if task.clearance is None else task.clearance.distance,
            "lacking": near.lacking,
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
    trajectory = here.outcome.trajectory
    return {
        "found": bool(trajectory.found),
        "motion": here.number,
        "objective": float(trajectory.objective) if trajectory.found else None,
        "verdict": trajectory.evidence.verdict,
        "sentences": trajectory.evidence.sentences or "",
        "message": trajectory.message,
        "slopes": here.outcome.slopes,
    }
