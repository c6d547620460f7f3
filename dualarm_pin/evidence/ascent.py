"""One set of cuts: raise the multipliers, search every piece anew, until both rest."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dualarm_pin.answer.evidence import Bound
from dualarm_pin.arrays import Array
from dualarm_pin.evidence.bundle import highest
from dualarm_pin.evidence.check import polished
from dualarm_pin.evidence.piece_search import PieceSearch, SearchOptions, WideSearch
from dualarm_pin.evidence.pieces import Cuts, split
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.tolerance import TOLERANCE


@dataclass(frozen=True)
class BoundOptions:
    """How far the bound goes.

    Attributes:
        search: Starts of each piece.
        steps: Most steps of the multipliers between two re-checks.
        rounds: Most re-checks of one set of cuts.
        closed: Relative gap at which the multipliers are good enough.
        enough: Relative gap at which no other set of cuts is tried.
        hopeless: Relative gap at which a set of cuts is left, if its pieces prove hard to search.
        patience: Re-checks before that.
        radius: First half-width of the box of a step, in objective per rad or m.
    """

    search: SearchOptions = field(default_factory=SearchOptions)
    steps: int = 60
    rounds: int = 6
    closed: float = 1e-5
    enough: float = 1e-3
    hopeless: float = 1e-2
    patience: int = 2
    radius: float = 0.5


class Ascent:
    """One set of cuts: multipliers raised, pieces re-checked, until both rest.

    Attributes:
        theta: The best multipliers (cuts, n).
        value: The believed sum of the pieces' minima there; never returned as the bound.
        better: A better path than those known, or None.
    """

    def __init__(
        self,
        problem: Problem,
        known: list[Array],
        cuts: Cuts,
        *,
        seed: int,
        jobs: int | None,
        options: BoundOptions,
    ) -> None:
        self.problem, self.cuts, self.options = problem, cuts, options
        self.objective = min(problem.objective(q) for q in known)
        self.better: Array | None = None
        self.pieces = [
            PieceSearch(
                piece, known[0][piece.points], len(cuts), (seed, j, *cuts), options.search, jobs
            )
            for j, piece in enumerate(split(problem, cuts))
        ]
        for q in known[1:]:
            self._add(q)
        self.theta = np.zeros((len(cuts), problem.n))
        self.value = -np.inf
        self.count = 0

    def run(self, progress: Progress, *, may_give_up: bool = False) -> Bound | None:
        """Climb until a re-check finds no piece lower than believed; return the bound it found.

        The re-check of the last round stands, whatever it finds.

        Args:
            progress: Told of every step.
            may_give_up: Return None where a re-check found a piece lower and leaves a gap that
                other cuts should close better.
        """
        for piece in self.pieces:
            piece.prepare(self.theta)
        number = 1
        self.climb(progress)
        while (wides := self.recheck(number, to_the_end=number == self.options.rounds)) is None:
            wide_gap = self.objective - self.value > self._level(self.options.hopeless)
            if may_give_up and number >= self.options.patience and wide_gap:
                return None
            number += 1
            self.climb(progress)
        return Bound(
            value=self.value,
            objective=self.objective,
            cuts=self.cuts,
            starts=tuple(wide.starts for wide in wides),
            hits=tuple(wide.hits for wide in wides),
        )

    def climb(self, progress: Progress = SILENT) -> None:
        """Raise the multipliers until the model promises no more, by the cheap search."""
        radius = self.options.radius
        self._evaluate(self.theta)
        for _ in range(self.options.steps if self.cuts else 0):
            # A path found at other multipliers may have lowered the value here.
            self.value = self._model(self.theta)
            if self.objective - self.value <= self._level(self.options.closed):
                return
            planes = [piece.planes for piece in self.pieces]
            flat, height = highest(planes, self.theta.ravel(), radius)
            promised = height - self.value
            if promised <= self._level(self.options.closed / 10.0):
                return
            theta = flat.reshape(self.theta.shape)
            gained = self._evaluate(theta) - self.value
            progress.advance()
            if gained >= 0.1 * promised:
                self._recover(theta)
                self.theta = theta
                radius *= 2.0 if gained >= 0.5 * promised else 1.0
            elif gained < -promised:
                radius /= 2.0
        self.value = self._model(self.theta)

    def recheck(self, number: int, *, to_the_end: bool) -> list[WideSearch] | None:
        """Search every piece widely at the multipliers reached, and correct the value.

        Args:
            number: Of the re-check; each has starts of its own.
            to_the_end: Go on when a piece turns out lower than believed.

        Returns:
            The searches; None if one found its piece lower and the rest was left.
        """
        wides = [WideSearch(piece, self.theta, number) for piece in self.pieces]
        level = self._level(self.options.closed)
        for wide in wides:  # the first starts tell most
            wide.extend()
        for wide in wides:
            while not wide.done and (to_the_end or wide.value >= wide.believed - level):
                wide.extend()
        self.value = sum(wide.value for wide in wides)
        lower = any(wide.value < wide.believed - level for wide in wides)
        return None if lower and not to_the_end else wides

    def _model(self, theta: Array) -> float:
        return sum(piece.planes.lowest(theta.ravel()) for piece in self.pieces)

    def _evaluate(self, theta: Array) -> float:
        self.count += 1
        return sum(piece.cheap(theta, self.count) for piece in self.pieces)

    def _recover(self, theta: Array) -> None:
        """Join the pieces' minima to a path: where the incumbent is wrong it often is better."""
        parts = [piece.planes.lowest_path(theta.ravel()) for piece in self.pieces]
        start = np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
        for cut, part in zip(self.cuts, parts[1:], strict=True):
            start[cut] = 0.5 * (start[cut] + part[0])
        end = engine.solve(self.problem, start)
        if end.converged and end.objective < self.objective - self._level(TOLERANCE.same_objective):
            q = polished(self.problem, end.q)
            self.better, self.objective = q, self.problem.objective(q)
            self._add(q)

    def _add(self, q: Array) -> None:
        for piece in self.pieces:
            piece.add_path(q[piece.piece.points])

    def _level(self, relative: float) -> float:
        return relative * max(1.0, abs(self.objective))
