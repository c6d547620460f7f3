"""Where the bodies of a cell are along a motion, and how far apart capsules around them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

_POINT = 1e-24  # m^2; a segment this short is a point


class Places(NamedTuple):
    """Where all bodies are at all points.

    Attributes:
        rotation: (h, b, 3, 3).
        translation: (h, b, 3) [m].
    """

    rotation: Array
    translation: Array

    def of(self, point: int, body: int) -> pin.SE3:
        """Return one pose."""
        return pin.SE3(self.rotation[point, body], self.translation[point, body])


def placed(cell: Cell, q: Array) -> Places:
    """Return where the bodies of a cell are at postures (h, n)."""
    model, data, bodies = cell.model, cell.data(), cell.collision.geometryObjects
    poses = np.zeros((len(q), model.njoints, 4, 4))
    for i, posture in enumerate(q):
        pin.forwardKinematics(model, data, cell.model_q(posture))
        poses[i] = [pose.homogeneous for pose in data.oMi]
    own = np.array([body.placement.homogeneous for body in bodies])
    of = poses[:, [body.parentJoint for body in bodies]] @ own
    return Places(np.ascontiguousarray(of[..., :3, :3]), np.ascontiguousarray(of[..., :3, 3]))


def segment_distance(first: Array, second: Array) -> Array:
    """Return the distances (...) between segments (..., 2, 3), by their nearest points."""
    start, other = _parts(first[..., 0, :]), _parts(second[..., 0, :])
    along, beside = _parts(first[..., 1, :]) - start, _parts(second[..., 1, :]) - other
    from_second = start - other
    a, e = np.maximum(_dot(along, along), _POINT), np.maximum(_dot(beside, beside), _POINT)
    b, c, f = _dot(along, beside), _dot(along, from_second), _dot(beside, from_second)
    across = np.maximum(a * e - b * b, np.finfo(float).eps * a * e)
    s = np.clip((b * f - c * e) / across, 0.0, 1.0)
    t = np.clip((b * s + f) / e, 0.0, 1.0)
    s = np.clip((b * t - c) / a, 0.0, 1.0)
    apart = from_second + s * along - t * beside
    return np.asarray(np.sqrt(_dot(apart, apart)))


def _parts(points: Array) -> Array:
    """Return points (..., 3) as (3, ...): sums over a last axis of three are slow."""
    return np.ascontiguousarray(np.moveaxis(points, -1, 0))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
