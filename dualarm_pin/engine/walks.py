"""Walks in Python: many paths, each followed from one posture of one point, over threads."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.arrays import checked
from dualarm_pin.chain import Floats, Integers
from dualarm_pin.engine import entries
from dualarm_pin.engine.batch import usable_cores
from dualarm_pin.engine.interior_point.walk import LOST
from dualarm_pin.engine.options import Options
from dualarm_pin.engine.room import own_window, workspace_for
from dualarm_pin.errors import InputError
from dualarm_pin.problem import Problem

STEP = Options(tolerance=1e-4, iterations=25, mu0=1e-3, push=1e-3)  # a walk is refined afterwards
_CHUNKS_PER_JOB = 4
_FEW = 200  # points in all: done sooner than threads are started


@dataclass(frozen=True, eq=False)
class Walked:
    """What walks came to.

    Attributes:
        q: Paths (s, w, n), not yet minima; behind a point that was not reached, nothing.
        reached: Whether every point was (s,).
        steps: Newton steps of one point, of all walks together.
        interrupted: Ctrl-C came before all were walked.
    """

    q: Floats
    reached: NDArray[np.bool_]
    steps: int
    interrupted: bool = False


def walk_many(
    problem: Problem,
    postures: ArrayLike,
    at: ArrayLike,
    *,
    jobs: int | None = None,
    first: ArrayLike = 0,
    points: int | None = None,
    scale: ArrayLike = 1.0,
    options: Options | None = None,
) -> Walked:
    """Walk from postures forwards and backwards; the result does not depend on the threads.

    Args:
        problem: The problem of the whole path; fixed neighbours do not count.
        postures: (s, n), each at a point of its own.
        at: (s,) that point, counted on the path.
        jobs: Threads; the number of usable cores if None.
        first: (s,) or one number: first point of every walk.
        points: How many points a walk has; all by default.
        scale: (s,) or one number: factor on the weight of the links while walking.
        options: Of the solve of each point; `STEP` by default.

    Raises:
        ShapeError: An array has another shape.
        InputError: A walk leaves the path, or does not hold its own point.
    """
    n, w = problem.n, problem.k if points is None else points
    s = len(np.asarray(at))
    given = checked("postures", postures, (s, n))
    begin = np.array(np.broadcast_to(np.asarray(first, dtype=np.int64), (s,)))
    anchor = np.asarray(at, dtype=np.int64) - begin
    inside = (begin >= 0) & (begin + w <= problem.k) & (anchor >= 0) & (anchor < w)
    if not inside.all():
        raise InputError(f"a walk of {w} points leaves the path of {problem.k}", field="first")
    q = np.zeros((s, w, n))
    q[np.arange(s), anchor] = given
    codes, values = np.zeros((s, 3), dtype=np.int64), np.full((s, 4), np.inf)
    scales = checked("scale", scale, (s,))
    interrupt = np.zeros(1, dtype=np.int64)
    path, settings = problem.scaled(), (options or STEP).settings()

    def walk(items: Integers) -> None:
        one = own_window(path, 1)
        entries.solve_items(
            one,
            workspace_for(one, path),
            settings,
            False,
            items,
            one.neighbours.posture[None],
            interrupt,
            q,
            codes,
            values,
            np.full(1, np.inf),
            path,
            begin,
            anchor,
            scales,
        )

    threads = jobs or usable_cores()
    if s * w <= _FEW or threads == 1:
        walk(np.arange(s))
    else:
        with ThreadPoolExecutor(threads) as pool:
            try:
                list(pool.map(walk, np.array_split(np.arange(s), threads * _CHUNKS_PER_JOB)))
            except KeyboardInterrupt:
                interrupt[0] = 1
    return Walked(q, values[:, 1] <= LOST, int(codes[:, 1].sum()), bool(interrupt[0]))
