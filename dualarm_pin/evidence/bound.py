"""An estimate of a lower bound: the sum of the minima of pieces of the path, and its condition.

For any multipliers the pieces' minima sum to no more than the objective of any path (see
`pieces`); the multipliers are raised by cutting planes (`bundle`). The sum is a bound only as far
as each piece's minimum is right, and that is searched, not proven: a search that misses one makes
the sum too high. So every piece is searched anew, widely, and only that value is returned.
"""

from __future__ import annotations

import time
from dataclasses import replace

from dualarm_pin.answer.evidence import Bound, LocalCheck
from dualarm_pin.arrays import Array
from dualarm_pin.evidence.ascent import Ascent, BoundOptions
from dualarm_pin.evidence.check import check_minimum
from dualarm_pin.evidence.pieces import Cuts, cut_sets
from dualarm_pin.problem import Problem
from dualarm_pin.progress import SILENT, Progress


def lower_bound(
    problem: Problem,
    q: Array,
    *,
    seed: int,
    jobs: int | None = None,
    progress: Progress = SILENT,
    options: BoundOptions | None = None,
) -> tuple[Bound | None, Array | None]:
    """Estimate a lower bound of the objective over all paths.

    Args:
        problem: The problem.
        q: The incumbent (k, n), feasible.
        seed: Seed of the searches: the same bound for any number of threads.
        jobs: Threads; None takes the processors there are.
        progress: Told where the work stands.
        options: How far to go.

    Returns:
        The highest re-checked value of the sets of cuts that were tried, None if Ctrl-C came
        before the first re-check; a better path (k, n) found on the way, polished, or None.
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
                best = result
            if best.gap < options.enough and min(best.hits) >= options.search.hits:
                break
        complete = True
    except KeyboardInterrupt:
        complete = False
    if best is None:
        return None, better
    bound = replace(
        best,
        objective=incumbent,
        seconds=time.perf_counter() - begun,
        tried=tried,
        found_better=better is not None,
        complete=complete,
    )
    return bound, better


def bound_minimum(
    problem: Problem,
    q: Array,
    local: LocalCheck,
    *,
    seed: int,
    jobs: int | None = None,
    progress: Progress = SILENT,
    options: BoundOptions | None = None,
) -> tuple[Array, LocalCheck, Bound | None]:
    """Bound a checked path, and put the better one in its place if the bound finds one.

    Args:
        problem: The problem.
        q: The incumbent (k, n).
        local: Its check.
        seed: Seed of the searches.
        jobs: Threads; None takes the processors there are.
        progress: Told where the work stands.
        options: How far to go.

    Returns:
        The path (k, n) that is now best, its check, and the bound, if Ctrl-C left one.
    """
    bound, better = lower_bound(
        problem, q, seed=seed, jobs=jobs, progress=progress, options=options
    )
    if bound is None or better is None:
        return q, local, bound
    q, local = check_minimum(problem, better, seed=seed, jobs=jobs)
    return q, local, replace(bound, objective=local.objective, replaced=bound.objective)
