"""Whole processes: start-up times of fastpin, and the memory of each size."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Timed = Callable[..., Any]
COMMANDS = {
    "bare Python": ["-c", "pass"],
    "import numpy": ["-c", "import numpy"],
    "import of the libraries": ["-c", "import numpy, scipy.linalg, numba"],
    "import fastpin": ["-c", "import fastpin"],
    "fastpin --help": ["-m", "fastpin", "--help"],
    "fastpin run": ["-m", "fastpin", "run"],
    "fastpin run --plot": ["-m", "fastpin", "run", "--plot", "figure.png"],
}
ROUNDS = 5


def run(arguments: list[str], directory: Path, **environment: str) -> str:
    """Run a new Python from an empty directory, and return its output."""
    done = subprocess.run(
        [sys.executable, "-P", *arguments],
        cwd=directory, env={**os.environ, **environment}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return done.stdout


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.benchmark(group="start-up")
def test_start_up(benchmark: Any, command: str, tmp_path: Path) -> None:
    """Time the commands with compiled code in the cache. The round that fills the cache is not timed."""
    benchmark.pedantic(run, (COMMANDS[command], tmp_path), rounds=ROUNDS, warmup_rounds=1)


@pytest.mark.benchmark(group="start-up, nothing compiled")
def test_cold_start(benchmark: Any, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Time the built-in case with an empty cache of compiled code."""
    if benchmark.disabled:
        pytest.skip("compiles everything again")

    def compile_and_run(directory: Path) -> str:
        return run(COMMANDS["fastpin run"], directory, NUMBA_CACHE_DIR=str(directory / "cache"))

    assert benchmark.pedantic(compile_and_run, setup=lambda: ((tmp_path_factory.mktemp("cold"),), {}), rounds=2)


@pytest.mark.benchmark(group="memory")
def test_memory(benchmark: Any, nodes: int, tmp_path: Path) -> None:
    """Measure the peak memory in a separate process. The time is of the whole process and means little."""
    script = Path(__file__).with_name("memory.py")
    environment = {"PYTHONPATH": os.pathsep.join(filter(None, [str(script.parent), os.environ.get("PYTHONPATH")]))}
    output = benchmark.pedantic(run, ([str(script), str(nodes)], tmp_path), environment, rounds=1)
    benchmark.extra_info.update(nodes=nodes, **json.loads(output))
