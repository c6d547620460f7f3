"""When the path itself forbids the clearance that is asked for: said before any search."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.planners.unreachable import feasible_postures
from dualarm_pin.search.starts import generator

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_TRIES = 20  # random postures for each point: they only show what it looks like


def forbidden(task: Task, method: str, solver: str, seed: int, clock: Clock) -> Trajectory | None:
    """Return the trajectory that was not found, or None where the path forbids nothing.

    Its joints are postures at single points, for pictures of what is too near.
    """
    found = asked_of(task).forbidden
    if not found:
        return None
    worst = min(found, key=lambda each: each.distance - each.required)
    more = f" (and for {len(found) - 1} more pairs)" if len(found) > 1 else ""
    message = (
        f"{worst.text}{more}; ask less of it in clearance.pairs, hold part and tool elsewhere, "
        "or change the path"
    )
    problem = task.problem()
    q = [
        feasible_postures(problem, i, 1, generator(seed, 31, i), _TRIES)[1]
        for i in range(problem.k)
    ]
    answer = verified(
        task,
        np.array(q),
        method=method,
        solver=solver,
        timing=clock.read(),
        seed=seed,
        message=message,
    )
    return replace(answer, checked=replace(answer.checked, found=False))
