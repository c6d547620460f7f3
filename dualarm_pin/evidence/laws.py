"""Counts of the two start laws, and when they suffice.

"Best value hit k times" alone is a bad rule: a worse minimum often draws ten times the starts of
the best. Two different laws must agree, each with enough starts and hits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.multistart import anchored, whole
from dualarm_pin.multistart.anchored import AnchoredSearch
from dualarm_pin.multistart.whole import WholePathSearch
from dualarm_pin.solvers.ends import distinct, same_path
from dualarm_pin.trajectory import LawCount

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
        starts, ends, weight = drawn
        hit = [
            bool(ok) and same_path(q, best) for q, ok in zip(ends.q, ends.converged, strict=True)
        ]
        laws[anchored.NAME] = LawCount(
            starts=starts,
            converged=int(weight[ends.converged].sum()),
            minima=len(distinct(ends)),
            best_hits=int(weight[hit].sum()),
        )
    ends = whole_search.ends
    if ends is not None:
        minima = distinct(ends)
        hits = [
            int(count)
            for q, count in zip(minima.ends.q, minima.hits, strict=True)
            if same_path(q, best)
        ]
        laws[whole.NAME] = LawCount(
            starts=len(ends),
            converged=int(ends.converged.sum()),
            minima=len(minima),
            best_hits=sum(hits),
        )
    return laws


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
