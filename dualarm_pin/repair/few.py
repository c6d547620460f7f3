"""Long paths: a few points are moved apart first, then ever more, from where those ended."""

from __future__ import annotations

import time
from collections.abc import Generator, Sequence

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.problem import Problem
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.dips import ENOUGH, add_dips, with_room
from dualarm_pin.repair.meter import Meter, OverError
from dualarm_pin.repair.pool import Apart, Effort, keep_apart
from dualarm_pin.repair.repaired import Repaired
from dualarm_pin.repair.survey import Survey
from dualarm_pin.repair.walks import stepped
from dualarm_pin.repair.witness import REACH, asked_apart, witness_table
from dualarm_pin.search.coarse import Coarse, coarse_of
from dualarm_pin.solvers.projection import project
from dualarm_pin.tolerance import TOLERANCE

LONG = 100  # points; a path with more is led by a few of them
# Points, in turn: between fewer a path jumps through bodies and no other follows it; with more one
# is not always found.
_FEW = (96, 48)
_DENSE = 6  # times as many points: so far they follow a path by themselves, mostly
_ALONE = 5  # solves of a point alone, until its bodies are apart
_REACH = 0.2  # rad or m, that it may move in one
_ROUNDS = 8  # over the points whose bodies are not apart
_EASED = 2.0  # times the work, to bring the objective of a path of all points down
_GIVEN = 2  # paths of a few points, of which the first is taken that all points can follow


def led_by_few(
    basin: Basin,
    minima: Sequence[tuple[float, Array]],
    effort: Effort,
    *,
    deadline: float,
    seed: int,
    jobs: int | None,
    given: Sequence[Array] = (),
) -> Apart:
    """Look for a long path whose bodies are apart, near the best one of a few points.

    Args:
        basin: What moves paths of all points apart.
        minima: Objective and path (k, n) of what the search came to, best first.
        effort: How far to look.
        deadline: Monotonic time at which the work is cut [s].
        seed: Of the walks.
        jobs: Threads.
        given: Further paths (k, n) to move apart.

    Returns:
        One path, or none; after Ctrl-C what there was so far.
    """
    whole, result = basin.survey.problem, Apart()
    for count in _FEW:
        levels = _levels(whole, count)
        few, at = _on(levels[0], basin.survey, effort, deadline), levels[0].points
        thinned = [(value, path[at]) for value, path in minima]
        also = [path[at] for path in given]
        apart = keep_apart(few, thinned, effort, seed=seed, jobs=jobs, given=also)
        last = _all_points(levels, apart, basin, effort, deadline)
        last.tried, last.complete = last.tried + result.tried, last.complete and result.complete
        result = last
        if result.found or result.cut:
            break
    basin.survey.meter = Meter(whole)
    return result


def _levels(whole: Problem, count: int) -> list[Coarse]:
    """Return problems of so many points of a whole path, of twice as many, and so on."""
    counts = [count]
    while counts[-1] << 1 < whole.k:
        counts.append(counts[-1] << 1)
    return [coarse_of(whole, count) for count in counts]


def _all_points(
    levels: Sequence[Coarse], apart: Apart, basin: Basin, effort: Effort, deadline: float
) -> Apart:
    """Return what the paths that came apart at the points of the first level lead to."""
    result = Apart(tried=apart.tried, complete=apart.complete, cut=apart.cut)
    try:
        for each in apart.found[:_GIVEN]:
            path = _followed(levels, each.q, basin, effort, deadline)
            if path is not None:
                result.found = [path]
                for better in _eased(basin, path, effort, deadline):
                    result.found = [better]
                break
    except OverError:
        result.complete, result.cut = False, result.cut or time.monotonic() > deadline
    except KeyboardInterrupt:
        result.complete, result.cut = False, True
    return result


def _on(level: Coarse, survey: Survey, effort: Effort, deadline: float) -> Basin:
    """Return what moves paths of some points apart; the whole path is looked at between them."""
    meter = Meter(level.problem, effort.work, deadline)
    return Basin(Survey(level.problem, survey.pairs, meter), between=False, settle=False)


def _followed(
    levels: Sequence[Coarse], q: Array, basin: Basin, effort: Effort, deadline: float
) -> Repaired | None:
    """Return a path of all points that follows one of the first level, or None.

    As soon as there are enough points the rest is put between them; where these do not come apart
    one by one, more points follow together.
    """
    survey, whole, last = basin.survey, basin.survey.problem, levels[0]
    for level in levels:
        if level is not levels[0]:
            few = _on(level, survey, effort, deadline)
            path = few.repaired(_cleared(few.survey, last.start(q)[level.points]))
            if path is None:
                return None
            q, last = path.q, level
        if len(level.points) * _DENSE >= whole.k:
            survey.meter = Meter(whole, effort.work, deadline)
            nothing = np.zeros((len(survey.pairs.number), whole.k))
            path = _set_down(basin, level.start(q), nothing)
            if path is not None and _longest(path.q) <= _longest(q):  # else a point was lost
                return path
    survey.meter = Meter(whole, effort.work, deadline)
    path = Basin(survey, between=False, settle=False).repaired(_cleared(survey, last.start(q)))
    survey.meter = Meter(whole)
    return path if path is not None and basin.keeps(path.q) else None


def _longest(q: Array) -> float:
    """Return the longest step of a joint on a path (k, n) [rad or m]."""
    return float(np.abs(np.diff(q, axis=0)).max())


def _eased(
    basin: Basin, path: Repaired, effort: Effort, deadline: float
) -> Generator[Repaired, None, None]:
    """Yield better paths than one whose points came apart one by one: all of them together."""
    meter = basin.survey.meter = Meter(basin.survey.problem, _EASED * effort.work, deadline)
    meter.found = True
    steps = basin.settled(path)
    while True:
        try:
            found, last = next(steps).found, False
        except StopIteration as end:
            found, last = end.value, True
        if found is not None and found.objective < path.objective:
            yield found
        if last:
            return


def roomier(basin: Basin, path: Repaired, pair: int, line: int, lack: float) -> Repaired | None:
    """Return a long path with more room for a pair on one line; as `Basin.roomier`.

    A whole long path would move everywhere for that; so only the points without room do.
    """
    return _set_down(basin, path.q, with_room(path.extra, pair, line, lack))


def _set_down(basin: Basin, q: Array, extra: Array) -> Repaired | None:
    """Put a path (k, n) near the poses onto them, and move apart what is not, point by point.

    What is asked beyond what is required, `extra` (p, k) [m], grows where bodies dip.
    """
    survey, problem = basin.survey, basin.survey.problem
    for _ in range(_ROUNDS):
        q, residual = project(problem, q)
        contacts = survey.contacts(q, REACH, extra)
        if residual > TOLERANCE.on_path:
            return None
        if contacts.kept.all() and (not basin.between or add_dips(survey, q, extra) <= ENOUGH):
            apart = asked_apart(contacts)
            held = problem.with_pairs(witness_table(survey, contacts, apart, len(q)))
            return Repaired(q, problem.objective(q), held, contacts, apart, extra)
        q = _cleared(survey, q, extra)
    return None


def _cleared(survey: Survey, q: Array, extra: Array | None = None) -> Array:
    """Return a path (k, n) whose points were moved apart one by one, their neighbours held.

    Between points that are apart bodies may dip deeply into each other; a whole path hardly comes
    out of that, a point by itself nearly always does.
    """
    q, both = q.copy(), np.ones(2)
    if extra is None:
        extra = np.zeros((len(survey.pairs.number), len(q)))
    lacking = survey.contacts(q, 0.0, extra)
    for i in np.unique(lacking.point[~lacking.kept]).tolist():
        beside = q[[max(i - 1, 0), min(i + 1, len(q) - 1)]]
        for _ in range(_ALONE):
            moved, contacts = stepped(survey, i, q[i : i + 1], beside, both, _REACH, extra[:, [i]])
            if contacts.kept.all():
                break
            q[i] = moved
    return q
