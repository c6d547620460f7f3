"""A = L L^T of six rows, and the six vectors that make A the identity.

A row of weight 0 is a zero row and column of A: a 1 on its diagonal cuts it off.
"""

from __future__ import annotations

import math

from dualarm_pin.chain import Floats
from dualarm_pin.engine.jit.compiled import compiled

_SINGULAR = 1e-14  # of the trace: a pivot below it is what rounding leaves of a zero


@compiled
def factor(A: Floats, L: Floats) -> bool:
    """Fill the lower triangle of L (6, 6); return whether A is regular.

    The pivots of a singular A are kept away from zero.
    """
    regular = True
    trace = 0.0
    for r in range(6):
        trace += A[r, r]
    least = max(_SINGULAR * trace, 1e-300)  # above 0, whatever A
    for c in range(6):
        pivot = A[c, c] if A[c, c] > 0.0 else 1.0
        for k in range(c):
            pivot -= L[c, k] * L[c, k]
        if not pivot > least:
            regular, pivot = False, least
        root = math.sqrt(pivot)
        L[c, c] = root
        for r in range(c + 1, 6):
            entry = A[r, c]
            for k in range(c):
                entry -= L[r, k] * L[c, k]
            L[r, c] = entry / root
    return regular


@compiled
def solve_lower(L: Floats, y: Floats) -> None:
    """Turn y (6,) into L^-1 y."""
    for r in range(6):
        for k in range(r):
            y[r] -= L[r, k] * y[k]
        y[r] /= L[r, r]


@compiled
def solve_upper(L: Floats, x: Floats) -> None:
    """Turn x (6,) into L^-T x."""
    for r in range(5, -1, -1):
        for k in range(r + 1, 6):
            x[r] -= L[k, r] * x[k]
        x[r] /= L[r, r]
