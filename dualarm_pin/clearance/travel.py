"""How much nearer two bodies can come on a straight line in the joints: a bound that holds.

A point of a body moves by at most the sum over the joints before it of |dq_k| times its largest
distance from axis k. That distance is taken in the middle of the line; joints nearer to the body
can add to it what they move the body by in half the line.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.chain import REVOLUTE, joint_axis
from dualarm_pin.clearance.extent import ball_of

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell


def travel(cell: Cell, q: Array) -> Array:
    """Return how far the two bodies of each pair can move against each other, at most.

    Args:
        cell: The two arms.
        q: Postures (h, n) [rad or m], joined by straight lines.

    Returns:
        (h - 1, p) [m] for each line and each of `Cell.pairs`.
    """
    model, geometry = cell.model, cell.collision
    supports = [_up(model, body.parentJoint) for body in geometry.geometryObjects]
    moved = np.abs(np.diff([cell.model_q(x) for x in q], axis=0))
    origin, axis, centre = _middles(cell, q)
    paths = []
    for k, (body, joints) in enumerate(zip(geometry.geometryObjects, supports, strict=True)):
        radius, total = ball_of(body.geometry)[1], np.zeros(len(moved))
        found = [total]
        for joint in joints:
            step = moved[:, model.joints[joint].idx_v]
            if joint_axis(model, joint)[0] == REVOLUTE:
                away = np.cross(centre[:, k] - origin[:, joint], axis[:, joint])
                step = step * (np.linalg.norm(away, axis=1) + radius + total / 2.0)
            total = total + step
            found.append(total)
        paths.append(found)
    result = np.zeros((len(moved), len(geometry.collisionPairs)))
    for number, pair in enumerate(geometry.collisionPairs):
        ends = (pair.first, pair.second)
        shared = len(set(supports[ends[0]]) & set(supports[ends[1]]))
        for end in ends:
            result[:, number] += paths[end][len(supports[end]) - shared]
    return result


def _middles(cell: Cell, q: Array) -> tuple[Array, Array, Array]:
    """Return joints' origins and axes (h - 1, j, 3) and bodies' middles (h - 1, b, 3) halfway."""
    model, data, bodies = cell.model, cell.data(), cell.collision.geometryObjects
    axes = np.array([np.zeros(3)] + [joint_axis(model, k)[1] for k in range(1, model.njoints)])
    balls = np.array([body.placement.act(ball_of(body.geometry)[0]) for body in bodies])
    carriers = [body.parentJoint for body in bodies]
    poses = np.zeros((len(q) - 1, model.njoints, 4, 4))
    for i, middle in enumerate((q[1:] + q[:-1]) / 2.0):
        pin.forwardKinematics(model, data, cell.model_q(middle))
        poses[i] = [pose.homogeneous for pose in data.oMi]
    rotation, origin = poses[..., :3, :3], poses[..., :3, 3]
    centre = np.einsum("hbij,bj->hbi", rotation[:, carriers], balls.reshape(-1, 3))
    axis = np.einsum("hkij,kj->hki", rotation, axes)
    return origin, axis, centre + origin[:, carriers]


def _up(model: pin.Model, joint: int) -> list[int]:
    """Return the joints from a body to the world, nearest first."""
    return [k for k in reversed(list(model.supports[joint])) if k > 0]
