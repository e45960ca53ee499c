"""The compiler: Numba, and the machine code that it makes of a kernel.

This is the only file that imports Numba. It is imported when a kernel has no machine code on disk.
"""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable
from typing import Any

import numba
from numba.core import intrinsics, types

from fastpin.runtime.jit import CACHED, SETTINGS, Kernel
from fastpin.runtime.machine import CAN_LOAD, Code, helpers, load


@functools.cache
def dispatcher(kernel: Kernel, alone: bool) -> Any:
    """Numba's function for a kernel: `alone` for calls from Python, else without a wrapper for these.

    Code of fastpin's own store is not kept by Numba a second time. Code of a text that was replaced is not kept.
    """
    settings = dict(SETTINGS) if alone else {**SETTINGS, "no_cpython_wrapper": True}
    if CACHED and kernel.is_current() and not (alone and CAN_LOAD):
        return _kept_by_numba(kernel, settings)
    return numba.njit(**settings)(kernel.py_func)


@functools.cache
def kept(kernel: Kernel) -> Any:
    """Numba's function for a kernel whose machine code can't be stored. Numba keeps it on disk."""
    return _kept_by_numba(kernel, SETTINGS)


def _kept_by_numba(kernel: Kernel, settings: dict[str, Any]) -> Any:
    """A function that Numba keeps beside the package, else in the user's cache directory, else nowhere."""
    try:
        return numba.njit(cache=True, **settings)(kernel.py_func)
    except RuntimeError:  # no directory can be written
        return numba.njit(**settings)(kernel.py_func)


def callee(kernel: Kernel) -> Any:
    """The type of a kernel that another kernel calls."""
    return types.Dispatcher(dispatcher(kernel, alone=False))


def compile_kernel(kernel: Kernel, arguments: tuple[Any, ...]) -> tuple[Callable[..., Any], Code | None]:
    """Compile a kernel for arguments of these types.

    Returns
    -------
    entry : callable
        The compiled function, which does not check the types of its arguments.
    code : Code or None
        Its machine code. None if it can't be loaded by a process without Numba.
    """
    function = dispatcher(kernel, alone=True)
    kinds = tuple(function.typeof_pyval(value) for value in arguments)
    entry = function.compile(kinds)
    result = function.overloads[kinds]
    return entry, _machine_code(result) if CACHED and CAN_LOAD else None


def _machine_code(result: Any) -> Code | None:
    """The machine code of a compiled function; None if a process without Numba can't load it."""
    try:
        code = _object_code(result)
        if code is not None:
            load(code, result.fndesc.qualname, result.fndesc.modname)
    except Exception:  # these parts of Numba may change with any version: Numba keeps the code then
        return None
    return code


def _object_code(result: Any) -> Code | None:
    """The machine code of a compiled function. None if it needs more than C, Python and the known helpers."""
    library, description, process = result.library, result.fndesc, ctypes.CDLL(None)
    module = library._final_module
    foreign = {one.name for one in (*module.functions, *module.global_variables) if one.is_declaration}
    known = helpers()
    unknown = [
        name for name in foreign if not name.startswith("llvm.") and name not in known and not hasattr(process, name)
    ]
    if unknown or library.has_dynamic_globals or result.environment.consts or result.reload_init:
        return None
    return Code(
        library._get_compiled_object(),
        description.llvm_cpython_wrapper_name,
        description.env_name,
        tuple(sorted(intrinsics.INTR_MATH)),
    )


def read_environment() -> None:
    """Let Numba read the variables of the environment again."""
    numba.config.reload_config()
