"""An earlier result as a start for another task of the same joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dualarm_pin.answer.trajectory import Trajectory
from dualarm_pin.arrays import Array
from dualarm_pin.errors import InputError

if TYPE_CHECKING:
    from dualarm_pin.task import Task


def resampled(task: Task, warm: Trajectory) -> Array:
    """Return the joints (h, n) of an earlier result at the points of a task, by arc length.

    Raises:
        InputError: It has other joints.
    """
    names = task.cell.joint_names
    if set(warm.joints) != set(names):
        missing = sorted(set(warm.joints) ^ set(names))
        raise InputError(
            f"the earlier result has other joints than this cell: {', '.join(missing)} "
            "stand in one alone",
            field="warm",
        )
    columns = [warm.q[:, warm.joints.index(name)] for name in names]
    old, new = (_shares(length) for length in (warm.arc_length, task.path.arc_length))
    q = np.column_stack([np.interp(new, old, column) for column in columns])
    return np.clip(q, task.cell.lower, task.cell.upper)


def _shares(length: Array) -> Array:
    """Return which share of its path lies before each point; by number where it has no length."""
    whole = length[-1] - length[0]
    return (length - length[0]) / whole if whole > 0 else np.linspace(0.0, 1.0, len(length))
