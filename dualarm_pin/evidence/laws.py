"""Counts of the two start laws, what they say, and when they suffice.

"Best value hit k times" alone is a bad rule: a worse minimum often draws ten times the starts of
the best. Two different laws must agree, each with enough starts and hits. Statistics of one law
say nothing about paths which that law cannot reach.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.answer.evidence import LawCount
from dualarm_pin.search import anchored, whole_path
from dualarm_pin.search.anchored import AnchoredSearch
from dualarm_pin.search.whole_path import WholePathSearch
from dualarm_pin.solution import Solutions, distinct, same_path
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]
LEAST_STARTS = 300
LEAST_HITS = 3


def count_laws(
    anchored_search: AnchoredSearch, whole_search: WholePathSearch, best: Array
) -> dict[str, LawCount]:
    """Count what the starts of each law came to.

    Args:
        anchored_search: Starts of the anchored law.
        whole_search: Starts of the whole-path law.
        best: The best path (k, n): its basin is what hits are counted for.
    """
    laws = {}
    drawn = anchored_search.starts_by_path()
    if drawn is not None:
        starts, refined, weight = drawn
        laws[anchored.NAME] = count(refined, best, weight=weight, starts=starts)
    if whole_search.ends is not None:
        laws[whole_path.NAME] = count(whole_search.ends, best)
    return laws


def count(
    ends: Solutions,
    best: Array,
    *,
    weight: NDArray[np.int64] | None = None,
    starts: int | None = None,
) -> LawCount:
    """Count the ends of one law.

    Args:
        ends: Where its starts ended.
        best: The best path (k, n).
        weight: How many starts led to each end (s,); None for one each, in their order.
        starts: Starts in all, those included that led to no end; None for the sum of `weight`.
    """
    in_order = weight is None
    weight = np.ones(len(ends), dtype=np.int64) if weight is None else weight
    minima = distinct(ends)
    label = minima.label
    drawn = np.zeros(len(minima), dtype=np.int64)
    np.add.at(drawn, label[label >= 0], weight[label >= 0])
    is_best = np.array([same_path(q, best) for q in minima.ends.q], dtype=bool)
    value = minima.ends.objective
    others = value[~is_best]
    twins = 0
    if is_best.any():
        lowest = float(value[is_best].min())
        level = TOLERANCE.same_objective * max(1.0, abs(lowest))
        twins = int(np.sum(np.abs(others - lowest) < level))
    found = np.flatnonzero((label >= 0) & np.isin(label, np.flatnonzero(is_best)))
    return LawCount(
        starts=int(weight.sum()) if starts is None else starts,
        converged=int(weight[ends.converged].sum()),
        minima=len(minima),
        best_hits=int(drawn[is_best].sum()),
        singletons=int(np.sum(drawn == 1)),
        twins=twins,
        second_best=float(others.min()) if len(others) else None,
        last_improvement=int(found[0]) + 1 if in_order and len(found) else None,
    )


def laws_suffice(laws: dict[str, LawCount]) -> bool:
    """Tell whether both laws made enough starts and hit the best often enough."""
    return len(laws) == 2 and all(
        law.starts >= LEAST_STARTS and law.best_hits >= LEAST_HITS for law in laws.values()
    )


def missed_share(laws: dict[str, LawCount]) -> float | None:
    """Return the share of starts that a better, reachable optimum stays under (95 %).

    Of n starts none hit a better optimum; one that draws more than 1 - 0.05^(1/n), about 3/n, of
    them would have been missed with less than 5 %. The weaker law counts.
    """
    counts = [law.starts for law in laws.values() if law.starts]
    return 1.0 - 0.05 ** (1.0 / min(counts)) if len(counts) == 2 else None
