"""Times that are expected of histories."""

import time

import numpy as np
import pytest

import fastpin
from fastpin.casefile.reader import builtin_case
from fastpin.model.options import SolveOptions
from fastpin.solver.duration import SETTLED, expected_seconds

CASE = builtin_case()
PUSH = fastpin.LoadHistory([{"P": 2.42e6}])
CYCLE = fastpin.LoadHistory([{"Q": 7e5}, {"Q": -7e5}])


def seconds(history: fastpin.LoadHistory, **options: object) -> float:
    return expected_seconds(CASE.problem, history, SolveOptions(**options))


@pytest.mark.gate
def test_the_time_is_expected_within_a_factor_of_ten() -> None:
    """Measured on a busy machine: factors of 0.4 to 1.7. Other machines may be slower."""
    history = PUSH + CYCLE.repeated(30)
    fastpin.solve(CASE.problem, history, nodes=51)
    began = time.process_time()
    fastpin.solve(CASE.problem, history, nodes=401)
    measured = time.process_time() - began
    assert 0.1 < seconds(history, nodes=401) / measured < 10.0


def test_reversals_cost_a_step_and_straight_steps_little() -> None:
    reversals = fastpin.LoadHistory([{"Q": (-1) ** k * 1e5} for k in range(200)])
    straight = fastpin.LoadHistory([{"Q": 1e3 * k} for k in range(1, 201)])
    assert seconds(reversals) > 10.0 * seconds(straight)
    coarse, fine = (
        fastpin.LoadHistory.harmonic({"P": 2e6}, {"Q": 5e5, "sxx": 2e7}, {"sxx": 90}, 10, points) for points in (24, 48)
    )
    assert seconds(coarse) < seconds(fine) < 1.6 * seconds(coarse)


def test_cycles_that_repeat_cost_nothing() -> None:
    few, many = (PUSH + CYCLE.repeated(count) for count in (SETTLED, 1000 * SETTLED))
    assert seconds(few) == seconds(many)
    assert seconds(many, shortcut=False) == pytest.approx(1000 * seconds(few), rel=0.2)
    assert seconds(PUSH + CYCLE) < seconds(few)


def test_nodes_increments_and_error_bars_cost_time() -> None:
    history = PUSH + CYCLE
    assert 4.0 < seconds(history, nodes=1601) / seconds(history, nodes=801) < 6.5
    assert seconds(history, method="increment", increments=80) > 20.0 * seconds(history)
    assert seconds(history, error_bars=True) == 1.25 * seconds(history)
    assert seconds(history, between=1000) > 2.0


def test_a_history_without_motion_has_a_time() -> None:
    assert np.isfinite(seconds(fastpin.LoadHistory([{"P": 0.0}, {"P": 0.0}])))
