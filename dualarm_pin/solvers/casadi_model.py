"""The pair of arms and the indices as CasADi expressions, from the chain of the Pinocchio model.

The wheel of Pinocchio has no CasADi interface, so the kinematics is written out here; a test holds
it against `Relative`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin

from dualarm_pin.arrays import Array
from dualarm_pin.chain import REVOLUTE, VARIABLE, body_of, chain_of
from dualarm_pin.errors import InputError, MissingExtraError

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell
    from dualarm_pin.indices import Index
    from dualarm_pin.rows import Row

Expression = Any  # casadi.SX


def import_casadi() -> Any:
    """Return the module.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import casadi
    except ImportError as error:
        raise MissingExtraError(
            "this method needs CasADi: pip install 'dualarm-pin[casadi]'"
        ) from error
    return casadi


class Pose(NamedTuple):
    """e2 in e1 for symbolic q (n, 1).

    Attributes:
        position: (3, 1) [m].
        rotation: (3, 3).
        quaternion: (4, 1), w first; one of the two that stand for the rotation.
        jacobian: J_r (6, n).
        segments: Rotation (3, 3) and position (3, 1) in e1 of every segment of the chain.
    """

    position: Expression
    rotation: Expression
    quaternion: Expression
    jacobian: Expression
    segments: list[tuple[Expression, Expression]]


def kinematics(cell: Cell, q: Expression) -> Pose:
    """Return the pose of e2 in e1 and J_r for symbolic q (n, 1)."""
    ca = import_casadi()
    chain = chain_of(cell)
    position, rotation = ca.SX.zeros(3), ca.SX.eye(3)
    quaternion = ca.SX(ca.DM([1, 0, 0, 0]))
    axes: list[tuple[Expression, Expression]] = []
    segments: list[tuple[Expression, Expression]] = []
    for element in range(len(chain.kind) + 1):
        fixed = chain.quaternion[element]
        position = position + rotation @ ca.DM(chain.translation[element])
        rotation = rotation @ ca.sparsify(ca.DM(_matrix(fixed)))
        quaternion = _product(ca, quaternion, ca.SX(ca.DM(fixed)))
        segments.append((rotation, position))
        if element == len(chain.kind):
            break
        axes.append((rotation[:, 2], position))
        value = ca.SX(float(chain.offset[element]))
        if chain.role[element] == VARIABLE:
            value += chain.scale[element] * q[int(chain.source[element])]
        if chain.kind[element] == REVOLUTE:
            rotation = rotation @ _turn(ca, value)
            half = ca.vertcat(ca.cos(value / 2), 0, 0, ca.sin(value / 2))
            quaternion = _product(ca, quaternion, half)
        else:
            position = position + value * rotation[:, 2]
    jacobian = ca.SX.zeros(6, cell.n)
    for element, (axis, origin) in enumerate(axes):
        if chain.role[element] == VARIABLE:
            turns = chain.kind[element] == REVOLUTE
            linear = ca.cross(axis, position - origin) if turns else axis
            angular = axis if turns else ca.SX.zeros(3)
            column = int(chain.source[element])
            jacobian[:, column] += chain.scale[element] * ca.vertcat(linear, angular)
    return Pose(position, rotation, quaternion, jacobian, segments)


def row_expression(row: Row, cell: Cell, pose: Pose) -> Expression:
    """Return g of a row between two bodies, as `Row.at` has it.

    Raises:
        InputError: The row has no expression.
    """
    ca = import_casadi()
    if row.expression is None:
        raise InputError(
            f"CasADi has no expression for the row {row.name!r}: give it one, or choose "
            "another method",
            field="constraints",
        )
    bodies = []
    for frame in row.frames(cell):
        body = body_of(cell, frame)
        rotation, position = pose.segments[body.segment]
        at = ca.DM(body.placement.translation)
        turn = ca.DM(body.placement.rotation)
        bodies.append((rotation @ turn, position + rotation @ at))
    (R_a, p_a), (R_b, p_b) = bodies
    return row.expression(ca, R_a.T @ R_b, R_a.T @ (p_b - p_a))


def pose_rows(
    pose: Pose, position: Expression, quaternion: Expression, rows: int, spin_axis: Array
) -> Expression:
    """Return the pose residual (rows, 1), as `rows.pose.pose_residual` has it.

    2 vec(e) of the error quaternion e: a product of half-angle quaternions, so it is smooth for
    every q and zero at the right rotation alone, whichever sign e has.
    """
    ca = import_casadi()
    linear = pose.position - position
    if rows == 3:
        return linear
    conjugate = ca.vertcat(quaternion[0], -quaternion[1:])
    error = _product(ca, conjugate, pose.quaternion)
    if rows == 6:
        return ca.vertcat(linear, 2 * error[1:])
    # The tool axis after the error rotation: a + 2 v x (v x a + w a).
    axis, turn = ca.DM(spin_axis), error[1:]
    tilted = axis + 2 * ca.cross(turn, ca.cross(turn, axis) + error[0] * axis)
    normals = ca.DM(np.linalg.svd(spin_axis[None])[2][1:])
    half = ca.sqrt((1 + ca.dot(axis, tilted)) / 2 + 1e-12)
    return ca.vertcat(linear, normals @ tilted / half)


def index_expression(index: Index, jacobian: Expression, u: Expression) -> Expression:
    """Return c for symbolic J_r (6, n) and u (6, 1), without the joint-centre term.

    Raises:
        InputError: The index has no expression: its derivatives are not those of a polynomial, a
            determinant or an inverse, or it is the user's own.
    """
    ca = import_casadi()
    if index.expression is None:
        raise InputError(
            f"CasADi has no expression for the index {index.name!r}: give it one, or choose "
            "another method",
            field="index",
        )
    rows = jacobian
    if index.task_weights is not None:
        used = [i for i, weight in enumerate(index.task_weights) if weight > 0]
        rows = ca.diag(ca.DM(np.sqrt(index.task_weights))) @ rows
        if index.name != "force":
            rows, u = rows[used, :], u[used]
    weighted = rows if index.joint_weights is None else rows @ ca.diag(ca.DM(index.joint_weights))
    return index.expression(ca, weighted @ rows.T, u)


def _product(ca: Any, a: Expression, b: Expression) -> Expression:
    """Return the product of two quaternions, w first."""
    return ca.vertcat(
        a[0] * b[0] - ca.dot(a[1:], b[1:]), a[0] * b[1:] + b[0] * a[1:] + ca.cross(a[1:], b[1:])
    )


def _matrix(quaternion: Array) -> Array:
    matrix = np.array(pin.Quaternion(*quaternion).matrix())
    matrix[np.abs(matrix) < 1e-15] = 0.0  # right angles stay sparse
    return matrix


def _turn(ca: Any, angle: Expression) -> Expression:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))
