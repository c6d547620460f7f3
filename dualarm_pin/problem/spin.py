"""The axis whose spin is free at some points: e2 is turned so that it is z."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.arrays import checked
from dualarm_pin.chain import Chain, quaternion_of
from dualarm_pin.errors import InputError
from dualarm_pin.tolerance import TOLERANCE

Array = NDArray[np.float64]


def spin_of(axis: ArrayLike) -> tuple[Array, Array]:
    """Return the unit axis (3,) and a rotation (3, 3) whose z it is; the identity for z."""
    given = checked("spin_axis", axis, (3,))
    length = np.linalg.norm(given)
    if length < TOLERANCE.no_length:
        raise InputError("is the zero vector; give an axis in the e2 frame", field="spin_axis")
    given = given / length
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), given)
    return given, np.asarray(turn.toRotationMatrix())


def spin_frame(chain: Chain, turn: Array) -> Chain:
    """Return the chain with e2 turned."""
    last = pin.Quaternion(np.roll(chain.quaternion[-1], -1)).toRotationMatrix()
    quaternion = chain.quaternion.copy()
    quaternion[-1] = quaternion_of(last @ turn)
    return chain._replace(quaternion=quaternion)
