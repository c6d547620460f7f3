"""Eigenvalues and eigenvectors of a symmetric 6 x 6 matrix: tridiagonal form, implicit QL."""

from __future__ import annotations

import math

from dualarm_pin.chain import Floats
from dualarm_pin.engine.jit.compiled import compiled

_ROUNDING = 2.3e-16  # of its neighbours: an entry beside the diagonal that counts as zero
_SWEEPS = 60  # of one eigenvalue; two are usual


@compiled
def eigen(A: Floats, vectors: bool, V: Floats, lam: Floats, beside: Floats) -> None:
    """Fill eigenvalues lam (6,) in no order and, if asked, eigenvectors as rows of V (6, 6).

    Args:
        A: (6, 6), overwritten.
        vectors: Whether V is wanted.
        V: Filled if so.
        lam: Filled.
        beside: (6,) room for the entries beside the diagonal.
    """
    _tridiagonal(A, vectors, V)
    for r in range(6):
        lam[r] = A[r, r]
        beside[r] = A[r + 1, r] if r < 5 else 0.0
    for first in range(6):
        for _ in range(_SWEEPS):
            last = first
            while last < 5:
                near = abs(lam[last]) + abs(lam[last + 1])
                if abs(beside[last]) <= _ROUNDING * near:
                    break
                last += 1
            if last == first:
                break
            _sweep(first, last, lam, beside, vectors, V)


@compiled
def _tridiagonal(A: Floats, vectors: bool, V: Floats) -> None:
    """Mirror A to tridiagonal form; the product of the mirrors is left in V."""
    if vectors:
        for r in range(6):
            for c in range(6):
                V[r, c] = 1.0 if r == c else 0.0
    for k in range(4):
        tail = 0.0
        for r in range(k + 2, 6):
            tail += A[r, k] * A[r, k]
        if tail == 0.0:
            continue
        head = A[k + 1, k]
        length = math.sqrt(head * head + tail)
        length = -length if head > 0.0 else length
        A[k + 1, k] = head - length  # column k now holds the mirror's normal
        scale = 2.0 / (tail + (head - length) * (head - length))
        # row k, of no more use, takes p = scale A x, then w = p - (scale x . p / 2) x
        along = 0.0
        for r in range(k + 1, 6):
            entry = 0.0
            for c in range(k + 1, 6):
                entry += A[r, c] * A[c, k]
            A[k, r] = scale * entry
            along += A[k, r] * A[r, k]
        along *= 0.5 * scale
        for r in range(k + 1, 6):
            A[k, r] -= along * A[r, k]
        for r in range(k + 1, 6):
            for c in range(k + 1, 6):
                A[r, c] -= A[r, k] * A[k, c] + A[k, r] * A[c, k]
        if vectors:
            for c in range(6):
                entry = 0.0
                for r in range(k + 1, 6):
                    entry += A[r, k] * V[r, c]
                entry *= scale
                for r in range(k + 1, 6):
                    V[r, c] -= A[r, k] * entry
        A[k + 1, k] = length


@compiled
def _sweep(first: int, last: int, lam: Floats, beside: Floats, vectors: bool, V: Floats) -> None:
    """Chase one bulge from `last` up to `first`, with the shift of Wilkinson."""
    half = 0.5 * (lam[first + 1] - lam[first]) / beside[first]
    root = math.sqrt(half * half + 1.0)
    shifted = lam[last] - lam[first]
    shifted += beside[first] / (half + (root if half >= 0.0 else -root))
    sine, cosine, moved = 1.0, 1.0, 0.0
    for r in range(last - 1, first - 1, -1):
        bulge, edge = sine * beside[r], cosine * beside[r]
        root = math.sqrt(bulge * bulge + shifted * shifted)
        beside[r + 1] = root
        if root == 0.0:
            lam[r + 1] -= moved
            beside[last] = 0.0
            return
        sine, cosine = bulge / root, shifted / root
        shifted = lam[r + 1] - moved
        root = (lam[r] - shifted) * sine + 2.0 * cosine * edge
        moved = sine * root
        lam[r + 1] = shifted + moved
        shifted = cosine * root - edge
        for c in range(6 if vectors else 0):
            above, below = V[r, c], V[r + 1, c]
            V[r + 1, c] = sine * above + cosine * below
            V[r, c] = cosine * above - sine * below
    lam[first] -= moved
    beside[first] = shifted
    beside[last] = 0.0
