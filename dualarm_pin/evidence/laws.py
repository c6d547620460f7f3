"""Counts of the start laws, what they say, and when they suffice.

"Best value hit k times" alone is a bad rule: a worse minimum often draws ten times the starts of
the best. Two different laws must agree, each with enough starts and hits. Statistics of one law
say nothing about paths which that law cannot reach.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dualarm_pin.answer.evidence import LawCount
from dualarm_pin.arrays import Array
from dualarm_pin.search.law import Counted, Drawn
from dualarm_pin.solution import distinct, same_path
from dualarm_pin.tolerance import TOLERANCE

# On the paper's path, 400 simulated runs of each law: right in 87 % (whole path) and 94 to 100 %
# (anchored); 3 hits alone are right in 18 to 53 %.
LEAST_STARTS = 300
LEAST_HITS = 3


def count_laws(laws: Sequence[Counted], best: Array) -> dict[str, LawCount]:
    """Count what the starts of each law that made some came to, for the basin of `best` (k, n)."""
    drawn = {law.name: law.drawn() for law in laws}
    return {name: count(each, best) for name, each in drawn.items() if each is not None}


def count(drawn: Drawn, best: Array) -> LawCount:
    """Count the ends of one law.

    Args:
        drawn: Where its starts ended.
        best: The best path (k, n): its basin is what hits are counted for.
    """
    ends, weight = drawn.ends, drawn.weight
    in_order = weight is None
    weight = np.ones(len(ends), dtype=np.int64) if weight is None else weight
    minima = distinct(ends)
    label = minima.label
    hits = np.zeros(len(minima), dtype=np.int64)
    np.add.at(hits, label[label >= 0], weight[label >= 0])
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
        starts=drawn.starts,
        converged=int(weight[ends.converged].sum()),
        minima=len(minima),
        best_hits=int(hits[is_best].sum()),
        singletons=int(np.sum(hits == 1)),
        twins=twins,
        second_best=float(others.min()) if len(others) else None,
        last_improvement=int(found[0]) + 1 if in_order and len(found) else None,
    )


def laws_suffice(laws: dict[str, LawCount]) -> bool:
    """Tell whether two laws made enough starts and hit the best often enough."""
    enough = [law.starts >= LEAST_STARTS and law.best_hits >= LEAST_HITS for law in laws.values()]
    return sum(enough) >= 2


def missed_share(laws: dict[str, LawCount]) -> float | None:
    """Return the share of starts that a better, reachable optimum stays under (95 %).

    Of n starts none hit a better optimum; one that draws more than 1 - 0.05^(1/n), about 3/n, of
    them would have been missed with less than 5 %. The weaker of the two largest laws counts.
    """
    counts = sorted(law.starts for law in laws.values() if law.starts)
    return 1.0 - 0.05 ** (1.0 / counts[-2]) if len(counts) >= 2 else None
