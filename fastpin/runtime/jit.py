"""Compiled functions.

A kernel is compiled when it is first called, once for each combination of types of its arguments. No signal and no
exception of another thread disturbs it. The machine code is kept on disk (:mod:`fastpin.runtime.stored`). Later
processes load it without Numba, whose import takes several times as long as that of NumPy. Set ``FASTPIN_CACHE=0`` to
compile afresh. Numba's own ``NUMBA_DISABLE_JIT=1`` runs everything as plain Python.
"""

from __future__ import annotations

import functools
import logging
import os
import sys
import threading
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy import ndarray

from fastpin.runtime import beside, machine, stored
from fastpin.runtime.extensions import numba
from fastpin.runtime.machine import CACHED, KernelSource
from fastpin.runtime.threads import undisturbed

PLAIN = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
"""Whether kernels run as plain Python."""

SCALARS: dict[type, str] = {
    bool: "?", np.bool_: "?", int: "q", np.int64: "q", float: "d", np.float64: "d", complex: "D", np.complex128: "D",
}  # fmt: skip
"""Types of numbers, and the letter of the type that the compiler gives them."""

C_ORDER, F_ORDER, ALIGNED, WRITEABLE = 0x1, 0x2, 0x100, 0x400
LAYOUT = C_ORDER | F_ORDER | ALIGNED | WRITEABLE
"""Bits of ``ndarray.flags.num`` on which compiled code depends."""

logger = logging.getLogger("fastpin.compiler")

_lock = threading.RLock()


class Kernel(KernelSource):
    """A compiled function.

    Attributes
    ----------
    inner : bool
        Whether only kernels call it. The wrapper for calls from Python is then never compiled.
    """

    def __init__(self, function: Callable[..., Any], inner: bool) -> None:
        super().__init__(function)
        functools.update_wrapper(self, function)
        self.inner = inner
        self._entries: dict[tuple[Any, ...], Callable[..., Any]] = {}

    def __call__(self, *arguments: Any) -> Any:
        try:
            types = argument_types(arguments)
        except KeyError:  # types that no kernel of fastpin takes: the compiler decides
            function = machine.dispatcher(self)
            undisturbed(lambda: function.compile(tuple(map(numba.typeof, arguments))))
            return function(*arguments)
        entry = self._entries.get(types)
        if entry is None:
            entry = self._find(types, arguments)
        return entry(*arguments)

    def prepare(self, *arguments: Any) -> None:
        """Load or compile the machine code for arguments of these types. Nothing is called."""
        self._find(argument_types(arguments), arguments)

    @functools.cached_property
    def _numba_type_(self) -> Any:
        """The type of the kernel in other kernels. The compiler asks for it by this name."""
        return numba.typeof(machine.dispatcher(self, alone=False))

    def _find(self, types: tuple[Any, ...], arguments: tuple[Any, ...]) -> Callable[..., Any]:
        """Load the machine code for these arguments, or compile it."""
        if self.inner:
            raise TypeError(f"{self.py_func.__qualname__} is called by kernels only")
        return undisturbed(lambda: self._load_or_compile(types, arguments))

    def _load_or_compile(self, types: tuple[Any, ...], arguments: tuple[Any, ...]) -> Callable[..., Any]:
        with _lock:
            if types not in self._entries:
                place = stored.place_of(self, signature(types)) if CACHED else None
                entry: Any = place and (place.load() or stored.load_shipped(self, signature(types)))
                if entry is None:
                    _announce()
                    if place and machine.CAN_LOAD:
                        beside.start()
                    entry, code = machine.compile_kernel(self, arguments)
                    if place and code:
                        place.save(code)
                self._entries[types] = entry
            return self._entries[types]


def compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a kernel: the decorator of every kernel. It returns numbers only.

    A kernel that makes no arrays counts no references to them. It can't copy an array to a slice.
    """
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
    """The dispatch key of the argument types. :class:`KeyError` if a type is neither array nor number."""
    found: list[Any] = []
    for value in values:
        if type(value) is ndarray:
            found.append((value.dtype, value.ndim, value.flags.num & LAYOUT))
        elif isinstance(value, tuple):
            found.append((type(value), argument_types(value)))
        else:
            found.append(SCALARS[type(value)])
    return tuple(found)


def signature(types: tuple[Any, ...]) -> str:
    """The key of :func:`argument_types` as text. Keys that the compiler takes for the same types have the same text."""
    words = []
    for one in types:
        kind = one[0]
        if isinstance(kind, np.dtype):
            _, dimensions, bits = one
            order = "C" if bits & C_ORDER else "F" if bits & F_ORDER else "A"
            words.append(f"{kind.str}{dimensions}{order}{bits & (ALIGNED | WRITEABLE):x}")
        else:
            words.append(f"{kind.__name__}({signature(one[1])})" if isinstance(kind, type) else one)
    return ", ".join(words)


@functools.cache
def _announce() -> None:
    """Say once why the first call takes long."""
    logger.info("compiling the solver; this takes some seconds%s", ", once" if CACHED else "")


def limit_to_one_thread() -> None:
    """Limit compiled code to one thread, in this process and in the processes that it starts."""
    os.environ["NUMBA_NUM_THREADS"] = "1"
    if "numba" in sys.modules:
        numba.config.reload_config()
