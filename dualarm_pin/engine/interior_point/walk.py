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
    _take_point(path, first + i, one, 0)
    copy_row(path.links.metric[link], one.links.metric[0])
    one.neighbours.weight[0] = scale * path.links.weight[link]
    one.neighbours.weight[1] = 0.0
    copy_row(q[before], one.neighbours.posture[0])
    copy_row(q[before], q[i])
    if before != anchor:
        for c in range(q.shape[1]):
            q[i, c] += _AHEAD * (q[before, c] - q[before + before - i, c])


@compiled
def take_window(path: Problem, first: int, scale: float, window: Problem) -> None:
    """Make `window` the problem of neighbouring points of a path, as `Problem.window` does.

    Args:
        path: The problem of all points.
        first: The point that the first one of the window stands for.
        scale: Factor on the weight of the links that lead out of the window: 0 or 1.
        window: A problem with arrays of its own, overwritten.
    """
    count, links = window.row_count.shape[0], path.links
    for i in range(count):
        _take_point(path, first + i, window, i)
        copy_row(links.metric[first + i], window.links.metric[i])
        window.links.weight[i] = links.weight[first + i]
    weight, after = window.neighbours.weight, first + count
    weight[0] = scale * links.weight[first - 1] if first > 0 else path.neighbours.weight[0]
    weight[1] = path.neighbours.weight[1]
    if after < path.row_count.shape[0]:
        weight[1] = scale * links.weight[after - 1]


@compiled
def _take_point(path: Problem, i: int, window: Problem, at: int) -> None:
    """Copy what belongs to point i into that one of a window."""
    source, target = path.points, window.points
    copy_row(source.position[i], target.position[at])
    copy_row(source.quaternion[i], target.quaternion[at])
    copy_rows(source.target_axes[i], target.target_axes[at])
    copy_row(source.u[i], target.u[at])
    copy_row(source.linear[i], target.linear[at])
    target.pose_rows[at] = source.pose_rows[i]
    target.index_weight[at] = source.index_weight[i]
    window.row_count[at] = path.row_count[i]
    _take_rows(path.equalities, i, window.equalities, at)
    _take_rows(path.inequalities, i, window.inequalities, at)


@compiled
def _take_rows(source: RowTable, i: int, target: RowTable, at: int) -> None:
    target.size[at] = source.size[i]
    copy_row(source.kind[i], target.kind[at])
    copy_row(source.source[i], target.source[at])
    copy_row(source.first[i], target.first[at])
    copy_row(source.second[i], target.second[at])
    copy_rows(source.data[i], target.data[at])
