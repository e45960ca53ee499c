"""The lowest and the highest slip of each node while closed, exact along every piece of a history.

The sums of slip are compared with many states here too: both comparisons share the states.
"""

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from fastpin import Grid, State, solve
from fastpin.elasticity import build
from fastpin.kernels.status import OPEN
from tests.support.programs import EXTREMES, RANDOM, SLIP, P, q
from tests.support.slip_cases import CASES, LIKE, UNLIKE, assert_contains, solved, unitless

PATHS = ["unlike bodies", "remote stress", "driven", "normal unloading", "neat fit", "interference"]


def stopped(name: str, between: int | list[float]) -> list[State]:
    """The states of a case with other stops inside its steps, on the same grid."""
    plain = solved(name)
    return list(solve(plain.problem, plain.history, slip_sums=True, between=between, grid=plain.grid))


def extremes(states: Sequence[State]) -> np.ndarray:
    """Lowest and highest slip over some states, from their own extremes, shape (2, n)."""
    lowest, highest = (np.array([getattr(state, name) for state in states]) for name in EXTREMES)
    return np.array([np.fmin.reduce(lowest), np.fmax.reduce(highest)])


def read(states: Sequence[State]) -> np.ndarray:
    """Lowest and highest slip of the states in which a node is closed, shape (2, n)."""
    slip = np.array([np.where(state.status == OPEN, np.nan, state.slip) for state in states])
    return np.array([np.fmin.reduce(slip), np.fmax.reduce(slip)])


def size_of(states: Sequence[State]) -> float:
    return max(float(np.abs(state.slip).max()) for state in states)


@pytest.fixture(scope="module")
def finer(request: pytest.FixtureRequest) -> list[list[State]]:
    """The states of a case with more and more stops inside its steps."""
    return [stopped(request.param, between) for between in (7, 63, 255)]


@pytest.mark.gate
@pytest.mark.parametrize("finer", PATHS, indirect=True)
def test_readings_from_states_converge_to_the_exact_extremes(finer: list[list[State]]) -> None:
    missed = []
    for states in finer:
        exact, found = extremes(states), read(states)
        missed.append(float(np.nanmax(np.abs(found - exact))) / size_of(states))
    assert missed[1] < 0.3 * missed[0]
    assert missed[2] < 0.3 * missed[1]
    assert missed[2] < 4e-3
    assert np.array_equal(np.isnan(found), np.isnan(exact))


def naive(states: Sequence[State]) -> np.ndarray:
    """Slip distance and friction energy summed from state to state, shape (2, n)."""
    sums = np.zeros((2, states[0].grid.size))
    for before, after in itertools.pairwise(states):
        both = (before.status != OPEN) & (after.status != OPEN)
        slid = np.where(both, after.slip - before.slip, 0.0)
        sums += [np.abs(slid), -0.5 * slid * (before.shear + after.shear)]
    return sums


@pytest.mark.gate
@pytest.mark.parametrize("finer", ["unlike bodies", "remote stress", "much friction", "driven"], indirect=True)
def test_sums_from_state_to_state_converge_to_the_exact_sums(finer: list[list[State]]) -> None:
    errors = []
    for states in finer:
        exact = np.array([np.sum([getattr(state, field) for state in states[1:]], axis=0) for field in SLIP])
        errors.append(np.abs(naive(states) - exact).max(axis=1) / exact.max(axis=1))
    assert np.all(errors[1] < 0.4 * errors[0])
    assert np.all(errors[2] < 0.4 * errors[1])
    assert np.all(errors[2] < 2.8e-2)  # measured: 2.1e-2; 9.2e-3 with 511 and 6e-4 with 8,191 states a step


@pytest.mark.gate
@pytest.mark.parametrize("name", ["snap", "snap under a moment"])
def test_readings_across_snaps_approach_the_extremes(name: str) -> None:
    """What happens at one instant of the load is in the extremes; the states see a part of it only."""
    missed = []
    for between in (3, 255):
        states = stopped(name, between)
        assert_contains(states)
        missed.append(float(np.nanmax(np.abs(read(states) - extremes(states)))) / size_of(states))
    assert missed[1] < 0.3 * missed[0]


@pytest.mark.gate
@pytest.mark.parametrize("name", list(CASES))
def test_extremes_do_not_depend_on_the_states_between(name: str) -> None:
    first = solved(name)
    expected, rounding = extremes(first), (1e-10 if "snap" in name else 1e-13) * size_of(first)
    for between in (19, [0.1, 0.35, 0.7]):
        found = extremes(stopped(name, between))
        assert np.array_equal(np.isnan(found), np.isnan(expected))
        assert np.nanmax(np.abs(found - expected)) <= rounding


@pytest.mark.gate
@pytest.mark.parametrize("name", ["unlike bodies", "remote stress", "driven", "interference"])
def test_increments_converge_to_the_extremes_of_the_path(name: str) -> None:
    path = solved(name)
    exact, errors = extremes(path), []
    for increments in (10, 80):
        options = {"method": "increment", "increments": increments, "grid": path.grid}
        found = extremes(solve(path.problem, path.history, slip_sums=True, **options))
        errors.append(float(np.nanmax(np.abs(found - exact))) / size_of(path))
    assert errors[1] < 0.3 * errors[0]
    assert errors[1] < 0.02


@pytest.mark.parametrize("keep", ["every 2", "every 7", "every 100"])
def test_sums_and_extremes_count_corners_that_are_not_kept(keep: str) -> None:
    problem, history = unitless(LIKE, 0.5, 0.55, "centre", "fixed"), P + q(*RANDOM)
    every = solve(problem, history, nodes=61, slip_sums=True)
    before = -1
    for state in solve(problem, history, nodes=61, keep=keep, slip_sums=True):
        between = every[before + 1 : state.step + 1]
        assert np.array_equal(extremes([state]), extremes(between), equal_nan=True)
        for name in SLIP:
            total = np.sum([getattr(one, name) for one in between], axis=0)
            assert np.abs(total - getattr(state, name)).max() <= 1e-13 * total.max()
        before = state.step


def test_states_between_count_from_the_corner() -> None:
    states = list(solved("unlike bodies", 3))
    for begin in range(0, len(states), 4):
        for earlier, later in zip(states[begin : begin + 3], states[begin + 1 : begin + 4], strict=True):
            assert not np.any(later.slip_lowest > earlier.slip_lowest)
            assert not np.any(later.slip_highest < earlier.slip_highest)
    assert np.nanmax(states[4].slip_lowest - states[3].slip_lowest) > 0.0  # a new corner: they begin anew


def test_a_new_resting_place_keeps_what_the_states_have_shown() -> None:
    """After a complete unloading slip counts from a new place. The extremes hold each slip as its state had it."""
    problem = unitless(LIKE, 0.5, 0.5)
    history = [{"P": 1.0, "Q": 0.3}, {"P": 0.0, "Q": 0.0}, {"P": -1.0}]
    grid = Grid.circle(160, 0.3)
    every = list(solve(problem, history, grid=grid, slip_sums=True))
    last = solve(problem, history, grid=grid, slip_sums=True, keep="every 9")
    assert len(last) == 1
    assert np.array_equal(extremes(list(last)), extremes(every), equal_nan=True)
    assert_contains(list(solve(problem, history, grid=grid, slip_sums=True, between=20)))
    below, above = every[0].status != OPEN, every[2].status != OPEN
    assert below.any()
    assert above.any()
    assert np.all(every[0].slip[below] >= last[0].slip_lowest[below])
    assert np.all(every[2].slip[above] <= last[0].slip_highest[above])
    assert np.all(np.isfinite(last[0].slip_lowest[below | above]))


def test_nodes_that_stick_have_one_slip() -> None:
    states = solved("much friction")
    moved = (states[1].status == 0) & (states[2].status == 0) & (states[2].slip_distance == 0.0)
    still = moved & np.isfinite(states[2].slip_lowest) & (states[2].slip_lowest == states[2].slip_highest)
    assert moved.any()
    assert np.array_equal(still, moved)


def test_windows_give_the_sums_and_extremes_of_the_whole_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = unitless(UNLIKE, 20.0, 0.4, "centre", "fixed")
    sheared = [{"P": 1.0}, {"P": 0.8, "Q": 0.7}, {"P": 0.8, "Q": -0.7}]
    history = [*sheared, {"P": 0.02, "Q": 0.01}, {"P": 0.0, "Q": 0.0}, {"P": 1.0}]
    grid = Grid.graded([(-0.5 * np.pi, 0.3), (-1.0, 0.3), (-2.1, 0.3)], 260, -0.5 * np.pi)
    whole = solve(problem, history, grid=grid, slip_sums=True)
    monkeypatch.setattr(build, "MOST_DENSE", 100)
    on_windows = list(solve(problem, history, grid=grid, slip_sums=True, between=2))
    assert_contains(on_windows)
    for place, expected in enumerate(whole):
        states = on_windows[3 * place : 3 * place + 3]
        for name in SLIP:
            total = np.sum([getattr(state, name) for state in states], axis=0)
            assert np.abs(total - getattr(expected, name)).max() <= 1e-7 * getattr(expected, name).max()
        found, wanted = extremes(states), extremes([expected])
        assert np.array_equal(np.isnan(found), np.isnan(wanted))
        assert np.nanmax(np.abs(found - wanted), initial=0.0) <= 1e-7 * size_of(list(whole))


def test_increments_count_from_the_first_contact() -> None:
    """Without friction the first nodes slip one way from their first contact on, whatever the size of increments."""
    problem, grid = unitless(UNLIKE, 0.1, 0.0, "centre", "fixed"), Grid.arc(-np.pi, 0.0, 101)
    options: dict[str, Any] = {"grid": grid, "slip_sums": True}
    exact = solve(problem, [{"P": 1.0}], **options)[0]
    found = solve(problem, [{"P": 1.0}], method="increment", increments=2, **options)[0]
    beside = 51
    expected = exact.slip_highest[beside] - exact.slip_lowest[beside]
    assert found.slip_highest[beside] - found.slip_lowest[beside] == pytest.approx(expected, rel=5e-3)
    assert expected > 1e-6 * np.abs(exact.slip).max()
