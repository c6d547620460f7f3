"""Evidence for a path that came from anywhere: the local check and, if asked, the bound."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from dualarm_pin.answer.evidence import Evidence
from dualarm_pin.errors import ShapeError
from dualarm_pin.evidence.bound import bound_minimum
from dualarm_pin.evidence.check import check_minimum
from dualarm_pin.evidence.verdict import Findings, conclude
from dualarm_pin.progress import SILENT, Progress

if TYPE_CHECKING:
    from dualarm_pin.problem import Problem


def examine(
    problem: Problem,
    q: ArrayLike,
    *,
    bound: bool = False,
    seed: int = 0,
    jobs: int | None = None,
    progress: Progress = SILENT,
) -> Evidence:
    """Say what is known about a path, without any starts of the laws.

    Args:
        problem: The problem, such as `task.problem()`.
        q: A path (k, n), nearly a minimum [rad or m].
        bound: Compute the lower bound too.
        seed: Seed of the searches.
        jobs: Threads; None takes the processors there are.
        progress: Told where the work stands.

    Returns:
        The evidence of the polished path, or of a better one found on the way.

    Raises:
        ShapeError: q has another shape.
    """
    path = np.array(q, dtype=float)
    if path.shape != (problem.k, problem.n):
        raise ShapeError(f"expected shape {(problem.k, problem.n)}, given {path.shape}", field="q")
    path, local = check_minimum(problem, path, seed=seed, jobs=jobs)
    found = None
    if bound:
        _, local, found = bound_minimum(
            problem, path, local, seed=seed, jobs=jobs, progress=progress
        )
    return conclude(Findings(local=local, bound=found))
