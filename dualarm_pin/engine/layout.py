"""The data of one problem as contiguous arrays, and the room a solve works in.

All values are run-time data: another robot, index, path, bound or weight compiles nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dualarm_pin.engine.by_reference import by_reference
from dualarm_pin.engine.chain import Chain, Floats, Integers
from dualarm_pin.engine.compiled import compiled

# index_kind: the fast path, or phi and its derivatives by address (the number goes with the call)
FORCE, VELOCITY, YOSHIKAWA, CONDITION, SMALLEST, CUSTOM = 0, 1, 2, 3, 4, 5


@by_reference
class Points(NamedTuple):
    """What differs from point to point.

    The pose is resolved in axes of e2 turned so that the spin axis is their z.

    Attributes:
        position: (k, 3) m, target of e2 in e1.
        quaternion: (k, 4) target (w, x, y, z).
        target_axes: (k, 3, 3) transposed target rotation.
        rows: (k,) 6, 5 or 3 pose rows.
        u: (k, 6) directions in e1.
        index_weight: (k,).
        linear: (k, n).
        link_weight: (k,) of the link after each point; the last one is not used.
        end_weight: (2,) weights of the links to the fixed ends, 0 for none.
    """

    position: Floats
    quaternion: Floats
    target_axes: Floats
    rows: Integers
    u: Floats
    index_weight: Floats
    linear: Floats
    link_weight: Floats
    end_weight: Floats


@by_reference
class Problem(NamedTuple):
    """min sum_i index_weight_i c(q_i) + linear_i . q_i + links, s.t. pose rows and bounds.

    A link between neighbours is weight * (dq^T diag(metric) dq)^2; the ends are links to fixed
    postures before the first and after the last point.

    Attributes:
        chain: The chain from e1 to e2.
        points: Targets, directions and weights.
        index_kind: FORCE to CUSTOM.
        calls: (3,) addresses of phi, gradient and curvature (0 for FORCE).
        task_scale: (6,) square roots of the task weights.
        joint_weights: (n,) diagonal of W.
        centre: (n,) middle of the bounds.
        centre_weight: (n,) weight of (q - centre)^2, with the index.
        lower: (n,) rad or m; a fixed variable has a harmless interval around its value.
        upper: (n,).
        fixed: (f,) columns that must not move.
        fixed_value: (f,) where they stand.
        metric: (n,).
        end: (2, n) fixed neighbours before and after.
        inequality: (r, 12) inequality rows of every point: none yet.
    """

    chain: Chain
    points: Points
    index_kind: int
    calls: Integers
    task_scale: Floats
    joint_weights: Floats
    centre: Floats
    centre_weight: Floats
    lower: Floats
    upper: Floats
    fixed: Integers
    fixed_value: Floats
    metric: Floats
    end: Floats
    inequality: Floats


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


def room_for_window(points: Points, k: int) -> Points:
    """Return points of the same kind with room for k of them."""
    room = {
        name: np.zeros((k, *array.shape[1:]), dtype=array.dtype)
        for name, array in points._asdict().items()
    }
    return Points(**(room | {"end_weight": np.zeros(2)}))


@compiled
def load_window(whole: Points, first: int, window: Points) -> None:
    """Fill a window with neighbouring points; a fixed end counts where the path ends."""
    count, total = window.position.shape[0], whole.position.shape[0]
    for i in range(count):
        at = first + i
        for c in range(3):
            window.position[i, c] = whole.position[at, c]
            for r in range(3):
                window.target_axes[i, c, r] = whole.target_axes[at, c, r]
        for c in range(4):
            window.quaternion[i, c] = whole.quaternion[at, c]
        for c in range(6):
            window.u[i, c] = whole.u[at, c]
        for c in range(whole.linear.shape[1]):
            window.linear[i, c] = whole.linear[at, c]
        window.rows[i] = whole.rows[at]
        window.index_weight[i] = whole.index_weight[at]
        window.link_weight[i] = whole.link_weight[at]
    window.end_weight[0] = whole.end_weight[0] if first == 0 else 0.0
    window.end_weight[1] = whole.end_weight[1] if first + count == total else 0.0
