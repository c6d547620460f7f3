"""Velocity transmission: phi = u^T A^-1 u = |y|^2 with A = L L^T and y = L^-1 u."""

from __future__ import annotations

import math

from dualarm_pin.chain import Floats
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.kernels.cholesky import factor, solve_lower, solve_upper
from dualarm_pin.engine.kernels.layout import BASIS, BOTH, PAIR, SLOPE, VALUE


@compiled
def velocity(A: Floats, u: Floats, wanted: bool, model: Floats) -> None:
    """Fill the model: dphi = -x^T dA x, d2phi = 2 x^T dA A^-1 dA x, x = A^-1 u.

    f_0 is along x; the others complete it to vectors that make A the identity, by one mirror.
    """
    L = model[PAIR : PAIR + 6]  # room until the pairs are known
    y = model[SLOPE]
    regular = factor(A, L)
    for r in range(6):
        y[r] = u[r] if A[r, r] > 0.0 else 0.0
    solve_lower(L, y)
    value = 0.0
    for r in range(6):
        value += y[r] * y[r]
    model[VALUE, 0] = value if regular else math.inf
    if not wanted:
        return
    length = math.sqrt(value)
    y[0] += length if y[0] >= 0.0 else -length  # the mirror's normal
    square = 0.0
    for r in range(6):
        square += y[r] * y[r]
    factor_of = 2.0 / square if square > 0.0 else 0.0
    for a in range(6):
        x = model[BASIS + a]
        for r in range(6):
            x[r] = (1.0 if r == a else 0.0) - factor_of * y[a] * y[r]
        solve_upper(L, x)
    for a in range(6):
        model[SLOPE, a] = -value if a == 0 else 0.0
        for b in range(6):
            model[PAIR + a, b] = 2.0 * value if a == 0 else 0.0
            model[BOTH + a, b] = 0.0
