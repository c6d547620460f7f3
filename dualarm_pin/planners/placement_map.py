"""The best objective known over two coordinates of base 2: what a placement leaves on the table."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.placement.asked import Asked
from dualarm_pin.placement.parameters import BASE, Free, moved_base
from dualarm_pin.planners.placement import Placement
from dualarm_pin.progress import SILENT, Progress
from dualarm_pin.solution import distinct

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Array = NDArray[np.float64]
_REACH = 0.5  # m on each side of the place found, for a coordinate that was not free
_DRAWN, _ANCHORED = 100, 4  # postures drawn at one point of every place; best of them refined
_POOL = 4  # minima of the search from which every place is tried, beside its neighbours


@dataclass(frozen=True, eq=False)
class PlaceMap:
    """The best motion known at every place of a grid, all else as at the place found.

    Attributes:
        axes: The two coordinates of base 2, such as ("x", "z").
        first: Values of the first in the world (a,) [m].
        second: Values of the second (b,) [m].
        objective: (b, a); nan where no start reached the whole path, or base 2 is kept out.
        clearance: (b, a) smallest distance on that motion [m], negative in collision; nan where
            it is not known.
        kept_out: (b, a) inside an area that is kept free.
        best: The place found (2,).
    """

    axes: tuple[str, str]
    first: Array
    second: Array
    objective: Array
    clearance: Array
    kept_out: NDArray[np.bool_]
    best: tuple[float, float]


def maps_around(
    task: Task,
    found: Placement,
    *,
    columns: int,
    jobs: int | None = None,
    progress: Progress = SILENT,
) -> tuple[PlaceMap, ...]:
    """Return maps over x, y and over x, z through the place found; none where arm 2 has no base.

    Args:
        task: The task as it was asked.
        found: What the search came to.
        columns: Columns of each map; 0 for no map.
        jobs: Threads.
        progress: Told where the work stands.
    """
    may = task.placement
    if columns < 2 or may is None or not found.places:
        return ()
    if not any(name.startswith(f"{BASE}.") for name in may.names):
        return ()
    pairs = (("x", "y"), ("x", "z"))
    return tuple(_map(task, found, may, axes, columns, jobs, progress) for axes in pairs)


def _map(
    task: Task,
    found: Placement,
    may: Asked,
    axes: tuple[str, str],
    columns: int,
    jobs: int | None,
    progress: Progress,
) -> PlaceMap:
    from dualarm_pin.engine.interior_point.solve_one import CONVERGED
    from dualarm_pin.engine.solve import Options, solve_many
    from dualarm_pin.placement.shared import placed

    moved, here = found.task, found.task.cell.arms[1].base
    boxes = {each.name: each for each in may.free}
    grids = [_line(boxes.get(f"{BASE}.{axis}"), task, here, axis, columns) for axis in axes]
    free = tuple(Free(f"{BASE}.{axis}", -1.0, 1.0) for axis in sorted(axes))
    at = [float(here.translation["xyz".index(axis)]) for axis in axes]
    problem = placed(moved.problem(), free, np.zeros(2))
    shape = (len(grids[1]), len(grids[0]))
    objective, clearance = np.full(shape, np.nan), np.full(shape, np.nan)
    kept_out = np.zeros(shape, dtype=bool)
    joints: dict[tuple[int, int], Array] = {}
    draw = np.random.default_rng(0).uniform(problem.lower, problem.upper, (_DRAWN, 1, problem.n))
    rough = Options(tolerance=1e-4, iterations=60)
    middle = np.full(_DRAWN, (problem.k - 1) // 2)
    pool = [place.q for place in found.places[:_POOL]]
    cells = [(b, a) for b in range(shape[0]) for a in range(shape[1])]
    cells.sort(key=lambda c: np.hypot(grids[1][c[0]] - at[1], grids[0][c[1]] - at[0]))
    progress.stage(f"map over {axes[0]} and {axes[1]}", len(cells))
    for b, a in cells:
        progress.advance()
        shift = np.array([grids[0][a] - at[0], grids[1][b] - at[1]])
        kept_out[b, a] = _kept_out(may, here, axes, shift)
        if kept_out[b, a]:
            continue
        problem.chain.parameters[:] = shift
        near = [joints[c] for c in ((b, a - 1), (b, a + 1), (b - 1, a), (b + 1, a)) if c in joints]
        single = solve_many(problem, draw, rough, jobs=jobs, points=middle)
        minima = distinct(replace(single, converged=single.status == CONVERGED)).ends.q
        anchored = np.repeat(minima[:_ANCHORED], problem.k, axis=1)
        starts = np.array([*near, *pool, *anchored])
        ends = solve_many(problem, starts, Options(iterations=80, mu0=1e-2), jobs=jobs)
        value = np.where(ends.converged, ends.objective, np.inf)
        best = int(np.argmin(value))
        if np.isfinite(value[best]):
            objective[b, a], joints[b, a] = value[best], ends.q[best]
            clearance[b, a] = _clearance(moved, axes, shift, ends.q[best])
    return PlaceMap(axes, grids[0], grids[1], objective, clearance, kept_out, (at[0], at[1]))


def _line(each: Free | None, task: Task, here: pin.SE3, axis: str, columns: int) -> Array:
    """Return the values of one coordinate: its box, or some room around the place found."""
    k = "xyz".index(axis)
    if each is None:
        low, high = here.translation[k] - _REACH, here.translation[k] + _REACH
    else:
        stood = task.cell.arms[1].base.translation[k]
        low, high = stood + each.lower, stood + each.upper
    return np.linspace(low, high, columns)


def _kept_out(may: Asked, here: pin.SE3, axes: tuple[str, str], shift: Array) -> bool:
    place = {"x": float(here.translation[0]), "y": float(here.translation[1])}
    for axis, by in zip(axes, shift, strict=True):
        if axis in place:
            place[axis] += float(by)
    return may.inside_area(place["x"], place["y"])


def _clearance(task: Task, axes: tuple[str, str], shift: Array, q: Array) -> float:
    """Return the smallest distance of a motion (h, n) with base 2 shifted; nan if not known."""
    change = {f"{BASE}.{axis}": float(by) for axis, by in zip(axes, shift, strict=True)}
    cell = task.cell.moved(base2=moved_base(task.cell.arms[1].base, change))
    least = np.inf
    for posture in q:
        near = cell.clearance(posture, between_arms=True)
        if near is None:
            return float("nan")
        least = min(least, near.distance)
        if least < 0.0:
            break
    return float(least)
