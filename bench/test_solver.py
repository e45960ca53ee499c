"""Times of the solver: filling the matrices, the first load, a fretting cycle, from small to large.

    pytest bench                       times
    pytest bench --benchmark-disable   runs everything once, so that the benchmarks keep working

Compilation is not timed: everything runs once at a small size before.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from cases import ARC, CYCLE, FIRST_LOAD, PROBLEM, SIZES

import fastpin
from fastpin.kernels import fill_log

Benchmark = Callable[..., Any]


@pytest.fixture(scope="module", autouse=True)
def _compiled() -> None:
    first = fastpin.solve(PROBLEM, FIRST_LOAD, nodes=41, arc=ARC)
    fastpin.solve(PROBLEM, CYCLE, start=first)
    fill(41, uniform=False)


def fill(nodes: int, uniform: bool) -> np.ndarray:
    grid = fastpin.Grid.arc(*ARC, nodes)
    left, right = grid.knots()
    direct, cross = np.empty((nodes, nodes)), np.empty((nodes, nodes))
    ratio = PROBLEM.pair.alpha_star / PROBLEM.pair.beta_star
    fill_log(grid.theta, left, right, uniform, grid.closed, ratio, direct, cross)
    return direct


@pytest.mark.parametrize("nodes", SIZES)
@pytest.mark.parametrize("uniform", [True, False], ids=["uniform", "graded"])
@pytest.mark.benchmark(group="fill")
def test_fill(benchmark: Benchmark, nodes: int, uniform: bool) -> None:
    assert np.isfinite(benchmark(fill, nodes, uniform)).all()


@pytest.mark.parametrize("nodes", SIZES)
@pytest.mark.parametrize("method", ["path", "increment"])
@pytest.mark.benchmark(group="first load")
def test_first_load(benchmark: Benchmark, nodes: int, method: str) -> None:
    result = benchmark(fastpin.solve, PROBLEM, FIRST_LOAD, nodes=nodes, method=method, increments=20, arc=ARC)
    assert result.complete


@pytest.mark.parametrize("nodes", SIZES)
@pytest.mark.benchmark(group="cycle")
def test_cycle(benchmark: Benchmark, nodes: int) -> None:
    first = fastpin.solve(PROBLEM, FIRST_LOAD, nodes=nodes, arc=ARC)
    result = benchmark(fastpin.solve, PROBLEM, CYCLE, start=first)
    assert result.complete
    benchmark.extra_info.update(result.statistics)  # type: ignore[attr-defined]
