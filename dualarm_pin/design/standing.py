"""The parameters that the cell of a session has, and where they stand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from dualarm_pin.errors import InputError
from dualarm_pin.placement.asked import standing
from dualarm_pin.placement.parameters import BASE, ELEMENTS, Free, checked, moved_base
from dualarm_pin.tolerance import TOLERANCE

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

_BOX = 100.0  # m or rad: a session has no boxes


def parameters_of(cell: Cell) -> tuple[Free, ...]:
    """Return all parameters that a cell has, in the order of the chain."""
    return checked({name: (-_BOX, _BOX) for name in ELEMENTS if _has(cell, name)}, cell)


def stands(cell: Cell, name: str) -> float:
    """Return where a parameter stands before any change: only those of base 2 are in the world."""
    return standing(cell).get(name, 0.0)


def change_to(base: pin.SE3, pose: pin.SE3) -> dict[str, float]:
    """Return the parameters that take base 2 from where it stood to a pose.

    Raises:
        InputError: It is tilted against where it stood.
    """
    turn = np.asarray(pose.rotation @ base.rotation.T)
    yaw = float(np.arctan2(turn[1, 0], turn[0, 0]))
    shift = pose.translation - base.translation
    change = {f"{BASE}.{axis}": float(by) for axis, by in zip("xyz", shift, strict=True)}
    change[f"{BASE}.yaw"] = yaw
    if not moved_base(base, change).isApprox(pose, TOLERANCE.parallel):
        raise InputError("is tilted: base 2 may turn about the vertical alone", field="base2")
    return change


def _has(cell: Cell, name: str) -> bool:
    try:
        checked({name: (-_BOX, _BOX)}, cell)
    except InputError:
        return False
    return True
