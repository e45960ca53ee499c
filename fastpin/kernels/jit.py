"""The settings of compiled code, in one place.

Numba stores compiled code beside the package. If the package folder can't be written, Numba stores it in the user's
cache directory. If neither can be written, every process compiles again. Set ``FASTPIN_CACHE=0`` to compile without a
cache on disk. Numba's own ``NUMBA_DISABLE_JIT=1`` runs everything as plain Python.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numba
from numba.extending import get_cython_function_address

CACHED = os.environ.get("FASTPIN_CACHE", "1") != "0"
"""Whether compiled code is stored on disk."""

SETTINGS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
"""Settings of every kernel: no fastmath and no parallel sums.

Division by zero gives inf or nan. C calls no kernel, so the wrapper for C is left out, which saves compiling.
"""


def compiled(function: Callable[..., Any], **settings: Any) -> Callable[..., Any]:
    """Compile a kernel: the decorator of every kernel."""
    if CACHED:
        try:
            return numba.njit(cache=True, **SETTINGS, **settings)(function)
        except RuntimeError:  # no directory can be written
            pass
    return numba.njit(**SETTINGS, **settings)(function)


def inner(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a kernel that only kernels call: the decorator of these.

    The wrapper for calls from Python is left out. With arguments of many arrays the wrapper takes longer to compile
    than the kernel. A call from Python all the same crashes the interpreter.
    """
    return compiled(function, no_cpython_wrapper=True)


def blas_address(name: str) -> int:
    """The address of a routine of SciPy's own BLAS, for calls that leave the interpreter free."""
    return int(get_cython_function_address("scipy.linalg.cython_blas", name))


def limit_to_one_thread() -> None:
    """Limit compiled code to one thread, in this process and in the processes that it starts."""
    os.environ["NUMBA_NUM_THREADS"] = "1"
    numba.config.reload_config()
