"""The reference kinematics at one q, from Pinocchio: relative pose, Jacobian, derivative.

Conventions (eq. 11): velocities are [linear; angular] of e2 with respect to e1, in
the axes of e1; the linear part is the rate of the position of e2 in e1, so the turning of e1
counts.
"""

from __future__ import annotations

import weakref
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Array = NDArray[np.float64]

_ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
# (9, 3): row 3 a + b holds the cross-product matrix entry [w]_ab as a linear function of w.
_SKEW = np.zeros((9, 3))
for _a, _b, _c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    _SKEW[3 * _b + _a, _c] = 1.0
    _SKEW[3 * _a + _b, _c] = -1.0


class Relative:
    """Everything about e2 as seen from e1 at one q.

    Pose and Jacobian are computed at once, the derivative when it is asked for.

    Args:
        cell: The two arms.
        q: Joints (n,) [rad or m].

    Attributes:
        cell: The two arms.
        q: Joints (n,), a copy.
        T_e1_e2: Pose of e2 in e1 (`pin.SE3`) (eq. 10).
        J_r: Relative Jacobian (6, n) (eq. 11).

    Raises:
        ShapeError: q does not have n values.
    """

    def __init__(self, cell: Cell, q: ArrayLike) -> None:
        self.cell = cell
        self.q = np.array(q, dtype=float)
        self.T_e1_e2, self._J_model = _motion_in_model(cell, cell.e1, cell.e2, self.q)
        J = self._J_model
        self.J_r: Array = J if cell.same_order else J @ cell.joint_map

    @cached_property
    def dJ_r(self) -> Array:
        """Derivative (6, n, n): `dJ_r[:, k, l]` is d J_r[:, k] / d q_l.

        Closed form from the columns of J_r: with the joints in chain order
        e1 -> base1 -> base2 -> e2, dJ_k/dq_l is [w_l x v_k; w_l x w_k] for l before or at k, and
        [w_k x v_l; 0] for l after k.
        """
        J = self._J_model
        n = J.shape[1]
        early = chain_order(self.cell)
        skew = (_SKEW @ J[3:]).reshape(3, 3, n).transpose(0, 2, 1).reshape(3 * n, 3)
        cross = (skew @ J.reshape(2, 3, n)).reshape(2, 3, n, n)  # [., a, l, k] = (w_l x J_k)_a
        parts = np.empty((2, 3, n, n))
        turned = cross.transpose(0, 1, 3, 2)  # [., a, k, l]
        np.copyto(parts[0], np.where(early, turned[0], cross[0]))
        np.multiply(turned[1], early, out=parts[1])
        dJ: Array = parts.reshape(6, n, n)
        if self.cell.same_order:
            return dJ
        P = self.cell.joint_map
        return np.ascontiguousarray(P.T @ (dJ @ P))


def relative_motion(cell: Cell, first: int, second: int, q: ArrayLike) -> tuple[pin.SE3, Array]:
    """Return the pose of one frame in another, and the Jacobian of that motion.

    Args:
        cell: The two arms.
        first: Frame id of the one that looks; 0 is the world.
        second: Frame id of the one that is looked at.
        q: Joints (n,) [rad or m].

    Returns:
        Pose (`pin.SE3`) and Jacobian (6, n) [linear; angular] in axes of the first frame.

    Raises:
        ShapeError: q does not have n values.
    """
    T, J = _motion_in_model(cell, first, second, q)
    return T, J if cell.same_order else J @ cell.joint_map


def _motion_in_model(cell: Cell, first: int, second: int, q: ArrayLike) -> tuple[pin.SE3, Array]:
    """Return pose and Jacobian (6, nv) by the joints of the model."""
    model, data = cell.model, cell.data()
    pin.computeJointJacobians(model, data, cell.model_q(q))
    M1 = pin.updateFramePlacement(model, data, first)
    M2 = pin.updateFramePlacement(model, data, second)
    if not model.nv:  # Pinocchio crashes on the Jacobian of a model without joints
        return M1.actInv(M2), np.zeros((6, 0))
    J1 = pin.getFrameJacobian(model, data, first, _ALIGNED)
    J2 = pin.getFrameJacobian(model, data, second, _ALIGNED)
    # v = R1^T (v2 - v1 + [p2 - p1]x w1), w = R1^T (w2 - w1)
    R1 = M1.rotation
    J2 -= J1
    J2[:3] += pin.skew(M2.translation - M1.translation) @ J1[3:]
    J = np.empty(J2.shape)
    np.matmul(R1.T, J2[:3], out=J[:3])
    np.matmul(R1.T, J2[3:], out=J[3:])
    return M1.actInv(M2), J.reshape(6, -1)  # Pinocchio gives that of one joint as a vector


_ORDER: weakref.WeakKeyDictionary[Cell, NDArray[np.bool_]] = weakref.WeakKeyDictionary()


def chain_order(cell: Cell) -> NDArray[np.bool_]:
    """Return a mask (n, n) [k, l]: joint l comes before or at joint k in chain order."""
    try:
        return _ORDER[cell]
    except KeyError:
        position = _positions(cell)
        return _ORDER.setdefault(cell, position[None, :] <= position[:, None])


def _positions(cell: Cell) -> Array:
    """Return the place of each model joint on the way from e1 to e2; elsewhere columns are 0."""
    model = cell.model
    position = np.zeros(model.nv)
    paths = [list(model.supports[model.frames[e].parentJoint])[1:] for e in (cell.e1, cell.e2)]
    for place, joint in enumerate(reversed(paths[0])):
        position[model.joints[joint].idx_v] = place - model.njoints
    for place, joint in enumerate(paths[1]):
        position[model.joints[joint].idx_v] = place
    return position
