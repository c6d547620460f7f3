"""Where base, workpiece and tool should stand: a search over places, then the motion there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.notes import PlacementNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.errors import InputError
from dualarm_pin.placement.asked import Asked, standing
from dualarm_pin.placement.shared import placed
from dualarm_pin.planners.flat import at_bound, flat_directions
from dualarm_pin.planners.placed_motions import Place, Planned, motions, slid
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solution import Minima
from dualarm_pin.solvers import interior_point as engine

if TYPE_CHECKING:
    from dualarm_pin.problem import Problem
    from dualarm_pin.search.places import PlaceSearch
    from dualarm_pin.task import Task

Array = NDArray[np.float64]
_HALVINGS = 16  # of the way from a place that is reached to its box: a mm of 50 m
_WIDER = (1.0, 3.0, 9.0)  # of its box on each side: where a place that can be reached is sought


@dataclass(frozen=True, eq=False)
class Placement:
    """What a search for a placement came to.

    Attributes:
        task: The task with everything where it was found best; as it was if nothing is reached.
        trajectory: The motion there, checked with Pinocchio on the moved cell.
        places: The distinct minima that were found, best first.
        flat: Directions along which the objective does not change, in words.
    """

    task: Task
    trajectory: Trajectory
    places: tuple[Place, ...]
    flat: tuple[str, ...]


def plan_placement(
    task: Task,
    may: Asked | None = None,
    *,
    effort: str = "quick",
    seed: int = 0,
    jobs: int | None = None,
    progress: Progress = SILENT,
) -> Placement:
    """Find where base, workpiece and tool should stand for the best motion.

    Places and joints are minimised together; then the motion is planned again at the place found,
    which may only make it better.

    Args:
        task: What is asked.
        may: What may change; that of the task if None. See `placement.asked.asked`.
        effort: Of the planning at the place found: `quick`, `normal` or `thorough`.
        seed: Seed of the places and starts.
        jobs: Threads; None takes the processors there are.
        progress: Told where the work stands.

    Raises:
        InputError: Nothing may change.
    """
    from dualarm_pin.search.places import PlaceSearch

    may = may or task.placement
    if may is None:
        raise InputError(
            "nothing may change: give the task a section such as "
            "`placement: {base2: {x: [1.4, 3.0]}}`",
            field="placement",
        )
    problem, clock = task.problem(), Clock.start()
    engine.compare(problem)
    progress.stage("places drawn and refined")
    search = PlaceSearch(problem, may, seed, jobs=jobs)
    minima = search.run()
    if not len(minima):
        return Placement(task, _nothing(task, search, may, seed, clock, jobs), (), ())
    n = problem.n
    places = tuple(_place(may, minima, number, n) for number in range(len(minima)))
    progress.stage("motion at the places found", len(places))
    tried = motions(task, places, effort, seed, jobs, progress)
    if task.clearance is not None and any(each.answer.found for each in tried):
        progress.stage("places moved while the bodies stay apart")
        tried += slid(task, may, tried, effort, seed, jobs)
    planned = min(tried, key=Planned.rank)
    best, moved, there = planned.place, planned.task, planned.answer
    flat = flat_directions(moved.problem(), best, may)
    notes = PlacementNotes(
        change=best.change,
        flat=flat,
        at_bound=at_bound(best, may),
        rounds=search.rounds,
        rounds_here=search.rounds_here,
        starts=search.starts,
    )
    answer = replace(there, method="placement", timing=clock.read(), notes=notes)
    return Placement(moved, answer, places, flat)


def _place(may: Asked, minima: Minima, number: int, n: int) -> Place:
    end = minima.ends[number]
    change = may.change(end.q[0, n:])
    joints = np.ascontiguousarray(end.q[:, :n])
    return Place(end.objective, change, joints, int(minima.hits[number]))


def _nothing(
    task: Task, search: PlaceSearch, may: Asked, seed: int, clock: Clock, jobs: int | None
) -> Trajectory:
    """Return the trajectory that was not found, naming the nearest place that would do."""
    from dualarm_pin.search.places import PlaceBudget, PlaceSearch

    width = may.upper - may.lower
    short = replace(PlaceBudget.of(len(may.free)), least_rounds=1, rounds=1)
    for share in _WIDER:
        free = tuple(
            replace(each, lower=each.lower - share * w, upper=each.upper + share * w)
            for each, w in zip(may.free, width, strict=True)
        )
        wider = PlaceSearch(search.problem, replace(may, free=free), seed, short, jobs)
        minima = wider.run()
        if len(minima):
            break
    n, message = search.problem.n, "no place in these boxes lets the arms follow the whole path"
    q = np.tile(0.5 * (task.cell.lower + task.cell.upper), (task.path.h, 1))
    if len(minima):
        values = minima.ends.q[:, 0, n:]
        outside = np.maximum(may.lower - values, 0.0) + np.maximum(values - may.upper, 0.0)
        nearest = int(np.argmin(np.linalg.norm(outside / width, axis=1)))
        q = np.ascontiguousarray(minima.ends.q[nearest, :, :n])
        there, q = _toward(search.problem, may, values[nearest], q)
        message += "; the nearest found that does: " + said(task, may.change(there))
    else:
        message += (
            f"; the nearest posture at a single point stays {search.nearest:.3g} (m or rad) away, "
            f"at {said(task, may.change(search.nearest_values))}"
        )
    return verified(
        task,
        q,
        method="placement",
        solver="engine",
        timing=clock.read(),
        seed=seed,
        message=message,
    )


def _toward(problem: Problem, may: Asked, values: Array, q: Array) -> tuple[Array, Array]:
    """Return the place between one that can be reached and its boxes that is as near as they get.

    Args:
        problem: The problem where the task stands.
        may: What may change.
        values: Parameters (p,) where the motion q (h, n) follows the whole path.
        q: That motion.
    """
    from dualarm_pin.engine.solve import Options

    aim, there = np.clip(values, may.lower, may.upper), values.copy()
    moved = placed(problem, may.free, there)
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        there[:] = moved.chain.parameters[:] = values + middle * (aim - values)
        end = engine.solve(moved, q, Options(mu0=1e-2, push=1e-3))
        if end.converged and not may.kept_out(there):
            low, q = middle, end.q
        else:
            high = middle
    return values + low * (aim - values), q


def said(task: Task, change: Mapping[str, float]) -> str:
    """Return parameters as the task states them: base 2 in the world, angles in degrees."""
    stands = standing(task.cell)
    parts = []
    for name, by in change.items():
        value = stands.get(name, 0.0) + by
        angle = name.endswith(".yaw")
        parts.append(f"{name} {np.rad2deg(value):.4g} deg" if angle else f"{name} {value:.4g} m")
    return ", ".join(parts)
