"""Distance of two capsules, and how it changes with the motion of b seen from a.

For the nearest points x_a, x_b of the segments, d = |x_b - x_a|, n the unit vector between them and
P = (I - n n^T) / d, the distance is stationary in the parameters s, t of those points that are not
at an end. So the gradient by the twist [v; w] of b at x_b is [n; 0], and the second derivative

    [v; w] . ( [P 0; 0 0] - U M^-1 U^T ) [v; w],   U = [-P a, P b; 0, b x n]

loses the Schur complement of s and t, M = [a . P a, -a . P b; -a . P b, b . P b], a and b along the
segments; a column at an end falls out.
"""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.chain.vectors import Vector, cross, dot, rotate
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.workspace import Scratch
from dualarm_pin.rows.capsules import nearest_of_segments
from dualarm_pin.rows.table import RowTable

# Nearer axes, deep inside each other, have a normal that turns too fast for any step to follow.
_LEAST_DISTANCE = 1e-3  # m
_nearest = compiled(nearest_of_segments)


@compiled
def capsule_distance(
    table: RowTable, i: int, j: int, scratch: Scratch
) -> tuple[float, Vector, Vector, Vector, Vector, bool, bool]:
    """Return d, x_b - x_a, x_b, both directions, and whether s and t move; in e1 axes."""
    data = table.data[i, j]
    place_a, place_b = scratch.place[table.first[i, j]], scratch.place[table.second[i, j]]
    A, B = _end(place_a, data, 0), _end(place_b, data, 6)
    a, b = _less(_end(place_a, data, 3), A), _less(_end(place_b, data, 9), B)
    r = _less(A, B)
    s, t, s_moves, t_moves = _nearest(dot(a, a), dot(a, b), dot(b, b), dot(a, r), dot(b, r))
    x = (B[0] + t * b[0], B[1] + t * b[1], B[2] + t * b[2])
    apart = (x[0] - A[0] - s * a[0], x[1] - A[1] - s * a[1], x[2] - A[2] - s * a[2])
    return dot(apart, apart) ** 0.5, apart, x, a, b, s_moves, t_moves


@compiled
def capsule_terms(table: RowTable, i: int, j: int, scratch: Scratch) -> Vector:
    """Fill row_slope (6,) and row_bend (6, 6) for the twist of b at x_b, which is returned."""
    d, apart, x, a, b, s_moves, t_moves = capsule_distance(table, i, j, scratch)
    d = max(d, _LEAST_DISTANCE)
    n = (apart[0] / d, apart[1] / d, apart[2] / d)
    slope, bend = scratch.row_slope, scratch.row_bend
    slope[:] = 0.0
    bend[:] = 0.0
    for r in range(3):
        slope[r] = n[r]
        for c in range(3):
            bend[r, c] = -n[r] * n[c] / d
        bend[r, r] += 1.0 / d
    Pa, Pb = _across(n, a, -d), _across(n, b, d)  # -P a and P b
    turn = cross(b, n)
    m_ss, m_st, m_tt = -dot(a, Pa), dot(b, Pa), dot(b, Pb)
    if s_moves and t_moves:
        det = m_ss * m_tt - m_st * m_st
        _take(bend, Pa, (0.0, 0.0, 0.0), Pa, (0.0, 0.0, 0.0), m_tt / det)
        _take(bend, Pb, turn, Pb, turn, m_ss / det)
        _take(bend, Pa, (0.0, 0.0, 0.0), Pb, turn, -m_st / det)
        _take(bend, Pb, turn, Pa, (0.0, 0.0, 0.0), -m_st / det)
    elif s_moves:
        _take(bend, Pa, (0.0, 0.0, 0.0), Pa, (0.0, 0.0, 0.0), 1.0 / m_ss)
    elif t_moves:
        _take(bend, Pb, turn, Pb, turn, 1.0 / m_tt)
    return x


@compiled
def _end(place: Floats, data: Floats, at: int) -> Vector:
    """Return the point of a segment that stands in `data` from `at` on, in e1."""
    arm = rotate((place[3], place[4], place[5], place[6]), (data[at], data[at + 1], data[at + 2]))
    return (place[0] + arm[0], place[1] + arm[1], place[2] + arm[2])


@compiled
def _less(x: Vector, y: Vector) -> Vector:
    return (x[0] - y[0], x[1] - y[1], x[2] - y[2])


@compiled
def _across(n: Vector, x: Vector, d: float) -> Vector:
    """Return (I - n n^T) x / d."""
    along = dot(n, x)
    return ((x[0] - along * n[0]) / d, (x[1] - along * n[1]) / d, (x[2] - along * n[2]) / d)


@compiled
def _take(bend: Floats, f: Vector, t: Vector, g: Vector, u: Vector, share: float) -> None:
    """Subtract share [f; t] [g; u]^T."""
    for r in range(3):
        for c in range(3):
            bend[r, c] -= share * f[r] * g[c]
            bend[r, 3 + c] -= share * f[r] * u[c]
            bend[3 + r, c] -= share * t[r] * g[c]
            bend[3 + r, 3 + c] -= share * t[r] * u[c]
