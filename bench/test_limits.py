"""Limits of the machine, in the same run as the solver: one dense solve, matrix products, writing to memory.

Matrices have 2n rows and columns, double precision and column order, like the matrices of the solver.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.linalg import blas, lapack
from threadpoolctl import threadpool_limits

Timed = Callable[..., Any]
THREADS = tuple(range(1, min(2, os.cpu_count() or 1) + 1))


def random_matrix(order: int) -> np.ndarray:
    """Return a random square matrix in column order."""
    return np.asfortranarray(np.random.default_rng(order).standard_normal((order, order)))


@pytest.mark.parametrize("threads", THREADS)
@pytest.mark.benchmark(group="LAPACK solve")
def test_lapack_solve(timed: Timed, nodes: int, threads: int) -> None:
    """Solve with one right side. The matrix is overwritten, so it is copied before each round, outside the timing.

    dgesv calls dgetrf and dgetrs. scipy's own dgesv stays on one thread, whatever the limit.
    """
    order = 2 * nodes
    matrix, right = random_matrix(order), np.ones(order)

    def factor_and_solve(copy: np.ndarray) -> np.ndarray:
        factors, pivots, _ = lapack.dgetrf(copy, overwrite_a=1)
        return lapack.dgetrs(factors, pivots, right)[0]

    with threadpool_limits(limits=threads, user_api="blas"):
        solution = timed(
            factor_and_solve, nodes, setup=lambda: matrix.copy(order="F"), watch=True, least=5,
            threads=threads, flops=2.0 / 3.0 * order**3,
        )  # fmt: skip
    assert np.abs(matrix @ solution - right).max() < 1e-6


@pytest.mark.parametrize("threads", THREADS)
@pytest.mark.benchmark(group="matrix product")
def test_matrix_product(timed: Timed, nodes: int, threads: int) -> None:
    order = 2 * nodes
    matrix, out = random_matrix(order), np.zeros((order, order), order="F")
    with threadpool_limits(limits=threads, user_api="blas"):
        timed(
            lambda: blas.dgemm(1.0, matrix, matrix, beta=0.0, c=out, overwrite_c=1), nodes, watch=True, least=5,
            threads=threads, flops=2.0 * order**3,
        )  # fmt: skip
    assert np.isfinite(out[0, 0])


@pytest.mark.parametrize("memory", ["fresh", "touched"])
@pytest.mark.benchmark(group="write")
def test_write(timed: Timed, nodes: int, memory: str) -> None:
    """Fill a matrix with one number. The system gives fresh memory page by page while it is written."""
    shape = (2 * nodes, 2 * nodes)
    old = np.zeros(shape)
    old.fill(0.5)
    write = (lambda: np.full(shape, 1.0)) if memory == "fresh" else (lambda: old.fill(1.0))
    timed(write, nodes, least=10, threads=1, bytes=old.nbytes)


@pytest.mark.parametrize("memory", ["fresh", "touched"])
@pytest.mark.benchmark(group="copy")
def test_copy(timed: Timed, nodes: int, memory: str) -> None:
    """Copy a matrix. The stored bytes are the written ones; as many are read."""
    matrix = random_matrix(2 * nodes)
    old = matrix.copy(order="F")
    copy = (lambda: matrix.copy(order="F")) if memory == "fresh" else (lambda: np.copyto(old, matrix))
    timed(copy, nodes, least=10, threads=1, bytes=matrix.nbytes)
