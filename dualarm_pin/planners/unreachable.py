"""When no start reaches the path: which point is out of reach, and how close it came."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import generator
from dualarm_pin.solvers.projection import project_point
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.task import Task


def feasible_postures(
    problem: Problem, i: int, count: int, random: np.random.Generator, tries: int
) -> tuple[list[Array], Array, float]:
    """Draw postures and put them on the pose of point i.

    Args:
        problem: The problem.
        i: Which point.
        count: How many feasible postures are wanted.
        random: Source of the postures.
        tries: Most postures drawn.

    Returns:
        The feasible postures [(n,)], the closest of all (n,), and its largest residual.
    """
    found: list[Array] = []
    closest, smallest = np.clip(np.zeros(problem.n), problem.lower, problem.upper), np.inf
    for _ in range(tries):
        q, residual = project_point(problem, i, random.uniform(problem.lower, problem.upper))
        if residual < smallest:
            closest, smallest = q, residual
        if residual < TOLERANCE.position / 100.0:
            found.append(q)
            if len(found) == count:
                break
    return found, closest, smallest


def unreachable(
    task: Task,
    problem: Problem,
    method: str,
    solver: str,
    seed: int,
    clock: Clock,
    tries: int = 200,
) -> Trajectory:
    """Return the trajectory that was not found, naming the first point without a solution."""
    q = []
    blame = ""
    for i in range(problem.k):
        found, closest, residual = feasible_postures(problem, i, 1, generator(seed, 9, i), tries)
        q.append(closest)
        if not found:
            blame = (
                f"point {i + 1} of {problem.k} has no solution within the joint bounds: the best "
                f"of {tries} random postures ends {residual:.3g} (m or rad) from it"
            )
            q += [closest] * (problem.k - len(q))
            break
    else:
        blame = (
            "every point can be reached by itself, but no start reached all of them; "
            "try --effort normal or more --starts"
        )
    return verified(
        task,
        np.array(q),
        method=method,
        solver=solver,
        timing=clock.read(),
        seed=seed,
        message=blame,
    )
