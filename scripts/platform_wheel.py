"""The platform wheel: the package with machine code of its kernels, for the first run without a compilation.

``python -m scripts.platform_wheel [--outdir DIST] [--python PYTHON ...]`` builds it beside the plain wheel. Code is
compiled for each level of processors (``LEVELS`` of fastpin/runtime/stored.py) by this Python, or by the given ones,
each with its own version of Numba. An installation with another Python, Numba or processor compiles, as the plain wheel
does. Linux on x86-64 is needed, with a processor of the best level.

The class below is the hook of hatchling that adds the files and the tag. ``pyproject.toml`` names it.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

from fastpin.runtime.stored import LEVELS

ROOT = Path(__file__).resolve().parents[1]

FOLDER = "FASTPIN_MACHINE_CODE"
"""The variable that names the folder of machine code to the hook."""

TAG = "FASTPIN_WHEEL_TAG"
"""The variable that tells the hook the tag. Without it the wheel is for this system and this Python."""

ANY_LINUX = "py3-none-manylinux_2_17_x86_64"
"""Any Python, since each file names its own. No file is linked to the system, so an old tag will do."""

AS_SHIPPED = """
import sys
from fastpin.runtime import beside, stored
level, *commands = sys.argv[1:]
stored.own_environment = lambda: stored.environment_of(level)
beside.start = lambda: None
"""
"""The first lines of a process whose code is stored for all processors of a level."""

RUN_COMMANDS = """
from fastpin.cli.main import main
for command in commands:
    if main(command.split()) != 0:
        sys.exit(f"fastpin {command} failed")
"""

COMMANDS = ("run --error-bars --plot figure.png -o case.h5", "report case.h5 -o case.html", "verify")
"""Commands that call the kernels."""


def compile_kernels(
    folder: Path,
    level: str,
    python: str = sys.executable,
    root: Path = ROOT,
    calls: str = RUN_COMMANDS,
    commands: tuple[str, ...] = COMMANDS,
    longest: float | None = None,
) -> None:
    """Compile the kernels that a process calls, for a level of processors, and put their machine code into a folder.

    :class:`subprocess.SubprocessError` if the process fails, or takes longer than `longest` seconds.
    """
    with tempfile.TemporaryDirectory() as work:
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("NUMBA_", "FASTPIN_"))}
        chosen = {"NUMBA_CPU_NAME": level, "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(Path(work, "cache"))}
        words = [python, "-P", "-c", AS_SHIPPED + calls, level, *commands]
        paths = [str(root), *filter(None, [os.environ.get("PYTHONPATH")])]  # pip has its dependencies there
        environment = kept | chosen | {"PYTHONPATH": os.pathsep.join(paths)}
        subprocess.run(words, cwd=work, env=environment, stdout=subprocess.DEVNULL, check=True, timeout=longest)
        folder.mkdir(parents=True, exist_ok=True)
        for file in Path(work, "cache").glob("*.machine"):
            shutil.copy(file, folder)


class PlatformWheel(BuildHookInterface):
    """Adds machine code to the wheel, and says for which systems it is."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        build_data["force_include"][os.environ[FOLDER]] = "fastpin/runtime/shipped"
        build_data["pure_python"], build_data["infer_tag"] = False, True
        if TAG in os.environ:
            build_data["tag"] = os.environ[TAG]


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--outdir", default="dist", help="folder of the wheel (default dist)")
    parser.add_argument("--python", nargs="+", default=[sys.executable], help="interpreters with the dependencies")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for python in options.python:
            for level in LEVELS:
                compile_kernels(Path(folder), level, python)
        words = ["-m", "build", "--wheel", "--no-isolation", "--outdir", options.outdir, str(ROOT)]
        variables = os.environ | {FOLDER: folder, TAG: ANY_LINUX, "HATCH_BUILD_HOOK_ENABLE_CUSTOM": "true"}
        subprocess.run([sys.executable, *words], env=variables, check=True)


if __name__ == "__main__":
    main()
