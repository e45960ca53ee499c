"""The compiler: Numba, and the machine code that it makes of a kernel.

Numba is imported when a kernel has no machine code on disk. Its private parts are used in :func:`compile_kernel`, and
in :mod:`fastpin.runtime.machine`, to store machine code. Where this can't be loaded, Numba's own result is stored.
"""

from __future__ import annotations

import contextlib
import functools
import pickle
from collections.abc import Callable
from typing import Any

from fastpin.runtime import machine
from fastpin.runtime.extensions import numba
from fastpin.runtime.source import SETTINGS, KernelSource


@functools.cache
def dispatcher(source: KernelSource, alone: bool = True) -> Any:
    """Numba's function for a kernel: `alone` for calls from Python, else without a wrapper for these.

    Numba stores neither.
    """
    return numba.njit(**SETTINGS, no_cpython_wrapper=not alone)(source.py_func)


def compile_kernel(
    source: KernelSource, arguments: tuple[Any, ...]
) -> tuple[Callable[..., Any], machine.Code | bytes | None]:
    """Compile a kernel for arguments of these types.

    Returns
    -------
    entry : callable
        The compiled function, which need not check the types of its arguments.
    code : Code, bytes or None
        What later processes load: its machine code, else a result for :func:`unpack`. None if there is neither.
    """
    function = dispatcher(source)
    kinds = tuple(map(numba.typeof, arguments))
    entry = function.compile(kinds)
    # Private parts of Numba may change with any version, and an exception in a call from LLVM hides the object code.
    with contextlib.suppress(Exception):
        result = function.overloads[kinds]
        if machine.CAN_LOAD:
            with contextlib.suppress(Exception):
                code = _object_code(result)
                machine.load(code, result.fndesc.qualname, result.fndesc.modname)
                return entry, code
        return entry, _pack(result)
    return entry, None


def _object_code(result: Any) -> machine.Code:
    """The machine code of a compiled function. :class:`ImportError` if it needs more than C, Python and the helpers."""
    library, description = result.library, result.fndesc
    module = library._final_module
    foreign = {one.name for one in (*module.functions, *module.global_variables) if one.is_declaration}
    foreign = {name for name in foreign if not name.startswith("llvm.")}
    if library.has_dynamic_globals or result.environment.consts or result.reload_init:
        raise ImportError("the code depends on this process")
    return machine.Code(
        library._get_compiled_object(),
        description.llvm_cpython_wrapper_name,
        description.env_name,
        tuple(sorted(numba.core.intrinsics.INTR_MATH)),
        tuple(sorted(foreign)),
    )


def _pack(result: Any) -> bytes | None:
    """A compiled function for another process with Numba. None if it depends on this process."""
    if result.library.has_dynamic_globals or result.lifted or result.reload_init:
        return None
    library = result.library.serialize_using_object_code()
    description, environments = result.fndesc, result._find_referenced_environments()
    description.typemap = description.calltypes = None  # these can't be packed, and nobody needs them
    return numba.core.serialize.dumps((library, description, result.environment, environments))


def unpack(content: bytes) -> Callable[..., Any]:
    """The function of a packed result. :class:`ImportError` if it is not whole."""
    target = numba.core.registry.cpu_target.target_context
    target.refresh()
    codegen = target.codegen()
    packed, description, environment, environments = pickle.loads(content)
    library = codegen.unserialize_library(packed)
    engine, names = codegen._engine, [one.env_name for one in (environment, *environments)]
    if not engine.get_function_address(description.llvm_cpython_wrapper_name) or not all(
        map(engine.get_global_value_address, names)
    ):
        raise ImportError(f"no {description.llvm_cpython_wrapper_name}, or no environment")
    for one in environments:
        codegen.set_env(one.env_name, one)
    return target.get_executable(library, description, environment)
