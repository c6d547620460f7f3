"""Where base, workpiece and tool should stand: a search over places, then the motion there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.notes import PlacementNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.errors import InputError
from dualarm_pin.placement.asked import Asked, standing
from dualarm_pin.planners.slide import slide
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solution import Minima
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task.moved import moved_task
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.search.places import PlaceSearch
    from dualarm_pin.task import Task

Array = NDArray[np.float64]
_TRIED = 8  # places at most at which the motion is planned again
_SLID = 2  # of these that are moved on, where the bodies hold the motion
_FLAT = 1e-5  # of max(1, objective): what a whole box of a flat direction may change it by
_AT_BOUND = 1e-4  # of its box: a parameter this near to an end stands there
_WIDER = (1.0, 3.0, 9.0)  # of its box on each side: where a place that can be reached is sought


@dataclass(frozen=True)
class Place:
    """One minimum over places and joints.

    Attributes:
        objective: Objective there.
        change: Change of each parameter from where the cell stood [m or rad], by name.
        q: Joints (h, n).
        hits: How many refined starts ended there.
    """

    objective: float
    change: dict[str, float]
    q: Array
    hits: int


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
    tried = _motions(task, places, effort, seed, jobs, progress)
    if task.clearance is not None and any(each.answer.found for each in tried):
        progress.stage("places moved while the bodies stay apart")
        tried += _slid(task, may, tried, effort, seed, jobs)
    planned = min(tried, key=_Planned.rank)
    best, moved, there = planned.place, planned.task, planned.answer
    flat = _flat_directions(moved.problem(), best, may)
    notes = PlacementNotes(
        change=best.change,
        flat=flat,
        at_bound=_at_bound(best, may),
        rounds=search.rounds,
        rounds_here=search.rounds_here,
        starts=search.starts,
    )
    answer = replace(there, method="placement", timing=clock.read(), notes=notes)
    return Placement(moved, answer, places, flat)


class _Planned(NamedTuple):
    """A place and the motion that was planned there."""

    place: Place
    task: Task
    answer: Trajectory

    def rank(self) -> tuple[bool, float]:
        """Return what is lower for what is better."""
        return not self.answer.found, self.answer.objective


def _motions(
    task: Task,
    places: tuple[Place, ...],
    effort: str,
    seed: int,
    jobs: int | None,
    progress: Progress,
) -> list[_Planned]:
    """Plan at the places, best first, until none that is left could do better.

    What the search of places leaves out, such as clearance, can only raise their objectives.
    """
    tried: list[_Planned] = []
    for place in places[:_TRIED]:
        if any(each.answer.found and each.answer.objective <= place.objective for each in tried):
            break
        moved = moved_task(task, place.change)
        there = plan_global(moved, effort=effort, seed=seed, jobs=jobs, progress=progress)
        if not there.found or there.objective > place.objective + _level(place.objective):
            alone = _checked(moved, place.q, seed, jobs)
            there = alone if alone.found or not there.found else there
        tried.append(_Planned(place, moved, there))
    return tried


def _slid(
    task: Task, may: Asked, tried: list[_Planned], effort: str, seed: int, jobs: int | None
) -> list[_Planned]:
    """Return the best places moved on, where the bodies held the motion and not the place.

    A place whose objective without clearance is no lower than the best with it leads nowhere.
    """
    best = min(each.answer.objective for each in tried if each.answer.found)
    held = [e for e in tried if e.answer.found and e.place.objective < best - _level(best)]
    found = []
    for each in sorted(held, key=_Planned.rank)[:_SLID]:
        stand = slide(task, may, each.place.change, each.answer.q)
        if stand is None or stand.path.objective > each.answer.objective - _level(best):
            continue
        q = stand.task.free().whole(stand.path.q)
        place = Place(stand.path.objective, dict(stand.change), q, each.place.hits)
        alone = _checked(stand.task, q, seed, jobs)
        again = plan_global(stand.task, effort=effort, seed=seed, jobs=jobs, warm=alone)
        found += [_Planned(place, stand.task, answer) for answer in (alone, again)]
    return found


def _place(may: Asked, minima: Minima, number: int, n: int) -> Place:
    end = minima.ends[number]
    change = may.change(end.q[0, n:])
    joints = np.ascontiguousarray(end.q[:, :n])
    return Place(end.objective, change, joints, int(minima.hits[number]))


def _level(value: float) -> float:
    return TOLERANCE.same_objective * max(1.0, abs(value))


def _at_bound(place: Place, may: Asked) -> tuple[str, ...]:
    found = []
    for each in may.free:
        near = _AT_BOUND * (each.upper - each.lower)
        value = place.change[each.name]
        if min(value - each.lower, each.upper - value) < near:
            found.append(each.name)
    return tuple(found)


def _checked(task: Task, q: Array, seed: int, jobs: int | None) -> Trajectory:
    """Return the motion of the search, with the local check alone as evidence."""
    from dualarm_pin.evidence.check import check_minimum
    from dualarm_pin.evidence.verdict import Findings, conclude

    q, local = check_minimum(task.problem(), q, seed=seed, jobs=jobs)
    evidence = conclude(Findings(local=local))
    return verified(task, q, method="placement", solver="engine", seed=seed, evidence=evidence)


def _flat_directions(problem: Problem, best: Place, may: Asked) -> tuple[str, ...]:
    """Return the directions of the free parameters along which V has no curvature, in words.

    V has no slope either at a minimum, along parameters that stand inside their boxes.
    """
    from dualarm_pin.engine.sensitivity import sensitivity
    from dualarm_pin.engine.solve import Options, solve

    held = _at_bound(best, may)
    inside = tuple(replace(each, weight=0.0) for each in may.free if each.name not in held)
    rough = solve(problem, best.q, Options(tolerance=TOLERANCE.polish, mu0=1e-4, push=1e-6))
    if not inside or not rough.converged:
        return ()
    found = sensitivity(problem, rough, inside)
    if not found.regular:
        return ()
    width = np.array([each.upper - each.lower for each in inside])
    bends, directions = np.linalg.eigh(found.curvature * np.outer(width, width))
    least = _FLAT * max(1.0, abs(best.objective))
    return tuple(
        _in_words(found.names, width * direction)
        for bend, direction in zip(bends, directions.T, strict=True)
        if abs(bend) < least
    )


def _in_words(names: tuple[str, ...], direction: Array) -> str:
    """Return a direction as changes of parameters, the largest of them 1."""
    direction = direction / direction[np.argmax(np.abs(direction))]
    parts = [
        f"{name} {share:+.3g}"
        for name, share in zip(names, direction, strict=True)
        if f"{share:.3f}" not in ("0.000", "-0.000")
    ]
    return " with ".join(parts)


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
        message += "; the nearest found that does: " + said(task, may.change(values[nearest]))
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


def said(task: Task, change: Mapping[str, float]) -> str:
    """Return parameters as the task states them: base 2 in the world, angles in degrees."""
    stands = standing(task.cell)
    parts = []
    for name, by in change.items():
        value = stands.get(name, 0.0) + by
        angle = name.endswith(".yaw")
        parts.append(f"{name} {np.rad2deg(value):.4g} deg" if angle else f"{name} {value:.4g} m")
    return ", ".join(parts)
