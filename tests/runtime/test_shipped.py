"""Machine code of a platform wheel: used where it fits, with the bits of code that is compiled for this processor."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import pytest

from fastpin.runtime import jit, machine, stored
from scripts import platform_wheel
from tests.support import small_kernels
from tests.support.processes import finished

pytestmark = pytest.mark.skipif(jit.PLAIN or not machine.CAN_LOAD, reason="no code is stored")

SIN = """
import math
from fastpin.runtime.jit import compiled
@compiled
def waves(x, out):
    for i in range(x.size):
        out[i] = x[i] * 0.1 + math.sin(x[i]) * x[i] ** 2 / 7.0 + out[i]
"""
CALLS = """
import hashlib, sys
import numpy as np
from fastpin.kernels.small import waves
x = np.linspace(-9.0, 9.0, 1001)
out = x / 3.0
waves(x, out)
print(hashlib.sha256(out.tobytes()).hexdigest(), "numba" in sys.modules)
"""


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A folder with the files of the package that compile, and one small kernel."""
    return small_kernels.install(tmp_path, SIN)


def run(site: Path, cache: Path, **more: str) -> list[str]:
    """The digest of the kernel's values, and whether Numba was imported, in a process with this cache."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("NUMBA_", "FASTPIN_"))}
    variables = kept | {"PYTHONPATH": str(site), "NUMBA_CACHE_DIR": str(cache), **more}
    return finished([sys.executable, "-P", "-c", CALLS], cwd=site, env=variables).stdout.split()


def runs(level: str) -> bool:
    return stored.LEVELS[level] <= {name.removeprefix("+") for name in machine.target()[-1].split(",")}


@pytest.mark.survey
@pytest.mark.parametrize("level", stored.LEVELS)
def test_shipped_code_needs_no_compiler_and_gives_the_same_bits(site: Path, tmp_path: Path, level: str) -> None:
    if not runs(level):
        pytest.skip("another processor")
    digest, imported = run(site, tmp_path / "own")
    assert imported == "True"
    shipped = site / "fastpin/runtime/shipped"
    platform_wheel.compile_kernels(shipped, level, root=site, calls=CALLS)
    (file,) = shipped.iterdir()
    assert run(site, tmp_path / "empty") == [digest, "False"]
    assert not (tmp_path / "empty").exists()
    # Code of another compiler, or with settings of the user, is not used.
    assert run(site, tmp_path / "other", NUMBA_OPT="2") == [digest, "True"]
    content = bytearray(file.read_bytes())
    content[-1] ^= 1
    file.write_bytes(content)
    assert run(site, tmp_path / "changed") == [digest, "True"]


def test_code_for_other_processors_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stored, "SHIPPED", tmp_path)
    monkeypatch.setattr(stored, "_settings", list)
    levels = stored._shipped_levels.__wrapped__
    for features, known in {"+sse4.2": [], ",".join(f"+{name}" for name in stored.LEVELS["x86-64-v2"]): 1}.items():
        monkeypatch.setattr(machine, "target", lambda features=features: ("x86_64", "some", features))
        assert levels() == (["x86-64-v2"] if known else [])


def test_code_that_needs_an_unknown_symbol_is_not_loaded() -> None:
    """LLVM would end the process."""
    code = machine.Code(b"", "entry", "environment", (), ("sin", "no_such_function"))
    with pytest.raises(ImportError, match="no_such_function"):
        machine.load(code, "name", __name__)


@pytest.mark.parametrize("tag", [None, "py3-none-manylinux_2_17_x86_64"])
def test_the_hook_adds_the_folder_and_the_tag(tag: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(platform_wheel.FOLDER, "/code")
    if tag is not None:
        monkeypatch.setenv(platform_wheel.TAG, tag)
    data: dict[str, Any] = {"force_include": {}}
    hook = object.__new__(platform_wheel.PlatformWheel)
    hook.initialize("standard", data)
    assert data["force_include"] == {"/code": "fastpin/runtime/shipped"}
    assert (data["pure_python"], data["infer_tag"], data.get("tag")) == (False, True, tag)
