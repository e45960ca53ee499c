"""The settings of compiled code, and the functions that are compiled with them.

A kernel is compiled when it is first called, once for each combination of types of its arguments. The machine code is
kept on disk (:mod:`fastpin.runtime.stored`). Later processes load it without Numba, whose import takes several times
as long as that of NumPy. Set ``FASTPIN_CACHE=0`` to compile afresh. Numba's own ``NUMBA_DISABLE_JIT=1`` runs everything
as plain Python.
"""

from __future__ import annotations

import functools
import importlib
import logging
import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy import ndarray

CACHED = os.environ.get("FASTPIN_CACHE", "1") != "0"
"""Whether compiled code is stored on disk."""

PLAIN = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
"""Whether kernels run as plain Python."""

SETTINGS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
"""Settings of every kernel: no fastmath and no parallel sums.

Division by zero gives inf or nan. C calls no kernel, so the wrapper for C is left out, which saves compiling.
"""

SCALARS: dict[type, str] = {
    bool: "?", np.bool_: "?", int: "q", np.int64: "q", float: "d", np.float64: "d", complex: "D", np.complex128: "D",
}  # fmt: skip
"""Types of numbers, and the letter of the type that the compiler gives them."""

C_ORDER, F_ORDER, ALIGNED, WRITEABLE = 0x1, 0x2, 0x100, 0x400
LAYOUT = C_ORDER | F_ORDER | ALIGNED | WRITEABLE
"""Bits of ``ndarray.flags.num`` on which compiled code depends."""

SHARED = ("kernels/arrays.py", "kernels/status.py")
"""Files of constants and of records of arrays that kernels take from other files. Code depends on them, too."""

logger = logging.getLogger("fastpin.compiler")

_lock = threading.RLock()


def stamp(file: str) -> tuple[int, int] | None:
    """Time and size of a file, which change with its text. None if there is no such file."""
    try:
        found = os.stat(file)  # noqa: PTH116  every process does it for each kernel, and paths take three times as long
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


_shared = tuple((file, stamp(file)) for file in (str(Path(__file__).parents[1] / name) for name in SHARED))


class Kernel:
    """A compiled function.

    Attributes
    ----------
    py_func : callable
        The function as plain Python.
    inner : bool
        Whether only kernels call it. The wrapper for calls from Python is then never compiled.
    texts : tuple
        The files of its text, and their stamps at its import. An upgrade may replace the files in a running process.
    """

    def __init__(self, function: Callable[..., Any], inner: bool) -> None:
        functools.update_wrapper(self, function)
        self.py_func = function
        self.inner = inner
        file = function.__code__.co_filename
        self.texts = ((file, stamp(file)), *_shared)
        self._entries: dict[tuple[Any, ...], Callable[..., Any]] = {}

    def __call__(self, *arguments: Any) -> Any:
        try:
            types = argument_types(arguments)
        except KeyError:  # types that no kernel of fastpin takes: the compiler decides
            return _compiler().dispatcher(self, alone=True)(*arguments)
        entry = self._entries.get(types)
        if entry is None:
            entry = self._find(types, arguments)
        return entry(*arguments)

    def is_current(self) -> bool:
        """Whether the files of its text are still those that were imported."""
        return all(stamp(file) == imported for file, imported in self.texts)

    @functools.cached_property
    def _numba_type_(self) -> Any:
        """The type of the kernel in other kernels. The compiler asks for it by this name."""
        return _compiler().callee(self)

    def _find(self, types: tuple[Any, ...], arguments: tuple[Any, ...]) -> Callable[..., Any]:
        """Load the machine code for these arguments, or compile it."""
        if self.inner:
            raise TypeError(f"{self.py_func.__qualname__} is called by kernels only")
        with _lock:
            if types not in self._entries:
                place: Any = None
                if CACHED:
                    place = importlib.import_module("fastpin.runtime.stored").place_of(self, signature(types))
                entry: Any = place and place.load()
                if entry is None:
                    _announce()
                    entry, code = _compiler().compile_kernel(self, arguments)
                    if place:
                        place.save(code)
                self._entries[types] = entry
            return self._entries[types]


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a kernel: the decorator of every kernel."""
    return function if PLAIN else Kernel(function, inner=False)


def inner(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a kernel that only kernels call: the decorator of these.

    The wrapper for calls from Python is left out. With arguments of many arrays the wrapper takes longer to compile
    than the kernel.

    Raises
    ------
    TypeError
        When it is called from Python.
    """
    return function if PLAIN else Kernel(function, inner=True)


def argument_types(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """The types of arguments: a key that is quickly made. :class:`KeyError` if a type is neither array nor number."""
    found: list[Any] = []
    for value in values:
        kind = type(value)
        if kind is ndarray:
            found += value.dtype, value.ndim, value.flags.num & LAYOUT
        elif kind in SCALARS:
            found.append(SCALARS[kind])
        elif issubclass(kind, tuple):
            found += kind, argument_types(value)
        else:
            raise KeyError(kind)
    return tuple(found)


def signature(types: tuple[Any, ...]) -> str:
    """The key of :func:`argument_types` as text. Keys that the compiler takes for the same types have the same text."""
    words, rest = [], iter(types)
    for one in rest:
        if isinstance(one, np.dtype):
            dimensions, bits = next(rest), next(rest)
            order = "C" if bits & C_ORDER else "F" if bits & F_ORDER else "A"
            words.append(f"{one.str}{dimensions}{order}{bits & (ALIGNED | WRITEABLE):x}")
        elif isinstance(one, type):
            words.append(f"{one.__name__}({signature(next(rest))})")
        else:
            words.append(one)
    return ", ".join(words)


@functools.cache
def _announce() -> None:
    """Say once why the first call takes long."""
    logger.info("compiling the solver; this takes some seconds%s", ", once" if CACHED else "")


def limit_to_one_thread() -> None:
    """Limit compiled code to one thread, in this process and in the processes that it starts."""
    os.environ["NUMBA_NUM_THREADS"] = "1"
    if "numba" in sys.modules:
        _compiler().read_environment()


def _compiler() -> Any:
    """The module that imports Numba. Nothing that is loaded from disk needs it."""
    return importlib.import_module("fastpin.runtime.compiler")
