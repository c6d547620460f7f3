"""From findings to the evidence of a result: the verdict, the figures, three sentences.

A sentence never says more than was checked, and a bound is never named without its condition.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from dualarm_pin.answer.trajectory import Evidence, LawCount
from dualarm_pin.evidence import sentences
from dualarm_pin.evidence.bound import Bound
from dualarm_pin.evidence.check import LocalCheck
from dualarm_pin.evidence.laws import (
    LEAST_HITS,
    expected_better,
    laws_suffice,
    missed_share,
    unseen_share,
)

CLOSED_GAP = 1e-3


@dataclass(frozen=True)
class Findings:
    """What was found out about one path.

    Attributes:
        local: Its local check.
        laws: Counts by the name of the start law.
        agree: Every law ended at this path at least once.
        bound: The lower bound, if it was asked for.
    """

    local: LocalCheck
    laws: dict[str, LawCount] = field(default_factory=dict)
    agree: bool = False
    bound: Bound | None = None

    @property
    def starts_suffice(self) -> bool:
        """Whether both laws agree, each with enough starts and hits."""
        return self.agree and laws_suffice(self.laws)

    @property
    def bound_closes(self) -> bool:
        """Whether the gap is under 0.1 % and every piece's minimum was hit often enough."""
        bound = self.bound
        return (
            bound is not None
            and bound.complete
            and bound.better is None
            and bound.gap < CLOSED_GAP
            and min(bound.hits) >= LEAST_HITS
        )


def verdict(findings: Findings) -> str:
    """Return `local_only`, `best_known` or `best_known_bounded`."""
    if not findings.local.minimum or not findings.starts_suffice:
        return "local_only"
    return "best_known_bounded" if findings.bound_closes else "best_known"


def conclude(findings: Findings) -> tuple[Evidence, str]:
    """Return the evidence of a result, and three sentences on lines of their own."""
    local, bound = findings.local, findings.bound
    evidence = Evidence(
        verdict=verdict(findings),
        laws=dict(findings.laws),
        missed_share_95=missed_share(findings.laws),
        stationarity=local.stationarity,
        curvature_min=local.curvature_min,
        active_bounds=local.n_active,
        lower_bound=None if bound is None else bound.value,
        gap=None if bound is None else bound.gap,
        details=_local_details(local) | _start_details(findings) | _bound_details(bound),
    )
    text = (
        sentences.starts(findings.laws, findings.agree, evidence.missed_share_95),
        sentences.stopping(_rule_met(findings))
        if bound is None
        else sentences.bound(bound, CLOSED_GAP),
        sentences.local(local),
    )
    return evidence, "\n".join(text)


def _rule_met(findings: Findings) -> bool:
    return findings.starts_suffice and (findings.bound is None or findings.bound.gap < CLOSED_GAP)


def _local_details(local: LocalCheck) -> dict[str, Any]:
    kind = "not_stationary"
    if local.strict:
        kind = "strict_minimum"
    elif local.minimum:
        kind = "flat_minimum"
    elif local.stationary:
        kind = "saddle"
    return {
        "local": kind,
        "objective": local.objective,
        "feasibility": local.feasibility,
        "min_multiplier": local.min_multiplier,
        "free_directions": local.free_directions,
        "sigma_min": local.sigma_min,
        "near_singular": local.near_singular,
        "return_radius": local.return_radius,
        "return_share": local.return_share,
        "adopted_from_nearby": local.adopted,
        "limit_cost": dict(local.limit_cost),
        "costliest_joint": local.costliest_joint,
    }


def _start_details(findings: Findings) -> dict[str, Any]:
    laws = findings.laws
    return {
        "laws_agree": findings.agree if len(laws) == 2 else None,
        "unseen_share": {name: unseen_share(law) for name, law in laws.items()},
        "expected_better": {name: expected_better(law) for name, law in laws.items()},
        "stopping_rule": sentences.STOPPING_RULE,
        "stopping_rule_met": _rule_met(findings),
    }


def _bound_details(bound: Bound | None) -> dict[str, Any]:
    if bound is None:
        return {"bound_pieces": None, "piece_starts": None, "piece_hits": None}
    return {
        "bound_pieces": bound.pieces,
        "bound_cuts": [cut + 1 for cut in bound.cuts],
        "bound_condition": sentences.CONDITION,
        "bound_seconds": bound.seconds,
        "bound_complete": bound.complete,
        "bound_tried": [
            {"cuts": [cut + 1 for cut in cuts], "bound": value}
            for cuts, value in bound.tried.items()
        ],
        "bound_found_better": bound.better is not None or bound.replaced is not None,
        "bound_replaced": bound.replaced,
        "piece_starts": list(bound.starts),
        "piece_hits": list(bound.hits),
    }
