"""Steps that repeat: recognised by the whole state, and the same as if they had been solved again."""

from __future__ import annotations

import numpy as np
import pytest

from fastpin import NoEquilibriumError, Problem, repeats, solve
from fastpin.repeats import Repeats

CYCLE = [{"Q": 0.275}, {"Q": -0.275}]
FIELDS = ("pressure", "shear", "gap", "slip")


@pytest.fixture(scope="module")
def held(similar):
    return Problem.from_load_parameter(similar, 0.5, 0.55, "centre", "fixed")


@pytest.fixture(scope="module")
def free(similar):
    return Problem.from_load_parameter(similar, 0.05, 0.55, "body")


def never(monkeypatch):
    monkeypatch.setattr(Repeats, "find", lambda *_: None)


@pytest.mark.parametrize("kind", ["held", "free"])
def test_constant_amplitude_is_as_if_every_cycle_were_solved(request, monkeypatch, kind):
    problem, history = request.getfixturevalue(kind), [{"P": 1.0}, *CYCLE * 12]
    known = solve(problem, history, nodes=101, between=1)
    never(monkeypatch)
    solved = solve(problem, history, nodes=101, between=1)
    assert solved.statistics["repeated"] == 0
    assert known.statistics["repeated"] >= 6
    assert known.statistics["events"] < solved.statistics["events"]
    assert len(known) == len(solved) == 50
    for one, two in zip(known, solved, strict=True):
        assert (one.step, one.fraction, one.load) == (two.step, two.fraction, two.load)
        for name in FIELDS:
            scale = np.abs(getattr(two, name)).max()
            assert np.abs(getattr(one, name) - getattr(two, name)).max() < 1e-11 * scale
        for name in ("dissipation", "work", "energy"):
            assert getattr(one, name) == pytest.approx(getattr(two, name), rel=1e-11, abs=1e-12)
    cycle = known[-1].dissipation - known[-5].dissipation
    assert cycle > 0.0 or kind == "free"  # which shakes down: nothing slips any more
    assert known[-5].dissipation - known[-9].dissipation == pytest.approx(cycle, rel=1e-9, abs=1e-13)


def test_repeated_states_are_exact_copies(held):
    result = solve(held, [{"P": 1.0}, *CYCLE * 8], nodes=101)
    for name in FIELDS:
        assert np.array_equal(getattr(result[-1], name), getattr(result[-3], name))


def test_a_history_that_is_gone_on_from_repeats_as_the_whole_does(held):
    whole = solve(held, [{"P": 1.0}, *CYCLE * 8], nodes=101)
    first = solve(held, [{"P": 1.0}, *CYCLE * 3], grid=whole.grid)
    for _ in range(2):  # the first part can be gone on from more than once
        second = solve(held, CYCLE * 5, start=first)
        assert first.statistics["repeated"] + second.statistics["repeated"] == whole.statistics["repeated"]
        for name in (*FIELDS, "dissipation", "work"):
            assert np.array_equal(getattr(second[-1], name), getattr(whole[-1], name))


def test_blocks_of_a_load_program_are_recognised(held):
    block = [{"Q": 0.275}, {"Q": 0.1}, {"Q": 0.2}, {"Q": 0.1}, {"Q": -0.275}]
    result = solve(held, [{"P": 1.0}, *block * 6], nodes=101)
    assert result.statistics["repeated"] >= 15
    assert result[-1].peak_shear == result[-6].peak_shear


@pytest.mark.parametrize(
    "cycles",
    [
        [{"Q": 0.275 * (1.0 - 0.01 * k) * sign} for k in range(8) for sign in (1, -1)],  # each one different
        [{"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}, {"Q": -0.275 * (1.0 + 1e-12)}, {"Q": 0.275}],
    ],
    ids=["variable", "almost"],
)
def test_different_loads_are_not_taken_for_repeats(held, cycles):
    assert solve(held, [{"P": 1.0}, *cycles], nodes=101).statistics["repeated"] <= 1


def test_a_contact_that_still_settles_is_followed(titanium_in_aluminium):
    """It shakes down by a fifth a cycle: after twenty cycles a millionth of the peak is left to come."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.2, "centre", "fixed")
    cycle = [{"Q": -0.1}, {"Q": 0.05, "P": 1.2}, {"Q": 0.1, "P": 1.0}]
    result = solve(problem, [{"P": 1.0}, {"Q": 0.1}, *cycle * 20], nodes=101)
    assert result.statistics["repeated"] == 0
    assert 1e-8 < np.abs(result[-1].shear - result[-4].shear).max() < 1e-4


def test_other_stops_and_another_solver_are_other_steps(held):
    first = solve(held, [{"P": 1.0}, *CYCLE * 3], nodes=61)
    assert solve(held, CYCLE, start=first).statistics["repeated"] == 2
    between = solve(held, CYCLE, start=first, between=1)
    assert between.statistics["repeated"] == 0
    assert len(between) == 4
    assert solve(held, CYCLE, start=first, method="increment", increments=4).statistics["repeated"] == 0


def test_little_memory_costs_time_but_changes_nothing(held, monkeypatch):
    history = [{"P": 1.0}, *CYCLE * 6]
    plenty = solve(held, history, nodes=61)
    monkeypatch.setattr(repeats, "MOST_NODES", 60)
    little = solve(held, history, nodes=61)
    assert little.statistics["repeated"] == 0 < plenty.statistics["repeated"]
    assert np.abs(little[-1].shear - plenty[-1].shear).max() < 1e-11 * plenty[-1].pressure.max()


def test_unloading_completely_and_pressing_again(held):
    """The pin leaves the hole in every cycle; the place where it comes to rest again is part of the state."""
    result = solve(held, [{"P": 1.0}, {"Q": 0.2}, {"P": 0.0, "Q": 0.0}] * 5, nodes=101)
    assert result.statistics["repeated"] > 0
    assert result[-2].peak_shear == pytest.approx(result[1].peak_shear, rel=1e-6)


def test_the_place_of_an_error_after_repeats(similar):
    problem = Problem.from_load_parameter(similar, 0.5, 0.55)
    with pytest.raises(NoEquilibriumError) as caught:
        solve(problem, [{"P": 1.0}, *CYCLE * 10, {"M": 2.0}], nodes=61)
    assert caught.value.step == 21
    assert caught.value.result is not None
    assert len(caught.value.result) == 21
    assert caught.value.result.statistics["repeated"] > 0


def test_shared_arrays_can_not_be_changed(held):
    result = solve(held, [{"P": 1.0}, *CYCLE * 4], nodes=61)
    assert result.statistics["repeated"] > 0
    assert result[-1].pressure is result[-3].pressure
    with pytest.raises(ValueError, match="read-only"):
        result[-1].pressure[0] = 1.0
    result[-1].load["P"] = 0.0
    assert result[-3].load["P"] == 1.0


def test_loads_that_repeat_many_times_without_settling_stay_cheap(held, monkeypatch):
    looked = []
    monkeypatch.setattr(repeats, "_same", lambda *_: looked.append(1) is not None)
    monkeypatch.setattr(repeats, "LATEST", 3)
    solve(held, [{"P": 1.0}, *CYCLE * 12], nodes=61, arc=(-3.0, -0.1))
    assert len(looked) <= 3 * 24
