"""Matrix products in two threads, with the same bits for any number of cores: the two halves are always the same.

Where every core has work of its own, :func:`in_one_thread` computes the halves one after the other. BLAS runs on one
thread each. Its own threads wait in loops that cost more than they give as soon as another process wants a core, and
the bits of their results may depend on how many there are.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar

import numpy as np

from fastpin.kernels.jit import blas_address

WORTHWHILE = 4_000_000
"""Multiplications from which on a product is made in two threads."""

_POINTER = ctypes.c_void_p

# Called in this way it leaves the interpreter free, and works on parts of arrays in place.
_dgemm = ctypes.CFUNCTYPE(None, *[_POINTER] * 13)(blas_address("dgemm"))
_second: ThreadPoolExecutor | None = None
_alone = ContextVar("_alone", default=False)


@contextmanager
def in_one_thread() -> Iterator[None]:
    """Inside the block the calling thread makes its products alone; their bits stay the same."""
    before = _alone.set(True)
    try:
        yield
    finally:
        _alone.reset(before)


def add_product(out: np.ndarray, left: np.ndarray, right: np.ndarray) -> None:
    """out (m, n) += left (m, k) @ right (k, n), in place; all of them stored column by column, parts of arrays too."""
    m, n = out.shape
    if left.shape[0] != m or right.shape != (left.shape[1], n):
        raise ValueError(f"shapes do not fit: {out.shape} += {left.shape} @ {right.shape}")
    if m * n * left.shape[1] < WORTHWHILE:
        _add(out, left, right)
        return
    half = m // 2
    lower = out[half:], left[half:], right
    other = None if _alone.get() else _start(*lower)
    try:
        if other is None:
            _add(*lower)
        _add(out[:half], left[:half], right)
    finally:
        if other is not None:
            other.result()


def _start(out: np.ndarray, left: np.ndarray, right: np.ndarray) -> Future[None] | None:
    """The product on its way in the second thread; None if the interpreter is about to end."""
    global _second
    if _second is None:
        _second = ThreadPoolExecutor(1, thread_name_prefix="fastpin")
    try:
        return _second.submit(_add, out, left, right)
    except RuntimeError:
        return None


def _add(out: np.ndarray, left: np.ndarray, right: np.ndarray) -> None:
    (m, n), k = out.shape, left.shape[1]
    if m * n * k == 0:
        return
    one, plain = ctypes.byref(ctypes.c_double(1.0)), ctypes.c_char_p(b"N")
    sizes = [ctypes.byref(ctypes.c_int(size)) for size in (m, n, k)]
    (a, lda), (b, ldb), (c, ldc) = (_place(array) for array in (left, right, out))
    _dgemm(plain, plain, *sizes, one, a, lda, b, ldb, one, c, ldc)


def _place(array: np.ndarray) -> tuple[int, object]:
    """Where an array begins, and the distance of its columns, for BLAS."""
    rows, columns = array.shape
    step = array.strides[1] if columns > 1 else 8 * rows
    if array.dtype != np.float64 or (rows > 1 and array.strides[0] != 8) or step < 8 * rows or step % 8:
        raise ValueError("must be stored column by column")
    return array.ctypes.data, ctypes.byref(ctypes.c_int(step // 8))


def _forget_threads() -> None:
    global _second
    _second = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_threads)  # threads do not survive in a forked process
