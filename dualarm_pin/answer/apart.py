"""Whether a motion keeps the clearance that its task asks for, at the points and between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.trajectory import Apart, Distances
from dualarm_pin.arrays import Array
from dualarm_pin.cell.parts import Pair
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.clearance.between import Search

if TYPE_CHECKING:
    from dualarm_pin.task import Task


def check_apart(task: Task, q: Array) -> tuple[Apart, Distances, Distances | None] | None:
    """Measure a motion q (h, n) against the clearance rule of its task, with Coal.

    Returns:
        What the rule comes to, and the smallest distances at the points of the pairs that it asks
        about: of all, and between the arms (None without such a pair). None where nothing is
        asked, or the cell has no two bodies to compare.
    """
    rule, asked = task.clearance, asked_of(task)
    if rule is None or not asked.any:
        return None
    search = Search(task.cell, q, asked.required)
    between = search.between() if rule.between_points else None
    names = [task.cell.pairs[k] for k in search.asked]
    arms = np.flatnonzero(task.cell.between_arms[search.asked])
    apart = Apart(rule.distance, "points", search.kept, _worst(search, names))
    if between is not None:
        apart = Apart(
            required=rule.distance,
            level="samples" if between.bound is None else "certified",
            kept=search.kept,
            worst=_worst(search, names),
            between=between.distance,
            place=between.place,
            pairs=between.pairs,
            bound=between.bound,
        )
    every = _nearest(search.points, names)
    if not len(arms):
        return apart, every, None
    return apart, every, _nearest(search.points[:, arms], [names[k] for k in arms])


def _nearest(distance: Array, names: list[Pair]) -> Distances:
    return Distances(distance.min(axis=1), tuple(names[k] for k in np.argmin(distance, axis=1)))


def _worst(search: Search, names: list[Pair]) -> str:
    lack, line, place, k = search.worst
    where = f"between points {line + 1} and {line + 2}"
    if place in (0.0, 1.0):
        where = f"at point {line + 1 + int(place)}"
    required, who = float(search.required[k]), " and ".join(names[k])
    apart = required - lack
    how = f"{who} are {apart:.4f} m apart" if apart >= 0.0 else f"{who} collide ({apart:.4f} m)"
    return f"{how} {where}, {required:g} m is asked for"
