"""The fastest law of motion along a curve: reachability on a grid, compiled.

With x the square of the speed along the path and u its acceleration, every limit is a row
a u + b x <= g, and between two grid points x changes by 2 u ds. Backwards, the largest x is found
from which the next point can be reached within its own range; forwards, the largest u is taken
(Pham and Pham, "A new approach to time-optimal path parameterization based on reachability
analysis", 2018). Rows are kept at both ends of an interval. The ranges begin at x = 0, because
standing still keeps all limits where 0 <= g.
"""

# mypy: disable-error-code="untyped-decorator"

from __future__ import annotations

import math

import numba
import numpy as np

from dualarm_pin.arrays import Array

_FLAT = 1e-12  # a row whose slope in u is smaller leaves u free
_SLACK = 1e-10  # share by which an interval may be empty: rounding
_TURNS = 200  # Newton steps on a concave function of straight pieces; a handful is used


@numba.njit(cache=True)
def _range_of_u(a: Array, b: Array, g: Array, x: float) -> tuple[float, float, float, float]:
    """Return the ends of the interval of u at x, and their slopes by x."""
    low, high, low_slope, high_slope = -math.inf, math.inf, 0.0, 0.0
    for k in range(len(a)):
        if a[k] > _FLAT:
            end = (g[k] - b[k] * x) / a[k]
            if end < high:
                high, high_slope = end, -b[k] / a[k]
        elif a[k] < -_FLAT:
            end = (g[k] - b[k] * x) / a[k]
            if end > low:
                low, low_slope = end, -b[k] / a[k]
    return low, high, low_slope, high_slope


@numba.njit(cache=True)
def _largest_x(a: Array, b: Array, g: Array, most: float) -> float:
    """Return the largest x in 0..most at which some u keeps all rows; -1 if there is none.

    The width of the interval of u is concave in x, so Newton steps from above end at its edge.
    """
    for k in range(len(a)):
        if abs(a[k]) <= _FLAT and b[k] > _FLAT:
            most = min(most, g[k] / b[k])
    x = most
    for _ in range(_TURNS):
        low, high, low_slope, high_slope = _range_of_u(a, b, g, x)
        width, slope = high - low, high_slope - low_slope
        if width >= -_SLACK * (1.0 + abs(low) + abs(high)):
            return x
        if slope >= 0.0:
            return -1.0
        x -= width / slope
        if x < 0.0:
            return -1.0 if x < -_SLACK * (1.0 + most) else 0.0
    return -1.0


@numba.njit(cache=True)
def _gather(rows: tuple[Array, Array, Array], i: int, ds: float, reach: float, out: Array) -> None:
    """Write the rows of interval i: at both its ends, and that its end lies in 0..reach."""
    a, b, g = rows
    m = a.shape[1]
    for k in range(m):
        out[0, k], out[1, k], out[2, k] = a[i, k], b[i, k], g[i, k]
        out[0, m + k] = a[i + 1, k] + 2.0 * ds * b[i + 1, k]
        out[1, m + k], out[2, m + k] = b[i + 1, k], g[i + 1, k]
    out[0, 2 * m], out[1, 2 * m], out[2, 2 * m] = 2.0 * ds, 1.0, reach
    out[0, 2 * m + 1], out[1, 2 * m + 1], out[2, 2 * m + 1] = -2.0 * ds, -1.0, 0.0


@numba.njit(cache=True)
def fastest(
    s: Array, rows: tuple[Array, Array, Array], most: Array, rest: bool
) -> tuple[int, Array]:
    """Return the squares of the fastest speeds along a grid.

    Args:
        s: Grid (N + 1,), rising.
        rows: a, b, g, each (N + 1, m), with 0 <= g.
        most: Largest x at each grid point (N + 1,).
        rest: Begin and end at rest; at any speed if not.

    Returns:
        -1 and x (N + 1,), or the grid point at which no speed keeps all limits.
    """
    n, m = len(s) - 1, rows[0].shape[1]
    reach, x, work = np.zeros(n + 1), np.zeros(n + 1), np.zeros((3, 2 * m + 2))
    reach[n] = 0.0 if rest else most[n]
    for i in range(n - 1, -1, -1):
        _gather(rows, i, s[i + 1] - s[i], reach[i + 1], work)
        reach[i] = _largest_x(work[0], work[1], work[2], most[i])
        if reach[i] < 0.0:
            return i, x
    x[0] = 0.0 if rest else reach[0]
    for i in range(n):
        ds = s[i + 1] - s[i]
        _gather(rows, i, ds, reach[i + 1], work)
        low, high, _, _ = _range_of_u(work[0], work[1], work[2], x[i])
        u = high if low <= high else 0.5 * (low + high)
        x[i + 1] = min(max(x[i] + 2.0 * ds * u, 0.0), reach[i + 1])
    return -1, x
