"""Limits of the joints as an array, or an error that says where the missing one belongs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dualarm_pin.arrays import Array
from dualarm_pin.cell.parts import MOTION_KEYS, Joint
from dualarm_pin.errors import InputError


def known_limits(joints: Sequence[Joint], word: str, advice: str = "") -> Array:
    """Return one kind of limit of all joints (n,).

    Args:
        joints: The columns of q.
        word: `velocity`, `acceleration`, `jerk` or `effort`.
        advice: What else may be done where one is missing.

    Raises:
        InputError: One is missing; the message names the joint and the key of the cell file.
    """
    values = [getattr(joint, word) for joint in joints]
    missing = [joint for joint, value in zip(joints, values, strict=True) if value is None]
    if not missing:
        return np.array(values, dtype=float)
    first = missing[0]
    owner, _, name = first.name.partition("/")
    key = MOTION_KEYS[word]
    if first.kind == "prismatic" and word != "effort":
        key = word  # metres
    where = key if owner == "common" else f"arms.{owner}.{key}"
    more = f" (nor for {len(missing) - 1} more joints)" if len(missing) > 1 else ""
    kind = "torque" if word == "effort" else word
    raise InputError(
        f"no {kind} limit is known for {first.name}{more}, or it is 0: give "
        f"`{where}: {{{name}: ...}}` in the cell file{advice}",
        field=f"{where}.{name}",
    )
