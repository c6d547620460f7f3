"""The room a solve works in: allocated once per thread, in Python."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dualarm_pin.chain import Floats, Integers
from dualarm_pin.engine.jit.by_reference import by_reference


class Scratch(NamedTuple):
    """Room for the derivatives at one point (E elements, n variables).

    Attributes:
        w: (3, E) axes.
        v: (3, E) velocity columns.
        B: (3, 3) rotation rows, d(2 vec) = B w.
        J_r: (6, n), rows scaled by the task weights.
        a: (n,) u . J_r, column by column.
        b: (6, E) d(value)/d(column of J_r), per element and unscaled.
        chain_slope: (E, E) u . dJ_e/dq_j.
        slope: (E, n) the same by j, summed over the elements e of a variable.
        alpha: (3, E) factors of the second derivatives, see `derivatives`.
        beta: (3, E) the same.
        second: (E, E) second derivatives by elements, upper triangle.
        A: (6, 6) J_r W J_r^T.
        G: (6, 6) dphi/dA.
        dJ: (E, 6, n) derivative of J_r by element.
        dA: (E, 6, 6) derivative of A by element.
        dG: (6, 6) change of G along one dA.
        GdJ: (6, n) G times one dJ.
        value: (1,) phi.
        index_calls: (3,) addresses of phi, gradient and curvature.
        place: (E+1, 7) segments of the chain in e1, for rows.
        row_calls: (rows, 3) addresses of phi, slope and bend of every row.
        row_columns: (6, E) motion of body b seen from body a.
        row_slope: (6,) dg by the twist of b.
        row_bend: (6, 6) second derivative.
        row_frame: (3, 3) rotation of a in e1.
        row_turn: (3, 3) rotation of b in a.
        row_other: (3, 3) rotation of b in e1.
        row_shift: (3,) position of b in a.
        row_value: (1,) g.
    """

    w: Floats
    v: Floats
    B: Floats
    J_r: Floats
    a: Floats
    b: Floats
    chain_slope: Floats
    slope: Floats
    alpha: Floats
    beta: Floats
    second: Floats
    A: Floats
    G: Floats
    dJ: Floats
    dA: Floats
    dG: Floats
    GdJ: Floats
    value: Floats
    index_calls: Integers
    place: Floats
    row_calls: Integers
    row_columns: Floats
    row_slope: Floats
    row_bend: Floats
    row_frame: Floats
    row_turn: Floats
    row_other: Floats
    row_shift: Floats
    row_value: Floats


class Iterate(NamedTuple):
    """Where a solve stands, and what it returns.

    Attributes:
        q: (k, n) joints.
        y: (k, m) multipliers of the equality rows.
        lower: (k, n) multipliers of the lower bounds.
        upper: (k, n) multipliers of the upper bounds.
        slack: (k, r) s of every inequality row, g - s = 0.
        push: (k, r) multipliers of the inequality rows.
    """

    q: Floats
    y: Floats
    lower: Floats
    upper: Floats
    slack: Floats
    push: Floats


class Workspace(NamedTuple):
    """Room for one solve of k points, m equality and r inequality rows; one a thread.

    Attributes:
        scratch: Room for one point.
        axes: (k, 3, E) w of the last posture evaluated.
        columns: (k, 3, E) its v.
        error: (k, 4) its error quaternion.
        residual: (k, m) equality rows, those of the pose first.
        trial_residual: (k, m).
        jacobian: (k, m, n) of the equality rows.
        gap: (k, r) inequality rows g.
        trial_gap: (k, r).
        row_jacobian: (k, r, n) of the inequality rows.
        gradient: (k, n) of the objective.
        barrier_gradient: (k, n) of the barrier objective.
        pulled: (k, n) the same, with the pull of the inequality rows.
        hessian: (k, n, n) diagonal blocks of the Lagrangian's Hessian.
        link: (k, n) diag(metric) dq of the link after each point.
        stiffness: (k,) 4 weight dq^T diag(metric) dq of that link.
        basis: (k, n, n) rows: orthonormal basis, first of the row space, then of the null space.
        triangle: (k, m, m) lower triangular factor: jacobian = triangle basis.
        kept: (k, m) which equality rows are independent.
        rank: (k,) how many.
        free: (k,) n - rank, size of the reduced blocks.
        mirror: (m, n) Householder vectors of one point.
        half: (n, n) room for a product.
        diagonal: (k, d, d) reduced Hessian, d = n.
        coupling: (k, d, d) reduced coupling with the point before.
        factor: (k, d, d) Cholesky factors, diagonal inverted.
        below: (k, d, d) Cholesky factors left of the diagonal.
        row: (m,) room.
        stack: (2, m + r) residual of one point in a restoration, and of its trial.
        stack_jacobian: (m + r, n) its Jacobian.
        stack_square: (m + r, m + r) its normal matrix.
        stack_row: (m + r,) room.
        reduced: (k, d) right-hand side and solution.
        step: (k, n).
        correction: (k, n) second-order correction of the step.
        normal: (k, n) part of the step in the row space.
        product: (k, n) Hessian times a vector.
        target: (k, m) residual that the step shall remove.
        target_gap: (k, r) g - s that the step shall remove.
        new_y: (k, m) multipliers after a full step.
        trial: (k, n).
        trial_slack: (k, r).
        slack_step: (k, r) step of the slacks, and of their multipliers:
        push_step: (k, r).
        plain_slack_step: (k, r) that of the slacks without correction.
        lower_step: (k, n) step of the multipliers of the lower bounds.
        upper_step: (k, n).
        filter: (f, 2) pairs of violation and barrier objective.
        at: Where the solve stands.
        best: The best iterate so far.
    """

    scratch: Scratch
    axes: Floats
    columns: Floats
    error: Floats
    residual: Floats
    trial_residual: Floats
    jacobian: Floats
    gap: Floats
    trial_gap: Floats
    row_jacobian: Floats
    gradient: Floats
    barrier_gradient: Floats
    pulled: Floats
    hessian: Floats
    link: Floats
    stiffness: Floats
    basis: Floats
    triangle: Floats
    kept: Integers
    rank: Integers
    free: Integers
    mirror: Floats
    half: Floats
    diagonal: Floats
    coupling: Floats
    factor: Floats
    below: Floats
    row: Floats
    stack: Floats
    stack_jacobian: Floats
    stack_square: Floats
    stack_row: Floats
    reduced: Floats
    step: Floats
    correction: Floats
    normal: Floats
    product: Floats
    target: Floats
    target_gap: Floats
    new_y: Floats
    trial: Floats
    trial_slack: Floats
    slack_step: Floats
    push_step: Floats
    plain_slack_step: Floats
    lower_step: Floats
    upper_step: Floats
    filter: Floats
    at: Iterate
    best: Iterate


FILTER_SIZE = 500  # pairs; more than a start has iterations, so that none is dropped

for _record in (Scratch, Iterate, Workspace):
    by_reference(_record, _record._fields)


def new_scratch(elements: int, n: int, rows: int) -> Scratch:
    """Allocate the room for one point."""
    return Scratch(
        w=np.zeros((3, elements)),
        v=np.zeros((3, elements)),
        B=np.zeros((3, 3)),
        J_r=np.zeros((6, n)),
        a=np.zeros(n),
        b=np.zeros((6, elements)),
        chain_slope=np.zeros((elements, elements)),
        slope=np.zeros((elements, n)),
        alpha=np.zeros((3, elements)),
        beta=np.zeros((3, elements)),
        second=np.zeros((elements, elements)),
        A=np.zeros((6, 6)),
        G=np.zeros((6, 6)),
        dJ=np.zeros((elements, 6, n)),
        dA=np.zeros((elements, 6, 6)),
        dG=np.zeros((6, 6)),
        GdJ=np.zeros((6, n)),
        value=np.zeros(1),
        index_calls=np.zeros(3, dtype=np.int64),
        place=np.zeros((elements + 1, 7)),
        row_calls=np.zeros((rows, 3), dtype=np.int64),
        row_columns=np.zeros((6, elements)),
        row_slope=np.zeros(6),
        row_bend=np.zeros((6, 6)),
        row_frame=np.zeros((3, 3)),
        row_turn=np.zeros((3, 3)),
        row_other=np.zeros((3, 3)),
        row_shift=np.zeros(3),
        row_value=np.zeros(1),
    )


def new_iterate(k: int, n: int, m: int, r: int) -> Iterate:
    """Allocate one iterate."""
    return Iterate(
        q=np.zeros((k, n)),
        y=np.zeros((k, m)),
        lower=np.zeros((k, n)),
        upper=np.zeros((k, n)),
        slack=np.zeros((k, r)),
        push=np.zeros((k, r)),
    )


def new_workspace(k: int, elements: int, n: int, m: int, r: int, rows: int) -> Workspace:
    """Allocate the room for one solve.

    Args:
        k: Points.
        elements: Elements E of the chain.
        n: Joints.
        m: Equality rows a point at most.
        r: Inequality rows a point at most.
        rows: Different rows of the problem.
    """
    return Workspace(
        scratch=new_scratch(elements, n, rows),
        axes=np.zeros((k, 3, elements)),
        columns=np.zeros((k, 3, elements)),
        error=np.zeros((k, 4)),
        residual=np.zeros((k, m)),
        trial_residual=np.zeros((k, m)),
        jacobian=np.zeros((k, m, n)),
        gap=np.zeros((k, r)),
        trial_gap=np.zeros((k, r)),
        row_jacobian=np.zeros((k, r, n)),
        gradient=np.zeros((k, n)),
        barrier_gradient=np.zeros((k, n)),
        pulled=np.zeros((k, n)),
        hessian=np.zeros((k, n, n)),
        link=np.zeros((k, n)),
        stiffness=np.zeros(k),
        basis=np.zeros((k, n, n)),
        triangle=np.zeros((k, m, m)),
        kept=np.zeros((k, m), dtype=np.int64),
        rank=np.zeros(k, dtype=np.int64),
        free=np.zeros(k, dtype=np.int64),
        mirror=np.zeros((m, n)),
        half=np.zeros((n, n)),
        diagonal=np.zeros((k, n, n)),
        coupling=np.zeros((k, n, n)),
        factor=np.zeros((k, n, n)),
        below=np.zeros((k, n, n)),
        row=np.zeros(m),
        stack=np.zeros((2, m + r)),
        stack_jacobian=np.zeros((m + r, n)),
        stack_square=np.zeros((m + r, m + r)),
        stack_row=np.zeros(m + r),
        reduced=np.zeros((k, n)),
        step=np.zeros((k, n)),
        correction=np.zeros((k, n)),
        normal=np.zeros((k, n)),
        product=np.zeros((k, n)),
        target=np.zeros((k, m)),
        target_gap=np.zeros((k, r)),
        new_y=np.zeros((k, m)),
        trial=np.zeros((k, n)),
        trial_slack=np.zeros((k, r)),
        slack_step=np.zeros((k, r)),
        push_step=np.zeros((k, r)),
        plain_slack_step=np.zeros((k, r)),
        lower_step=np.zeros((k, n)),
        upper_step=np.zeros((k, n)),
        filter=np.zeros((FILTER_SIZE, 2)),
        at=new_iterate(k, n, m, r),
        best=new_iterate(k, n, m, r),
    )
