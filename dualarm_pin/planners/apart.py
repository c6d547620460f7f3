"""The whole path with clearance: what the search found, moved until its bodies are far apart."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dualarm_pin.answer.notes import GlobalNotes
from dualarm_pin.answer.provenance import Clock
from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.answer.verify import verified
from dualarm_pin.arrays import Array
from dualarm_pin.clearance.asked import asked_of
from dualarm_pin.clearance.between import Search
from dualarm_pin.evidence.check import polished
from dualarm_pin.planners.alternatives import Candidate, local_evidence, with_alternatives
from dualarm_pin.problem import Problem
from dualarm_pin.progress import Progress
from dualarm_pin.repair import few
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.bodies import asked_pairs
from dualarm_pin.repair.meter import Meter, OverError
from dualarm_pin.repair.pool import EFFORTS, Apart, keep_apart
from dualarm_pin.repair.repaired import Repaired
from dualarm_pin.repair.survey import Survey
from dualarm_pin.rows import Row, half_space
from dualarm_pin.rows.row import WORLD

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell
    from dualarm_pin.task import Task

_CHECKED = 3  # paths, the best first, of which the first is taken that the check confirms
# Of what is left of a time limit, for the check of the answer; and a second, or half of it.
_CHECK, _CHECK_S, _CHECK_MOST = 0.25, 1.0, 0.5
_ROOMS = (1.0, 2.0, 4.0)  # times what lacks: planes that cannot make one room may make another
_MORE_ROOM = 3  # times; a dip that the check finds is less than a millimetre as a rule
_NEAR, _HELD = 0.05, 1e-3  # m: with more room, before and after, a row has no part in the path


def plan_apart(
    task: Task,
    best: Array,
    minima: Sequence[tuple[float, Array]],
    *,
    effort: str,
    solver: str,
    seed: int,
    jobs: int | None,
    clock: Clock,
    compile_s: float,
    interrupted: bool,
    deadline: float,
    progress: Progress,
    given: Sequence[Array] = (),
    alternatives: int = 1,
) -> Trajectory | None:
    """Return the best path that keeps its bodies apart, or None where the best path does.

    Where there is none, that of the search is returned, not found, and its message says which
    bodies are how near.

    Args:
        task: What is asked.
        best: The best path (k, n) of a search without rows of pairs.
        minima: Objective and path of all that the search came to, the best first.
        effort: How far to look.
        solver: Name of the solver of the search.
        seed: Of the starts.
        jobs: Threads.
        clock: Started with the search.
        compile_s: Seconds that compiling took.
        interrupted: The search was cut short.
        deadline: Monotonic time at which the work is cut [s].
        progress: Told where the work stands.
        given: Further paths to move apart.
        alternatives: How many answers there shall be, as for `plan_global`.
    """
    assert task.clearance is not None
    free = task.free()
    survey = Survey(free.problem, asked_pairs(task.cell, asked_of(task).required))
    basin = Basin(survey, between=task.clearance.between_points)
    if basin.keeps(best):
        return None
    progress.stage("paths that keep the bodies apart")
    left = max(deadline - time.monotonic(), 0.0)
    stop = deadline
    if left < np.inf:
        stop -= max(_CHECK * left, min(_CHECK_S, _CHECK_MOST * left))
    how, apart = EFFORTS[effort], Apart()
    if free.problem.k > few.LONG:
        apart = few.led_by_few(basin, minima, how, deadline=stop, seed=seed, jobs=jobs, given=given)
    if not (apart.found or apart.cut):
        survey.meter, before = Meter(free.problem, how.work, stop), apart.tried
        apart = keep_apart(basin, minima, how, seed=seed, jobs=jobs, given=given)
        apart.tried += before
    provenance: dict[str, Any] = {
        "method": "global",
        "solver": solver,
        "seed": seed,
        "notes": GlobalNotes(effort=effort, interrupted=interrupted or apart.cut),
    }

    def candidate(path: Repaired) -> Candidate:
        return path.q, lambda: (held_problem(task, survey, path), _polished(basin, path))

    answer = None
    for end in apart.found[:_CHECKED]:  # the check looks closer than the repair
        for path in _with_room(task, basin, end):
            if answer is not None and time.monotonic() > deadline:
                break
            q = _polished(basin, path)
            answer = verified(task, free.whole(q), timing=clock.read(compile_s), **provenance)
            if answer.found:
                held = held_problem(task, survey, path)
                said = _said(apart, apart.hits(path), effort)
                evidence = local_evidence(held, q, said, free.constant)
                answer = replace(answer, evidence=evidence, timing=clock.read(compile_s))
                others = [candidate(other) for other in apart.found]
                return with_alternatives(task, answer, others, alternatives)
    answer = answer or verified(task, free.whole(best), timing=clock.read(compile_s), **provenance)
    if apart.best is None:
        tried = f"none of {apart.tried} paths that were tried keeps the clearance that is asked for"
        near = answer.message.removeprefix("not verified: ")
        return replace(answer, message=f"{tried}; in the best path without it {near}")
    return answer


def _with_room(task: Task, basin: Basin, path: Repaired) -> Iterator[Repaired]:
    """Yield a path, then the same with more room on the line where the check found it too near."""
    free = task.free()
    yield path
    for _ in range(_MORE_ROOM):
        search = Search(task.cell, free.whole(path.q), asked_of(task).required)
        if basin.between:
            search.between()
        if search.kept:  # it is not the distances that lack
            return
        lack, line, _, pair = search.worst
        basin.survey.meter = Meter(free.problem, EFFORTS["quick"].work)
        try:
            roomier = few.roomier if free.problem.k > few.LONG else Basin.roomier
            after = line - free.first
            ways = (roomier(basin, path, pair, after, room * lack) for room in _ROOMS)
            wider = next((way for way in ways if way is not None), None)
        except OverError:
            return
        finally:
            basin.survey.meter = Meter(free.problem)
        if wider is None:
            return
        path = wider
        yield path


def _polished(basin: Basin, path: Repaired) -> Array:
    """Return a path at the tolerance of an answer, or as it is where its bodies then lack room."""
    q = polished(path.problem, path.q)
    return q if basin.keeps(q) else path.q


def _said(apart: Apart, hits: int, effort: str) -> str:
    """Return how a path was found, in words, and what to do for a better one."""
    more = next((name for name, e in EFFORTS.items() if e.work > EFFORTS[effort].work), None)
    advice = "" if more is None else f": --effort {more} tries more"
    return (
        f"With clearance: {apart.tried} paths were moved apart or tried to be, {len(apart.found)} "
        f"came apart, {hits} of them as this one; others may be better{advice}. The local "
        "check holds the bodies by planes between them."
    )


def held_problem(task: Task, survey: Survey, path: Repaired) -> Problem:
    """Return the task's problem with the rows that hold a path, as rows that Pinocchio knows."""
    rows = _rows(survey, path, task.free().first)
    return replace(task, rows=(*task.rows, *rows)).free().problem


def _rows(survey: Survey, path: Repaired, before: int) -> list[Row]:
    """Return the rows; `before` points of the whole path have postures that are given."""
    cell, contacts = survey.problem.cell, path.contacts
    placed, joint = survey.placements(path.q), survey.pairs.joint[contacts.pair]
    first, second = (placed[contacts.point, joint[:, side]] for side in (0, 1))
    between = _placed(second, contacts.second) - _placed(first, contacts.first)
    normal = np.einsum("cij,cj->ci", first[:, :3, :3], contacts.normal)
    near = np.sum(normal * between, axis=1) - path.apart < _HELD
    found = []
    for c in np.flatnonzero(near & (path.apart - contacts.distance > -_NEAR)):
        pair, point = int(contacts.pair[c]), int(contacts.point[c])
        one, two = (_frame(cell, joint) for joint in survey.pairs.joint[pair])
        normal_c = contacts.normal[c]
        found.append(
            half_space(
                two,
                normal_c,
                float(normal_c @ contacts.first[c] + path.apart[c]),
                of=one,
                point=contacts.second[c],
                points=[point + before],
                name=f"{' and '.join(survey.pairs.names[pair])} at point {point + before + 1}",
            )
        )
    return found


def _frame(cell: Cell, joint: int) -> str:
    return WORLD if joint == 0 else str(cell.model.names[int(joint)])


def _placed(poses: Array, points: Array) -> Array:
    """Return points (c, 3) given in frames with poses (c, 4, 4) in the world."""
    return np.asarray(np.einsum("cij,cj->ci", poses[:, :3, :3], points) + poses[:, :3, 3])
