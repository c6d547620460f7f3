"""Long paths: a few points of them are moved apart first, and all of them begin from there."""

from __future__ import annotations

from collections.abc import Sequence

from dualarm_pin.arrays import Array
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.meter import Meter
from dualarm_pin.repair.pool import Effort, keep_apart
from dualarm_pin.repair.survey import Survey
from dualarm_pin.search.coarse import coarse_of

LONG = 100  # points; a path with more is led by a few of them
_FEW = 48  # points: bodies pass between no two of them unseen on a path that all points follow
_SHARE = 0.5  # of the work
_GIVEN = 2  # paths of a few points that all points begin from


def led_by_few(
    basin: Basin,
    minima: Sequence[tuple[float, Array]],
    effort: Effort,
    *,
    deadline: float,
    seed: int,
    jobs: int | None,
) -> tuple[list[Array], bool]:
    """Return starts (k, n) of a long path, near paths of a few points whose bodies are apart.

    Args:
        basin: What moves paths of all points apart.
        minima: Objective and path (k, n) of what the search came to, best first.
        effort: How far to look.
        deadline: Monotonic time at which the work is cut [s].
        seed: Of the walks.
        jobs: Threads.

    Returns:
        The starts, best first, and whether Ctrl-C or the time limit cut the work.
    """
    few = coarse_of(basin.survey.problem, _FEW)
    meter = Meter(few.problem, _SHARE * effort.work, deadline)
    part = Basin(Survey(few.problem, basin.survey.pairs, meter), between=False)
    thinned = [(value, path[few.points]) for value, path in minima]
    apart = keep_apart(part, thinned, effort, seed=seed, jobs=jobs)
    return [few.start(each.q) for each in apart.found[:_GIVEN]], apart.cut
