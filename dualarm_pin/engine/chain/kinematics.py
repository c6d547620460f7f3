"""Where the chain stands: axes and velocity columns, the pose residual and its Jacobian.

Everything is expressed in e1. Column e of J_r is [v_e; w_e], the velocity [linear; angular] of e2
with respect to e1 per unit speed of element e. Arrays over elements are (3, E), so that loops over
elements run through memory.
"""

from __future__ import annotations

import math

from dualarm_pin.chain import PARAMETER, REVOLUTE, VARIABLE, Chain, Floats
from dualarm_pin.engine.chain.vectors import (
    Quaternion,
    Vector,
    cross,
    multiply,
    rotate,
    turn_about_z,
    z_axis,
)
from dualarm_pin.engine.jit.compiled import compiled


@compiled
def element_value(chain: Chain, q: Floats, e: int) -> float:
    """Return where element e stands [rad or m]."""
    value: float = chain.offset[e]
    if chain.role[e] == VARIABLE:
        value += chain.scale[e] * q[chain.source[e]]
    elif chain.role[e] == PARAMETER:
        value += chain.scale[e] * chain.parameters[chain.source[e]]
    return value


@compiled
def place_chain(chain: Chain, q: Floats, w: Floats, v: Floats) -> tuple[Vector, Quaternion]:
    """Walk from e1 to e2 and fill the columns of J_r, one per element.

    w_e is the axis of a revolute element and v_e = w_e x (p_e2 - p_e); a prismatic element has
    w_e = 0 and v_e its axis.

    Args:
        chain: The chain.
        q: (n,) joint variables.
        w: (3, E) filled, rad per unit.
        v: (3, E) filled, m per unit.

    Returns:
        Position and quaternion of e2 in e1. The quaternion is the running product, so it is a
        smooth function of q (no choice of sign).
    """
    elements = chain.kind.shape[0]
    place, fixed = chain.translation, chain.quaternion
    p = (place[0, 0], place[0, 1], place[0, 2])
    Q = (fixed[0, 0], fixed[0, 1], fixed[0, 2], fixed[0, 3])
    for e in range(elements):
        axis = z_axis(Q)
        value = element_value(chain, q, e)
        if chain.kind[e] == REVOLUTE:
            w[0, e], w[1, e], w[2, e] = axis
            v[0, e], v[1, e], v[2, e] = p
            Q = turn_about_z(Q, math.sin(0.5 * value), math.cos(0.5 * value))
        else:
            w[0, e], w[1, e], w[2, e] = 0.0, 0.0, 0.0
            v[0, e], v[1, e], v[2, e] = axis
            p = (p[0] + value * axis[0], p[1] + value * axis[1], p[2] + value * axis[2])
        step = rotate(Q, (place[e + 1, 0], place[e + 1, 1], place[e + 1, 2]))
        p = (p[0] + step[0], p[1] + step[1], p[2] + step[2])
        turn = (fixed[e + 1, 0], fixed[e + 1, 1], fixed[e + 1, 2], fixed[e + 1, 3])
        Q = multiply(Q, turn)
    for e in range(elements):
        if chain.kind[e] == REVOLUTE:
            arm = (p[0] - v[0, e], p[1] - v[1, e], p[2] - v[2, e])
            v[0, e], v[1, e], v[2, e] = cross((w[0, e], w[1, e], w[2, e]), arm)
    return p, Q


@compiled
def pose_residual(
    p: Vector, Q: Quaternion, position: Floats, target: Floats, residual: Floats, error: Floats
) -> None:
    """Fill the residual [p - p_d; 2 vec(Q_d* Q)] (6,) and the error quaternion Q_d* Q (4,).

    The rotation part is smooth in q and vanishes only at the right rotation (both covers of it).
    Its norm is 2 sin(angle / 2). Without its third row the spin about z is free: the first two
    have norm 2 sin(swing / 2), largest where the axis points the wrong way, so nothing is
    trapped there. (The frames are turned beforehand so that z is the spin axis.)
    """
    error[0], error[1], error[2], error[3] = multiply(
        (target[0], -target[1], -target[2], -target[3]), Q
    )
    for i in range(3):
        residual[i] = p[i] - position[i]
        residual[3 + i] = 2.0 * error[1 + i]


@compiled
def rotation_rows(error: Floats, target_axes: Floats, B: Floats) -> None:
    """Fill B (3, 3) with d(2 vec(Q_d* Q))/dq_e = B w_e, B = (s I - [vec]x) R_d^T.

    From dQ/dq_e = (0, w_e) Q / 2 and Q_d* (0, w) Q = (0, R_d^T w) Q_d* Q.

    Args:
        error: (4,) Q_d* Q = (s, vec).
        target_axes: (3, 3) R_d^T.
        B: Filled.
    """
    s, x, y, z = error[0], error[1], error[2], error[3]
    for c in range(3):
        a0, a1, a2 = target_axes[0, c], target_axes[1, c], target_axes[2, c]
        B[0, c] = s * a0 + a1 * z - a2 * y
        B[1, c] = s * a1 + a2 * x - a0 * z
        B[2, c] = s * a2 + a0 * y - a1 * x


@compiled
def constraint_jacobian(chain: Chain, w: Floats, v: Floats, B: Floats, jacobian: Floats) -> None:
    """Fill the first six rows of the Jacobian (m, n): column += scale_e [v_e; B w_e]."""
    jacobian[:] = 0.0
    for e in range(chain.kind.shape[0]):
        if chain.role[e] != VARIABLE:
            continue
        k, s = chain.source[e], chain.scale[e]
        for i in range(3):
            jacobian[i, k] += s * v[i, e]
            jacobian[3 + i, k] += s * (B[i, 0] * w[0, e] + B[i, 1] * w[1, e] + B[i, 2] * w[2, e])


@compiled
def place_segments(chain: Chain, q: Floats, place: Floats) -> None:
    """Fill place (E+1, 7), the pose [position; quaternion] in e1 of every segment.

    The same walk as `place_chain`, for problems with rows between other bodies than the hands.
    """
    elements = chain.kind.shape[0]
    translation, fixed = chain.translation, chain.quaternion
    p, Q = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)
    for e in range(elements + 1):
        step = rotate(Q, (translation[e, 0], translation[e, 1], translation[e, 2]))
        p = (p[0] + step[0], p[1] + step[1], p[2] + step[2])
        Q = multiply(Q, (fixed[e, 0], fixed[e, 1], fixed[e, 2], fixed[e, 3]))
        place[e, 0], place[e, 1], place[e, 2] = p
        place[e, 3], place[e, 4], place[e, 5], place[e, 6] = Q
        if e < elements:
            value = element_value(chain, q, e)
            if chain.kind[e] == REVOLUTE:
                Q = turn_about_z(Q, math.sin(0.5 * value), math.cos(0.5 * value))
            else:
                axis = z_axis(Q)
                p = (p[0] + value * axis[0], p[1] + value * axis[1], p[2] + value * axis[2])


@compiled
def relative_jacobian(chain: Chain, w: Floats, v: Floats, J_r: Floats) -> None:
    """Fill J_r (6, n): column of a variable = sum of scale_e [v_e; w_e] over its elements."""
    J_r[:] = 0.0
    for e in range(chain.kind.shape[0]):
        if chain.role[e] != VARIABLE:
            continue
        k, s = chain.source[e], chain.scale[e]
        for i in range(3):
            J_r[i, k] += s * v[i, e]
            J_r[3 + i, k] += s * w[i, e]
