"""Poses as files and users give them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import finite, rotations
from dualarm_pin.errors import ShapeError
from dualarm_pin.files.cell_spec import PlacementSpec


def pose_of(xyz: Sequence[float], rpy: Sequence[float]) -> pin.SE3:
    """Return the pose of a URDF origin."""
    return pin.SE3(pin.rpy.rpyToMatrix(*map(float, rpy)), np.array(xyz, dtype=float))


def placement_pose(placement: PlacementSpec | None) -> pin.SE3:
    """Return the pose that a cell file states, identity if it states none."""
    if placement is None:
        return pin.SE3.Identity()
    if placement.rotation is not None:
        rotation = pin.Quaternion(np.array(placement.rotation)).normalized().toRotationMatrix()
        return pin.SE3(rotation, np.array(placement.xyz))
    rpy = placement.rpy or (0.0, 0.0, 0.0)
    if placement.rpy_deg is not None:
        rpy = tuple(np.deg2rad(placement.rpy_deg))
    return pose_of(placement.xyz, rpy)


def checked_pose(pose: pin.SE3, field: str) -> pin.SE3:
    """Return a copy of a pose from a user, its rotation moved to the nearest exact one.

    Raises:
        ShapeError: It is no `pin.SE3`.
        InputError: It holds a value that is not finite, or no rotation.
    """
    if not isinstance(pose, pin.SE3):
        message = f"a pose (pinocchio.SE3) is expected; given a {type(pose).__name__}"
        raise ShapeError(message, field=field)
    rotation = rotations(pose.rotation, (1, 3, 3), field)[0]
    return pin.SE3(rotation, finite(pose.translation, field, (3,)))
