"""The check that decides `found`: every point of the path, evaluated with Pinocchio.

Never a solver's flag: pose errors, bounds and clearance are computed anew from the joints.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.reference import index_value
from dualarm_pin.relative import Relative
from dualarm_pin.tolerance import TOLERANCE, Tolerance

if TYPE_CHECKING:
    from dualarm_pin.task import Task

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Verification:
    """What the joints of a path come to.

    Attributes:
        index: Index at each point (h,).
        position_error: Distance to the wanted position (h,) [m].
        rotation_error: Angle to the wanted rotation, or between tool axes with the spin free,
            or 0 where only the position is asked for (h,) [rad].
        bound_violation: Largest violation of a bound at each point (h,) [rad or m].
        clearance: Smallest distance of the collision pairs (h,) [m], or None.
        arm_clearance: Smallest distance between the arms (h,) [m], or None: a wrist always sits
            close to its own forearm, so this one tells more.
        smallest_singular_value: Of J_r at each point (h,).
        max_joint_step: Largest step of one joint between neighbours [rad or m].
        found: All errors are within tolerance.
    """

    index: Array
    position_error: Array
    rotation_error: Array
    bound_violation: Array
    clearance: Array | None
    arm_clearance: Array | None
    smallest_singular_value: Array
    max_joint_step: float
    found: bool


def verify(
    task: Task, q: Array, tolerance: Tolerance = TOLERANCE, *, clearance: bool = True
) -> Verification:
    """Evaluate joints q (h, n) against what the task asks for.

    Args:
        task: Cell, path and index.
        q: Joints at every point of the path (h, n).
        tolerance: What counts as found.
        clearance: Compute distances too.

    Raises:
        ShapeError: q does not have a row for each point and a column for each joint.
        InputError: A joint is NaN or infinite.
    """
    cell, path = task.cell, task.path
    expected = (path.h, cell.n)
    if np.shape(q) != expected:
        raise ShapeError(f"expected shape {expected}, given {np.shape(q)}", field="q")
    if not np.all(np.isfinite(q)):
        point = int(np.argmin(np.isfinite(q).all(axis=1))) + 1
        raise InputError(f"the joints of point {point} are not finite", field="q")
    points = [Relative(cell, q_i) for q_i in q]
    bounds = (cell.lower, cell.upper)
    index = np.array(
        [
            index_value(task.index, point, u, q_i, bounds)
            for point, u, q_i in zip(points, path.u, q, strict=True)
        ]
    )
    position_error = np.array(
        [
            np.linalg.norm(point.T_e1_e2.translation - wanted)
            for point, wanted in zip(points, path.position, strict=True)
        ]
    )
    rotation_error = np.array(
        [
            rotation_distance(R, point.T_e1_e2.rotation, int(rows), path.spin_axis)
            for R, point, rows in zip(path.rotation, points, path.rows, strict=True)
        ]
    )
    violation = np.maximum(np.maximum(cell.lower - q, q - cell.upper).max(axis=1), 0.0)
    step = float(np.max(np.abs(np.diff(q, axis=0)))) if len(q) > 1 else 0.0
    return Verification(
        index=index,
        position_error=position_error,
        rotation_error=rotation_error,
        bound_violation=violation,
        clearance=distances(task, q) if clearance else None,
        arm_clearance=distances(task, q, between_arms=True) if clearance else None,
        smallest_singular_value=np.array(
            [np.linalg.svd(point.J_r, compute_uv=False)[-1] for point in points]
        ),
        max_joint_step=step,
        found=bool(np.all(position_error <= tolerance.position))
        and bool(np.all(rotation_error <= tolerance.rotation))
        and bool(np.all(violation <= tolerance.bound)),
    )


def distances(task: Task, q: Array, *, between_arms: bool = False) -> Array | None:
    """Return the smallest distance at every point (h,) [m], or None where it is not known.

    Convex hulls are compared first; they never say more than there is. Where they touch, the
    meshes themselves decide.
    """
    least = []
    for q_i in q:
        clearance = task.cell.clearance(q_i, between_arms=between_arms)
        if clearance is not None and clearance.distance <= 0.0:
            clearance = task.cell.clearance(q_i, between_arms=between_arms, exact=True)
        if clearance is None:
            return None
        least.append(clearance.distance)
    return np.array(least)


def rotation_distance(wanted: Array, given: Array, rows: int, spin_axis: Array) -> float:
    """Return the angle that counts for the pose rows asked for [rad]."""
    if rows == 3:
        return 0.0
    error = wanted.T @ given
    if rows == 5:
        tilted = error @ spin_axis
        sine = np.linalg.norm(np.cross(spin_axis, tilted))
        return float(np.arctan2(sine, spin_axis @ tilted))
    twice_sine = np.array(
        [error[2, 1] - error[1, 2], error[0, 2] - error[2, 0], error[1, 0] - error[0, 1]]
    )
    return float(np.arctan2(np.linalg.norm(twice_sine), np.trace(error) - 1.0))
