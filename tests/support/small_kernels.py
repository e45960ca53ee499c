"""Small kernels in a file and a store of their own. One is called both from Python and by another one."""

import math
import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

TEXT = """
import math
from fastpin.runtime.jit import compiled, inner

@inner
def product(x, y):
    return x * y

@compiled
def wave(x):
    return math.sin(x) + 1.0

@compiled
def doubled(x):
    return product(2.0, wave(x))
"""

VALUES = [2.0 * (math.sin(0.5) + 1.0), math.sin(0.5) + 1.0]
"""What :data:`CALLS` prints, without its last word."""

CALLS = """
import os, sys
from fastpin.runtime import machine
machine.CAN_LOAD = machine.CAN_LOAD and "elsewhere" not in sys.argv
import small
print(small.doubled(0.5), small.wave(0.5), "numba" in sys.modules)
"""
"""A process that calls them: inner forms first. The argument "elsewhere" makes a system where Numba loads the code."""


def site(folder: Path) -> Path:
    """Write the kernels into a folder, and return it."""
    (folder / "small.py").write_text(TEXT)
    return folder


def install(folder: Path, kernels: str) -> Path:
    """Copy the files of the package that compile into a folder, with these kernels in `kernels/small.py`."""
    for part in ("", "kernels", "runtime"):
        copies = folder / "fastpin" / part
        copies.mkdir(parents=True, exist_ok=True)
        for file in (ROOT / "fastpin" / part).glob("*.py*"):
            shutil.copy(file, copies)
    (folder / "fastpin" / "kernels" / "small.py").write_text(kernels)
    return folder


def start(folder: Path, *arguments: str, code: str = CALLS, store: str = "store", **more: str) -> subprocess.Popen[str]:
    """Start a process that finds the kernels of a folder, and keeps their code there."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("NUMBA_", "FASTPIN_"))}
    paths = {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT}", "NUMBA_CACHE_DIR": str(folder / store)}
    words = [sys.executable, "-X", "faulthandler", "-P", "-c", code, *arguments]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(words, cwd=folder, env=kept | paths | more, **pipes)


def read(process: subprocess.Popen[str], quiet: bool = True) -> list[str]:
    """What such a process says, when it has ended well. A `quiet` one has no messages."""
    out, errors = process.communicate()
    assert process.returncode == 0, errors
    assert not quiet or errors == "", errors
    return out.split()


def names(folder: Path, store: str = "store") -> list[str]:
    """The kernels of the files of a store, with their forms."""
    found: Sequence[Path] = list((folder / store).iterdir())
    return sorted(path.name.split("-")[0] + path.suffix for path in found)
