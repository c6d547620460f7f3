"""The best path that keeps its bodies apart: from walks that do, and from the lowest minima."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.repair.basin import Basin, Repaired
from dualarm_pin.repair.meter import LongError, Meter, OverError
from dualarm_pin.repair.walks import walked
from dualarm_pin.solution import same_path

_ALIKE = 1e-3  # of the objective: minima nearer than this are twins, of which one is enough
_HOPE = 1.02  # times the best: rounds of planes may still take so much off an objective
_MARGINS = (0.02, 0.01, 0.04)  # m: the distances of bodies are smoother farther out
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
        margins: Margins with which the best is moved apart again.
        share: Of the work, that one path may cost.
    """

    work: float = 2.2
    postures: int = 100
    walks: int = 4
    refined: int = 5
    basins: int = 2
    ways: int = 2
    rounds: int = 1
    margins: int = 1
    share: float = 0.4


EFFORTS = {
    "quick": Effort(),
    "normal": Effort(18.0, 150, 10, 15, 16, 3, 1, 3, 0.3),
    "thorough": Effort(75.0, 200, 16, 24, 16, 5, 3, 3, 0.1),
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
    result, meter = Apart(), basin.survey.meter
    tries = _Tries(basin, effort, result, seed, jobs)
    differing = _differing(minima)
    try:
        for path in given:
            tries.take(path)
        for _, path in differing[:1]:  # often it is nearly apart
            tries.take(path)
        for number in range(effort.rounds):
            tries.walk(number, effort.postures)
            if not number:
                tries.lower(differing[1 : effort.basins], _REDUCTIONS[:1])
                tries.lower(differing[: effort.basins], _REDUCTIONS[1 : effort.ways])
        tries.ease(_MARGINS[: effort.margins])
        number = effort.rounds
        while result.best is None:  # never without an answer while there is a budget
            spent = meter.spent
            tries.lower(differing, _REDUCTIONS[number % len(_REDUCTIONS) :][:1])
            tries.walk(number, effort.postures << 1)
            number += 1
            if meter.spent == spent:
                break
    except OverError:
        result.complete, result.cut = False, meter.cut
    except KeyboardInterrupt:
        result.complete, result.cut = False, True
    basin.survey.meter = Meter(basin.survey.problem)  # what follows is the check of the answer
    return result


class _Tries:
    """What is tried, one after the other."""

    def __init__(
        self, basin: Basin, effort: Effort, result: Apart, seed: int, jobs: int | None
    ) -> None:
        self.basin, self.effort, self.result = basin, effort, result
        self.seed, self.jobs = seed, jobs

    def take(
        self, path: Array, way: float | None = None, margin: float = 0.0, *, patient: bool = False
    ) -> None:
        """Move one path apart; a patient try may take the whole budget while there is none."""
        meter, best = self.basin.survey.meter, self.result.best
        limit = np.inf if best is None else best.objective
        meter.allow(self.effort.share if meter.found or not patient else 1.0)
        try:
            self.result.take(self.basin.repaired(path, way, _HOPE * limit, margin=margin))
        except LongError:
            self.result.take(None)
        meter.allow(np.inf)
        meter.found = self.result.best is not None

    def lower(self, minima: Sequence[tuple[float, Array]], ways: Sequence[float | None]) -> None:
        """Move apart what is lower than the best."""
        for objective, path in minima:
            for way in ways:
                if self.result.best is None or objective < self.result.best.objective:
                    self.take(path, way)

    def walk(self, number: int, postures: int) -> None:
        """Walk, and move apart where the best walks end."""
        walks = walked(
            self.basin.survey,
            seed=self.seed + number,
            postures=postures,
            walks=self.effort.walks,
            jobs=self.jobs,
        )
        for path in walks[: self.effort.refined]:  # clear at each point: the likeliest ones
            self.take(path, patient=True)

    def ease(self, margins: Sequence[float]) -> None:
        """Ask for more than there must be, then for that: so bodies get past what held them."""
        for margin in margins:
            best = self.result.best
            if best is not None:
                self.take(best.q, margin=margin)


def _differing(minima: Sequence[tuple[float, Array]]) -> list[tuple[float, Array]]:
    """Return one of those of equal objective."""
    found: list[tuple[float, Array]] = []
    for value, path in minima:
        if not found or value > found[-1][0] + _ALIKE * max(1.0, abs(value)):
            found.append((value, path))
    return found
