"""Matrix products in two threads. Their bits are the same for any number of cores.

A product is always cut into the same two halves. If every core has other work
(:func:`fastpin.runtime.threads.in_one_thread`), the halves are computed one after the other. BLAS runs on one thread
for each half. BLAS's own threads wait in loops. The loops cost more than they give as soon as another process wants a
core. The bits of BLAS's results may also depend on its number of threads.
"""

from __future__ import annotations

import ctypes
import os
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from fastpin.runtime.extensions import blas_address
from fastpin.runtime.threads import works_alone

WORTHWHILE = 4_000_000
"""Least number of multiplications of a product in two threads."""

# Called by its address, dgemm leaves the interpreter free, and works on parts of arrays in place.
_dgemm = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 13)(blas_address("dgemm"))
_second: ThreadPoolExecutor | None = None


def add_product(out: np.ndarray, left: np.ndarray, right: np.ndarray) -> None:
    """Add a product in place: out (m, n) += left (m, k) @ right (k, n).

    All three are stored column by column. They may be parts of larger arrays.

    Raises
    ------
    ValueError
        If shapes do not fit, or an array is not stored column by column in double precision.
    """
    m, n = out.shape
    if left.shape[0] != m or right.shape != (left.shape[1], n):
        raise ValueError(f"shapes do not fit: {out.shape} += {left.shape} @ {right.shape}")
    if m * n * left.shape[1] < WORTHWHILE:
        _add(out, left, right)
        return
    half = m // 2
    lower = out[half:], left[half:], right
    other = None if works_alone() else _start(*lower)
    try:
        if other is None:
            _add(*lower)
        _add(out[:half], left[:half], right)
    finally:
        if other is not None:
            other.result()


def _start(out: np.ndarray, left: np.ndarray, right: np.ndarray) -> Future[None] | None:
    """Start a product in the second thread. Return None if the interpreter is about to end."""
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
    (a, lda), (b, ldb), (c, ldc) = _place(left), _place(right), _place(out)
    _dgemm(plain, plain, *sizes, one, a, lda, b, ldb, one, c, ldc)


def _place(array: np.ndarray) -> tuple[int, object]:
    """The address of an array and the distance of its columns, for BLAS."""
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
