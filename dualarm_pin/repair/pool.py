"""The best path that keeps its bodies apart: from minima, a search with capsules, and walks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.covered import CoveredSearch, differing
from dualarm_pin.repair.meter import Meter, OverError
from dualarm_pin.repair.race import Race, promise
from dualarm_pin.repair.repaired import Repaired
from dualarm_pin.repair.walks import Walks
from dualarm_pin.solution import same_path

_MARGINS = (0.02, 0.01, 0.04)  # m: the distances of bodies are smoother farther out
_EASED = 0.98  # of the best: what it promises when it is moved apart once more, with a margin
_REDUCTIONS = (0.06, 0.03, 0.1, 0.0)  # m: on which side bodies pass each other
_LED = 1.1  # times as much is expected of a path that capsules lead
_DEEP = 0.08  # m: minima that lack more hardly ever come apart, whatever it costs
_NEARLY = 0.06  # m: a path that lacks no more is moved apart before anything else ...
_STILL_NEAR = 1.5  # ... as long as no more than so many times what it promised is expected
_LEARNT = 3  # minima, the best first, whose bodies show which capsules are needed
_MINIMUM, _LED_ONE, _WALK, _BEST = "minimum", "led by capsules", "walk", "best"
_COVERED = "capsules apart"
_LOOKED_AT = 10  # points of a minimum, at which its lack is measured first


@dataclass(frozen=True)
class Effort:
    """How far to look.

    Attributes:
        work: Seconds of a usual processor, as `Meter` counts them.
        covered: Rounds of a search with capsules ...
        round: ... and the work of each [s].
        postures: Postures drawn at each anchor.
        walks: Minima of each anchor that are walked from.
        basins: Minima of the search that are repaired.
        ways: Ways of leading each of them out of a collision.
        rounds: Times that walks are drawn anew.
        margins: Margins with which the best is moved apart again.
    """

    work: float = 2.4
    covered: int = 3
    round: float = 0.35
    postures: int = 100
    walks: int = 6
    basins: int = 8
    ways: int = 1
    rounds: int = 4
    margins: int = 1


EFFORTS = {
    "quick": Effort(),
    "normal": Effort(18.0, 6, 1.0, 150, 10, 16, 2, 1, 3),
    "thorough": Effort(75.0, 12, 2.0, 200, 16, 24, 4, 3, 3),
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

    def take(self, path: Repaired) -> None:
        """Keep a path that came apart, instead of what it was before it settled."""
        self.found = [each for each in self.found if each is not path and each is not path.before]
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
    try:
        for path in given:
            tries.take(path)
        tries.enter(differing(minima))
        tries.run()
    except OverError:
        result.complete, result.cut = False, meter.cut
    except KeyboardInterrupt:
        result.complete, result.cut = False, True
    result.tried = tries.given + tries.race.tried
    basin.survey.meter = Meter(basin.survey.problem)  # what follows is the check of the answer
    return result


class _Tries:
    """What is tried: minima of the search, paths whose capsules are apart, walks."""

    def __init__(
        self, basin: Basin, effort: Effort, result: Apart, seed: int, jobs: int | None
    ) -> None:
        self.basin, self.effort, self.result = basin, effort, result
        self.seed, self.jobs = seed, jobs
        self.race = Race(basin, effort.work)
        self._minima: Sequence[tuple[float, Array]] = []
        self._margins = list(_MARGINS[: effort.margins])
        self._drawn, self._near, self.given = 0, np.inf, 0
        self._covered = CoveredSearch(basin.survey, seed=seed, jobs=jobs)
        self._rounds = 0
        self._walks = self._drawn_anew(effort.postures)

    def take(self, path: Array) -> None:
        """Move one path apart."""
        self.given += 1
        apart = self.basin.repaired(path)
        if apart is not None:
            self._keep(apart)

    def enter(self, minima: Sequence[tuple[float, Array]]) -> None:
        """Let minima of the search take part."""
        self._minima = minima
        for value, path in minima[: self.effort.basins]:
            some = path[:: max(1, len(path) // _LOOKED_AT)]
            lack = self.basin.survey.contacts(some, 0.0, enough=_DEEP).worst
            if lack > _DEEP:
                continue
            expected = promise(value, lack)
            if lack < _NEARLY:
                self._near = min(self._near, expected)
            self.race.enter(path, expected, _MINIMUM)
            for number, way in enumerate(_REDUCTIONS[: self.effort.ways - 1], 1):
                self.race.enter(path, expected * _LED**number, _LED_ONE, way)

    def run(self) -> None:
        """Minima that are nearly apart, a search with capsules, what came of it; walks at last."""
        meter, race = self.basin.survey.meter, self.race
        walked = moved = last = 0.0
        near = self._near < np.inf
        while True:
            before, best = meter.spent, self.result.best
            near = near and race.best < _STILL_NEAR * self._near
            if not near and self._rounds < self.effort.covered:
                self._covered_next()
            elif not near and self._walks_next(walked, moved):
                for value, start in self._walks.next():
                    race.enter(start, value, _WALK)
                walked += meter.spent - before
            elif self._margins and best is not None and race.best > best.objective:
                margin = self._margins.pop(0)
                race.enter(best.q, best.objective * _EASED, _BEST, margin=margin)
            elif len(race):
                ended, path = race.round(np.inf if best is None else best.objective)
                near = near and not ended
                if path is not None:
                    self._keep(path)
                moved += meter.spent - before
            elif best is None and meter.spent > last:
                last = meter.spent
                self._again()
            else:
                return

    def _covered_next(self) -> None:
        """Make a round of the search with capsules, and let what comes near take part."""
        if not self._rounds:
            for _, path in self._minima[:_LEARNT]:
                self._covered.learn(path)
        rows = self._covered.rows
        self._covered.round(self.effort.round)
        self._rounds += 1
        near = [each for each in self._covered.paths if each[2] <= _DEEP]
        for value, path, lack in near[: self.effort.basins]:
            self.race.enter(path, promise(value, lack), _COVERED, fitted=True)
        if not near and self._covered.rows == rows:  # the next round would be as this one
            self._rounds = self.effort.covered

    def _walks_next(self, walked: float, moved: float) -> bool:
        """Tell whether to walk, after so much work on walks and on moving paths apart."""
        turn = not len(self.race) or (self.result.best is not None and walked <= moved)
        if not self._walks.left and self._drawn < self.effort.rounds and turn:
            self._walks = self._drawn_anew(self.effort.postures << 1)
        return self._walks.left > 0 and turn

    def _again(self) -> None:
        """Draw walks anew, and lead the minima in the next way."""
        way = _REDUCTIONS[self._drawn % len(_REDUCTIONS)]
        for value, path in self._minima:
            self.race.enter(path, value, _LED_ONE, way)
        self._walks = self._drawn_anew(self.effort.postures << 1)

    def _drawn_anew(self, postures: int) -> Walks:
        self._drawn += 1
        return Walks(
            self.basin.survey,
            seed=self.seed + self._drawn - 1,
            postures=postures,
            walks=self.effort.walks,
            jobs=self.jobs,
        )

    def _keep(self, path: Repaired) -> None:
        self.result.take(path)
        self.basin.survey.meter.found = True
