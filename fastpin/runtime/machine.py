"""Machine code of kernels: the source of a kernel, its compilation by Numba, and its loading by LLVM without Numba.

Numba is imported when a kernel has no machine code on disk. Its private parts are used here to store machine code.
Where this can't be loaded, Numba's own result is stored. Numba's compiled functions need three small libraries of
Numba, which are loaded from their files: one makes Python functions, two have helpers in C.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import os
import pickle
import platform
import sys
from collections.abc import Callable, Iterable
from hashlib import blake2b
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

from fastpin.runtime.extensions import library, llvm, numba

CACHED = os.environ.get("FASTPIN_CACHE", "1") != "0"
"""Whether compiled code is stored on disk."""

SETTINGS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
"""Settings of every kernel: no fastmath and no parallel sums.

Division by zero gives inf or nan. C calls no kernel, so the wrapper for C is left out, which saves compiling.
"""

SHARED = ("kernels/arrays.py", "kernels/status.py")
"""Files of constants and of records of arrays that kernels take from other files. Code depends on them, too."""

CAN_LOAD = sys.platform == "linux" and platform.machine() == "x86_64"
"""Whether LLVM loads machine code without Numba: on the processors on which this is tested."""


# -- the source ------------------------------------------------------------------------------------------------


def stamp(file: str) -> tuple[int, int] | None:
    """Time and size of a file, which change with its text. None if there is no such file."""
    try:
        found = os.stat(file)  # noqa: PTH116  every process does it for each kernel, and paths take three times as long
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


@functools.cache
def digest(file: str, imported: tuple[int, int] | None) -> bytes:
    """The digest of an imported text. :class:`OSError` if its file is gone, or was replaced since the import."""
    content = Path(file).read_bytes()
    if stamp(file) != imported:
        raise OSError(f"{file} was replaced after its import")
    return blake2b(content).digest()


_shared = tuple((file, stamp(file)) for file in (str(Path(__file__).parents[1] / name) for name in SHARED))


class KernelSource:
    """A function that is to be compiled.

    Attributes
    ----------
    py_func : callable
        The function as plain Python.
    makes_arrays : bool
        Whether it makes arrays. If not, it works on arrays of its caller and returns numbers only. So it counts no
        references to arrays: counts take a quarter of the time of :func:`fastpin.kernels.held.step`.
    texts : tuple
        The files of its text, and their stamps at its import: its own file first, then those of the kernels of other
        files that its file imports. An upgrade may replace the files in a running process.
    """

    texts: tuple[tuple[str, tuple[int, int] | None], ...]

    def __init__(self, function: Callable[..., Any]) -> None:
        self.py_func = function
        self.makes_arrays = not {"arange", "copy", "empty", "ones", "zeros"}.isdisjoint(function.__code__.co_names)
        file = function.__code__.co_filename
        texts: dict[str, tuple[int, int] | None] = {file: stamp(file)}
        for each in function.__globals__.values():
            if isinstance(each, KernelSource):
                texts.update((other, kept) for other, kept in each.texts if other != file)
        self.texts = tuple({**texts, **dict(_shared)}.items())


# -- the compiler ----------------------------------------------------------------------------------------------


class Code(NamedTuple):
    """The machine code of a kernel for arguments of certain types.

    Attributes
    ----------
    machine_code : bytes
        An object file.
    entry, environment : str
        Symbols of the function that Python calls, and of the pointer to Numba's environment.
    mathematics : tuple of str
        Functions of C that are to be Numba's own, to get the same bits.
    foreign : tuple of str
        All symbols of Numba, Python and C that it needs.
    """

    machine_code: bytes
    entry: str
    environment: str
    mathematics: tuple[str, ...]
    foreign: tuple[str, ...]

    def to_bytes(self) -> bytes:
        """Four lines of names, and the object file."""
        lines = (self.entry, self.environment, " ".join(self.mathematics), " ".join(self.foreign), "")
        return "\n".join(lines).encode() + self.machine_code

    @classmethod
    def from_bytes(cls, content: bytes) -> Code:
        """The code of such bytes. :class:`ValueError` if they are others."""
        *lines, machine_code = content.split(b"\n", 4)
        entry, environment, mathematics, foreign = (line.decode() for line in lines)
        if not (entry and environment):
            raise ValueError("symbols without names")  # LLVM would end the process
        return cls(machine_code, entry, environment, tuple(mathematics.split()), tuple(foreign.split()))


@functools.cache
def dispatcher(source: KernelSource, alone: bool = True) -> Any:
    """Numba's function for a kernel: `alone` for calls from Python, else for other kernels, without a wrapper.

    Numba stores neither.
    """
    inner: dict[str, Any] = {} if alone else {"no_cpython_wrapper": True, "pipeline_class": _inner_compiler()}
    if hasattr(numba.core.options.DefaultOptions, "_nrt"):  # another version of Numba may lack it
        inner["_nrt"] = source.makes_arrays
    return numba.njit(**SETTINGS, **inner)(source.py_func)


@functools.cache
def _inner_compiler() -> Any:
    """Numba's compiler for functions that only kernels call. Their code is optimised in the outermost kernel, once.

    Numba itself optimises a function and makes its machine code, and does it again in its caller and in the caller of
    this one. That would take a third more time.
    """
    compiler: Any = numba.core.compiler.Compiler
    whole: Any = getattr(numba.core.codegen, "JITCodeLibrary", None)
    if whole is None:  # another version of Numba
        return compiler

    class Linked(whole):  # type: ignore[misc]
        """Code to be linked into others, which has no address."""

        codegen = SimpleNamespace(set_env=lambda name, environment: None)

        def _optimize_final_module(self) -> None:
            pass

        def _finalize_final_module(self) -> None:
            self._finalize_dynamic_globals()
            self._finalized = True

        def get_pointer_to_function(self, name: str) -> int:
            return 0

    class InnerCompiler(compiler):  # type: ignore[misc]
        def define_pipelines(self) -> Any:
            self.state.library = Linked(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
            return super().define_pipelines()

    return InnerCompiler


def compile_kernel(source: KernelSource, arguments: tuple[Any, ...]) -> tuple[Callable[..., Any], Code | bytes | None]:
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
        if CAN_LOAD:
            with contextlib.suppress(Exception):
                code = _object_code(result)
                load(code, result.fndesc.qualname, result.fndesc.modname)
                return entry, code
        return entry, _pack(result)
    return entry, None


def _object_code(result: Any) -> Code:
    """The machine code of a compiled function. :class:`ImportError` if it needs more than C, Python and the helpers."""
    library, description = result.library, result.fndesc
    module = library._final_module
    foreign = {one.name for one in (*module.functions, *module.global_variables) if one.is_declaration}
    foreign = {name for name in foreign if not name.startswith("llvm.")}
    if library.has_dynamic_globals or result.environment.consts or result.reload_init:
        raise ImportError("the code depends on this process")
    return Code(
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


# -- loading without Numba -------------------------------------------------------------------------------------


def load(code: Code, name: str, module: str) -> Callable[..., Any]:
    """Load a function of a module. It does not check the types of its arguments.

    :class:`ImportError` if it is not whole, or the process lacks a symbol, with which LLVM would end the process.
    """
    if missing := unknown_symbols(code.foreign):
        raise ImportError(f"no {', '.join(missing)}")
    parsed = llvm.ObjectFileRef.from_data(code.machine_code)
    if not parsed:
        raise ImportError("no object file")
    _name_symbols(code.mathematics)
    engine = _engine()
    engine.add_object_file(parsed)
    engine.finalize_object()
    entry, place = engine.get_function_address(code.entry), engine.get_global_value_address(code.environment)
    if not (entry and place):
        raise ImportError(f"no {code.entry}, or no {code.environment}")
    maker = library("numba._dynfunc")
    home = sys.modules[module]
    environment = maker.Environment(vars(home))
    ctypes.c_void_p.from_address(place).value = id(environment)
    # The function keeps environment and engine alive.
    return maker.make_function(home, name, "", entry, environment, (engine,))


@functools.cache
def target() -> tuple[str, str, str]:
    """The kind of machine, the processor and its features: code for another one may not run here."""
    return llvm.get_process_triple(), llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


@functools.cache
def helpers() -> dict[str, int]:
    """Names and addresses of the helpers of compiled code, as Numba names them."""
    memory = library("numba.core.runtime._nrt_python")
    memory.memsys_use_cpython_allocator()
    found = {f"numba_{name}": address for name, address in library("numba._helperlib").c_helpers.items()}
    found |= {name if name.startswith("_") else f"NRT_{name}": address for name, address in memory.c_helpers.items()}
    return found


def unknown_symbols(names: Iterable[str]) -> list[str]:
    """Those that are neither helpers nor symbols of the process, such as functions of C and Python."""
    known, process = helpers(), _process()
    return [name for name in names if name not in known and not hasattr(process, name)]


@functools.cache
def _process() -> ctypes.CDLL:
    """The symbols of this process. Found symbols are kept: kernels ask for the same ones."""
    return ctypes.CDLL(None)


@functools.cache
def _name_symbols(mathematics: tuple[str, ...]) -> None:
    """Tell LLVM the addresses of the helpers and of Numba's mathematical functions."""
    known = helpers()
    for name, address in known.items():
        llvm.add_symbol(name, address)
    for name in mathematics:
        llvm.add_symbol(name, known[f"numba_{name}"])


def _engine() -> Any:
    """A new engine. Each function has its own: names of one may not meet names of another."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    triple, processor, features = target()
    machine = llvm.Target.from_triple(triple).create_target_machine(
        cpu=processor, features=features, opt=3, reloc="static", codemodel="jitdefault", jit=True
    )
    return llvm.create_mcjit_compiler(llvm.parse_assembly(f'target triple = "{triple}"'), machine)
