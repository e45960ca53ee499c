"""Kernels where private parts of Numba have changed: results of Numba are stored, with the same bits."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from numba.core import codegen, compiler, intrinsics

from fastpin.kernels import influence
from fastpin.runtime import extensions, jit, machine, stored
from tests.support.processes import finished, python

pytestmark = pytest.mark.skipif(jit.PLAIN or not machine.CAN_LOAD, reason="no machine code is stored")


def without(name: str, *attributes: str) -> Any:
    """The loader of extension modules when one of them is missing, or lacks these attributes."""

    def library(asked: str) -> Any:
        module = extensions.library(asked)
        if asked != name:
            return module
        if not attributes:
            raise ImportError(f"{name} is missing")
        return SimpleNamespace(**{key: value for key, value in vars(module).items() if key not in attributes})

    return library


def refuse(*_: object) -> Any:
    raise AttributeError("no such part")


CHANGES: dict[str, tuple[object, str, object]] = {
    "no maker of functions": (machine, "library", without("numba._dynfunc")),
    "a maker without environments": (machine, "library", without("numba._dynfunc", "Environment")),
    "a maker of something else": (machine, "library", without("numba._dynfunc", "make_function")),
    "no helpers": (machine, "library", without("numba._helperlib")),
    "helpers without a list": (machine, "library", without("numba._helperlib", "c_helpers")),
    "no memory": (machine, "library", without("numba.core.runtime._nrt_python")),
    "memory with another call": (
        machine,
        "library",
        without("numba.core.runtime._nrt_python", "memsys_use_cpython_allocator"),
    ),
    "no list of mathematics": (intrinsics, "INTR_MATH", None),
    "no object code": (machine, "_object_code", refuse),
    "no engine": (machine, "_engine", refuse),
}


@pytest.fixture
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The only directory of stored code."""
    monkeypatch.setattr(stored.StoredCode, "_directories", lambda self: iter([tmp_path]))
    yield tmp_path
    forget()


def forget() -> None:
    """Ask Numba for its parts once more."""
    for remembered in (machine.helpers, machine._name_symbols, stored.own_environment):
        remembered.cache_clear()


@pytest.mark.gate
@pytest.mark.parametrize("change", CHANGES)
def test_a_result_of_numba_is_stored_when_a_part_changes(
    change: str, directory: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def value() -> float:
        """The value of a kernel in a new process, so to say."""
        forget()
        return float(jit.Kernel(influence.clausen.py_func, inner=False)(1.0))

    before = value()
    (file,) = directory.glob("*.machine")
    monkeypatch.setattr(*CHANGES[change])
    assert value() == before
    file.unlink()
    assert value() == before
    assert file.with_suffix(stored.NUMBA).is_file()
    monkeypatch.setattr(machine, "compile_kernel", refuse)
    assert value() == before


def test_numba_compiles_inner_functions_as_others_when_its_libraries_change(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(codegen, "JITCodeLibrary")
    assert machine._inner_compiler.__wrapped__() is compiler.Compiler


@pytest.mark.gate
def test_code_is_stored_for_versions_that_have_no_file(directory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    forget()
    monkeypatch.setattr(stored, "folder", lambda name: Path(os.devnull, name))
    jit.Kernel(influence.clausen.py_func, inner=False)(1.0)
    assert len(list(directory.glob("*.machine"))) == 1


@pytest.mark.gate
def test_code_that_can_not_be_stored_is_compiled_each_time(directory: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("_object_code", "_pack"):
        monkeypatch.setattr(machine, name, refuse)
    for _ in range(2):
        assert jit.Kernel(influence.clausen.py_func, inner=False)(1.0) == pytest.approx(1.0139591323607684, rel=1e-14)
    assert not list(directory.iterdir())


SOLVE = """
import hashlib, sys
import fastpin
from fastpin.runtime import machine
if len(sys.argv) > 1:
    def refuse(name):
        raise ImportError(name)
    machine.library = refuse
pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem.from_load_parameter(pair, 0.5, friction=0.4)
result = fastpin.solve(problem, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.1}], nodes=101, error_bars=True)
numbers = repr([[state.peak_hoop_stress(), state.contact, state.stick, dict(state.error_bars)] for state in result])
arrays = b"".join(state.pressure.tobytes() + state.shear.tobytes() for state in result)
print(hashlib.sha256(arrays + numbers.encode()).hexdigest())
"""


@pytest.mark.survey
def test_a_history_has_the_same_bits_without_any_part(tmp_path: Path) -> None:
    def run(*arguments: str, **more: str) -> str:
        variables = {name: value for name, value in os.environ.items() if name != "FASTPIN_CACHE"} | more
        return finished(python(SOLVE, *arguments), env=variables).stdout

    expected = run()
    assert run("without", NUMBA_CACHE_DIR=str(tmp_path)) == expected
    assert run("without", NUMBA_CACHE_DIR=str(tmp_path)) == expected
    assert list(tmp_path.glob("*.numba"))
