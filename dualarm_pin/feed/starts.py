"""Starts of a search for speed: postures that reach the path, smoothed along it, ranked by speed.

Postures are taken as they fall: a small index means a large lever for forces and a slow tool.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from dualarm_pin.arrays import Array
from dualarm_pin.feed.slowness import Slowness
from dualarm_pin.motion.limits import Limits
from dualarm_pin.problem import Problem
from dualarm_pin.search.anchored import anchor_points
from dualarm_pin.search.coarse import coarse_of
from dualarm_pin.search.starts import generator
from dualarm_pin.search.turns import Turns
from dualarm_pin.solvers import interior_point as engine
from dualarm_pin.task import Task
from dualarm_pin.tolerance import TOLERANCE

LAMBDA = 1e4  # of the links: the fourth powers then come near the largest step, which is the speed
_INDEX = 1e-3  # weight of the index: it only chooses where speed does not care
_KEPT = 40  # paths that are refined on all points, by their speed
_DISTINCT = 1e-4  # share by which the speeds of distinct paths differ
_NEAR, _ROUGH = 1e-3, 1e-4  # residual of a posture that reaches its point, and of a coarse path


def speed_problem(task: Task, limits: Limits, smoothness: float = LAMBDA) -> Problem:
    """Return the programme whose links stand for time: metric 1 / speed^2, lambda by arc length."""
    pace = np.mean(limits.velocity) / limits.velocity
    if "acceleration" in limits.kinds:
        # A joint that is slow to change its speed counts as slower than its limit says.
        reach = limits.acceleration / limits.velocity
        pace = pace * np.sqrt(np.maximum(1.0, np.median(reach) / reach))
    timed = replace(task, metric=pace**2, per_arc_length=True, smoothness=smoothness)
    problem = timed.problem()
    return problem.with_points(index_weight=_INDEX / problem.size * problem.points.index_weight)


def fast_paths(
    task: Task, limits: Limits, starts: int, *, seed: int, jobs: int | None = None
) -> Array:
    """Return paths (p, h, n) on the path, the fastest first; none where none reaches every point.

    Args:
        task: Cell and path.
        limits: What the joints can do.
        starts: Postures drawn.
        seed: Of the draw.
        jobs: Threads.

    Raises:
        KeyboardInterrupt: Ctrl-C.
    """
    from dualarm_pin.engine.solve import Options

    problem = speed_problem(task, limits)
    anchors = anchor_points(problem.k)
    count = -(-starts // len(anchors))
    turns = Turns(problem)
    shape = (count * len(anchors), problem.n)
    drawn = generator(seed, 80).uniform(turns.lower, turns.upper, shape)
    bare = problem.with_points(index_weight=0.0 * problem.points.index_weight)
    alone = engine.solve_many(
        bare,
        drawn[:, None],
        points=np.repeat(anchors, count),
        jobs=jobs,
        options=Options(_ROUGH, 60, 1e-3, 1e-3),
    )
    reached = turns.folded(alone.q[alone.residual < _NEAR])
    coarse = coarse_of(problem)
    tiled = np.repeat(reached, coarse.problem.k, axis=1)
    if not len(tiled):
        return np.zeros((0, problem.k, problem.n))
    ends = engine.solve_many(
        coarse.problem, tiled, jobs=jobs, options=Options(_ROUGH, 100, 1e-2, 1e-2)
    )
    paths = ends.q[ends.residual < _ROUGH]
    place = _places(task)
    paths = fastest(paths, Slowness(place[coarse.points], limits), _KEPT)
    whole = np.array(
        [CubicSpline(place[coarse.points], q, bc_type="natural")(place) for q in paths]
    ).reshape(len(paths), problem.k, problem.n)
    ends = engine.solve_many(problem, whole, jobs=jobs, options=Options(1e-6, 100, 1e-2, 1e-3))
    if ends.interrupted or alone.interrupted:
        raise KeyboardInterrupt
    return fastest(ends.q[ends.residual < TOLERANCE.position], Slowness(place, limits), _KEPT)


def fastest(paths: Array, slowness: Slowness, most: int) -> Array:
    """Return the fastest distinct of paths (p, h, n), the best first, at most so many."""
    if not len(paths):
        return paths
    slow = slowness.of_paths(paths)
    order = np.argsort(slow, kind="stable")
    new = np.append(True, np.diff(slow[order]) > _DISTINCT * slow[order][:-1])
    chosen: Array = paths[order[new][:most]]
    return chosen


def _places(task: Task) -> Array:
    from dualarm_pin.motion.relative_path import RelativePath

    return RelativePath(task.path).place
