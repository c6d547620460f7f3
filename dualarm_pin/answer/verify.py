"""The check that decides `found`: every point of the path, evaluated with Pinocchio.

Never a solver's flag: pose errors, bounds and distances are computed anew from the joints, once,
and every page and table shows these figures.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.apart import check_apart
from dualarm_pin.answer.distances import distances_along
from dualarm_pin.answer.evidence import Evidence
from dualarm_pin.answer.provenance import Timing, versions
from dualarm_pin.answer.trajectory import Checked, RowValues, Trajectory
from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.reference import coupling, index_values
from dualarm_pin.relatives import Relatives
from dualarm_pin.tolerance import TOLERANCE, Tolerance

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

    from dualarm_pin.task import Task


def verified(
    task: Task,
    q: Array,
    *,
    method: str,
    solver: str,
    timing: Timing | None = None,
    seed: int | None = None,
    evidence: Evidence | None = None,
    message: str = "",
    notes: DataclassInstance | None = None,
) -> Trajectory:
    """Return joints q (h, n) as the answer to a task, checked: what every planner ends with.

    Args:
        task: What was asked.
        q: Joints at every point of the path (h, n).
        method: Name of the planner.
        solver: Name of the solver.
        timing: Seconds spent.
        seed: Seed of the starts.
        evidence: What is known about the optimum.
        message: What to know about it; by default why it is not found, if it is not.
        notes: What the method says of its own work: a record of `answer.notes`, or any dataclass
            of JSON values.

    Raises:
        ShapeError: q does not have a row for each point and a column for each joint.
        InputError: A joint is NaN or infinite.
    """
    checked = verify(task, q)
    return Trajectory(
        q,
        task.cell.joint_names,
        task.path.arc_length,
        checked,
        method=method,
        solver=solver,
        evidence=evidence or Evidence(),
        timing=timing or Timing(),
        seed=seed,
        versions=versions(),
        message=message or _why_not(checked),
        notes=notes,
    )


def verify(
    task: Task, q: Array, tolerance: Tolerance = TOLERANCE, *, clearance: bool = True
) -> Checked:
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
    everywhere, arms, apart = None, None, None
    measured = check_apart(task, q) if clearance else None
    if measured is not None:
        apart, everywhere, arms = measured
    elif clearance:
        everywhere, arms = distances_along(cell, np.asarray(q))
    bounds = (cell.lower, cell.upper)
    relatives = Relatives(cell, q)
    index, minimised = (
        index_values(task.index, relatives, path.u, bounds, reported=reported)
        for reported in (True, False)
    )
    position_error = np.linalg.norm(relatives.translation - path.position, axis=1)
    rotation_error = np.array(
        [
            _rotation_distance(wanted, given, rows, path.spin_axis)
            for wanted, given, rows in zip(
                path.rotation, relatives.rotation, path.rows, strict=True
            )
        ]
    )
    singular_value: Array = np.asarray(
        np.linalg.svd(relatives.J_r, compute_uv=False)[:, -1], dtype=np.float64
    )
    objective = float(np.sum(minimised)) + coupling(task.problem(), q)[0]
    violation = np.maximum(np.maximum(cell.lower - q, q - cell.upper).max(axis=1), 0.0)
    rows = []
    for row in task.rows:
        held = tuple(i for i in range(path.h) if row.holds_at(i))
        value = np.array([row.at(cell, q[i])[0] for i in held])
        rows.append(RowValues(row.name, row.units, row.equality, held, value))
    for name, point in (("from_posture", 0), ("to_posture", path.h - 1)):
        posture = getattr(task, name)
        if posture is not None:
            away = np.array([np.max(np.abs(q[point] - posture))])
            rows.append(RowValues(name, "rad or m", True, (point,), away))
    return Checked(
        index=index,
        objective=objective,
        position_error=position_error,
        rotation_error=rotation_error,
        bound_violation=violation,
        singular_value=singular_value,
        clearance=everywhere,
        arm_clearance=arms,
        found=bool(np.all(position_error <= tolerance.position))
        and bool(np.all(rotation_error <= tolerance.rotation))
        and bool(np.all(violation <= tolerance.bound))
        and all(row.violation <= tolerance.row for row in rows)
        and (apart is None or apart.kept),
        rows=tuple(rows),
        smoothing_error=float(np.max(np.abs(minimised - index), initial=0.0)),
        apart=apart,
    )


def _rotation_distance(wanted: Array, given: Array, rows: int, spin_axis: Array) -> float:
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


def _why_not(checked: Checked) -> str:
    if checked.found:
        return ""
    broken = max(checked.rows, key=lambda row: row.violation, default=None)
    if broken is not None and broken.violation > TOLERANCE.row:
        return (
            f"not verified: {broken.name} is violated by {broken.violation:.2g} {broken.units} at "
            f"point {broken.worst + 1}"
        )
    if checked.apart is not None and not checked.apart.kept:
        return f"not verified: {checked.apart.worst}"
    worst = int(np.argmax(checked.position_error + checked.rotation_error))
    return (
        f"not verified: point {worst + 1} is {checked.position_error[worst]:.2g} m and "
        f"{checked.rotation_error[worst]:.2g} rad from the path, largest bound violation "
        f"{float(np.max(checked.bound_violation)):.2g}"
    )
