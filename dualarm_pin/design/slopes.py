"""How the best objective changes with the place of base 2."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.design.standing import parameters_of
from dualarm_pin.placement.parameters import BASE
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.task import Task


def slopes_of(task: Task, found: Trajectory) -> dict[str, float] | None:
    """Return dV/dp of base 2, per m and rad, or None where it is not known.

    It is not known where the cell has no base to move, and where the motion is held by its
    clearance: the derivative knows limits and rows of the problem, not distances.
    """
    from dualarm_pin.engine.sensitivity import sensitivity
    from dualarm_pin.engine.solve import Options

    free = tuple(each for each in parameters_of(task.cell) if each.name.startswith(f"{BASE}."))
    problem = task.problem()
    best = engine.solve(problem, found.q, Options(mu0=1e-4, push=1e-6))
    level = TOLERANCE.same_objective * max(1.0, abs(best.objective))
    if not free or not best.converged or abs(best.objective - found.objective) > level:
        return None
    gradient = sensitivity(problem, best, free).gradient
    return {each.name: float(slope) for each, slope in zip(free, gradient, strict=True)}
