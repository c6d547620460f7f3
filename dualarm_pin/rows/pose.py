"""What must hold at a path point: the pose rows (eq. 17), as few as there are equations."""

from __future__ import annotations

import numpy as np

from dualarm_pin.arrays import Array, Integers
from dualarm_pin.relative import Relative
from dualarm_pin.relatives import Relatives


def pose_residual(
    relative: Relative, position: Array, rotation: Array, rows: int, spin_axis: Array
) -> tuple[Array, Array]:
    """Return the pose residual and its Jacobian.

    The rotation rows are twice the vector part of the error quaternion: smooth, and zero only at
    the right rotation (a skew part is also zero at half a turn). With the spin free they are
    twice the sine of half the angle between the tool axes, along the two normals of the axis.

    Args:
        relative: The pair of arms at one q.
        position: Wanted position (3,) [m].
        rotation: Wanted rotation (3, 3).
        rows: 6, 5 or 3.
        spin_axis: Unit axis in e2 (3,), used with 5 rows.

    Returns:
        Residual (rows,) and its Jacobian (rows, n).
    """
    T, J = relative.T_e1_e2, relative.J_r
    linear = T.translation - position
    if rows == 3:
        return linear, J[:3]
    error = rotation.T @ T.rotation
    if rows == 5:
        angular, slope = _axis_error(error, spin_axis)
    else:
        angular, slope = _quaternion_error(error)
    jacobian = np.vstack([J[:3], slope @ rotation.T @ J[3:]])
    return np.concatenate([linear, angular]), jacobian


def pose_pulls(
    relatives: Relatives, rotation: Array, rows: Integers, spin_axis: Array, y: Array
) -> Array:
    """Return y . dg/dq (s, n) of the rows g of `pose_residual` at several q.

    Args:
        relatives: The pair of arms at s q.
        rotation: Wanted rotations (s, 3, 3).
        rows: 6, 5 or 3 (s,).
        spin_axis: Unit axis in e2 (3,).
        y: (s, 6) multipliers; those beyond a point's rows do not count.
    """
    weight = np.zeros((len(y), 6))
    weight[:, :3] = y[:, :3]
    error = rotation.transpose(0, 2, 1) @ relatives.rotation
    whole, spin = rows == 6, rows == 5
    q = _quaternions(error[whole])
    weight[whole, 3:] = q[:, :1] * y[whole, 3:] + np.cross(q[:, 1:], y[whole, 3:])
    weight[spin, 3:] = _axis_pulls(error[spin], spin_axis, y[spin, 3:5])
    weight[:, 3:] = np.einsum("sij,sj->si", rotation, weight[:, 3:])
    return np.asarray(np.einsum("si,sin->sn", weight, relatives.J_r))


def _quaternion_error(error: Array) -> tuple[Array, Array]:
    """Return 2 vec(e) of a rotation and its derivative for a turn in the wanted frame."""
    w, x, y, z = _quaternion(error)
    # de = 1/2 (0, omega) e, so d(2 vec e) = (w I - [vec e]x) omega.
    return 2.0 * np.array([x, y, z]), np.array([[w, z, -y], [-z, w, x], [y, -x, w]])


def _quaternion(R: Array) -> tuple[float, float, float, float]:
    """Return (w, x, y, z) with w >= 0 of a rotation."""
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    candidates = (trace, R[0, 0], R[1, 1], R[2, 2])
    largest = int(np.argmax(candidates))
    if largest == 0:
        q = np.array([1 + trace, R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    else:
        i = largest - 1
        j, k = (i + 1) % 3, (i + 2) % 3
        q = np.empty(4)
        q[0] = R[k, j] - R[j, k]
        q[1 + i] = 1 + R[i, i] - R[j, j] - R[k, k]
        q[1 + j] = R[i, j] + R[j, i]
        q[1 + k] = R[i, k] + R[k, i]
    q /= np.sqrt(q @ q) * (1.0 if q[0] >= 0 else -1.0)
    return float(q[0]), float(q[1]), float(q[2]), float(q[3])


def _quaternions(R: Array) -> Array:
    """Return (w, x, y, z) with w >= 0 of rotations (s, 3, 3), as (s, 4)."""
    trace = np.trace(R, axis1=1, axis2=2)
    twice = R[:, (2, 0, 1), (1, 2, 0)] - R[:, (1, 2, 0), (2, 0, 1)]
    q = np.column_stack([1.0 + trace, twice])
    for i in np.flatnonzero(trace <= 0.0):  # far from no rotation, where that loses digits
        q[i] = _quaternion(R[i])
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))


def _axis_pulls(error: Array, axis: Array, y: Array) -> Array:
    """Return y (s, 2) times the derivative of `_axis_error` at rotations (s, 3, 3), as (s, 3)."""
    normals = np.linalg.svd(axis[None])[2][1:]
    tilted = error @ axis
    half = np.sqrt(np.maximum(0.5 + 0.5 * tilted @ axis, 1e-12))[:, None]
    along = np.sum(tilted @ normals.T / half * y, axis=1, keepdims=True)
    turned = np.cross(tilted, y @ normals) / half
    return np.asarray(turned - np.cross(tilted, axis) * along / (4.0 * half**2))


def _axis_error(error: Array, axis: Array) -> tuple[Array, Array]:
    """Return the tilt of `axis` (2,) and its derivative (2, 3) for a turn in the wanted frame."""
    normals = np.linalg.svd(axis[None])[2][1:]
    tilted = error @ axis
    # |normals . tilted| = sin(angle) = 2 sin(half) cos(half), and 1 + axis . tilted = 2 cos(half)^2
    half = float(np.sqrt(max(0.5 + 0.5 * float(axis @ tilted), 1e-12)))
    residual = normals @ tilted / half
    turn = _skew(tilted)  # d tilted = omega x tilted = -[tilted]x omega
    slope = -normals @ turn / half + np.outer(residual, axis @ turn) / (4.0 * half**2)
    return residual, slope


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
