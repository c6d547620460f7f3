"""A place moved together with a motion whose bodies stay apart.

The planes that hold the bodies apart hold from any place nearby: place and joints are solved with
them as one arrow system, within a small box around the place. There the bodies are measured and
moved apart again, and so on, until nothing is gained.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.engine.solve import Options, solve_many
from dualarm_pin.placement.asked import Asked
from dualarm_pin.placement.shared import share
from dualarm_pin.planners.apart import held_problem
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.bodies import asked_pairs
from dualarm_pin.repair.repaired import Repaired
from dualarm_pin.repair.survey import Survey
from dualarm_pin.task.moved import moved_task

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_STEPS = 24  # at most: the reach ends it before
_REACH, _LEAST = 0.06, 2e-3  # of a step [m or rad], first and last: planes are right nearby
_SHORTER, _LONGER = 0.3, 1.5  # after a step that gains nothing, and after one that does
_GAIN = 1e-4  # of the objective; a smaller one is none
_SOLVED = Options(tolerance=1e-6, iterations=100, mu0=1e-3, push=1e-3)  # a start for the repair


@dataclass(frozen=True, eq=False)
class Stand:
    """A place and the best motion there whose bodies are apart.

    Attributes:
        change: Change of each parameter from where the cell stood [m or rad].
        task: The task there.
        survey: What measures its bodies.
        path: The motion.
    """

    change: Mapping[str, float]
    task: Task
    survey: Survey
    path: Repaired


def slide(task: Task, may: Asked, change: Mapping[str, float], q: Array) -> Stand | None:
    """Return where a place and a motion lead whose objective falls and whose bodies stay apart.

    Args:
        task: The task where its cell stands.
        may: What may change.
        change: Where to begin.
        q: A motion there (h, n), nearly apart.

    Returns:
        None where its bodies do not come apart.
    """
    stand = _stand(task, change, task.free().part(q))
    if stand is None:
        return None
    reach = _REACH
    for _ in range(_STEPS):
        if reach < _LEAST:
            break
        better = _step(task, may, stand, reach)
        if better is not None:
            stand, reach = better, reach * _LONGER
        else:
            reach *= _SHORTER
    return stand


def _step(task: Task, may: Asked, stand: Stand, reach: float) -> Stand | None:
    """Solve place and joints with the planes of a stand, and move the bodies apart there.

    Returns:
        None where nothing is gained.
    """
    values = np.array([stand.change[name] for name in may.names])
    free = tuple(
        replace(each, lower=max(each.lower, at - reach), upper=min(each.upper, at + reach))
        for each, at in zip(may.room_around(values), values.tolist(), strict=True)
    )
    problem = held_problem(task, stand.survey, stand.path)
    shared = share(problem, free)
    end = solve_many(shared, shared.posture(stand.path.q[None], values), _SOLVED, jobs=1)
    limit, n = stand.path.objective * (1.0 - _GAIN), problem.n
    if not end.feasible[0] or end.objective[0] > limit:
        return None
    q = np.ascontiguousarray(end.q[0, :, :n])
    found = _stand(task, may.change(end.q[0, 0, n:]), q, limit)
    return found if found is not None and found.path.objective < limit else None


def _stand(
    task: Task, change: Mapping[str, float], q: Array, limit: float = np.inf
) -> Stand | None:
    moved = moved_task(task, change)
    assert moved.clearance is not None
    survey = Survey(moved.free().problem, asked_pairs(moved.cell, asked_of(moved).required))
    basin = Basin(survey, between=moved.clearance.between_points)
    path = basin.repaired(q, limit=limit)
    return None if path is None else Stand(change, moved, survey, path)
