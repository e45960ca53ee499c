"""Times of the solver, from small to large: filling the matrices, the first load, cycles, histories, fields.

    pytest bench --benchmark-json=bench/results/NAME.json   times, stored for bench/report.py
    pytest bench --benchmark-disable                        runs everything once, to check that the benchmarks work

A time of the solver is the time of a call of ``fastpin.solve``. It includes the matrices of the grid and the checks of
the returned states.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import cases
import numpy as np
import pytest
from threadpoolctl import threadpool_limits

import fastpin
from fastpin import damage
from fastpin.elasticity.system import System

Timed = Callable[..., Any]


def solved(timed: Timed, benchmark: Any, nodes: int, history: fastpin.LoadHistory, /, **options: Any) -> fastpin.Result:
    """Time a call of ``solve``, store its statistics with the time, and return its result."""
    result = timed(lambda: fastpin.solve(cases.PROBLEM, history, **options), nodes, watch=True)
    assert result.complete
    assert result.statistics["repeated"] == 0  # solved, not remembered
    benchmark.extra_info.update({key: value for key, value in result.statistics.items() if key != "seconds"})
    return result


@pytest.mark.parametrize("grid", cases.GRIDS)
@pytest.mark.benchmark(group="fill")
def test_fill(timed: Timed, grid: str, nodes: int) -> None:
    spaced = cases.GRIDS[grid](nodes)
    with threadpool_limits(limits=1, user_api="blas"):
        system = timed(lambda: System.build(cases.PROBLEM, spaced, cases.FORCE), nodes, least=5, threads=1)
    assert system.grid.size == nodes


@pytest.mark.benchmark(group="first load")
def test_first_load(timed: Timed, benchmark: Any, nodes: int) -> None:
    solved(timed, benchmark, nodes, cases.FIRST_LOAD, nodes=nodes, arc=cases.ARC)


@pytest.mark.benchmark(group="cycle")
def test_cycle(timed: Timed, benchmark: Any, nodes: int) -> None:
    solved(timed, benchmark, nodes, cases.CYCLE, start=cases.steady_state(nodes))


@pytest.mark.benchmark(group="history")
def test_history(timed: Timed, benchmark: Any, nodes: int) -> None:
    history = cases.variable_cycles(cases.HISTORY_CYCLES)
    solved(timed, benchmark, nodes, history, start=cases.steady_state(nodes))
    benchmark.extra_info["cycles"] = cases.HISTORY_CYCLES


@pytest.mark.benchmark(group="increment cycle")
def test_increment_cycle(timed: Timed, benchmark: Any, nodes: int) -> None:
    if nodes > cases.LARGEST_INCREMENT_SIZE:
        pytest.skip("takes minutes")
    options = {"method": "increment", "increments": cases.INCREMENTS}
    solved(timed, benchmark, nodes, cases.CYCLE, start=cases.steady_state(nodes), **options)


@pytest.mark.benchmark(group="residuals")
def test_residuals(timed: Timed, nodes: int) -> None:
    """Time the residuals of the singular integral equations (46), (47) at all nodes."""
    state = cases.steady_state(nodes)[-1]
    first, second = timed(lambda: cases.singular_residuals(state), nodes, least=5)
    assert first.size == second.size == nodes


@pytest.mark.benchmark(group="readings")
def test_readings(timed: Timed, nodes: int) -> None:
    """Time edges, borders, peaks and resultants of a state. A copy of the state has no cached readings."""
    state = cases.steady_state(nodes)[-1]

    def read(fresh: fastpin.State) -> tuple[Any, ...]:
        return fresh.contact, fresh.stick, fresh.slip_zones, fresh.peak_pressure, fresh.peak_shear, fresh.resultants

    assert timed(read, nodes, least=5, setup=lambda: dataclasses.replace(state))[0]


@pytest.mark.benchmark(group="fatigue")
def test_fatigue(timed: Timed, nodes: int) -> None:
    """Time Smith, Watson and Topper's parameter at 2,000 points from some 200 stops of a cycle, with the stresses."""
    stops = fastpin.solve(cases.PROBLEM, cases.CYCLE, start=cases.steady_state(nodes), between=99)
    points = fastpin.Points.at_depth(np.linspace(0.0, 0.1, 20)[:, None], np.linspace(-2.5, -0.6, 100))
    found = timed(lambda: damage.fatigue(stops, "smith-watson-topper", points=points), nodes)
    assert found.parameter.max() > 0.0
