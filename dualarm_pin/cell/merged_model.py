"""The two robots as one Pinocchio model, and how its q comes from the columns of the cell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.cell.merged_urdf import merged_urdf
from dualarm_pin.cell.parts import Joint, read_only
from dualarm_pin.cell.placed_robot import PlacedRobot
from dualarm_pin.cpp_messages import captured_stderr
from dualarm_pin.errors import InputError


def merged_model(
    robots: Sequence[PlacedRobot], tools: Mapping[str, tuple[str, pin.SE3]], name: str
) -> pin.Model:
    """Build the model from what `merged_urdf` takes; `name` is what messages call it.

    Raises:
        InputError: Pinocchio refuses it, with the reason it wrote to stderr.
    """
    with captured_stderr() as written:
        try:
            return pin.buildModelFromXML(merged_urdf(robots, tools))
        except (ValueError, RuntimeError) as error:
            reason = written() or str(error)
            raise InputError(f"Pinocchio refuses this robot: {reason}", file=name) from error


def joint_map_of(
    model: pin.Model, robots: Sequence[PlacedRobot], columns: Sequence[Joint]
) -> tuple[Array, Array]:
    """Return how Pinocchio's q, in its own order and with followers, comes from q (n).

    Returns:
        `joint_map` (nv, n) and `joint_offset` (nv,) of `Cell`.
    """
    column = {joint.name: k for k, joint in enumerate(columns)}
    joint_map, offset = np.zeros((model.nv, len(columns))), np.zeros(model.nv)
    for placed in robots:
        for name in placed.roles.columns:
            full = placed.joint(name)
            joint_map[model.joints[model.getJointId(full)].idx_v, column[full]] = 1.0
        for name, (leader, multiplier, shift) in placed.roles.followers.items():
            row = model.joints[model.getJointId(placed.joint(name))].idx_v
            joint_map[row, column[placed.joint(leader)]] = multiplier
            offset[row] = shift
    return read_only(joint_map), read_only(offset)
