"""What the joints of a cell can do in time, as arrays, and which of it a motion must keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.cell.parts import MOTION_KEYS, Joint
from dualarm_pin.errors import InputError
from dualarm_pin.motion.summary import Kind

_WORDS: dict[Kind, str] = {
    "velocity": "velocity", "acceleration": "acceleration", "jerk": "jerk", "torque": "effort",
}  # fmt: skip
"""Kinds to fields of `Joint`."""


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits of the columns of q, infinite where a kind is not kept.

    Attributes:
        joints: Names of the columns.
        velocity: (n,) [rad/s or m/s].
        acceleration: (n,) [rad/s^2 or m/s^2].
        jerk: (n,) [rad/s^3 or m/s^3].
        torque: (n,) [N m or N].
        kinds: The kinds that are kept.
    """

    joints: tuple[str, ...]
    velocity: Array
    acceleration: Array
    jerk: Array
    torque: Array
    kinds: tuple[Kind, ...]

    def of(self, kind: Kind) -> Array:
        """Return the limits of a kind (n,)."""
        limits: Array = getattr(self, kind)
        return limits


def limits_of(cell: Cell, asked: Sequence[Kind] | None = None) -> Limits:
    """Return the limits of a cell.

    Args:
        cell: The two arms.
        asked: The kinds to keep. By default velocity, and of acceleration, jerk and torque those
            that the cell states; torque only where it knows all masses.

    Raises:
        InputError: A limit is missing; the message names the joint and the key of the cell file.
    """
    known: dict[Kind, list[Joint]] = {
        kind: [joint for joint in cell.joints if getattr(joint, word) is None]
        for kind, word in _WORDS.items()
    }
    if asked is not None:
        kinds = [kind for kind in _WORDS if kind in asked]
    else:
        some = [kind for kind, lacking in known.items() if len(lacking) < cell.n]
        kinds = [kind for kind in some if kind != "torque"]
        if not known["torque"] and not cell.massless_joints:
            kinds.append("torque")
        if "acceleration" not in kinds and "torque" not in kinds:
            kinds.append("acceleration")  # a motion that starts from rest has to know one of them
    if "velocity" not in kinds:
        kinds.insert(0, "velocity")
    for kind in kinds:
        if known[kind]:
            raise _missing(cell, kind, known[kind])
    values = {
        kind: np.array([getattr(joint, _WORDS[kind]) for joint in cell.joints], dtype=float)
        if kind in kinds
        else np.full(cell.n, np.inf)
        for kind in _WORDS
    }
    return Limits(cell.joint_names, kinds=tuple(kinds), **values)


def _missing(cell: Cell, kind: Kind, joints: Sequence[Joint]) -> InputError:
    key = MOTION_KEYS[_WORDS[kind]]
    first = joints[0]
    owner, _, name = first.name.partition("/")
    if first.kind == "prismatic":
        key = kind
    more = f" (nor for {len(joints) - 1} more joints)" if len(joints) > 1 else ""
    where = f"arms.{owner}.{key}" if owner != "common" else key
    advice = "" if kind == "velocity" else "; or leave it out: motion.limits=[velocity]"
    return InputError(
        f"no {kind} limit is known for {first.name}{more}, or it is 0: give "
        f"`{where}: {{{name}: ...}}` in the cell file of {cell.name}{advice}",
        field=f"{where}.{name}",
    )
