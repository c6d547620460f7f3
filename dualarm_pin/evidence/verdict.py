"""From findings to the evidence of a result: the verdict, the figures, three sentences.

A sentence never says more than was checked, and a bound is never named without its condition.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dualarm_pin.answer.evidence import Bound, Evidence, LawCount, LocalCheck, Searches, Verdict
from dualarm_pin.evidence import sentences
from dualarm_pin.evidence.laws import LEAST_HITS, laws_suffice, missed_share

if TYPE_CHECKING:
    from dualarm_pin.answer.trajectory import Trajectory

CLOSED_GAP = 1e-3  # a bound this near says that no better path is worth a search


@dataclass(frozen=True)
class Findings:
    """What was found out about one path.

    Attributes:
        local: Its local check.
        laws: Counts by the name of the start law.
        agree: Two laws at least ended at this path.
        bound: The lower bound, if it was asked for.
        searches: What searches that shared nothing found.
    """

    local: LocalCheck
    laws: dict[str, LawCount] = field(default_factory=dict)
    agree: bool = False
    bound: Bound | None = None
    searches: Searches | None = None

    def shifted(self, constant: float) -> Findings:
        """Return the same about an objective that is larger by a constant."""
        if constant == 0.0:
            return self
        local, bound, found = self.local, self.bound, self.searches
        laws = {
            name: replace(law, second_best=law.second_best and law.second_best + constant)
            for name, law in self.laws.items()
        }
        return replace(
            self,
            local=replace(local, objective=local.objective + constant),
            laws=laws,
            bound=bound and bound.shifted(constant),
            searches=found
            and replace(
                found,
                objectives=tuple(value + constant for value in found.objectives),
                best=found.best + constant,
            ),
        )

    @property
    def starts_suffice(self) -> bool:
        """Whether independent searches agree, or two laws with enough starts and hits."""
        together = self.searches is not None and self.searches.agree
        return together or (self.agree and laws_suffice(self.laws))

    @property
    def bound_closes(self) -> bool:
        """Whether the gap is under 0.1 % and every piece's minimum was hit often enough.

        A bound above the path itself is wrong: it closes nothing.
        """
        bound = self.bound
        return (
            bound is not None
            and bound.complete
            and not bound.beaten
            and not bound.contradicted
            and bound.gap < CLOSED_GAP
            and min(bound.hits) >= LEAST_HITS
        )


def verdict(findings: Findings) -> Verdict:
    """Return `local_only`, `best_known` or `best_known_bounded`."""
    if not findings.local.minimum or not findings.starts_suffice:
        return "local_only"
    return "best_known_bounded" if findings.bound_closes else "best_known"


def with_bound_without_clearance(answer: Trajectory, found: Bound) -> Evidence:
    """Return the evidence of an answer that keeps a clearance, with a bound made without one."""
    free = min(found.objective, answer.objective)
    bound = replace(found, objective=answer.objective, without_clearance=free)
    first, *rest = answer.evidence.sentences.split("\n")  # the first says where it comes from
    text = [first, sentences.bound(bound, CLOSED_GAP), *rest]
    return replace(answer.evidence, bound=bound, sentences="\n".join(text))


def conclude(findings: Findings) -> Evidence:
    """Return the evidence of a result, a sentence a line: what matters most in the first two."""
    local, bound, laws = findings.local, findings.bound, findings.laws
    met = findings.starts_suffice and (
        bound is None or (bound.gap < CLOSED_GAP and not bound.contradicted)
    )
    missed = missed_share(laws)
    found = findings.searches
    checked = sentences.local(local)
    text = [
        sentences.starts(laws, findings.agree, missed) if found is None else sentences.tries(found),
        *([checked] if bound is None else [sentences.bound(bound, CLOSED_GAP), checked]),
        *([] if found is None else [sentences.starts(laws, findings.agree, missed)]),
        *([sentences.stopping(met)] if bound is None else []),
    ]
    return Evidence(
        verdict=verdict(findings),
        laws=dict(laws),
        searches=found,
        missed_share_95=missed,
        laws_agree=findings.agree if len(laws) >= 2 else None,
        stopping_rule=sentences.STOPPING_RULE,
        stopping_rule_met=met,
        local=local,
        bound=bound,
        sentences="\n".join(text),
    )
