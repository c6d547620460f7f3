"""The walk: from one posture through all points, one point at a time, each linked to the last.

A path for the price of a few iterations a point. It follows its branch as a whole solve cannot: no
point is asked to leave its rows for the sake of another.
"""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.jit.compiled import compiled, copy_row, copy_rows
from dualarm_pin.problem import Problem
from dualarm_pin.rows.table import RowTable

_AHEAD = 0.7  # share of the last step by which the next start lies ahead
LOST = 1e-2  # m, 2 sin(angle / 2) or unit of a row: a point farther off its rows ends the walk


@compiled
def visited(number: int, anchor: int, count: int) -> int:
    """Return which of `count` points is solved as number 0, 1, ...: forwards, then backwards."""
    ahead = count - 1 - anchor
    return anchor + 1 + number if number < ahead else anchor - 1 - (number - ahead)


@compiled
def take_step(
    path: Problem, first: int, anchor: int, i: int, scale: float, q: Floats, one: Problem
) -> None:
    """Make `one` the problem of point i alone, linked to the neighbour on the anchor's side.

    Args:
        path: The problem of all points.
        first: The point that the first row of q stands for.
        anchor: Row of q whose posture was given.
        i: Row of q that is to be solved; its start is put there.
        scale: Factor on the weight of the link.
        q: (w, n) postures, solved from the anchor to the neighbour of i.
        one: A problem of one point with arrays of its own, overwritten.
    """
    before = i - 1 if i > anchor else i + 1
    link = first + min(i, before)
    _take_point(path, first + i, one)
    copy_row(path.links.metric[link], one.links.metric[0])
    one.neighbours.weight[0] = scale * path.links.weight[link]
    one.neighbours.weight[1] = 0.0
    copy_row(q[before], one.neighbours.posture[0])
    copy_row(q[before], q[i])
    if before != anchor:
        for c in range(q.shape[1]):
            q[i, c] += _AHEAD * (q[before, c] - q[before + before - i, c])


@compiled
def _take_point(path: Problem, i: int, one: Problem) -> None:
    """Copy what belongs to point i into the problem of one point."""
    source, target = path.points, one.points
    copy_row(source.position[i], target.position[0])
    copy_row(source.quaternion[i], target.quaternion[0])
    copy_rows(source.target_axes[i], target.target_axes[0])
    copy_row(source.u[i], target.u[0])
    copy_row(source.linear[i], target.linear[0])
    target.pose_rows[0] = source.pose_rows[i]
    target.index_weight[0] = source.index_weight[i]
    one.row_count[0] = path.row_count[i]
    _take_rows(path.equalities, i, one.equalities)
    _take_rows(path.inequalities, i, one.inequalities)


@compiled
def _take_rows(source: RowTable, i: int, target: RowTable) -> None:
    target.size[0] = source.size[i]
    copy_row(source.kind[i], target.kind[0])
    copy_row(source.source[i], target.source[0])
    copy_row(source.first[i], target.first[0])
    copy_row(source.second[i], target.second[0])
    copy_rows(source.data[i], target.data[0])
