"""Smooth functions of the smallest and the largest eigenvalue, by the eigenvectors of A.

See `dualarm_pin.indices.spectral` for what is smoothed and by how much. dphi/dA is diagonal in the
eigenvectors, and so is its derivative: off the diagonal it is the divided difference of g.
"""

from __future__ import annotations

import math

from dualarm_pin.chain import Floats
from dualarm_pin.engine.jit.compiled import compiled
from dualarm_pin.engine.kernels.eigen import eigen
from dualarm_pin.engine.kernels.layout import BASIS, BOTH, PAIR, ROOM, SLOPE, VALUE
from dualarm_pin.indices.spectral import DOUBLINGS, SINGULAR

_POWER = 2.0**DOUBLINGS  # of the smooth extremes
_NOTHING = 1e-20  # of the largest: lost in rounding, and a direction less to carry to the joints
_APART = 0.1  # of the smaller one: eigenvalues this far apart lose no digit in a plain difference


@compiled
def smallest_singular_value(A: Floats, u: Floats, wanted: bool, model: Floats) -> None:
    """Fill the model of phi = -sqrt(low), low the smooth smallest eigenvalue."""
    _smooth_ratio(A, wanted, model, False)


@compiled
def inverse_condition_number(A: Floats, u: Floats, wanted: bool, model: Floats) -> None:
    """Fill the model of phi = -sqrt(low / high), the smooth extremes."""
    _smooth_ratio(A, wanted, model, True)


@compiled
def _smooth_ratio(A: Floats, wanted: bool, model: Floats, both: bool) -> None:
    """Fill the model of -sqrt(low), or where `both` of -sqrt(low / high)."""
    room, V, lam = model[PAIR : PAIR + 6], model[BASIS : BASIS + 6], model[SLOPE]
    least, most = _spectrum(A, room, wanted, V, lam, model[ROOM])
    power_sum, top_sum = 0.0, 0.0
    for a in range(6):
        if lam[a] > 0.0:
            power_sum += _power(least / lam[a])
            top_sum += _power(lam[a] / most)
    low = least * math.exp(-math.log(power_sum) / _POWER)
    high = most * math.exp(math.log(top_sum) / _POWER) if both else 1.0
    value = -math.sqrt(low / high)
    model[VALUE, 0] = value
    if not wanted:
        return
    _fill(model, value, low, high, 1.0 if both else 0.0)


@compiled
def _spectrum(
    A: Floats, room: Floats, vectors: bool, V: Floats, lam: Floats, beside: Floats
) -> tuple[float, float]:
    """Fill eigenvalues and, if asked, eigenvectors; return the smallest and largest that count.

    A row of weight 0 gets an eigenvalue below all others, and then 0: it does not count.
    """
    trace = 1e-300  # above 0, whatever A
    for r in range(6):
        trace += A[r, r]
    for r in range(6):
        for c in range(6):
            room[r, c] = A[r, c]
        if not A[r, r] > 0.0:
            room[r, r] = -trace
    eigen(room, vectors, V, lam, beside)
    most, least = SINGULAR * trace, math.inf
    for a in range(6):
        most = max(most, lam[a])
    for a in range(6):
        if lam[a] < -0.5 * trace:
            lam[a] = 0.0
        else:
            lam[a] = max(lam[a], SINGULAR * most)
            least = min(least, lam[a])
    return min(least, most), most


@compiled
def _power(x: float) -> float:
    """Return x to the power of the smooth extremes."""
    for _ in range(DOUBLINGS):
        x *= x
    return x if x > _NOTHING else 0.0


@compiled
def _fill(model: Floats, value: float, low: float, high: float, top: float) -> None:
    """Fill slopes and second derivatives of phi = -sqrt(low / high^top).

    With d(log low)/dlam_a = p_a = (low / lam_a)^P / lam_a and d(log high)/dlam_a = r_a =
    (lam_a / high)^P / lam_a: g = phi / 2 (p - top r), and for a, b apart
    d2phi = phi / 2 ((p - r)_a (p - r)_b / 2 + P p_a p_b + top P r_a r_b), on the diagonal less
    phi / 2 ((P + 1) p_a + top (P - 1) r_a) / lam_a.
    """
    lam, p, r = model[SLOPE], model[ROOM], model[ROOM + 1]
    for a in range(6):
        counts = lam[a] > 0.0
        p[a] = _power(low / lam[a]) / lam[a] if counts else 0.0
        r[a] = top * _power(lam[a] / high) / lam[a] if counts else 0.0
    for a in range(6):
        for b in range(a, 6):
            entry = 0.5 * (p[a] - r[a]) * (p[b] - r[b]) + _POWER * (p[a] * p[b] + r[a] * r[b])
            if a == b and lam[a] > 0.0:
                entry -= ((_POWER + 1.0) * p[a] + (_POWER - 1.0) * r[a]) / lam[a]
            model[BOTH + a, b] = model[BOTH + b, a] = 0.5 * value * entry
            pair = _divided(lam[a], lam[b], p[a], p[b], r[a], r[b]) if a < b else 0.0
            model[PAIR + a, b] = value * pair
    for a in range(6):
        lam[a] = 0.5 * value * (p[a] - r[a])


@compiled
def _divided(la: float, lb: float, pa: float, pb: float, ra: float, rb: float) -> float:
    """Return ((pa - ra) - (pb - rb)) / (la - lb), exact where the eigenvalues meet."""
    if la == 0.0 or lb == 0.0:
        return 0.0
    apart = (la - lb) / lb
    if abs(apart) > _APART:
        return ((pa - ra) - (pb - rb)) / (la - lb)
    if apart == 0.0:
        return (-(_POWER + 1.0) * pb - (_POWER - 1.0) * rb) / lb
    log = math.log1p(apart)
    down = math.expm1(-(_POWER + 1.0) * log) / apart
    up = math.expm1((_POWER - 1.0) * log) / apart
    return (down * pb - up * rb) / lb
