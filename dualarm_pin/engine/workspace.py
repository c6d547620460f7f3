"""The room a solve works in: allocated once per thread, in Python."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dualarm_pin.engine.by_reference import by_reference
from dualarm_pin.engine.chain import Floats, Integers


@by_reference
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


@by_reference
class Workspace(NamedTuple):
    """Room for one solve of k points; every thread has its own.

    Attributes:
        scratch: Room for one point.
        axes: (k, 3, E) w of the last posture evaluated.
        columns: (k, 3, E) its v.
        error: (k, 4) its error quaternion.
        residual: (k, 6) pose residual.
        trial_residual: (k, 6).
        jacobian: (k, 6, n) of the pose residual.
        gradient: (k, n) of the objective.
        barrier_gradient: (k, n).
        hessian: (k, n, n) diagonal blocks of the Lagrangian's Hessian.
        link: (k, n) diag(metric) dq of the link after each point.
        stiffness: (k,) 4 weight dq^T diag(metric) dq of that link.
        basis: (k, n, n) rows: orthonormal basis, first of the row space, then of the null space.
        triangle: (k, 6, 6) lower triangular factor: jacobian = triangle basis.
        kept: (k, 6) which pose rows are independent.
        rank: (k,) how many.
        free: (k,) n - rank, size of the reduced blocks.
        mirror: (6, n) Householder vectors of one point.
        half: (n, n) room for a product.
        diagonal: (k, d, d) reduced Hessian, d = n.
        coupling: (k, d, d) reduced coupling with the point before.
        factor: (k, d, d) Cholesky factors, diagonal inverted.
        below: (k, d, d) Cholesky factors left of the diagonal.
        row: (6,) room.
        reduced: (k, d) right-hand side and solution.
        step: (k, n).
        correction: (k, n) second-order correction of the step.
        normal: (k, n) part of the step in the row space.
        product: (k, n) Hessian times a vector.
        target: (k, 6) residual that the step shall remove.
        new_y: (k, 6) multipliers after a full step.
        trial: (k, n).
        lower_step: (k, n) step of the multipliers of the lower bounds.
        upper_step: (k, n).
        filter: (f, 2) pairs of violation and barrier objective.
    """

    scratch: Scratch
    axes: Floats
    columns: Floats
    error: Floats
    residual: Floats
    trial_residual: Floats
    jacobian: Floats
    gradient: Floats
    barrier_gradient: Floats
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
    reduced: Floats
    step: Floats
    correction: Floats
    normal: Floats
    product: Floats
    target: Floats
    new_y: Floats
    trial: Floats
    lower_step: Floats
    upper_step: Floats
    filter: Floats


FILTER_SIZE = 500


def new_scratch(elements: int, n: int) -> Scratch:
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
    )


def new_workspace(k: int, elements: int, n: int) -> Workspace:
    """Allocate the room for one solve."""
    return Workspace(
        scratch=new_scratch(elements, n),
        axes=np.zeros((k, 3, elements)),
        columns=np.zeros((k, 3, elements)),
        error=np.zeros((k, 4)),
        residual=np.zeros((k, 6)),
        trial_residual=np.zeros((k, 6)),
        jacobian=np.zeros((k, 6, n)),
        gradient=np.zeros((k, n)),
        barrier_gradient=np.zeros((k, n)),
        hessian=np.zeros((k, n, n)),
        link=np.zeros((k, n)),
        stiffness=np.zeros(k),
        basis=np.zeros((k, n, n)),
        triangle=np.zeros((k, 6, 6)),
        kept=np.zeros((k, 6), dtype=np.int64),
        rank=np.zeros(k, dtype=np.int64),
        free=np.zeros(k, dtype=np.int64),
        mirror=np.zeros((6, n)),
        half=np.zeros((n, n)),
        diagonal=np.zeros((k, n, n)),
        coupling=np.zeros((k, n, n)),
        factor=np.zeros((k, n, n)),
        below=np.zeros((k, n, n)),
        row=np.zeros(6),
        reduced=np.zeros((k, n)),
        step=np.zeros((k, n)),
        correction=np.zeros((k, n)),
        normal=np.zeros((k, n)),
        product=np.zeros((k, n)),
        target=np.zeros((k, 6)),
        new_y=np.zeros((k, 6)),
        trial=np.zeros((k, n)),
        lower_step=np.zeros((k, n)),
        upper_step=np.zeros((k, n)),
        filter=np.zeros((FILTER_SIZE, 2)),
    )
