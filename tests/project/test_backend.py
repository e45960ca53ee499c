"""The build backend: pip builds wheels with machine code where it can, and all others build the plain wheel."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from zipfile import ZipFile

import pytest

from fastpin.runtime import machine, stored
from scripts import backend, platform_wheel
from tests.support import small_kernels

pytestmark = pytest.mark.skipif(not machine.CAN_LOAD, reason="no wheel has machine code")


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A source folder with a few files of the package. It is the working directory, and pip builds."""
    small_kernels.install(tmp_path, "")
    for name in ("pyproject.toml", "README.md", "LICENSE", "fastpin/version.py"):
        shutil.copy(small_kernels.ROOT / name, tmp_path / name)
    shutil.copytree(small_kernels.ROOT / "scripts", tmp_path / "scripts")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PIP_BUILD_TRACKER", "")
    for name in (platform_wheel.FOLDER, "HATCH_BUILD_HOOK_ENABLE_CUSTOM"):
        monkeypatch.setenv(name, "")  # the backend sets them; they are restored at the end
        monkeypatch.delenv(name)
    return tmp_path


def test_the_compilation_needs_the_dependencies(source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "numba>=0.60" in backend.get_requires_for_build_wheel()
    monkeypatch.delenv("PIP_BUILD_TRACKER")
    assert backend.get_requires_for_build_wheel() == []


def put(folder: Path, level: str, commands: tuple[str, ...], longest: float) -> None:
    assert level in stored.levels()
    (folder / "kernel.machine").write_bytes(b"code")


def fail(*_: object, **__: object) -> None:
    raise subprocess.CalledProcessError(1, "fastpin run")


@pytest.mark.gate
@pytest.mark.parametrize("who", ["pip", "pip without a compiler", "another program"])
def test_a_wheel_has_machine_code_if_pip_builds_it(who: str, source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(platform_wheel, "compile_kernels", put if who != "pip without a compiler" else fail)
    if who == "another program":
        monkeypatch.delenv("PIP_BUILD_TRACKER")
    name = backend.build_wheel(str(source))
    with ZipFile(source / name) as wheel:
        assert ("fastpin/runtime/shipped/kernel.machine" in wheel.namelist()) == (who == "pip")
    assert name.endswith("-py3-none-any.whl") == (who != "pip")
