"""What the joints of a cell can do in time, as arrays, and which of it a motion must keep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell import Cell
from dualarm_pin.cell.known_limits import known_limits
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
    kinds = set(_stated(cell) if asked is None else asked) | {"velocity"}
    values = {}
    for kind, word in _WORDS.items():
        advice = "" if kind == "velocity" else "; or leave it out: motion.limits=[velocity]"
        kept = kind in kinds
        values[kind] = known_limits(cell.joints, word, advice) if kept else np.full(cell.n, np.inf)
    return Limits(cell.joint_names, kinds=tuple(k for k in _WORDS if k in kinds), **values)


def _stated(cell: Cell) -> set[Kind]:
    """Return the kinds that a cell states, were it for one joint alone."""
    known = {
        kind: [getattr(joint, word) is not None for joint in cell.joints]
        for kind, word in _WORDS.items()
    }
    stated: set[Kind] = {kind for kind, each in known.items() if any(each)} - {"torque"}
    if all(known["torque"]) and not cell.massless_joints:
        stated.add("torque")
    if not stated & {"acceleration", "torque"}:
        stated.add("acceleration")  # a motion that starts from rest has to know one of them
    return stated
