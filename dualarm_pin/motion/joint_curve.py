"""Joints as a smooth function of the place along the path, on the path everywhere."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import CubicSpline

from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError
from dualarm_pin.motion.relative_path import RelativePath
from dualarm_pin.path import Path
from dualarm_pin.problem import Problem
from dualarm_pin.relative import Relative
from dualarm_pin.rows.pose import pose_residual
from dualarm_pin.solvers.projection import project_point
from dualarm_pin.task import Task
from dualarm_pin.task.motion_spec import ChordSpec
from dualarm_pin.tolerance import TOLERANCE

_INTERVALS = 150  # of the first grid: 2 mm on a path of 0.3 m
_MOST = 6000  # grid points; a path that needs more has corners that no motion follows
_NEAR = 0.05  # share of a link at which the bend of the path is seen: far above rounding
_BENDS = 6  # rounds: each leaves a quarter of what the last left
_FEW = 4  # points that a spline needs to tell an end from what is beside it
_SHORTEST = 1e-6  # m: an interval so short that still leaves the path is torn apart
_SPARE = 0.2  # share of the tolerance that the curve itself may take


@dataclass(frozen=True, eq=False)
class JointCurve:
    """Joints along a path.

    Attributes:
        relative: The path.
        task: Whose path it is.
        grid: Places (m,) [m] that were put onto the path, the points of the path among them.
        spline: Joints (n,) over the place.
    """

    relative: RelativePath
    task: Task
    grid: Array
    spline: CubicSpline

    def places(self, parts: int) -> Array:
        """Return the grid with each interval cut into equal parts, as places [m]."""
        inner = self.grid[:-1, None] + np.diff(self.grid)[:, None] * (np.arange(parts) / parts)
        return np.append(inner.ravel(), self.grid[-1])

    def at(self, place: Array, order: int = 0) -> Array:
        """Return joints (m, n) at places (m,), or their derivative by the place."""
        return np.asarray(self.spline(place, order))

    def errors(self, place: Array, q: Array) -> tuple[Array, Array]:
        """Return how far joints q (m, n) are from the path: [m] and [rad], each (m,).

        What a posture is ahead or behind along the path is no error.
        """
        wanted = self.relative.poses(place)
        position, rotation = np.zeros(len(q)), np.zeros(len(q))
        for i, q_i in enumerate(q):
            rows = int(wanted.rows[i])
            residual, _ = pose_residual(
                Relative(self.task.cell, q_i),
                wanted.position[i],
                wanted.rotation[i],
                rows,
                self.relative.path.spin_axis,
            )
            aside = residual[:3] - (residual[:3] @ wanted.tangent[i]) * wanted.tangent[i]
            position[i] = np.linalg.norm(aside)
            rotation[i] = np.linalg.norm(residual[3:])
        return position, rotation


def joint_curve(task: Task, q: Array, chord: ChordSpec) -> JointCurve:
    """Return the curve of joints through postures of a path, put onto it between them.

    Args:
        task: Cell and path.
        q: Joints (h, n) at its points.
        chord: How far it may leave the path.

    Raises:
        InputError: No grid is fine enough: the path has a corner, or cannot be reached there.
    """
    relative = RelativePath(task.path)
    first = through_postures(relative, task, q)
    grid = _divided(relative.place, relative.length / _INTERVALS)
    joints = _projected(task, relative, grid, first(grid))
    while True:
        curve = JointCurve(relative, task, grid, CubicSpline(grid, joints))
        middle = 0.5 * (grid[:-1] + grid[1:])
        between = curve.at(middle)
        position, rotation = curve.errors(middle, between)
        share = np.maximum(position / (1e-3 * chord.mm), rotation / np.deg2rad(chord.deg))
        rough = share > _SPARE
        if not rough.any():
            return curve
        if len(grid) + rough.sum() > _MOST or np.diff(grid)[rough].min() < _SHORTEST:
            worst = int(np.argmax(share))
            at = float(relative.arc_length(middle[worst : worst + 1])[0])
            raise InputError(
                f"the motion leaves the path by {1e3 * position[worst]:.2g} mm and "
                f"{np.rad2deg(rotation[worst]):.2g} deg at {at:.4f} m, however fine its grid: the "
                "path has a corner there or is out of reach between its points; round the corner "
                f"or set motion.chord above {chord.mm:g} mm and {chord.deg:g} deg",
                field="motion.chord",
            )
        # Neighbours are split too, so that the spacing changes by degrees.
        rough |= np.append(rough[1:], False) | np.append(False, rough[:-1])
        added = middle[rough]
        fresh = _projected(task, relative, added, between[rough])
        grid, joints = _merged(grid, joints, added, fresh)


def _merged(grid: Array, joints: Array, added: Array, fresh: Array) -> tuple[Array, Array]:
    order = np.argsort(np.concatenate([grid, added]), kind="stable")
    return np.concatenate([grid, added])[order], np.concatenate([joints, fresh])[order]


def through_postures(relative: RelativePath, task: Task, q: Array) -> CubicSpline:
    """Return the spline through postures (h, n) whose ends bend as they do beside and as the path.

    Ends without bend would leave the path in the first and the last link, and putting them back
    there would cost much acceleration.
    """
    place = relative.place
    bend = np.zeros((2, q.shape[1]))
    for _ in range(_BENDS):
        spline = CubicSpline(place, q, bc_type=((2, bend[0]), (2, bend[1])))
        beside = spline(place[[1, -2]], 2) if len(place) >= _FEW else bend
        bend = _on_path_bends(relative, task, q[[0, -1]], spline(place[[0, -1]], 1), beside)
    return spline


def _on_path_bends(
    relative: RelativePath, task: Task, q: Array, slope: Array, bend: Array
) -> Array:
    """Return second derivatives (2, n) near `bend` that keep both ends of a curve on the path.

    Args:
        relative: The path.
        task: Cell and path.
        q: Joints at both ends (2, n).
        slope: Their first derivatives by the place (2, n).
        bend: Wanted second derivatives (2, n).
    """
    first, last = _NEAR * np.diff(relative.place)[[0, -1]]
    steps = np.array([first, 2.0 * first, -2.0 * last, -last])
    which, along = np.array([0, 0, 1, 1]), steps[:, None]
    guess = q[which] + slope[which] * along + 0.5 * bend[which] * along**2
    inside = np.where(steps > 0.0, steps, relative.length + steps)
    away = _projected(task, relative, inside, guess) - guess
    # What grows with the step is an error of the slope; that of the bend grows with its square.
    lacking = np.array([away[1] - 2.0 * away[0], away[2] - 2.0 * away[3]])
    return np.asarray(bend + lacking / np.array([[first], [last]]) ** 2)


def _divided(place: Array, longest: float) -> Array:
    """Return places with each link cut into equal parts no longer than `longest`."""
    parts = np.maximum(1, np.ceil(np.diff(place) / longest - TOLERANCE.unit).astype(int))
    parts = np.maximum(parts, int(np.ceil(4 / max(len(parts), 1))))
    pieces = [
        np.linspace(a, b, count, endpoint=False)
        for a, b, count in zip(place[:-1], place[1:], parts, strict=True)
    ]
    return np.append(np.concatenate(pieces), place[-1])


def _projected(task: Task, relative: RelativePath, place: Array, q: Array) -> Array:
    """Return joints (m, n) moved onto the path inside the bounds, by as little as it takes."""
    problem = problem_of(task, relative.at(place))
    return np.array([project_point(problem, i, q_i, TOLERANCE.exact)[0] for i, q_i in enumerate(q)])


def problem_of(task: Task, path: Path) -> Problem:
    """Return the rows of a path in the task's cell, without its constraints."""
    bare = replace(task, path=path, rows=(), Gamma=(), metric=None)
    return bare.problem()
