"""Value, gradient and exact Hessian of a row between two bodies of the chain, at one point.

Only the elements between body a and body b move the row. Seen from a, b moves with the columns
[v_e(x); w_e] at its point x where b comes later in the chain than a, and with minus these columns
where it comes earlier; then the chain is walked the other way. With v_e(x) = v_e - w_e x (p - x)
for p the position of e2, elements j nearer to a than l, and slope and bend as `Row` has them:

    d g / dq_j         = slope . [v_j; w_j]
    d2 g / dq_j dq_l   = [v_j; w_j] . bend [v_l; w_l] + slope . [w_j x v_l; w_j x w_l / 2]

For a plane of a and a point of b, slope is [normal; 0] and bend is 0 if x is the point itself; for
two capsules see `capsule_terms`.
"""

from __future__ import annotations

from dualarm_pin.chain import VARIABLE, Chain, Floats
from dualarm_pin.engine.chain.capsule_terms import capsule_distance, capsule_terms
from dualarm_pin.engine.chain.vectors import Vector, cross, dot, rotate
from dualarm_pin.engine.jit.address import call_address
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.rows.table import CAPSULES, PLACEMENTS, PLANE_POINT, RowTable


@compiled
def row_values(table: RowTable, i: int, scratch: Scratch, values: Floats) -> None:
    """Fill values with g of the rows at point i, whose segments are placed in the scratch."""
    for j in range(table.size[i]):
        if table.kind[i, j] == PLANE_POINT:
            normal, x = _plane_and_point(table, i, j, scratch)
            place, data = scratch.place[table.first[i, j]], table.data[i, j]
            arm = (x[0] - place[0], x[1] - place[1], x[2] - place[2])
            values[j] = dot(normal, arm) - data[3]
        elif table.kind[i, j] == CAPSULES:
            values[j] = capsule_distance(table, i, j, scratch)[0] - table.data[i, j, 12]
        else:
            _relative_pose(table, i, j, scratch)
            _call(table, i, j, scratch, 0, scratch.row_value.ctypes.data)
            values[j] = scratch.row_value[0]


@compiled
def row_terms(
    table: RowTable,
    i: int,
    j: int,
    multiplier: float,
    chain: Chain,
    scratch: Scratch,
    slope: Floats,
) -> None:
    """Fill the gradient (n,) of row j at point i, and add multiplier times its Hessian.

    The Hessian goes into the upper triangle of the second derivatives by elements.
    """
    if table.kind[i, j] == PLANE_POINT:
        normal, x = _plane_and_point(table, i, j, scratch)
        _columns_at(table, i, j, x, scratch)
        scratch.row_slope[:] = 0.0
        scratch.row_slope[0], scratch.row_slope[1], scratch.row_slope[2] = normal
    elif table.kind[i, j] == CAPSULES:
        x = capsule_terms(table, i, j, scratch)
        _columns_at(table, i, j, x, scratch)
        _add_bend(table, i, j, multiplier, scratch)
    else:
        x = _relative_pose(table, i, j, scratch)
        _columns_at(table, i, j, x, scratch)
        _columns_in_first(table, i, j, scratch)
        _call(table, i, j, scratch, 1, scratch.row_slope.ctypes.data)
        _call(table, i, j, scratch, 2, scratch.row_bend.ctypes.data)
        _add_bend(table, i, j, multiplier, scratch)
    _gradient(table, i, j, chain, scratch, slope)
    _add_nests(table, i, j, multiplier, scratch)


@compiled
def _range(table: RowTable, i: int, j: int) -> tuple[int, int, float]:
    """Return the elements between the bodies, first and past the last, and the sign of a column."""
    a, b = table.first[i, j], table.second[i, j]
    if a <= b:
        return a, b, 1.0
    return b, a, -1.0


@compiled
def _plane_and_point(table: RowTable, i: int, j: int, scratch: Scratch) -> tuple[Vector, Vector]:
    """Return the normal and the point in e1 axes."""
    data = table.data[i, j]
    a, b = scratch.place[table.first[i, j]], scratch.place[table.second[i, j]]
    normal = rotate((a[3], a[4], a[5], a[6]), (data[0], data[1], data[2]))
    arm = rotate((b[3], b[4], b[5], b[6]), (data[4], data[5], data[6]))
    return normal, (b[0] + arm[0], b[1] + arm[1], b[2] + arm[2])


@compiled
def _columns_at(table: RowTable, i: int, j: int, x: Vector, scratch: Scratch) -> None:
    """Fill row_columns (6, E): the signed columns [v_e(x); w_e] of the elements between."""
    first, last, sign = _range(table, i, j)
    w, v, columns = scratch.w, scratch.v, scratch.row_columns
    end = scratch.place[w.shape[1]]
    arm = (end[0] - x[0], end[1] - x[1], end[2] - x[2])
    for e in range(first, last):
        we = (w[0, e], w[1, e], w[2, e])
        back = cross(we, arm)
        for c in range(3):
            columns[c, e] = sign * (v[c, e] - back[c])
            columns[3 + c, e] = sign * we[c]


@compiled
def _relative_pose(table: RowTable, i: int, j: int, scratch: Scratch) -> Vector:
    """Fill row_frame, row_turn and row_shift; return the origin of b in e1.

    row_frame (3, 3) is the rotation of a in e1, row_turn (3, 3) and row_shift (3,) the pose of b
    in a.
    """
    data = table.data[i, j]
    a, b = scratch.place[table.first[i, j]], scratch.place[table.second[i, j]]
    qa, qb = (a[3], a[4], a[5], a[6]), (b[3], b[4], b[5], b[6])
    frame, turn, shift, other = (
        scratch.row_frame,
        scratch.row_turn,
        scratch.row_shift,
        scratch.row_other,
    )
    for c in range(3):
        column = rotate(qa, (data[c], data[3 + c], data[6 + c]))
        frame[0, c], frame[1, c], frame[2, c] = column
        column = rotate(qb, (data[12 + c], data[15 + c], data[18 + c]))
        other[0, c], other[1, c], other[2, c] = column
    at = rotate(qa, (data[9], data[10], data[11]))
    origin = (a[0] + at[0], a[1] + at[1], a[2] + at[2])
    at = rotate(qb, (data[21], data[22], data[23]))
    x = (b[0] + at[0], b[1] + at[1], b[2] + at[2])
    for r in range(3):
        shift[r] = 0.0
        for k in range(3):
            shift[r] += frame[k, r] * (x[k] - origin[k])
        for c in range(3):
            turn[r, c] = 0.0
            for k in range(3):
                turn[r, c] += frame[k, r] * other[k, c]
    return x


@compiled
def _columns_in_first(table: RowTable, i: int, j: int, scratch: Scratch) -> None:
    """Turn row_columns into axes of a."""
    first, last, _ = _range(table, i, j)
    frame, columns = scratch.row_frame, scratch.row_columns
    for e in range(first, last):
        for part in (0, 3):
            x = (columns[part, e], columns[part + 1, e], columns[part + 2, e])
            for c in range(3):
                columns[part + c, e] = dot((frame[0, c], frame[1, c], frame[2, c]), x)


@compiled
def _call(table: RowTable, i: int, j: int, scratch: Scratch, which: int, out: int) -> None:
    """Call phi, slope or bend of the row by its address."""
    call_address(
        scratch.row_calls[table.source[i, j], which],
        scratch.row_turn.ctypes.data,
        scratch.row_shift.ctypes.data,
        table.data[i, j, PLACEMENTS:].ctypes.data,
        out,
    )


@compiled
def _gradient(
    table: RowTable, i: int, j: int, chain: Chain, scratch: Scratch, gradient: Floats
) -> None:
    first, last, _ = _range(table, i, j)
    columns, slope = scratch.row_columns, scratch.row_slope
    gradient[:] = 0.0
    for e in range(first, last):
        if chain.role[e] == VARIABLE:
            along = 0.0
            for c in range(6):
                along += slope[c] * columns[c, e]
            gradient[chain.source[e]] += chain.scale[e] * along


@compiled
def _add_nests(table: RowTable, i: int, j: int, multiplier: float, scratch: Scratch) -> None:
    """Add multiplier * slope . [w_near x v_far; w_near x w_far / 2]."""
    first, last, sign = _range(table, i, j)
    columns, slope, second = scratch.row_columns, scratch.row_slope, scratch.second
    f = (multiplier * slope[0], multiplier * slope[1], multiplier * slope[2])
    t = (0.5 * multiplier * slope[3], 0.5 * multiplier * slope[4], 0.5 * multiplier * slope[5])
    for e in range(first, last):
        for d in range(first, e + 1):
            near, far = (d, e) if sign > 0.0 else (e, d)
            w = (columns[3, near], columns[4, near], columns[5, near])
            nest = cross(w, (columns[0, far], columns[1, far], columns[2, far]))
            turn = cross(w, (columns[3, far], columns[4, far], columns[5, far]))
            second[d, e] += dot(f, nest) + dot(t, turn)


@compiled
def _add_bend(table: RowTable, i: int, j: int, multiplier: float, scratch: Scratch) -> None:
    """Add multiplier * column_d . bend column_e."""
    first, last, _ = _range(table, i, j)
    columns, bend, second = scratch.row_columns, scratch.row_bend, scratch.second
    bent = scratch.row_bent
    for e in range(first, last):
        for r in range(6):
            along = 0.0
            for c in range(6):
                along += bend[r, c] * columns[c, e]
            bent[r] = multiplier * along
        for d in range(first, e + 1):
            entry = 0.0
            for r in range(6):
                entry += columns[r, d] * bent[r]
            second[d, e] += entry
