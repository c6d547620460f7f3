"""The shared parameters that a cell can have: names, units, and where they act."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.chain import PRISMATIC, REVOLUTE
from dualarm_pin.errors import InputError, UnknownNameError, nearest

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

BASE, WORKPIECE, TOOL = "base2", "workpiece", "tool2"
_X, _Y, _Z = np.eye(3)
# In the order in which the chain passes them: workpiece, arm 1, base of arm 2, arm 2, tool.
ELEMENTS: dict[str, tuple[int, NDArray[np.float64]]] = {
    "workpiece.yaw": (REVOLUTE, -_Z),
    "workpiece.z": (PRISMATIC, -_Z),
    "workpiece.y": (PRISMATIC, -_Y),
    "workpiece.x": (PRISMATIC, -_X),
    "base2.x": (PRISMATIC, _X),
    "base2.y": (PRISMATIC, _Y),
    "base2.z": (PRISMATIC, _Z),
    "base2.yaw": (REVOLUTE, _Z),
    "tool2.length": (PRISMATIC, _Z),
}


@dataclass(frozen=True)
class Free:
    """One free parameter.

    Attributes:
        name: `base2.x`, `base2.yaw`, `workpiece.z`, `tool2.length`, ...: see `ELEMENTS`.
        lower: Smallest change from where the cell stands [m or rad].
        upper: Largest change.
        weight: Of (change)^2 in the objective, so that a flat direction stays where it is.
    """

    name: str
    lower: float
    upper: float
    weight: float = 0.0


def checked(
    free: Mapping[str, tuple[float, float]] | tuple[Free, ...], cell: Cell
) -> tuple[Free, ...]:
    """Return free parameters in the order of the chain.

    Raises:
        UnknownNameError: There is no such parameter.
        InputError: A box is crossed or not finite, or the cell does not have the parameter.
    """
    given = free if isinstance(free, tuple) else tuple(Free(k, *box) for k, box in free.items())
    for each in given:
        if each.name not in ELEMENTS:
            raise UnknownNameError(
                f"there is no parameter {each.name!r}; {nearest(each.name, ELEMENTS, 9)}",
                field="placement",
            )
        if not (np.isfinite([each.lower, each.upper]).all() and each.lower < each.upper):
            raise InputError(
                f"from {each.lower:g} to {each.upper:g} is no range: the lower end must be below "
                "the upper",
                field=f"placement.{each.name}",
            )
        if each.name.startswith(BASE):
            check_base(cell, f"placement.{each.name}")
    order = list(ELEMENTS)
    return tuple(sorted(given, key=lambda each: order.index(each.name)))


def check_base(cell: Cell, field: str) -> None:
    """Raise InputError where arm 2 has no base of its own."""
    try:
        cell.moved(base2=cell.arms[1].base)
    except InputError as error:
        raise InputError(error.message, field=field) from error


def moved_base(base: pin.SE3, change: Mapping[str, float]) -> pin.SE3:
    """Return the pose of base 2 after a change of its parameters, by name [m or rad]."""
    shift = np.array([change.get(f"{BASE}.{axis}", 0.0) for axis in "xyz"])
    turn = pin.utils.rotate("z", float(change.get(f"{BASE}.yaw", 0.0)))
    return pin.SE3(turn @ base.rotation, base.translation + shift)


def workpiece_pose(change: Mapping[str, float]) -> pin.SE3:
    """Return the pose of the path in e1 after a change: the identity where nothing changed."""
    shift = np.array([change.get(f"{WORKPIECE}.{axis}", 0.0) for axis in "xyz"])
    turn: Any = pin.utils.rotate("z", float(change.get(f"{WORKPIECE}.yaw", 0.0)))
    return pin.SE3(turn, shift)
