"""An estimate of a lower bound: the sum of the minima of pieces of the path, and its condition.

For any multipliers the pieces' minima sum to no more than the objective of any path (see
`pieces`); the multipliers are raised by cutting planes (`bundle`). The sum is a bound only as far
as each piece's minimum is right, and that is searched, not proven: a search that misses one makes
the sum too high. So every piece is searched anew, widely, and only that value is returned.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.evidence.ascent import Ascent, BoundOptions
from dualarm_pin.evidence.check import LocalCheck, check_minimum
from dualarm_pin.evidence.pieces import Cuts, cut_sets
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
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
        better: A better path (k, n) found on the way, polished; None if there was none.
        replaced: Objective of the incumbent before a better path took its place; None if none did.
        complete: False if Ctrl-C ended it early.
    """

    value: float
    objective: float
    cuts: Cuts
    starts: tuple[int, ...]
    hits: tuple[int, ...]
    seconds: float = 0.0
    tried: dict[Cuts, float] = field(default_factory=dict)
    better: Array | None = None
    replaced: float | None = None
    complete: bool = True

    @property
    def pieces(self) -> int:
        """Number of pieces."""
        return len(self.cuts) + 1

    @property
    def gap(self) -> float:
        """(objective - value) / objective."""
        return max(0.0, self.objective - self.value) / max(abs(self.objective), 1e-12)

    def against(self, objective: float) -> Bound:
        """Return the same bound compared with the better path that it found."""
        return replace(self, objective=objective, better=None, replaced=self.objective)


def lower_bound(
    problem: Problem,
    q: Array,
    *,
    seed: int,
    jobs: int | None = None,
    progress: Progress = SILENT,
    options: BoundOptions | None = None,
) -> Bound | None:
    """Estimate a lower bound of the objective over all paths.

    Args:
        problem: The problem.
        q: The incumbent (k, n), feasible.
        seed: Seed of the searches: the same bound for any number of threads.
        jobs: Threads; None takes the processors there are.
        progress: Told where the work stands.
        options: How far to go.

    Returns:
        The highest re-checked value of the sets of cuts that were tried. None if Ctrl-C came
        before the first re-check.
    """
    options = options or BoundOptions()
    begun = time.perf_counter()
    incumbent = problem.objective(q)
    better: Array | None = None
    best: Bound | None = None
    tried: dict[Cuts, float] = {}
    try:
        sets = cut_sets(problem)
        for cuts in sets:
            progress.stage(f"lower bound, {len(cuts) + 1} pieces")
            known = [q] if better is None else [better, q]
            ascent = Ascent(problem, known, cuts, seed=seed, jobs=jobs, options=options)
            result = ascent.run(progress, may_give_up=best is not None or cuts != sets[-1])
            better = better if ascent.better is None else ascent.better
            if result is None:
                continue
            tried[cuts] = result.value
            if best is None or result.value > best.value:
                best = Bound(result.value, ascent.objective, cuts, result.starts, result.hits)
            if best.gap < options.enough and min(best.hits) >= options.search.hits:
                break
        complete = True
    except KeyboardInterrupt:
        complete = False
    if best is None:
        return None
    return replace(
        best,
        objective=incumbent,
        seconds=time.perf_counter() - begun,
        tried=tried,
        better=better,
        complete=complete,
    )


def bound_minimum(
    problem: Problem,
    local: LocalCheck,
    *,
    seed: int,
    jobs: int | None = None,
    progress: Progress = SILENT,
    options: BoundOptions | None = None,
) -> tuple[LocalCheck, Bound | None]:
    """Bound a checked path, and put the better one in its place if the bound finds one.

    Args:
        problem: The problem.
        local: The check of the incumbent.
        seed: Seed of the searches.
        jobs: Threads; None takes the processors there are.
        progress: Told where the work stands.
        options: How far to go.

    Returns:
        The check of the path that is now best, and the bound, if Ctrl-C left one.
    """
    bound = lower_bound(problem, local.q, seed=seed, jobs=jobs, progress=progress, options=options)
    if bound is None or bound.better is None:
        return local, bound
    local = check_minimum(problem, bound.better, seed=seed, jobs=jobs)
    return local, bound.against(local.objective)
