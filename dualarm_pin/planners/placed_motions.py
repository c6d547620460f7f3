"""Motions at the places that a search found, best first, and places moved on with them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
from dualarm_pin.placement.asked import Asked
from dualarm_pin.planners.slide import slide
from dualarm_pin.planners.whole_path import plan_global
from dualarm_pin.progress import Progress
from dualarm_pin.task.moved import moved_task
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.task import Task

_TRIED = 8  # places at most at which the motion is planned again
_SLID = 2  # of these that are moved on, where the bodies hold the motion


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


class Planned(NamedTuple):
    """A place and the motion that was planned there."""

    place: Place
    task: Task
    answer: Trajectory

    def rank(self) -> tuple[bool, float]:
        """Return what is lower for what is better."""
        return not self.answer.found, self.answer.objective


def motions(
    task: Task,
    places: tuple[Place, ...],
    effort: str,
    seed: int,
    jobs: int | None,
    progress: Progress,
) -> list[Planned]:
    """Plan at the places, best first, until none that is left could do better.

    What the search of places leaves out, such as clearance, can only raise their objectives.
    """
    tried: list[Planned] = []
    for place in places[:_TRIED]:
        if any(each.answer.found and each.answer.objective <= place.objective for each in tried):
            break
        moved = moved_task(task, place.change)
        there = plan_global(moved, effort=effort, seed=seed, jobs=jobs, progress=progress)
        if not there.found or there.objective > place.objective + _level(place.objective):
            alone = _checked(moved, place.q, seed, jobs)
            there = alone if alone.found or not there.found else there
        tried.append(Planned(place, moved, there))
    return tried


def slid(
    task: Task, may: Asked, tried: list[Planned], effort: str, seed: int, jobs: int | None
) -> list[Planned]:
    """Return the best places moved on, where the bodies held the motion and not the place.

    A place whose objective without clearance is no lower than the best with it leads nowhere.
    """
    best = min(each.answer.objective for each in tried if each.answer.found)
    held = [e for e in tried if e.answer.found and e.place.objective < best - _level(best)]
    found = []
    for each in sorted(held, key=Planned.rank)[:_SLID]:
        stand = slide(task, may, each.place.change, each.answer.q)
        if stand is None or stand.path.objective > each.answer.objective - _level(best):
            continue
        q = stand.task.free().whole(stand.path.q)
        place = Place(stand.path.objective, dict(stand.change), q, each.place.hits)
        alone = _checked(stand.task, q, seed, jobs)
        again = plan_global(stand.task, effort=effort, seed=seed, jobs=jobs, warm=alone)
        found += [Planned(place, stand.task, answer) for answer in (alone, again)]
    return found


def _checked(task: Task, q: Array, seed: int, jobs: int | None) -> Trajectory:
    """Return the motion of the search, with the local check alone as evidence."""
    from dualarm_pin.evidence.check import check_minimum
    from dualarm_pin.evidence.verdict import Findings, conclude

    q, local = check_minimum(task.problem(), q, seed=seed, jobs=jobs)
    evidence = conclude(Findings(local=local))
    return verified(task, q, method="placement", solver="engine", seed=seed, evidence=evidence)


def _level(value: float) -> float:
    return TOLERANCE.same_objective * max(1.0, abs(value))
