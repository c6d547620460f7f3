"""Rows as arrays: which rows hold at which points, on which bodies of the chain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from dualarm_pin.chain import Body, body_of, chain_of
from dualarm_pin.errors import InputError
from dualarm_pin.rows.capsules import capsule_pair
from dualarm_pin.rows.half_space import plane_point
from dualarm_pin.rows.row import Row

if TYPE_CHECKING:
    from dualarm_pin.cell import Cell

# A plane against a point and two capsules have code of their own, any other row is called.
PLANE_POINT, CALLED, CAPSULES = 0, 1, 2
_WIDTH = 16  # rows: few shapes of tables, and little room that no row takes
PLACEMENTS = 24  # numbers before the parameters of a called row: rotation and position of a and b


Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


class RowTable(NamedTuple):
    """Rows of one sort over k points, at most r at a point; the first `size` of them count.

    Attributes:
        size: (k,) rows at each point.
        kind: (k, r) PLANE_POINT, CAPSULES or CALLED.
        source: (k, r) which row of the problem it is.
        first: (k, r) segment of body a on the chain.
        second: (k, r) segment of body b.
        data: (k, r, w) a plane [normal; offset] in segment a and a point in segment b; or two ends
            in segment a, two in segment b and their distance; or the placements of a and b in their
            segments (rotation by rows, position), then parameters.
    """

    size: Integers
    kind: Integers
    source: Integers
    first: Integers
    second: Integers
    data: Floats


def row_table(
    rows: Sequence[Row], cell: Cell, k: int, *, equality: bool, turn: Any | None = None
) -> RowTable:
    """Return the table of those rows that are equalities, or of those that are not.

    Args:
        rows: All rows of a problem.
        cell: The two arms.
        k: Points of the path.
        equality: Which sort.
        turn: Rotation (3, 3) of the frame in which the chain ends, in e2; the identity if None.

    Raises:
        InputError: A row names a point that does not exist, or a body off the chain.
        UnknownNameError: A row names a frame that the cell does not have.
    """
    chosen = [(number, row) for number, row in enumerate(rows) if row.equality == equality]
    entries = {number: _entry(row, cell, turn) for number, row in chosen}
    at = [[number for number, row in chosen if row.holds_at(i)] for i in range(k)]
    for _, row in chosen:
        outside = [point for point in row.points or () if not 0 <= point < k]
        if outside:
            raise InputError(
                f"point {outside[0] + 1} does not exist: the path has points 1 to {k}",
                field=row.name,
            )
    r = max(map(len, at), default=0)
    width = max((len(data) for *_, data in entries.values()), default=0)
    table = _room(np.array([len(numbers) for numbers in at], dtype=np.int64), r, width)
    for i, numbers in enumerate(at):
        for j, number in enumerate(numbers):
            kind, first, second, data = entries[number]
            table.kind[i, j], table.source[i, j] = kind, number
            table.first[i, j], table.second[i, j] = first, second
            table.data[i, j, : len(data)] = data
    return table


def _entry(row: Row, cell: Cell, turn: Any | None) -> tuple[int, int, int, Floats]:
    a, b = (_on_chain(cell, frame, turn, row) for frame in row.frames(cell))
    if row.phi is plane_point:
        # The same plane in the frame of segment a: n' = R n, d' = d + n' . p.
        normal = a.placement.rotation @ row.parameters[:3]
        offset = row.parameters[3] + normal @ a.placement.translation
        point = b.placement.act(row.parameters[4:7])
        return PLANE_POINT, a.segment, b.segment, np.array([*normal, offset, *point])
    if row.phi is capsule_pair:
        ends = row.parameters[:12].reshape(4, 3)
        moved = [body.placement.act(end) for body, end in zip((a, a, b, b), ends, strict=True)]
        return CAPSULES, a.segment, b.segment, np.array([*np.ravel(moved), row.parameters[12]])
    placements = [
        part for body in (a, b) for part in (body.placement.rotation, body.placement.translation)
    ]
    numbers = np.concatenate([*(np.ravel(part) for part in placements), row.parameters])
    return CALLED, a.segment, b.segment, numbers


def _on_chain(cell: Cell, frame: int, turn: Any | None, row: Row) -> Body:
    """Return the body of a frame, in the frame that the problem's chain ends in."""
    try:
        body = body_of(cell, frame)
    except InputError as error:
        raise InputError(f"{error.field} {error.message}", field=row.name) from error
    if turn is None or body.segment < len(chain_of(cell).kind):
        return body
    back = pin.SE3(np.asarray(turn).T, np.zeros(3))
    return Body(body.segment, back * body.placement)


def _room(size: Integers, r: int, width: int) -> RowTable:
    """Return a table without rows yet: `size` (k,) at each point, r at most, w numbers each."""
    k = len(size)
    return RowTable(
        size=size,
        kind=np.zeros((k, r), dtype=np.int64),
        source=np.zeros((k, r), dtype=np.int64),
        first=np.zeros((k, r), dtype=np.int64),
        second=np.zeros((k, r), dtype=np.int64),
        data=np.zeros((k, r, width)),
    )


def extended(table: RowTable, more: RowTable) -> RowTable:
    """Return a table with the rows of another one after its own at every point.

    Its width is a multiple of `_WIDTH`, so that room for one table of rows does for the next.
    """
    r = int(np.max(table.size + more.size, initial=0))
    room = -(-r // _WIDTH) * _WIDTH
    width = max(table.data.shape[2], more.data.shape[2])
    result = _room(table.size + more.size, room, width)
    for part, start in ((table, np.zeros_like(table.size)), (more, table.size)):
        i, j = np.nonzero(np.arange(part.kind.shape[1]) < part.size[:, None])
        at = start[i] + j
        for name in ("kind", "source", "first", "second"):
            getattr(result, name)[i, at] = getattr(part, name)[i, j]
        result.data[i, at, : part.data.shape[2]] = part.data[i, j]
    return result


def pair_table(
    k: int, point: Integers, kind: int, first: Integers, second: Integers, data: Floats
) -> RowTable:
    """Return rows of one kind as a table.

    Args:
        k: Points of the path.
        point: (c,) where each row holds, ascending.
        kind: PLANE_POINT or CAPSULES.
        first: (c,) segment of body a.
        second: (c,) segment of body b.
        data: (c, w) as in `RowTable`.
    """
    size = np.bincount(point, minlength=k)
    at = np.arange(len(point)) - np.repeat(np.cumsum(size) - size, size)
    r = int(np.max(size, initial=0))
    table = _room(size.astype(np.int64), r, data.shape[1])
    table.kind[:] = kind
    table.first[point, at], table.second[point, at] = first, second
    table.data[point, at] = data
    return table
