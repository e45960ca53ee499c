"""Common parts of all benchmarks: sizes, compilation before the clock runs, and the facts stored with the times."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Any

import cases
import numba
import numpy
import pytest
import scipy
from threadpoolctl import threadpool_info

import fastpin

MACHINE_KEYS = ("machine", "python_implementation", "python_version", "system")
"""Facts about the machine that are stored. Its name is private and not stored."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run benchmarks with an argument `nodes` at all sizes."""
    if "nodes" in metafunc.fixturenames:
        metafunc.parametrize("nodes", cases.sizes(timed=not metafunc.config.getoption("benchmark_disable")))


def pytest_benchmark_update_machine_info(config: pytest.Config, machine_info: dict[str, Any]) -> None:
    """Replace the description of the machine by processor, cores, threads, BLAS and versions."""
    kept = {key: machine_info[key] for key in MACHINE_KEYS}
    processor = machine_info["cpu"].get("brand_raw", machine_info["machine"])
    libraries = sorted({describe_library(library) for library in threadpool_info() if library["user_api"] == "blas"})
    versions = {package.__name__: package.__version__ for package in (fastpin, numpy, scipy, numba)}
    machine_info.clear()
    machine_info.update(
        kept,
        cpu=processor,
        cores=len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        threads={name: os.environ.get(name, "") for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")},
        blas=libraries,
        versions=versions,
    )


def describe_library(library: dict[str, Any]) -> str:
    """Return name, version and kernels of a BLAS library, without its path."""
    parts = (library["internal_api"], library.get("version"), library.get("architecture"))
    return " ".join(str(part) for part in parts if part)


def pytest_benchmark_update_json(config: pytest.Config, benchmarks: Any, output_json: dict[str, Any]) -> None:
    """Drop the times of single rounds, which make the file large, and the names of directory and branch."""
    output_json["commit_info"] = {key: output_json["commit_info"].get(key) for key in ("id", "dirty")}
    for entry in output_json["benchmarks"]:
        entry["stats"].pop("data", None)


@pytest.fixture(scope="session", autouse=True)
def _compiled() -> None:
    """Run everything once at a small size, so that no compilation is timed."""
    first = fastpin.solve(cases.PROBLEM, cases.STEADY, nodes=61, arc=cases.ARC)
    cycle = fastpin.solve(cases.PROBLEM, cases.CYCLE, start=first)
    cases.singular_residuals(cycle[-1])
    fastpin.solve(cases.PROBLEM, cases.FIRST_LOAD, grid=cases.graded_grid(61))


Timed = Callable[..., Any]
"""The type of the fixture :func:`timed`."""


@pytest.fixture
def timed(benchmark: Any) -> Timed:
    """Time a function in rounds: ``timed(function, nodes, setup=None, watch=False, least=2, **info)``.

    There are at least `least` rounds. `setup` is called before every round, outside the timing, and returns the
    argument of the function. `info` is stored with the times. With `watch` the number of processors in use is stored,
    too: a limit on threads does not tell how many threads there are, and whether other processes left them free. The
    result is the result of the function.
    """

    def run(
        function: Callable[..., Any],
        nodes: int,
        setup: Callable[[], Any] | None = None,
        watch: bool = False,
        least: int = 2,
        **info: Any,
    ) -> Any:
        prepared = None if setup is None else lambda: ((setup(),), {})
        spent: list[tuple[float, float]] = []
        target = watched(function, spent) if watch else function
        rounds = max(least, min(20, 2400 // nodes))
        value = benchmark.pedantic(target, setup=prepared, rounds=rounds, warmup_rounds=int(nodes < 800))
        if watch:
            wall, processor = min(spent)
            info["processors"] = processor / wall
        benchmark.extra_info.update(nodes=nodes, **info)
        return value

    return run


def watched(function: Callable[..., Any], spent: list[tuple[float, float]]) -> Callable[..., Any]:
    """Return the function with a watch. Every call adds its wall time and the processor time of all threads to `spent`.

    Both are in seconds.
    """

    def run(*arguments: Any) -> Any:
        began = time.perf_counter(), time.process_time()
        value = function(*arguments)
        spent.append((time.perf_counter() - began[0], time.process_time() - began[1]))
        return value

    return run
