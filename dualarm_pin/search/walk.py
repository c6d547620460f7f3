"""Walk: from a posture at one point through the whole path, one point at a time.

Each point is solved alone, linked to the neighbour just solved, from where the last step points
to. A few iterations a point: a whole path costs little more than one iteration on all of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.problem import Problem
from dualarm_pin.solvers import interior_point as engine

Array = NDArray[np.float64]
_AHEAD = 0.7  # share of the last step that the next is expected to repeat
_TOLERANCE, _ITERATIONS, _MU = 1e-4, 25, 1e-3  # a step is only a guess of what is refined later


def walk(
    problem: Problem, at: ArrayLike, postures: Array, *, jobs: int | None = None
) -> tuple[Array, int]:
    """Walk from postures (s, n), each at a point of its own, to both ends of the path.

    Returns:
        Paths (s, k, n), not yet minima, and the work: points times iterations.
    """
    points = np.asarray(at, dtype=np.int64)
    paths = np.zeros((len(postures), problem.k, problem.n))
    paths[np.arange(len(points)), points] = postures
    work = 0
    for step in (1, -1):
        for i in range(problem.k) if step > 0 else range(problem.k - 1, -1, -1):
            moving = np.flatnonzero(points < i if step > 0 else points > i)
            if len(moving):
                work += _one_step(problem, paths, points, moving, i, step, jobs)
    return paths, work


def _one_step(
    problem: Problem,
    paths: Array,
    points: NDArray[np.int64],
    moving: NDArray[np.int64],
    i: int,
    step: int,
    jobs: int | None,
) -> int:
    from dualarm_pin.engine.solve import Options

    before = paths[moving, i - step]
    further = np.abs(points[moving] - i) >= 2
    last = np.where(further[:, None], before - paths[moving, (i - 2 * step) % problem.k], 0.0)
    start = np.clip(before + _AHEAD * last, problem.lower, problem.upper)
    neighbours = np.stack([before, before], axis=1)
    ends = engine.solve_many(
        problem,
        start[:, None],
        jobs=jobs,
        points=np.full(len(moving), i),
        neighbours=neighbours,
        linked=(step > 0, step < 0),
        options=Options(_TOLERANCE, _ITERATIONS, _MU, _MU),
    )
    paths[moving, i] = np.where(ends.ran[:, None], ends.q[:, 0], before)
    if ends.interrupted:
        raise KeyboardInterrupt
    return int(ends.iterations.sum())
