"""Machine code of kernels, loaded by LLVM without Numba.

Numba's compiled functions need three small libraries of Numba, which are loaded from their files: one makes Python
functions, two have helpers in C.
"""

from __future__ import annotations

import ctypes
import functools
import platform
import sys
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from fastpin.runtime.extensions import library, llvm

CAN_LOAD = sys.platform == "linux" and platform.machine() == "x86_64"
"""Whether machine code is loaded in this way: on the processors on which it is tested."""


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
    """The symbols of this process. It keeps those that were found: kernels ask for the same ones."""
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
