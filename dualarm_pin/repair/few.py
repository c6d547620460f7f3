"""Long paths: a few points are moved apart first, then ever more, from where those ended."""

from __future__ import annotations

import itertools
import time
from collections.abc import Sequence

from dualarm_pin.arrays import Array
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.meter import Meter, OverError
from dualarm_pin.repair.pool import Apart, Effort, keep_apart
from dualarm_pin.repair.survey import Survey
from dualarm_pin.search.coarse import Coarse, coarse_of

LONG = 100  # points; a path with more is led by a few of them
_FEW = 48  # points: about as many as a short path has, where repairs are cheap
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
    whole, counts = basin.survey.problem, [_FEW]
    while counts[-1] << 1 < whole.k:
        counts.append(counts[-1] << 1)
    levels = [coarse_of(whole, count) for count in counts]
    few = _on(levels[0], basin.survey, effort, deadline)
    at = levels[0].points
    thinned = [(value, path[at]) for value, path in minima]
    also = [path[at] for path in given]
    apart = keep_apart(few, thinned, effort, seed=seed, jobs=jobs, given=also)
    result = Apart(tried=apart.tried, complete=apart.complete, cut=apart.cut)
    survey = basin.survey
    try:
        for each in apart.found[:_GIVEN]:
            q = _followed(levels, each.q, survey, effort, deadline)
            if q is None:
                continue
            survey.meter = Meter(whole, effort.work, deadline)
            path = Basin(survey, between=False).repaired(q)
            survey.meter = Meter(whole)  # what follows is a check
            if path is not None and basin.keeps(path.q):
                result.found = [path]
                break
    except OverError:
        result.complete, result.cut = False, result.cut or time.monotonic() > deadline
    except KeyboardInterrupt:
        result.complete, result.cut = False, True
    survey.meter = Meter(whole)
    return result


def _on(level: Coarse, survey: Survey, effort: Effort, deadline: float) -> Basin:
    """Return what moves paths of some points apart; the whole path is looked at between them."""
    meter = Meter(level.problem, effort.work, deadline)
    return Basin(Survey(level.problem, survey.pairs, meter), between=False)


def _followed(
    levels: Sequence[Coarse], q: Array, survey: Survey, effort: Effort, deadline: float
) -> Array | None:
    """Return a start (k, n) where ever more points follow a path of the first level, or None."""
    for before, level in itertools.pairwise(levels):
        path = _on(level, survey, effort, deadline).repaired(before.start(q)[level.points])
        if path is None:
            return None
        q = path.q
    return levels[-1].start(q)
