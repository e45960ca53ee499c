"""Parts of SciPy and Numba without the rest: extension modules loaded from their files, and modules for later.

Importing extension modules by name would import the packages around them, which takes several times as long as NumPy:
Numba 0.2 s, ``scipy.linalg`` 0.1 s. A package that is imported later uses the same modules.
"""

from __future__ import annotations

import ctypes
import functools
import importlib
import importlib.machinery
import importlib.util
import sys
from pathlib import Path
from types import ModuleType
from typing import Any


class Later:
    """A module that is imported when it is first used."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        return getattr(importlib.import_module(self._name), attribute)


@functools.cache
def folder(package: str) -> Path:
    """The folder of a package, which is not imported. :class:`ImportError` if there is none."""
    found = importlib.util.find_spec(package)
    if found is None or found.origin is None:
        raise ImportError(f"{package} is missing")
    return Path(found.origin).parent


def library(name: str) -> ModuleType:
    """An extension module, such as ``numba._dynfunc``, without the packages around it.

    The packages import the same module later.
    """
    if name in sys.modules:
        return sys.modules[name]
    package, *folders, _ = name.split(".")
    loader = (importlib.machinery.ExtensionFileLoader, importlib.machinery.EXTENSION_SUFFIXES)
    found = importlib.machinery.FileFinder(str(folder(package).joinpath(*folders)), loader).find_spec(name)
    if found is None or found.loader is None:
        raise ImportError(f"{name} is missing")
    module = importlib.util.module_from_spec(found)
    sys.modules[name] = module
    found.loader.exec_module(module)
    return module


numba = Later("numba")
"""The compiler, which kernels without machine code on disk need."""

llvm = Later("llvmlite.binding")
"""The part of the compiler that loads machine code."""

metadata = Later("importlib.metadata")
"""The versions of packages, if their own files do not tell them."""

fft = Later("scipy.fft")
"""Fourier transforms, which grids of many nodes need."""

interpolate = Later("scipy.interpolate")
"""Cubics, which curves between the nodes follow."""

special = Later("scipy.special")
"""Distributions, which lives at a confidence need."""

optimize = Later("scipy.optimize")
"""Minima and roots, which few problems need."""

blas, lapack = library("scipy.linalg._fblas"), library("scipy.linalg._flapack")
"""The routines of ``scipy.linalg.blas`` and ``scipy.linalg.lapack``."""


def blas_address(name: str) -> int:
    """The address of a routine of SciPy's own BLAS, for calls that leave the interpreter free."""
    python: Any = ctypes.pythonapi
    python.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
    python.PyCapsule_GetPointer.restype = ctypes.c_void_p
    return int(python.PyCapsule_GetPointer(getattr(blas, name)._cpointer, None))
