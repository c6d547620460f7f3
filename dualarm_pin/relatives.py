"""The reference kinematics at many q: Pinocchio places every one, numpy does the rest at once.

The conventions are those of `relative.Relative`, which says the same of a single q.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from dualarm_pin.errors import ShapeError
from dualarm_pin.relative import chain_order

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

Array = NDArray[np.float64]

_ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


class Relatives:
    """Everything about e2 as seen from e1 at several q.

    Args:
        cell: The two arms.
        q: Joints (s, n) [rad or m].

    Attributes:
        cell: The two arms.
        q: Joints (s, n), a copy.
        rotation: Rotations (s, 3, 3) of e2 in e1 (eq. 10).
        translation: Positions (s, 3) of e2 in e1 [m].
        J_r: Relative Jacobians (s, 6, n) (eq. 11).

    Raises:
        ShapeError: q does not have n columns.
    """

    def __init__(self, cell: Cell, q: ArrayLike) -> None:
        self.cell = cell
        self.q = np.array(q, dtype=float)
        if self.q.ndim != 2 or self.q.shape[1] != cell.n:
            raise ShapeError(f"has shape {self.q.shape}, not (s, {cell.n})", field="q")
        R, p, J = _placed(cell, self.q)
        self.rotation: Array = R[:, 0].transpose(0, 2, 1) @ R[:, 1]
        away = p[:, 1] - p[:, 0]
        self.translation: Array = np.einsum("sji,sj->si", R[:, 0], away)
        # v = R1^T (v2 - v1 + [p2 - p1]x w1), w = R1^T (w2 - w1)
        moved = J[:, 1] - J[:, 0]
        moved[:, :3] += np.cross(away[:, None], J[:, 0, 3:].transpose(0, 2, 1)).transpose(0, 2, 1)
        turned = R[:, None, 0].transpose(0, 1, 3, 2) @ moved.reshape(
            len(moved), 2, 3, cell.model.nv
        )
        self._J_model: Array = turned.reshape(moved.shape)
        same = cell.same_order
        self.J_r: Array = self._J_model if same else self._J_model @ cell.joint_map

    def __len__(self) -> int:
        """How many q there are."""
        return len(self.q)

    def along(self, P: Array) -> Array:
        """Return sum_k P_k . dJ_k/dq_l at every q: (s, n) for P (s, 6, n), columns as in J_r.

        With dJ_k/dq_l as in `Relative.dJ_r` and X_k = v_k x P_k + w_k x P'_k (linear and angular
        part of P), Y_k = P_k x w_k, that is w_l . sum X_k over the k at or after l on the way from
        e1 to e2, plus v_l . sum Y_k over those before: no derivative is written down.
        """
        cell, J = self.cell, self._J_model
        if not cell.same_order:
            P = P @ cell.joint_map.T
        v, w, linear, angular = (each.transpose(0, 2, 1) for each in (*_halves(J), *_halves(P)))
        X, Y = np.cross(v, linear) + np.cross(w, angular), np.cross(linear, w)
        early = self._early
        slope: Array = np.sum(w * (early.T @ X) + v * ((1.0 - early).T @ Y), axis=2)
        return slope if cell.same_order else slope @ cell.joint_map

    @cached_property
    def _early(self) -> Array:
        """1 where joint l (column) comes before or at joint k (row) in chain order (nv, nv)."""
        return chain_order(self.cell).astype(float)


def _halves(J: Array) -> tuple[Array, Array]:
    return J[:, :3], J[:, 3:]


def _placed(cell: Cell, q: Array) -> tuple[Array, Array, Array]:
    """Return rotations (s, 2, 3, 3), positions (s, 2, 3), Jacobians (s, 2, 6, nv) of e1 and e2."""
    model, data = cell.model, cell.data()
    R, p, J = (np.zeros((len(q), 2, *shape)) for shape in ((3, 3), (3,), (6, model.nv)))
    placed = q if cell.same_order else q @ cell.joint_map.T + cell.joint_offset
    tips = tuple(enumerate((cell.e1, cell.e2)))
    for i, x in enumerate(placed):
        pin.computeJointJacobians(model, data, x)
        for side, tip in tips:
            M = pin.updateFramePlacement(model, data, tip)
            R[i, side], p[i, side] = M.rotation, M.translation
            if model.nv:  # Pinocchio crashes on the Jacobian of a model without joints
                J[i, side] = pin.getFrameJacobian(model, data, tip, _ALIGNED).reshape(6, -1)
    return R, p, J
