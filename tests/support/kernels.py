"""Kernels as plain Python."""

from collections.abc import Callable
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any

import pytest


def python(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """A kernel as plain Python. NUMBA_DISABLE_JIT=1 leaves no other form."""
    return getattr(kernel, "py_func", kernel)


def in_python(module: ModuleType) -> SimpleNamespace:
    """The kernels of a module as plain Python, which call one another."""
    space = dict(vars(module))
    for name, kernel in vars(module).items():
        if hasattr(kernel, "py_func"):
            space[name] = FunctionType(kernel.py_func.__code__, space, name)
    return SimpleNamespace(**space)


def run_as_python(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace all kernels of a module by plain Python."""
    for name, function in vars(module).items():
        if hasattr(function, "py_func"):
            monkeypatch.setattr(module, name, function.py_func)
