"""The build backend: hatchling, with machine code in wheels that pip builds from the source.

pip builds such a wheel where it is used. So the kernels of a run are compiled during the installation, for the level of
this processor. Other programs build wheels for others: theirs are plain. A wheel of pip is plain, too, where
the dependencies are missing or do not run. A plain wheel compiles in its first run.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import hatchling.build
from hatchling.build import *  # noqa: F403  source archives and editable wheels

COMMANDS = ("run",)
"""Commands whose kernels are compiled. Others compile some more, for seconds."""

LONGEST = 900
"""Seconds that a compilation may take. It takes half a minute of a processor."""


def get_requires_for_build_wheel(config_settings: dict[str, Any] | None = None) -> list[str]:
    """What a wheel needs beside hatchling: for pip the dependencies of the package, which it installs anyway."""
    needed = hatchling.build.get_requires_for_build_wheel(config_settings)
    if _compiles():
        needed += tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]["dependencies"]
    return needed


def build_wheel(
    wheel_directory: str, config_settings: dict[str, Any] | None = None, metadata_directory: str | None = None
) -> str:
    """Build a wheel from the current folder. Return the name of its file."""
    with tempfile.TemporaryDirectory() as folder:
        if _compiles() and _compile(Path(folder)):
            os.environ |= {"FASTPIN_MACHINE_CODE": folder, "HATCH_BUILD_HOOK_ENABLE_CUSTOM": "true"}
        return hatchling.build.build_wheel(wheel_directory, config_settings, metadata_directory)


def _compiles() -> bool:
    """Whether pip builds, on a system that loads machine code without a compiler. pip sets the variable."""
    asked = "PIP_BUILD_TRACKER" in os.environ and "HATCH_BUILD_NO_HOOKS" not in os.environ
    return asked and (sys.platform, platform.machine()) == ("linux", "x86_64")


def _compile(folder: Path) -> bool:
    """Fill a folder with machine code for the best level of this processor. Say why if there is none."""
    try:
        from fastpin.runtime.stored import levels
        from scripts.platform_wheel import compile_kernels

        compile_kernels(folder, levels()[0], commands=COMMANDS, longest=LONGEST)
    except (ImportError, IndexError, OSError, subprocess.SubprocessError) as error:
        print(f"fastpin: the first run will compile the solver, since the installation could not: {error}", flush=True)
        return False
    return True
