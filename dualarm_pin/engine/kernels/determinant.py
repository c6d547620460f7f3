"""Manipulability: phi = -sqrt(det A), with A = L L^T and f_a the columns of L^-T."""

from __future__ import annotations

from dualarm_pin.chain import Floats
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.kernels.cholesky import factor, solve_upper
from dualarm_pin.engine.kernels.layout import BASIS, BOTH, PAIR, SLOPE, VALUE


@compiled
def yoshikawa(A: Floats, u: Floats, wanted: bool, model: Floats) -> None:
    """Fill the model: dphi = phi / 2 tr(A^-1 dA), and its derivative."""
    L = model[PAIR : PAIR + 6]  # room until the pairs are known
    regular = factor(A, L)
    value = -1.0
    for r in range(6):
        value *= L[r, r]
    model[VALUE, 0] = value if regular else -0.0
    if not wanted:
        return
    for a in range(6):
        x = model[BASIS + a]
        for r in range(6):
            x[r] = 1.0 if r == a else 0.0
        solve_upper(L, x)
    for a in range(6):
        model[SLOPE, a] = 0.5 * value
        for b in range(6):
            model[PAIR + a, b] = -0.5 * value if a == b else -value
            model[BOTH + a, b] = 0.25 * value
