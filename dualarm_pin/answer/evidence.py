"""Evidence: what is known about an optimum, as it stands in an answer.

What gathers it is in `dualarm_pin.evidence`; these are its records, so that every answer can hold
them and every page can show them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import nan
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from dualarm_pin.tolerance import TOLERANCE

Verdict = Literal["local_only", "best_known", "best_known_bounded"]
Kind = Literal["not_stationary", "saddle", "flat_minimum", "strict_minimum"]
Number = Annotated[float, BeforeValidator(lambda value: nan if value is None else value)]
"""A number that a file writes as null where it is not finite."""
Count = Annotated[int, Field(ge=0, le=2**53)]
SAME_ANSWER = 1e-4  # share of the objective below which two searches found the same
LEAST_SEARCHES = 3
_CONDITION = "valid as far as no piece search missed a minimum"
_WITHOUT = "made without clearance, which can only raise the objective"


@dataclass(frozen=True)
class LawCount:
    """What the starts of one law came to.

    Attributes:
        starts: How many were made.
        converged: How many ended feasible and converged.
        minima: How many distinct minima they found (by joints, then objective).
        best_hits: How many ended in the best minimum of all laws.
        singletons: Minima that one start alone led to.
        twins: Other minima with the objective of the best, such as mirror images.
        second_best: Lowest objective of another minimum; None if there is none.
        last_improvement: Number of the start that first found the best, from 1; None if none did,
            or the law does not number them.
    """

    starts: Count
    converged: Count
    minima: Count
    best_hits: Count
    singletons: Count = 0
    twins: Count = 0
    second_best: float | None = None
    last_improvement: Count | None = None

    @property
    def unseen_share(self) -> float | None:
        """The Good-Turing share of starts that would end in a minimum not seen yet.

        It is about minima of any quality: 1 % unseen is no statement about better ones.
        """
        return self.singletons / self.converged if self.converged else None

    @property
    def expected_better(self) -> float | None:
        """A rough, by experience high, number of better minima that were not seen, at most 1.

        With W minima in N starts, W (N - 1) / (N - W - 2) minima exist in the mean (Boender and
        Rinnooy Kan); if unseen ones are like seen ones, each beats the record with 1 / (W + 1).
        None where N <= W + 2 says nothing.
        """
        found, n = self.minima, self.converged
        if found == 0 or n <= found + 2:
            return None
        exist = found * (n - 1) / (n - found - 2)
        return float(min(1.0, (exist - found) / (found + 1)))


@dataclass(frozen=True)
class LocalCheck:
    """What the neighbourhood of a path says; every figure is recomputed with Pinocchio.

    Attributes:
        objective: Objective of the polished path.
        feasibility: Largest pose residual.
        stationarity: Largest KKT residual, with least-squares multipliers.
        min_multiplier: Smallest multiplier of an active bound; None if none is active.
        active_bounds: Active bounds.
        curvature_min: Smallest eigenvalue of the reduced Hessian on the free directions; None
            if there are none.
        free_directions: Their number.
        sigma_min: Smallest singular value of the free pose Jacobian of any point.
        return_radius: Largest tested shift per point from which all re-solves came back
            [rad]; None if there is none.
        return_share: Share of the re-solves from the largest shift that came back.
        adopted_from_nearby: How often a nearby start found a better path, which became the answer.
        limit_cost: Multipliers summed by joint: what the objective would fall by at first, per
            rad (or m) that its limits give way.
    """

    objective: Number
    feasibility: Number
    stationarity: Number
    min_multiplier: float | None
    active_bounds: Count
    curvature_min: float | None
    free_directions: Count
    sigma_min: Number
    return_radius: float | None
    return_share: Number
    adopted_from_nearby: Count = 0
    limit_cost: Mapping[str, Number] = field(default_factory=dict)

    @property
    def stationary(self) -> bool:
        """Whether the first-order conditions hold."""
        return (
            self.feasibility <= TOLERANCE.position
            and self.stationarity <= TOLERANCE.stationary * max(1.0, abs(self.objective))
            and (self.min_multiplier is None or self.min_multiplier >= -TOLERANCE.stationary)
        )

    @property
    def minimum(self) -> bool:
        """Whether it is stationary and no free direction leads down."""
        return self.stationary and (
            self.curvature_min is None or self.curvature_min >= -TOLERANCE.flat
        )

    @property
    def strict(self) -> bool:
        """Whether it is a minimum and every free direction leads up."""
        return self.minimum and (self.curvature_min is None or self.curvature_min > TOLERANCE.flat)

    @property
    def kind(self) -> Kind:
        """What kind of point it is."""
        if self.strict:
            return "strict_minimum"
        if self.minimum:
            return "flat_minimum"
        return "saddle" if self.stationary else "not_stationary"

    @property
    def near_singular(self) -> bool:
        """Whether some point is nearly singular with its active joints held."""
        return self.sigma_min < TOLERANCE.singular

    @property
    def costliest_joint(self) -> str | None:
        """The joint whose limits cost most; None if no bound is active."""
        name = max(self.limit_cost, key=lambda key: self.limit_cost[key], default=None)
        return name if name is not None and self.limit_cost[name] > 0.0 else None


@dataclass(frozen=True)
class Bound:
    """A lower bound under one condition: no piece search missed a minimum.

    Attributes:
        value: The bound, after the wide search of every piece.
        objective: Objective of the incumbent it is compared with.
        cuts: Points, from 0, where the path was cut; () if it was searched whole.
        starts: Starts of the wide search of each piece.
        hits: How many of them ended at the piece's minimum.
        seconds: Wall time.
        tried: Re-checked value by set of cuts; those that were given up are left out.
        found_better: A better path was found on the way.
        replaced: Objective of the incumbent before that path took its place; None if none did.
        complete: False if Ctrl-C ended it early.
        without_clearance: Objective of the best path known without clearance, where the bound was
            made without it for an answer that keeps one: what has to be kept only raises the
            objective, so the bound holds for the answer too. None otherwise.
    """

    value: Number
    objective: Number
    cuts: tuple[Count, ...]
    starts: tuple[Count, ...]
    hits: tuple[Count, ...]
    seconds: float = 0.0
    tried: Mapping[tuple[Count, ...], float] = field(default_factory=dict)
    found_better: bool = False
    replaced: float | None = None
    complete: bool = True
    without_clearance: float | None = None

    def shifted(self, constant: float) -> Bound:
        """Return the same about an objective that is larger by a constant."""
        without = self.without_clearance
        return replace(
            self,
            value=self.value + constant,
            objective=self.objective + constant,
            tried={cuts: value + constant for cuts, value in self.tried.items()},
            replaced=None if self.replaced is None else self.replaced + constant,
            without_clearance=None if without is None else without + constant,
        )

    @property
    def pieces(self) -> int:
        """Number of pieces."""
        return len(self.cuts) + 1

    @property
    def gap(self) -> float:
        """(objective - value) / objective; negative where the bound is wrong."""
        return (self.objective - self.value) / max(abs(self.objective), 1e-12)

    @property
    def contradicted(self) -> bool:
        """Whether a known path lies below the bound, by more than two solves of it may differ.

        Then a piece search missed a minimum, or the bound is wrong: either way it bounds nothing.
        """
        known = self.objective
        if self.without_clearance is not None:
            known = min(known, self.without_clearance)
        level = TOLERANCE.same_objective * max(1.0, abs(known))
        return self.value > known + level

    @property
    def condition(self) -> str:
        """Under which condition it holds, in words."""
        return _CONDITION if self.without_clearance is None else f"{_CONDITION}; {_WITHOUT}"

    @property
    def beaten(self) -> bool:
        """Whether the better path that was found has not taken the incumbent's place."""
        return self.found_better and self.replaced is None


@dataclass(frozen=True)
class Searches:
    """Tries that shared nothing: their agreement is evidence, that of hops within one is none.

    Attributes:
        kind: Whole searches with starts and hops of their own, or the rounds of starts of one.
        objectives: The lowest objective of each; not finite where it found nothing.
        best: The objective of the answer.
        hops: Moves from paths that were found before; they count for nothing.
    """

    kind: Literal["searches", "rounds"]
    objectives: tuple[Number, ...]
    best: Number
    hops: Count = 0

    @property
    def above(self) -> tuple[float, ...]:
        """By which share of its size each lies above the answer, ascending."""
        size = max(1e-12, abs(self.best))
        return tuple(sorted((value - self.best) / size for value in self.objectives))

    @property
    def hits(self) -> int:
        """How many of them found the answer."""
        return sum(above <= SAME_ANSWER for above in self.above)

    @property
    def agree(self) -> bool:
        """Whether three searches or more, and half of them or more, found the answer."""
        enough = self.hits >= max(LEAST_SEARCHES, 0.5 * len(self.objectives))
        return self.kind == "searches" and enough


@dataclass(frozen=True)
class Evidence:
    """What is known about the optimum; None is what the effort did not cover.

    Attributes:
        verdict: `local_only`, `best_known` or `best_known_bounded`.
        laws: Counts by the name of the start law.
        searches: What searches that shared nothing found.
        missed_share_95: A better optimum that these starts can reach draws less than this share
            of them (95 %).
        laws_agree: Both laws ended at this path; None without two laws.
        stopping_rule: When to stop, in words.
        stopping_rule_met: Whether that is now.
        local: What its neighbourhood says.
        bound: Lower bound of the objective, re-checked, and its condition.
        sentences: All of it in words, one sentence a line.
    """

    verdict: Verdict = "local_only"
    laws: Mapping[str, LawCount] = field(default_factory=dict)
    searches: Searches | None = None
    missed_share_95: float | None = None
    laws_agree: bool | None = None
    stopping_rule: str = ""
    stopping_rule_met: bool | None = None
    local: LocalCheck | None = None
    bound: Bound | None = None
    sentences: str = ""

    @property
    def lower_bound(self) -> float | None:
        """Estimated lower bound of the objective."""
        return None if self.bound is None else self.bound.value

    @property
    def gap(self) -> float | None:
        """(objective - lower bound) / objective; negative where the bound is wrong."""
        return None if self.bound is None else self.bound.gap
