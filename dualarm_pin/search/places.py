"""The law of placements: random places at single points, the best refined over the whole path.

A place is drawn first and held while its postures are found at one point; a place that is free
there is ideal for one point and seldom for all. The best are then refined as arrow systems, with
place and joints free together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.engine.interior_point.solve_one import CONVERGED
from dualarm_pin.engine.solve import Options, solve_many
from dualarm_pin.placement.asked import Asked
from dualarm_pin.placement.shared import share
from dualarm_pin.problem import Problem
from dualarm_pin.search.starts import generator
from dualarm_pin.solution import Minima, Solutions, distinct
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]

_ONE_POINT = Options(tolerance=1e-4, iterations=60)  # a start for a refinement, no more
_ROUGH = Options(tolerance=1e-4, iterations=100)  # enough to tell which minimum a start leads to
_FINE = Options(tolerance=1e-8, iterations=300, mu0=1e-4, push=1e-6)  # and to stay in it
_KEY = 40  # of the generators
_BEST_FIRST = 0.12  # chance that a hop starts from the best minimum, then from the next, ...
_HOP, _HOP_PLACE = 0.5, 0.2  # of a posture [rad or m], and of the box of a place
_HOPELESS = 3  # rounds without any path: a box that has one shows it in the first


@dataclass(frozen=True)
class PlaceBudget:
    """How far a search goes.

    Attributes:
        free_places: Random places a round that are free while one point is solved.
        free_refined: Best of these that are refined over the whole path.
        places: Random places a round that are held.
        refined: Best of these.
        hops: Refinements a round from places and postures near the minima that are known.
        least_rounds: Rounds at least.
        rounds: Rounds at most.
        agree: Rounds that must end in the best minimum before no more are made.
        kept: Distinct minima of a round that are refined to the end.
    """

    free_places: int
    free_refined: int
    places: int
    refined: int
    hops: int
    least_rounds: int
    rounds: int
    agree: int = 2
    kept: int = 12

    @classmethod
    def of(cls, p: int) -> PlaceBudget:
        """Return the budget for p free parameters: a box of more sides has more corners."""
        more = max(p - 2, 0)
        return cls(
            free_places=150 * p,
            free_refined=10 * p,
            places=75 * p,
            refined=6 * p,
            hops=50 * more,
            least_rounds=2 + (5 * more) // 2,
            rounds=6 + 4 * more,
        )


class PlaceSearch:
    """Rounds of places until enough of them end in the same minimum."""

    def __init__(
        self,
        problem: Problem,
        may: Asked,
        seed: int,
        budget: PlaceBudget | None = None,
        jobs: int | None = None,
    ) -> None:
        self.problem, self.may, self.seed, self.jobs = problem, may, seed, jobs
        self.budget = budget or PlaceBudget.of(len(may.free))
        self.shared = share(problem, may.free)
        self.rounds, self.rounds_here, self.starts = 0, 0, 0
        self.ends: list[Solutions] = []
        self.nearest = np.inf  # smallest residual of any start
        self.nearest_values = 0.5 * (may.lower + may.upper)

    def run(self) -> Minima:
        """Search and return the distinct minima, best first, to the tolerance of an answer."""
        hits, best = 0, np.inf
        budget = self.budget
        while self.rounds < budget.rounds:
            if hits >= budget.agree and self.rounds >= budget.least_rounds:
                break
            found = self.round()
            if not np.isfinite(found):
                if self.rounds >= _HOPELESS and not self.ends:
                    break
                continue
            level = self._same(found)
            if found < best - level:
                best, hits = found, 1
            elif found <= best + level:
                hits += 1
            self.rounds_here = hits
        return self.minima()

    def round(self) -> float:
        """Draw places, refine the best of them; return the best objective of this round."""
        random = generator(self.seed, _KEY, self.rounds)
        starts = np.concatenate([self._starts(random), self._hops(random)])
        self.rounds += 1
        if not len(starts):
            return np.inf
        ends = self._refine(starts, _ROUGH)
        rough = distinct(_trusted(ends))
        if not len(rough):
            return np.inf
        fine = self._refine(rough.ends.q[: self.budget.kept], _FINE)
        self.ends.append(fine)
        return float(np.min(np.where(self._usable(fine), fine.objective, np.inf)))

    def minima(self) -> Minima:
        """Return the distinct minima of all rounds outside the areas, best first."""
        if not self.ends:
            return distinct(_none(self.shared.n, self.problem.k))
        ends = Solutions.join(self.ends)
        return distinct(ends.take(self._usable(ends)))

    def _same(self, value: float) -> float:
        return TOLERANCE.same_objective * max(1.0, abs(value))

    def _usable(self, ends: Solutions) -> NDArray[np.bool_]:
        p = self.shared.shared
        out = np.array([self.may.kept_out(q[0, -p:]) for q in ends.q], dtype=bool)
        return np.asarray(ends.feasible & ~out)

    def _starts(self, random: np.random.Generator) -> Array:
        """Return the best starts (s, k, n + p) of a round: half of the laws' work each.

        Places held while one point is solved, and places that are free there.
        """
        k = self.problem.k
        points = (0, (k - 1) // 2, k - 1)
        found = []
        for problem, places, refined in (
            (self.shared, self.budget.free_places, self.budget.free_refined),
            (self.shared.standing, self.budget.places, self.budget.refined),
        ):
            draw = random.uniform(self.shared.lower, self.shared.upper, (places, 1, problem.n))
            draw = draw[[not self.may.kept_out(q[0, self.problem.n :]) for q in draw]]
            if not len(draw):
                continue
            at = np.resize(points, len(draw))
            ends = solve_many(problem, draw, _ONE_POINT, jobs=self.jobs, points=at)
            self.starts += len(draw)
            self._remember_nearest(ends)
            for point in points:
                minima = distinct(_trusted(ends.take(at == point)))
                found.append(minima.ends.q[: refined // len(points)])
        return np.repeat(np.concatenate(found), k, axis=1)

    def _hops(self, random: np.random.Generator) -> Array:
        """Return starts (s, k, n + p) near known minima: one posture of their paths, disturbed."""
        known, count = self.minima().ends.q, self.budget.hops
        if not len(known) or not count:
            return np.zeros((0, self.problem.k, self.shared.n))
        lower, upper, n = self.shared.lower, self.shared.upper, self.problem.n
        which = np.minimum(random.geometric(_BEST_FIRST, count) - 1, len(known) - 1)
        posture = known[which, random.integers(0, self.problem.k, count)]
        size = np.append(np.full(n, _HOP), _HOP_PLACE * (upper - lower)[n:])
        size[:n] = np.minimum(size[:n], (upper - lower)[:n])
        hopped = np.clip(posture + size * random.standard_normal(posture.shape), lower, upper)
        return np.repeat(hopped[:, None], self.problem.k, axis=1)

    def _remember_nearest(self, ends: Solutions) -> None:
        closest = int(np.argmin(ends.residual))
        if ends.residual[closest] < self.nearest:
            self.nearest = float(ends.residual[closest])
            self.nearest_values = ends.q[closest, 0, self.problem.n :]

    def _refine(self, starts: Array, options: Options) -> Solutions:
        """Refine starts (s, k, n + p), each inside a box around its place that meets no area."""
        rooms: dict[tuple[object, ...], list[int]] = {}
        for i, q in enumerate(starts):
            rooms.setdefault(self.may.room_around(q[0, self.problem.n :]), []).append(i)
        parts, order = [], []
        for room, which in rooms.items():
            shared = share(self.problem, room)  # type: ignore[arg-type]
            parts.append(solve_many(shared, starts[which], options, jobs=self.jobs))
            order += which
        return Solutions.join(parts).take(np.argsort(order))


def _trusted(ends: Solutions) -> Solutions:
    """Return ends of a loose tolerance with those counted that met it."""
    return replace(ends, converged=ends.status == CONVERGED)


def _none(n: int, k: int) -> Solutions:
    nothing = np.zeros(0)
    return Solutions(
        q=np.zeros((0, k, n)),
        objective=nothing,
        residual=nothing,
        feasible=nothing.astype(bool),
        converged=nothing.astype(bool),
        iterations=nothing.astype(np.int64),
        saddle=nothing.astype(bool),
        status=nothing.astype(np.int64),
    )
