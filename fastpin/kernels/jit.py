"""The one place for the settings of compiled code.

What is compiled is kept beside the package, or in the user's cache directory where the package can't be written; where
neither can, it is compiled again in every process. Set ``FASTPIN_CACHE=0`` to compile without an on-disk cache;
Numba's own ``NUMBA_DISABLE_JIT=1`` runs everything as plain Python.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numba
from numba.extending import get_cython_function_address

CACHED = os.environ.get("FASTPIN_CACHE", "1") != "0"
SETTINGS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
"""No fastmath, no parallel sums; division by zero gives inf or nan; nothing is called from C, which saves compiling."""


def compiled(function: Callable[..., Any], **settings: Any) -> Callable[..., Any]:
    """Decorator of every kernel."""
    if CACHED:
        try:
            return numba.njit(cache=True, **SETTINGS, **settings)(function)
        except RuntimeError:  # there is no directory that can be written
            pass
    return numba.njit(**SETTINGS, **settings)(function)


def inner(function: Callable[..., Any]) -> Callable[..., Any]:
    """Decorator of a kernel that only kernels call.

    What Python would need to call it is left out: with arguments of many arrays that takes longer to compile than the
    kernel. Called from Python all the same, it takes the interpreter down.
    """
    return compiled(function, no_cpython_wrapper=True)


def blas_address(name: str) -> int:
    """Where a routine of SciPy's own BLAS begins, for calls that leave the interpreter free."""
    return int(get_cython_function_address("scipy.linalg.cython_blas", name))


def on_one_thread() -> None:
    """No more than one thread for compiled code, in this process and those that it starts."""
    os.environ["NUMBA_NUM_THREADS"] = "1"
    numba.config.reload_config()
