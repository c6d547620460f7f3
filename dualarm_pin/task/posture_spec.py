"""What `from_posture` and `to_posture` of a task file may hold: joints at one end of the path."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import model_validator

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.errors import InputError, ShapeError
from dualarm_pin.files.npz import read_joint_names, read_npz
from dualarm_pin.files.numbers import Number, Point
from dualarm_pin.files.source import Spec


class PostureSpec(Spec):
    """The joints at one end of the path, otherwise than as a list in rad or m.

    Attributes:
        deg: The joints in the order of `check`; prismatic ones in m, such as `[0, 10, 90]`.
        result: Folder of a result with the same joints, such as `results/before`.
        point: Which of its points, from 1; its last for `from_posture`, its first for
            `to_posture`, such as `31`.
    """

    deg: list[Number] | None = None
    result: str | None = None
    point: Point | None = None

    @model_validator(mode="before")
    @classmethod
    def _one_way(cls, data: Any) -> Any:
        if isinstance(data, dict) and ("deg" in data) == ("result" in data):
            raise ValueError("give a list in rad or m, or one of `deg` and `result`")
        return data


def load_posture(
    spec: Sequence[float] | PostureSpec | None, cell: Cell, folder: Path, *, last: bool
) -> Array | None:
    """Return the joints (n,) [rad or m] that a task file gives, or None.

    Args:
        spec: What the file says.
        cell: Two arms.
        folder: Folder of the task file.
        last: Which point of a result is taken where none is named.

    Raises:
        MissingFileError: There is no such result.
        InputError: It has other joints, or no such point.
    """
    if spec is None:
        return None
    if not isinstance(spec, PostureSpec):
        return np.array(spec, dtype=float)
    if spec.deg is not None:
        turns = [joint.kind == "revolute" for joint in cell.joints]
        given = np.array(spec.deg, dtype=float)
        if given.shape != (cell.n,):
            raise ShapeError(f"{cell.n} joints are expected; given {len(given)}", field="deg")
        return np.where(turns, np.deg2rad(given), given)
    assert spec.result is not None  # one of the two is given
    file = folder / spec.result / "trajectory.npz"
    q = read_npz(file, {"q": 2}, what="a trajectory")["q"]
    names = read_joint_names(file, what="a trajectory")
    if q.shape[1:] != (len(names),) or set(names) != set(cell.joint_names):
        raise InputError(
            f"it has the joints {', '.join(names)}; this cell {', '.join(cell.joint_names)}",
            file=file,
        )
    at = spec.point or (len(q) if last else 1)
    if not 1 <= at <= len(q):
        raise InputError(f"a point from 1 to {len(q)} of it is expected; given {at}", field="point")
    return np.asarray(q[at - 1, [names.index(name) for name in cell.joint_names]])
