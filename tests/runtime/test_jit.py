"""Compiled code: where it is kept, when it is used again, and that it is the same code when it is loaded."""

from __future__ import annotations

import ast
import importlib
import inspect
import os
import sys
from collections import namedtuple
from pathlib import Path

import numpy as np
import pytest

from fastpin.kernels import conditions, exchange, influence
from fastpin.kernels.arrays import ContactValues
from fastpin.runtime import jit, machine
from tests.support import small_kernels
from tests.support.processes import finished, python

PACKAGE = Path(__file__).resolve().parents[2] / "fastpin"
KERNEL = """
from fastpin.runtime.jit import compiled, inner
@inner
def product(x, y):
    return x * y
@compiled
def doubled(x):
    return product(2.0, x)
"""
CODE = """
import sys
from fastpin.kernels.small import doubled
assert doubled(1.5) == 3.0
print("numba" in sys.modules)
"""
pytestmark = pytest.mark.skipif(jit.PLAIN, reason="nothing is compiled")
keeps = pytest.mark.skipif(not machine.CAN_LOAD, reason="results of Numba are stored")


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """A directory with copies of the files that compile, and a small kernel."""
    return small_kernels.install(tmp_path / "site", KERNEL)


def cache(installed: Path) -> Path:
    return installed / "fastpin" / "kernels" / "__pycache__"


def stored_in(directory: Path) -> list[str]:
    return sorted(path.name.split("-")[0] for path in directory.glob("*.machine"))


def compiles(installed: Path, **more: str) -> bool:
    """Whether a process compiles the function, because it does not find it."""
    switches = {"NUMBA_CACHE_DIR", "NUMBA_DISABLE_JIT", "FASTPIN_CACHE", "XDG_CACHE_HOME"}
    environment = {name: value for name, value in os.environ.items() if name not in switches}
    environment |= {"PYTHONPATH": str(installed), "HOME": str(installed), **more}
    done = finished(python(CODE), env=environment, cwd=installed)
    assert done.stderr == ""
    return done.stdout.split() == ["True"]


OPTIMISED = """
from numba.core.codegen import JITCodeLibrary
names, whole = [], JITCodeLibrary._optimize_final_module
def seen(library):
    names.append(library.name)
    whole(library)
JITCodeLibrary._optimize_final_module = seen
import small
print(small.doubled(0.5), *(name for name in names if name in vars(small)))
"""


@pytest.mark.gate
def test_functions_that_a_kernel_calls_are_optimised_with_it_only(tmp_path: Path) -> None:
    """Numba would optimise each of them alone first, and in each caller, for a third more time."""
    process = small_kernels.start(small_kernels.site(tmp_path), code=OPTIMISED)
    assert small_kernels.read(process) == [repr(small_kernels.VALUES[0]), "doubled"]


@pytest.mark.gate
@keeps
def test_kept_beside_the_package_until_it_does_not_fit_any_more(installed: Path, tmp_path: Path) -> None:
    assert compiles(installed)
    assert stored_in(cache(installed)) == ["small.doubled"]
    assert not compiles(installed)
    moved = installed.rename(tmp_path / "elsewhere")
    assert not compiles(moved)

    (file,) = cache(moved).glob("*.machine")
    with (moved / "fastpin" / "kernels" / "small.py").open("a") as source:
        source.write("# changed\n")
    assert compiles(moved)
    assert stored_in(cache(moved)) == ["small.doubled"]
    assert not file.exists()


REPLACED = """
import pathlib, sys
from fastpin.kernels import small
file = pathlib.Path(sys.argv[1])
file.write_text(sys.argv[2] + file.read_text())
print(small.doubled(1.5))
"""


@pytest.mark.gate
@keeps
@pytest.mark.parametrize("file", ["kernels/small.py", *machine.SHARED])
def test_a_process_whose_files_are_replaced_stores_no_code(installed: Path, file: str) -> None:
    """The text on disk is not the text that it has imported, as after an upgrade while it runs."""
    path = installed / "fastpin" / file
    variables = {**os.environ, "PYTHONPATH": str(installed), "HOME": str(installed), "NUMBA_CACHE_DIR": ""}
    done = finished(python(REPLACED, path, "# upgraded\n"), env=variables, cwd=installed)
    assert done.stdout.split() == ["3.0"]
    assert stored_in(cache(installed)) == []
    assert not list(cache(installed).glob("*.n*"))  # nor a result of Numba


@pytest.mark.gate
@keeps
def test_other_settings_need_other_code(installed: Path) -> None:
    assert compiles(installed)
    assert compiles(installed, FASTPIN_CACHE="0")
    assert compiles(installed, NUMBA_OPT="1")
    assert stored_in(cache(installed)) == ["small.doubled"] * 2


@pytest.mark.gate
@keeps
def test_in_the_cache_of_the_user_where_the_package_can_not_be_written(installed: Path) -> None:
    cache(installed).touch()  # nobody, not even root, can make a directory where a file is
    assert compiles(installed)
    assert stored_in(installed / ".cache" / "fastpin") == ["small.doubled"]
    assert not compiles(installed)
    chosen = installed / "chosen"
    assert compiles(installed, NUMBA_CACHE_DIR=str(chosen))
    assert stored_in(chosen) == ["small.doubled"]
    assert compiles(installed, HOME=str(Path(os.devnull) / "home"))


def arguments_of_columns(rng: np.random.Generator) -> tuple[object, ...]:
    seen, nodes = np.sort(rng.uniform(-3.0, 3.0, 30)), rng.uniform(-3.0, 3.0, 4)
    length, out = np.full(4, 0.1), np.zeros((2, 30, 4))
    return seen, nodes, length, length, 0.3, 2.0, influence._hat_series(length, length, 0.3), out[0], out[1]


@pytest.mark.gate
@keeps
def test_loaded_code_gives_the_same_bits_and_holds_nothing() -> None:
    arguments = arguments_of_columns(np.random.default_rng(1))
    entry, code = machine.compile_kernel(influence._columns, arguments)
    assert isinstance(code, machine.Code)
    loaded = machine.load(code, "_columns", "fastpin.kernels.influence")
    entry(*arguments)
    direct, cross = arguments[-2:]
    expected = direct.copy(), cross.copy()
    assert np.isfinite(expected).all()
    assert np.ptp(expected) > 0.0
    before = [sys.getrefcount(one) for one in arguments]
    for _ in range(100):
        direct[:], cross[:] = np.nan, np.nan
        loaded(*arguments)
    assert (np.stack([direct, cross]) == np.stack(expected)).all()
    assert [sys.getrefcount(one) for one in arguments] == before


def test_kernels_that_count_no_references_hold_no_array() -> None:
    assert not conditions.beyond_bounds.makes_arrays
    assert influence._columns.makes_arrays
    values = [ContactValues(*np.zeros((4, 3)), np.zeros(3, dtype=np.int8), np.zeros(3)) for _ in range(2)]
    arrays = [array for each in values for array in each]
    before = [sys.getrefcount(array) for array in arrays]
    for _ in range(100):
        assert conditions.beyond_bounds(*values) == (0.0, 0.0)
    assert [sys.getrefcount(array) for array in arrays] == before


@pytest.mark.parametrize("file", sorted(path.stem for path in (PACKAGE / "kernels").glob("[a-z]*.py")))
def test_code_depends_on_the_files_that_are_stored_with_it(file: str) -> None:
    """Stored code is compared with the texts of the files that it takes names from."""
    module = importlib.import_module(f"fastpin.kernels.{file}")
    imports = [node for node in ast.parse(inspect.getsource(module)).body if isinstance(node, ast.ImportFrom)]
    others = [node for node in imports if str(node.module).startswith("fastpin")]
    home = {
        alias.asname or alias.name: importlib.import_module(str(node.module)) for node in others for alias in node.names
    }
    for kernel in vars(module).values():
        if isinstance(kernel, jit.Kernel):
            taken = home.keys() & set(kernel.py_func.__code__.co_names)
            assert {home[name].__file__ for name in taken} <= dict(kernel.texts).keys(), kernel
            assert kernel.texts[0][0] == kernel.py_func.__code__.co_filename


def test_code_is_chosen_by_the_types_of_the_arguments() -> None:
    Pair = namedtuple("Pair", "one two")
    line, table = np.zeros(4), np.zeros((3, 4))
    frozen = np.zeros(4)
    frozen.setflags(write=False)
    values = [
        1, np.int64(2), 1.0, np.float64(2.0), True, np.True_, 1j, line, line[:2], line[::2], frozen, table, table.T,
        table[:, :2], table[:, :1], table[:1], np.zeros((3, 1), order="F"), line.astype(int), line.astype(np.int8),
        Pair(line, 1), Pair(line[::2], 1), (line, 1),
    ]  # fmt: skip
    kinds = [machine.numba.typeof(value) for value in values]
    words = [jit.signature(jit.argument_types((value,))) for value in values]
    for one, kind in zip(words, kinds, strict=True):
        for other, other_kind in zip(words, kinds, strict=True):
            assert (one == other) == (kind == other_kind), (kind, other_kind)


@pytest.mark.gate
def test_other_types_are_left_to_the_compiler() -> None:
    with pytest.raises(KeyError):
        jit.argument_types((np.float32(1.0),))
    assert influence.clausen(np.float32(1.0)) == pytest.approx(1.0139591323607684, abs=1e-7)


@pytest.mark.gate
def test_compiling_is_announced_once(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(jit, "CACHED", False)
    jit._announce.cache_clear()
    kernel = jit.compiled(lambda x: x + x)
    with caplog.at_level("INFO", "fastpin.compiler"):
        assert (kernel(1), kernel(1.5), kernel(2)) == (2, 3.0, 4)
    assert [record.message for record in caplog.records] == ["compiling the solver; this takes some seconds"]


def test_only_kernels_call_inner_kernels() -> None:
    with pytest.raises(TypeError, match="_column is called by kernels only"):
        exchange._column(np.zeros(1))


AFTER = """
import sys
import numpy as np
from fastpin.kernels import influence
from fastpin.runtime import extensions, jit
blas = extensions.library("scipy.linalg._fblas")
clausen = influence.clausen
value = clausen(1.0)
assert "scipy.linalg" not in sys.modules
import numba, scipy.linalg
assert scipy.linalg.blas.dgemm is blas.dgemm
from numba import _dynfunc
assert _dynfunc is extensions.library("numba._dynfunc")
assert numba.njit(lambda x: clausen(x) + np.ones(3).sum())(1.0) == value + 3.0
jit.limit_to_one_thread()
assert numba.config.NUMBA_NUM_THREADS == 1
"""


@pytest.mark.gate
def test_packages_that_are_imported_later_work() -> None:
    influence.clausen(1.0)  # its machine code is stored now
    assert finished(python(AFTER)).stderr == ""


@pytest.mark.gate
def test_modules_come_when_they_are_asked_for():
    code = "import fastpin; print(fastpin.model.LOADS[0], hasattr(fastpin, 'nothing'))"
    done = finished(python(code))
    assert done.stdout.split() == ["P", "False"]
