"""The best path that keeps its bodies apart: from walks that do, and from the lowest minima."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.repair.basin import Basin, Repaired
from dualarm_pin.repair.meter import Meter, OverError
from dualarm_pin.repair.walks import walked
from dualarm_pin.solution import same_path

_ALIKE = 1e-3  # of the objective: minima nearer than this are twins, of which one is enough
_HOPE = 1.02  # times the best: rounds of planes may still take so much off an objective
_REDUCTIONS: tuple[float | None, ...] = (None, 0.06, 0.03, 0.1, 0.0)


@dataclass(frozen=True)
class Effort:
    """How far to look.

    Attributes:
        work: Seconds of a usual processor, as `Meter` counts them.
        postures: Postures drawn at each anchor.
        walks: Minima of each anchor that are walked from.
        refined: Walks that are refined, best first.
        basins: Minima of the search that are repaired, while they are lower than the best.
        ways: Ways of leading each of them out of a collision.
        rounds: Times that walks are drawn anew.
    """

    work: float = 2.2
    postures: int = 100
    walks: int = 4
    refined: int = 5
    basins: int = 2
    ways: int = 2
    rounds: int = 1


EFFORTS = {
    "quick": Effort(),
    "normal": Effort(18.0, 150, 10, 15, 16, 3, 1),
    "thorough": Effort(75.0, 200, 16, 24, 16, 5, 3),
}


@dataclass
class Apart:
    """What was tried, and what came of it.

    Attributes:
        tried: Paths that were to be moved apart.
        found: Those that came apart, best first.
        complete: The budget did not end it.
        cut: Ctrl-C or the time limit did.
    """

    tried: int = 0
    found: list[Repaired] = field(default_factory=list)
    complete: bool = True
    cut: bool = False

    @property
    def best(self) -> Repaired | None:
        """The lowest path that came apart."""
        return self.found[0] if self.found else None

    def hits(self, path: Repaired) -> int:
        """Return how many of the tried paths ended in one of them."""
        return sum(same_path(each.q, path.q) for each in self.found)

    def take(self, path: Repaired | None) -> None:
        """Count a path that was tried."""
        self.tried += 1
        if path is not None:
            self.found.append(path)
            self.found.sort(key=lambda each: each.objective)


def keep_apart(
    basin: Basin,
    minima: Sequence[tuple[float, Array]],
    effort: Effort,
    *,
    seed: int,
    jobs: int | None,
    given: Sequence[Array] = (),
) -> Apart:
    """Look for the best path whose bodies stay as far apart as is asked of them.

    Args:
        basin: What moves paths apart.
        minima: Objective and path of what the search without clearance came to, best first.
        effort: How far to look.
        seed: Of the walks.
        jobs: Threads.
        given: Further paths to move apart, such as one that was apart in a task like this.

    Returns:
        What was found; after Ctrl-C what there was so far.
    """
    result, survey = Apart(), basin.survey
    differing = _differing(minima)[: effort.basins]

    def take(path: Array, way: float | None = None) -> None:
        limit = np.inf if result.best is None else result.best.objective
        result.take(basin.repaired(path, way, _HOPE * limit))
        survey.meter.found = result.best is not None

    try:
        for path in given:
            result.take(basin.repaired(path))
        for number in range(effort.rounds):
            walks = walked(
                survey,
                seed=seed + number,
                postures=effort.postures,
                walks=effort.walks,
                jobs=jobs,
            )
            for path in walks[: effort.refined]:
                take(path)
        for objective, path in differing:
            if result.best is not None and objective >= result.best.objective:
                break
            for way in _REDUCTIONS[: effort.ways]:
                take(path, way)
    except OverError:
        result.complete, result.cut = False, survey.meter.cut
    except KeyboardInterrupt:
        result.complete, result.cut = False, True
    survey.meter = Meter(survey.problem)  # what follows is the check of the answer
    return result


def _differing(minima: Sequence[tuple[float, Array]]) -> list[tuple[float, Array]]:
    """Return one of those of equal objective."""
    found: list[tuple[float, Array]] = []
    for value, path in minima:
        if not found or value > found[-1][0] + _ALIKE * max(1.0, abs(value)):
            found.append((value, path))
    return found
