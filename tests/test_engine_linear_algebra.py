"""Null space and block tridiagonal Cholesky against numpy."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from dualarm_pin.engine.interior_point.linear_algebra import (
    block_cholesky,
    block_solve,
    orthonormal_basis,
    solve_positive,
)


@numba.njit
def run_basis(matrix, rows, basis, triangle, kept, mirror):
    return orthonormal_basis(matrix, rows, basis, triangle, kept, mirror)


@numba.njit
def run_blocks(diagonal, coupling, sizes, shift, factor, below, x):
    done = block_cholesky(diagonal, coupling, sizes, shift, factor, below)
    if done:
        block_solve(factor, below, sizes, x)
    return done


@numba.njit
def run_solve(matrix, size, x):
    return solve_positive(matrix, size, x)


def basis_of(matrix, rows):
    m, n = matrix.shape
    basis, triangle, mirror = np.zeros((n, n)), np.zeros((m, m)), np.zeros((m, n))
    kept = np.zeros(m, dtype=np.int64)
    rank = run_basis(matrix, rows, basis, triangle, kept, mirror)
    return rank, basis, triangle[:rank, :rank], kept[:rank]


@pytest.mark.parametrize("n", [6, 7, 12, 16])
@pytest.mark.parametrize("rows", [6, 5, 3])
def test_basis_of_full_rank(n, rows):
    matrix = np.random.default_rng(n + rows).normal(size=(6, n))
    rank, basis, triangle, kept = basis_of(matrix, rows)
    assert rank == rows
    assert np.allclose(basis @ basis.T, np.eye(n), atol=1e-14)
    assert np.allclose(np.tril(triangle) @ basis[:rank], matrix[kept], atol=1e-13)
    assert np.abs(matrix[:rows] @ basis[rank:].T).max(initial=0.0) < 1e-13


def test_basis_drops_dependent_and_zero_rows():
    rng = np.random.default_rng(0)
    matrix = rng.normal(size=(6, 9))
    matrix[2] = 2.0 * matrix[0] - matrix[1]
    matrix[4] = 0.0
    rank, basis, triangle, kept = basis_of(matrix, 6)
    assert rank == 4
    assert kept.tolist() == [0, 1, 3, 5]
    assert np.allclose(np.tril(triangle) @ basis[:4], matrix[kept], atol=1e-13)
    assert np.abs(matrix @ basis[4:].T).max() < 1e-13


@pytest.mark.parametrize("n", [0, 2, 4])
def test_basis_of_more_rows_than_columns(n):
    matrix = np.random.default_rng(3).normal(size=(6, n))
    rank, basis, _, kept = basis_of(matrix, 6)
    assert rank == n
    assert kept.tolist() == list(range(n))
    assert np.allclose(basis @ basis.T, np.eye(n), atol=1e-14)


def blocks(sizes, seed):
    """Return a positive definite block tridiagonal matrix, dense and in blocks."""
    rng = np.random.default_rng(seed)
    k, d = len(sizes), max(sizes)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    dense = np.zeros((starts[-1], starts[-1]))
    diagonal, coupling = np.zeros((k, d, d)), np.zeros((k, d, d))
    for i, size in enumerate(sizes):
        part = rng.normal(size=(size, size))
        at = slice(starts[i], starts[i + 1])
        dense[at, at] = part @ part.T + 6.0 * np.eye(size)
        diagonal[i, :size, :size] = dense[at, at]
        if i:
            before = slice(starts[i - 1], starts[i])
            dense[at, before] = rng.normal(size=(size, sizes[i - 1]))
            dense[before, at] = dense[at, before].T
            coupling[i, :size, : sizes[i - 1]] = dense[at, before]
    return dense, diagonal, coupling, starts


@pytest.mark.parametrize("sizes", [(6,), (6, 6, 6, 6), (3, 7, 0, 5, 6), (0, 0)])
def test_block_cholesky_solves(sizes):
    dense, diagonal, coupling, _ = blocks(sizes, 1)
    shift = 40.0 if len(sizes) > 1 else 0.0
    k, d = diagonal.shape[:2]
    x = np.random.default_rng(2).normal(size=(k, d))
    flat = np.concatenate([x[i, :size] for i, size in enumerate(sizes)])
    done = run_blocks(
        diagonal,
        coupling,
        np.array(sizes),
        shift,
        np.zeros((k, d, d)),
        np.zeros((k, d, d)),
        x,
    )
    assert done
    expected = np.linalg.solve(dense + shift * np.eye(len(dense)), flat)
    found = np.concatenate([x[i, :size] for i, size in enumerate(sizes)])
    assert np.allclose(found, expected, atol=1e-12)


def test_block_cholesky_refuses_an_indefinite_matrix():
    dense, diagonal, coupling, _ = blocks((4, 4, 4), 1)
    lowest = np.linalg.eigvalsh(dense)[0]
    room = [np.zeros((3, 4, 4)) for _ in range(2)]
    sizes, x = np.array([4, 4, 4]), np.zeros((3, 4))
    assert run_blocks(diagonal, coupling, sizes, -lowest + 1e-6, *room, x)
    assert not run_blocks(diagonal, coupling, sizes, -lowest - 1e-6, *room, x)


def test_solve_positive():
    rng = np.random.default_rng(4)
    part = rng.normal(size=(6, 6))
    matrix, x = part @ part.T + np.eye(6), rng.normal(size=6)
    expected = np.linalg.solve(matrix, x)
    assert run_solve(matrix.copy(), 6, x)
    assert np.allclose(x, expected)
    assert not run_solve(-np.eye(6), 6, np.ones(6))
