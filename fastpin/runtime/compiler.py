"""The compiler: Numba, and the machine code that it makes of a kernel.

Numba is imported when a kernel has no machine code on disk. Its private parts are used in :func:`compile_kernel`, and
in :mod:`fastpin.runtime.machine`, to store machine code. Where they have changed, Numba keeps the code itself.
"""

from __future__ import annotations

import contextlib
import functools
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fastpin.runtime.extensions import numba
from fastpin.runtime.machine import Code, load, unknown_symbols
from fastpin.runtime.source import CACHED, SETTINGS, KernelSource


@functools.cache
def dispatcher(source: KernelSource, alone: bool = True, kept: bool = False) -> Any:
    """Numba's function for a kernel: `alone` for calls from Python, else without a wrapper for these.

    Numba keeps the code of a `kept` function beside the package, else in the user's cache directory, else nowhere. Code
    of a text that was replaced is not kept.
    """
    settings = {**SETTINGS, "no_cpython_wrapper": not alone}
    if kept and CACHED and source.is_current():
        with contextlib.suppress(RuntimeError):  # no directory can be written
            function = numba.njit(cache=True, **settings)(source.py_func)
            _forget_unreadable(source, function.stats.cache_path)
            return function
    return numba.njit(**settings)(source.py_func)


def _forget_unreadable(source: KernelSource, directory: str | None) -> None:
    """Delete Numba's list of stored code of a function if it can't be read: it may name a class of an older version.

    Numba reads the list before it compares the text of the function with the stored one.
    """
    stem, name = Path(source.py_func.__code__.co_filename).stem, source.py_func.__qualname__
    for path in Path(directory).glob(f"{stem}.{name}-*.nbi") if directory else ():
        try:
            with path.open("rb") as file:
                pickle.load(file)
                pickle.loads(file.read())
        except Exception:
            with contextlib.suppress(OSError):
                path.unlink()


def compile_kernel(
    source: KernelSource, arguments: tuple[Any, ...], stores: bool
) -> tuple[Callable[..., Any], Code | None]:
    """Compile a kernel for arguments of these types.

    Returns
    -------
    entry : callable
        The compiled function, which need not check the types of its arguments.
    code : Code or None
        Its machine code, if the caller `stores` it. None if it can't be loaded by a process without Numba.
    """
    function = dispatcher(source, kept=not stores)
    kinds = tuple(map(numba.typeof, arguments))
    entry = function.compile(kinds)
    with contextlib.suppress(Exception):  # these parts of Numba may change with any version: Numba keeps the code then
        result = function.overloads[kinds]
        code = _object_code(result) if stores else None
        if code is not None:
            load(code, result.fndesc.qualname, result.fndesc.modname)
        return entry, code
    return entry, None


def _object_code(result: Any) -> Code | None:
    """The machine code of a compiled function. None if it needs more than C, Python and the known helpers."""
    library, description = result.library, result.fndesc
    module = library._final_module
    foreign = {one.name for one in (*module.functions, *module.global_variables) if one.is_declaration}
    foreign = {name for name in foreign if not name.startswith("llvm.")}
    if unknown_symbols(foreign) or library.has_dynamic_globals or result.environment.consts or result.reload_init:
        return None
    return Code(
        library._get_compiled_object(),
        description.llvm_cpython_wrapper_name,
        description.env_name,
        tuple(sorted(numba.core.intrinsics.INTR_MATH)),
        tuple(sorted(foreign)),
    )
