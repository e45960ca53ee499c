"""Where compiled code is kept: beside the package, else in the user's cache directory, else nowhere."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "fastpin"
CODE = """
from fastpin.kernels.influence import clausen
assert abs(clausen(1.0) - 1.0139591323607684) < 1e-14
print(clausen.stats.cache_path, sum(clausen.stats.cache_hits.values()))
"""


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """A directory with a copy of the package."""
    shutil.copytree(PACKAGE, tmp_path / "site" / "fastpin", ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path / "site"


def read_only(installed: Path) -> Path:
    """Nobody, not even root, can make a directory where a file is."""
    (installed / "fastpin" / "kernels" / "__pycache__").touch()
    return installed


def kept(installed: Path, home: Path, **more: str) -> tuple[str, int]:
    """Where a process keeps what it compiles, and how much it found there."""
    switches = {"NUMBA_CACHE_DIR", "NUMBA_DISABLE_JIT", "FASTPIN_CACHE", "XDG_CACHE_HOME"}
    environment = {name: value for name, value in os.environ.items() if name not in switches}
    environment |= {"PYTHONPATH": str(installed), "HOME": str(home), **more}
    words = [sys.executable, "-c", CODE]
    done = subprocess.run(words, capture_output=True, text=True, check=True, env=environment, cwd=installed)
    assert done.stderr == ""
    place, hits = done.stdout.split()
    return place, int(hits)


def test_beside_the_package(installed: Path, tmp_path: Path) -> None:
    place = str(installed / "fastpin" / "kernels" / "__pycache__")
    assert kept(installed, tmp_path) == (place, 0)
    assert kept(installed, tmp_path) == (place, 1)
    assert kept(installed, tmp_path, FASTPIN_CACHE="0") == ("None", 0)


@pytest.mark.skipif(sys.platform != "linux", reason="the user's cache directory is elsewhere")
def test_in_the_cache_of_the_user_where_the_package_can_not_be_written(installed: Path, tmp_path: Path) -> None:
    read_only(installed)
    for found in (0, 1):
        place, hits = kept(installed, tmp_path)
        assert Path(place).parent == tmp_path / ".cache" / "numba"
        assert hits == found


def test_nowhere_when_nothing_can_be_written(installed: Path) -> None:
    nowhere = Path(os.devnull) / "home"
    assert kept(read_only(installed), nowhere) == ("None", 0)
    assert kept(installed, nowhere, NUMBA_CACHE_DIR=str(nowhere)) == ("None", 0)


def test_modules_come_when_they_are_asked_for():
    code = "import fastpin; print(fastpin.model.LOADS[0], hasattr(fastpin, 'nothing'))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["P", "False"]
