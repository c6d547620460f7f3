"""Small dense and block tridiagonal linear algebra, without allocation."""

from __future__ import annotations

import math

from dualarm_pin.chain import Floats, Integers
from dualarm_pin.engine.jit.compiled import compiled

RANK_TOLERANCE = 1e-8  # a row this small beside the rows before it is taken as dependent
_PIVOT_MIN = 1e-12


@compiled
def orthonormal_basis(
    matrix: Floats, rows: int, basis: Floats, triangle: Floats, kept: Integers, mirror: Floats
) -> int:
    """Split R^n into the row space of a matrix and its null space by Householder mirrors.

    Args:
        matrix: (m, n), of which the first `rows` rows count; dependent rows are dropped.
        rows: How many.
        basis: (n, n) filled: orthonormal rows, the first `rank` span the row space.
        triangle: (m, m) filled: matrix[kept[r]] = sum_{c<=r} triangle[r, c] basis[c].
        kept: (m,) filled: the rows that are independent.
        mirror: (m, n) room.

    Returns:
        The rank.
    """
    n = matrix.shape[1]
    rank = 0
    for r in range(rows):
        if rank == n:
            break
        x = mirror[rank]
        size = 0.0
        for k in range(n):  # without a store: see `links._pull`
            size += matrix[r, k] * matrix[r, k]
        for k in range(n):
            x[k] = matrix[r, k]
        for c in range(rank):
            _mirror(mirror[c], x)
        for k in range(rank):
            triangle[rank, k] = x[k]
            x[k] = 0.0
        rest = 0.0
        for k in range(rank, n):
            rest += x[k] * x[k]
        if rest <= RANK_TOLERANCE * RANK_TOLERANCE * size:
            continue
        pivot = -math.sqrt(rest) if x[rank] > 0.0 else math.sqrt(rest)
        triangle[rank, rank] = pivot
        x[rank] -= pivot
        scale = 1.0 / math.sqrt(-pivot * x[rank])
        for k in range(n):
            x[k] *= scale
        kept[rank] = r
        rank += 1
    for a in range(n):
        row = basis[a]
        for k in range(n):
            row[k] = 0.0
        row[a] = 1.0
        for c in range(min(rank, a + 1)):  # later mirrors leave e_a as it is
            _mirror(mirror[min(rank, a + 1) - 1 - c], row)
    return rank


@compiled
def _mirror(m: Floats, x: Floats) -> None:
    """Apply the mirror I - m m^T to x in place."""
    along = 0.0
    for k in range(x.shape[0]):
        along += m[k] * x[k]
    for k in range(x.shape[0]):
        x[k] -= along * m[k]


@compiled
def block_cholesky(
    diagonal: Floats, coupling: Floats, sizes: Integers, shift: float, factor: Floats, below: Floats
) -> bool:
    """Factor a symmetric block tridiagonal matrix plus shift I; False if it is not positive.

    Args:
        diagonal: (k, d, d) diagonal blocks, lower triangles.
        coupling: (k, d, d) block (i, i-1); the first is not used.
        sizes: (k,) size of every block, at most d.
        shift: Added to the diagonal.
        factor: (k, d, d) filled with lower triangular blocks, their diagonals inverted.
        below: (k, d, d) filled with the blocks left of them.
    """
    for i in range(diagonal.shape[0]):
        size = sizes[i]
        L, D = factor[i], diagonal[i]
        for a in range(size):
            for b in range(a + 1):
                L[a, b] = D[a, b]
            L[a, a] += shift
        if i > 0:
            before = sizes[i - 1]
            _solve_below(coupling[i], factor[i - 1], size, before, below[i])
            F = below[i]
            for a in range(size):
                for b in range(a + 1):
                    product = 0.0
                    for k in range(before):
                        product += F[a, k] * F[b, k]
                    L[a, b] -= product
        if not _cholesky(L, size):
            return False
    return True


@compiled
def _solve_below(E: Floats, L: Floats, rows: int, columns: int, F: Floats) -> None:
    """Solve F L^T = E for F, row by row."""
    for a in range(rows):
        for b in range(columns):
            rest = E[a, b]
            for k in range(b):
                rest -= F[a, k] * L[b, k]
            F[a, b] = rest * L[b, b]


@compiled
def _cholesky(L: Floats, size: int) -> bool:
    """Factor in place the lower triangle of a symmetric matrix; its diagonal ends inverted."""
    for a in range(size):
        pivot = L[a, a]
        for k in range(a):
            pivot -= L[a, k] * L[a, k]
        if not pivot > _PIVOT_MIN:
            return False
        inverse = 1.0 / math.sqrt(pivot)
        L[a, a] = inverse
        for b in range(a + 1, size):
            rest = L[b, a]
            for k in range(a):
                rest -= L[b, k] * L[a, k]
            L[b, a] = rest * inverse
    return True


@compiled
def block_solve(factor: Floats, below: Floats, sizes: Integers, x: Floats) -> None:
    """Solve in place with the factors of `block_cholesky`; x is (k, d)."""
    count = factor.shape[0]
    for i in range(count):
        for a in range(sizes[i]):
            rest = x[i, a]
            if i > 0:
                for k in range(sizes[i - 1]):
                    rest -= below[i, a, k] * x[i - 1, k]
            for k in range(a):
                rest -= factor[i, a, k] * x[i, k]
            x[i, a] = rest * factor[i, a, a]
    for i in range(count - 1, -1, -1):
        for a in range(sizes[i] - 1, -1, -1):
            rest = x[i, a]
            if i < count - 1:
                for k in range(sizes[i + 1]):
                    rest -= below[i + 1, k, a] * x[i + 1, k]
            for k in range(a + 1, sizes[i]):
                rest -= factor[i, k, a] * x[i, k]
            x[i, a] = rest * factor[i, a, a]


@compiled
def solve_positive(matrix: Floats, size: int, x: Floats) -> bool:
    """Solve matrix x = x in place (the lower triangle is destroyed); False if not positive."""
    if not _cholesky(matrix, size):
        return False
    for a in range(size):
        for k in range(a):
            x[a] -= matrix[a, k] * x[k]
        x[a] *= matrix[a, a]
    for a in range(size - 1, -1, -1):
        for k in range(a + 1, size):
            x[a] -= matrix[k, a] * x[k]
        x[a] *= matrix[a, a]
    return True
