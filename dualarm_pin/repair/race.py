"""Paths that are moved apart side by side, a round at a time, the most promising one first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.repair.basin import Basin
from dualarm_pin.repair.repaired import Repaired, Standing, Steps

_PER_LACK = 8.0  # 1/m: of the objective, that coming apart is expected to cost
# Of the objective: so much a path falls behind when the whole budget was spent on it, while no path
# has come apart yet, and after that.
_DEAR = (0.3, 4.0)
_EARLY = 1.03  # times what a path promises that was not apart at its points yet: most end above it
_BETWEEN = 1.03  # times the objective at which a path is apart at its points
_AHEAD = 3.0  # times what the last round gained: so much may still be gained
_TRUSTED = 3  # rounds in which no more is expected of a path than before the first ...
_LOST = 3.0  # ... unless its objective is so many times that
_DOUBT = 1.5  # times as much is expected of the others of its kind where one is lost


def promise(value: float, lack: float) -> float:
    """Return the objective at which a path is expected to come apart."""
    return value + abs(value) * _PER_LACK * max(lack, 0.0)


@dataclass(eq=False)
class _Runner:
    """A path under way.

    Attributes:
        steps: Its rounds.
        kind: Where it comes from.
        promise: See `promise`.
        rounds: How many it had.
        spent: What these have cost [s].
        last: Objective when its bodies were apart last, still infinite before.
    """

    steps: Steps
    kind: str
    promise: float
    rounds: int = 0
    spent: float = 0.0
    last: float = np.inf

    def behind(self, dear: float) -> float:
        """Return the promise, and how far a path falls behind that is not apart, or cost much."""
        early = _EARLY - 1.0 if np.isinf(self.last) else 0.0
        return self.promise + abs(self.promise) * (early + dear * self.spent)


class Race:
    """Paths under way; a round goes to the one that promises the lowest objective.

    Attributes:
        basin: What moves them.
        budget: Seconds that all of them may cost.
        tried: Paths that had a round.
    """

    def __init__(self, basin: Basin, budget: float) -> None:
        self.basin, self.budget, self.tried = basin, budget, 0
        self._runners: list[_Runner] = []

    def __len__(self) -> int:
        return len(self._runners)

    @property
    def best(self) -> float:
        """The lowest promise of all, infinite for none."""
        return min((each.promise for each in self._runners), default=np.inf)

    def enter(
        self,
        q: Array,
        expected: float,
        kind: str,
        way: float | None = None,
        margin: float = 0.0,
        fitted: bool = False,
    ) -> None:
        """Let a path take part.

        Args:
            q: Joints (k, n).
            expected: Objective at which it is expected to come apart.
            kind: Where it comes from.
            way: Of leading it out of a collision first; see `Basin.repaired`.
            margin: As of `Basin.repaired`.
            fitted: As of `Basin.steps`.
        """
        steps = self.basin.steps(q, way, margin=margin, fitted=fitted)
        self._runners.append(_Runner(steps, kind, expected))

    def round(self, best: float) -> tuple[bool, Repaired | None]:
        """Make one round of the most promising path; there has to be one.

        Args:
            best: The lowest objective of a path that came apart: others give up above it.

        Returns:
            Whether the path ended, and where bodies are apart on it, if they are.
        """
        meter = self.basin.survey.meter
        dear = _DEAR[bool(np.isfinite(best))] / self.budget
        one = min(self._runners, key=lambda each: each.behind(dear))
        before = meter.spent
        self.tried += not one.rounds
        try:
            standing = next(one.steps)
        except StopIteration as end:
            self._runners.remove(one)
            if end.value is None:
                self._doubt(one.kind)
            return True, end.value
        one.spent += meter.spent - before
        one.rounds += 1
        given_up = _given_up(one, standing, best)
        expected = promise(standing.value, standing.lack)
        if expected > _LOST * one.promise:
            self._doubt(one.kind)
        elif one.rounds < _TRUSTED:
            expected = min(expected, one.promise)
        # Apart at the points once, what is left to do between them costs little as a rule.
        one.promise = min(expected, _BETWEEN * one.last)
        if given_up:
            self._runners.remove(one)
        return given_up, standing.found

    def _doubt(self, kind: str) -> None:
        """Expect less of those of a kind that have not begun."""
        for each in self._runners:
            if each.kind == kind and not each.rounds:
                each.promise += (_DOUBT - 1.0) * abs(each.promise)


def _given_up(one: _Runner, standing: Standing, best: float) -> bool:
    """Tell whether a path whose bodies are apart will not come below the best any more."""
    if not standing.kept or standing.found is not None:  # what it gains by settling is to be seen
        return False
    gain, one.last = one.last - standing.value, standing.value
    return bool(np.isfinite(gain) and standing.value - _AHEAD * max(gain, 0.0) > best)
