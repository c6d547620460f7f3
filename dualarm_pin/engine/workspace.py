"""The room a solve works in: allocated once per thread, in Python.

Every array says its shape once, in its annotation: k points, n joints, E elements of the chain, m
equality and r inequality rows a point at most, `rows` different rows of the problem, f pairs.
"""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, NamedTuple, TypeVar, get_args, get_type_hints

import numpy as np

from dualarm_pin.chain import Floats, Integers
from dualarm_pin.engine.jit.by_reference import by_reference

T = TypeVar("T", bound=NamedTuple)
FILTER_SIZE = 500  # pairs; more than a start has iterations, so that none is dropped


class Scratch(NamedTuple):
    """Room for the derivatives at one point (E elements, n variables)."""

    w: Annotated[Floats, "3 E"]  # axes
    v: Annotated[Floats, "3 E"]  # velocity columns
    B: Annotated[Floats, "3 3"]  # rotation rows, d(2 vec) = B w
    J_r: Annotated[Floats, "6 n"]  # rows scaled by the task weights
    a: Annotated[Floats, "n"]  # u . J_r, column by column
    b: Annotated[Floats, "6 E"]  # d(value)/d(column of J_r), per element and unscaled
    chain_slope: Annotated[Floats, "E E"]  # u . dJ_e/dq_j
    slope: Annotated[Floats, "E n"]  # the same by j, summed over the elements e of a variable
    alpha: Annotated[Floats, "3 E"]  # factors of the second derivatives, see `derivatives`
    beta: Annotated[Floats, "3 E"]  # the same
    second: Annotated[Floats, "E E"]  # second derivatives by elements, upper triangle
    A: Annotated[Floats, "6 6"]  # J_r W J_r^T
    G: Annotated[Floats, "6 6"]  # dphi/dA
    dJ: Annotated[Floats, "E 6 n"]  # derivative of J_r by element
    dA: Annotated[Floats, "E 6 6"]  # derivative of A by element
    dG: Annotated[Floats, "6 6"]  # change of G along one dA
    GdJ: Annotated[Floats, "6 n"]  # G times one dJ
    value: Annotated[Floats, "1"]  # phi
    index_call: Annotated[Integers, "1"]  # address of what an index other than force contributes
    index_calls: Annotated[Integers, "3"]  # addresses of phi, gradient and curvature of the user's
    model: Annotated[Floats, "22 6"]  # what a kernel fills, see `kernels.layout`
    along: Annotated[Floats, "6 n"]  # f_a . J_r for the six vectors of the model
    moments: Annotated[Floats, "6 6 E"]  # dJ times the same, weighted, by element
    own: Annotated[Floats, "6 E"]  # f_a . dA f_a by element
    change: Annotated[Floats, "E"]  # f_a . dA f_b of one pair
    place: Annotated[Floats, "E+1 7"]  # segments of the chain in e1, for rows
    row_calls: Annotated[Integers, "rows 3"]  # addresses of phi, slope and bend of every row
    row_columns: Annotated[Floats, "6 E"]  # motion of body b seen from body a
    row_slope: Annotated[Floats, "6"]  # dg by the twist of b
    row_bend: Annotated[Floats, "6 6"]  # second derivative
    row_bent: Annotated[Floats, "6"]  # the same times one column
    row_frame: Annotated[Floats, "3 3"]  # rotation of a in e1
    row_turn: Annotated[Floats, "3 3"]  # rotation of b in a
    row_other: Annotated[Floats, "3 3"]  # rotation of b in e1
    row_shift: Annotated[Floats, "3"]  # position of b in a
    row_value: Annotated[Floats, "1"]  # g


class Iterate(NamedTuple):
    """Where a solve stands, and what it returns."""

    q: Annotated[Floats, "k n"]  # joints
    y: Annotated[Floats, "k m"]  # multipliers of the equality rows
    lower: Annotated[Floats, "k n"]  # multipliers of the lower bounds
    upper: Annotated[Floats, "k n"]  # multipliers of the upper bounds
    slack: Annotated[Floats, "k r"]  # s of every inequality row, g - s = 0
    push: Annotated[Floats, "k r"]  # multipliers of the inequality rows


class Workspace(NamedTuple):
    """Room for one solve of k points, m equality and r inequality rows; one a thread."""

    scratch: Scratch  # Room for one point
    axes: Annotated[Floats, "k 3 E"]  # w of the last posture evaluated
    columns: Annotated[Floats, "k 3 E"]  # its v
    error: Annotated[Floats, "k 4"]  # its error quaternion
    residual: Annotated[Floats, "k m"]  # equality rows, those of the pose first
    trial_residual: Annotated[Floats, "k m"]
    jacobian: Annotated[Floats, "k m n"]  # of the equality rows
    gap: Annotated[Floats, "k r"]  # inequality rows g
    trial_gap: Annotated[Floats, "k r"]
    row_jacobian: Annotated[Floats, "k r n"]  # of the inequality rows
    gradient: Annotated[Floats, "k n"]  # of the objective
    barrier_gradient: Annotated[Floats, "k n"]  # of the barrier objective
    pulled: Annotated[Floats, "k n"]  # the same, with the pull of the inequality rows
    hessian: Annotated[Floats, "k n n"]  # diagonal blocks of the Lagrangian's Hessian
    link: Annotated[Floats, "k n"]  # diag(metric) dq of the link after each point
    stiffness: Annotated[Floats, "k"]  # 4 weight dq^T diag(metric) dq of that link
    basis: Annotated[Floats, "k n n"]  # orthonormal rows: first the row space, then the null space
    triangle: Annotated[Floats, "k m m"]  # lower triangular factor: jacobian = triangle basis
    kept: Annotated[Integers, "k m"]  # which equality rows are independent
    rank: Annotated[Integers, "k"]  # how many
    free: Annotated[Integers, "k"]  # n - rank, size of the reduced blocks
    mirror: Annotated[Floats, "m n"]  # Householder vectors of one point
    half: Annotated[Floats, "n n"]  # room for a product
    diagonal: Annotated[Floats, "k n n"]  # reduced Hessian
    coupling: Annotated[Floats, "k n n"]  # reduced coupling with the point before
    factor: Annotated[Floats, "k n n"]  # Cholesky factors, diagonal inverted
    below: Annotated[Floats, "k n n"]  # Cholesky factors left of the diagonal
    row: Annotated[Floats, "m"]  # room
    stack: Annotated[Floats, "2 m+r"]  # residual of one point in a restoration, and of its trial
    stack_jacobian: Annotated[Floats, "m+r n"]  # its Jacobian
    stack_square: Annotated[Floats, "m+r m+r"]  # its normal matrix
    stack_row: Annotated[Floats, "m+r"]  # room
    reduced: Annotated[Floats, "k n"]  # right-hand side and solution
    step: Annotated[Floats, "k n"]
    correction: Annotated[Floats, "k n"]  # second-order correction of the step
    normal: Annotated[Floats, "k n"]  # part of the step in the row space
    product: Annotated[Floats, "k n"]  # Hessian times a vector
    target: Annotated[Floats, "k m"]  # residual that the step shall remove
    target_gap: Annotated[Floats, "k r"]  # g - s that the step shall remove
    new_y: Annotated[Floats, "k m"]  # multipliers after a full step
    trial: Annotated[Floats, "k n"]
    trial_slack: Annotated[Floats, "k r"]
    slack_step: Annotated[Floats, "k r"]  # step of the slacks, and of their multipliers:
    push_step: Annotated[Floats, "k r"]
    plain_slack_step: Annotated[Floats, "k r"]  # that of the slacks without correction
    lower_step: Annotated[Floats, "k n"]  # step of the multipliers of the lower bounds
    upper_step: Annotated[Floats, "k n"]
    filter: Annotated[Floats, "f 2"]  # pairs of violation and barrier objective
    at: Iterate  # Where the solve stands
    best: Iterate  # The best iterate so far


for _record in (Scratch, Iterate, Workspace):
    by_reference(_record, _record._fields)


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
    return allocate(Workspace, sizes_of(k, elements, n, m, r, rows))


def sizes_of(k: int, elements: int, n: int, m: int, r: int, rows: int) -> dict[str, int]:
    """Return the lengths by the names that the annotations use; arguments as `new_workspace`."""
    sizes = {"k": k, "E": elements, "E+1": elements + 1, "n": n, "m": m, "r": r, "m+r": m + r}
    return sizes | {"rows": rows, "f": FILTER_SIZE}


def new_scratch(elements: int, n: int, rows: int) -> Scratch:
    """Allocate the room for one point; the arguments are those of `new_workspace`."""
    return allocate(Scratch, {"E": elements, "E+1": elements + 1, "n": n, "rows": rows})


def allocate(record: type[T], sizes: dict[str, int]) -> T:
    """Allocate a record of arrays, and the records inside it, by the lengths of their axes."""
    room = []
    for kind, shape, dtype in _layout(record):
        if dtype is None:
            room.append(allocate(kind, sizes))
        else:
            lengths = [sizes[size] if size in sizes else int(size) for size in shape]
            room.append(np.zeros(lengths, dtype=dtype))
    return record(*room)


@cache
def _layout(record: type[NamedTuple]) -> list[tuple[Any, tuple[str, ...], Any]]:
    """Return type, shape and number type of every field; a record inside has no number type."""
    hints = get_type_hints(record, include_extras=True)
    found: list[tuple[Any, tuple[str, ...], Any]] = []
    for name in record._fields:
        kind, *shape = get_args(hints[name]) or (hints[name],)
        dtype = (np.int64 if kind == Integers else np.float64) if shape else None
        found.append((kind, tuple(shape[0].split()) if shape else (), dtype))
    return found
