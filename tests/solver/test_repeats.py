"""Contacts that become periodic: recognised by the whole state; what is not solved again has the same bits."""

import dataclasses
import math

import numpy as np
import pytest

from fastpin import MATERIALS, LoadHistory, MaterialPair, NoEquilibriumError, Problem, Result, solve
from fastpin.solver import repeats
from fastpin.solver.configuration import Configuration
from fastpin.solver.repeats import MOST_KEPT, Repeats
from fastpin.states.cycles import consecutive_cycles, periodic_from
from tests.support.programs import CYCLE, PROGRAMS, RANDOM, P, assert_same, assert_same_bits, grid_of, known, q
from tests.support.tiers import some_gate


@pytest.fixture(scope="module")
def held(similar):
    return Problem.from_load_parameter(similar, 0.5, 0.55, "centre", "fixed")


@pytest.fixture(scope="module")
def free(similar):
    return Problem.from_load_parameter(similar, 0.05, 0.55, "body")


@pytest.mark.parametrize("keep", some_gate(["all", "cycles", "every 3"], "all", "all", "all"))
@pytest.mark.parametrize(
    "program",
    some_gate(list(PROGRAMS), "pressed again and again", "pressed again and again", "pressed again and again"),
)
@pytest.mark.parametrize("kind", ["held", "free"])
def test_what_repeats_has_the_bits_of_what_is_solved_again(request, kind, program, keep):
    problem, history = request.getfixturevalue(kind), PROGRAMS[program]
    keep = keep if history.longest_cycle or keep != "cycles" else "every 40"
    between = 1 if keep == "all" else 0
    short, whole = (
        solve(problem, history, grid=grid_of(problem, program), between=between, keep=keep, shortcut=shortcut)
        for shortcut in (True, False)
    )
    assert_same(short, whole)
    assert known(short) == known(whole)
    assert whole.statistics["repeated"] == 0
    assert all(cycle.solved for cycle in whole.cycles)
    if keep == "all" and kind == "held":
        assert short.statistics["repeated"] > 0.3 * len(history)
        assert short.statistics["events"] < whole.statistics["events"]


@pytest.mark.parametrize("program", some_gate(PROGRAMS, "pressed again and again", "begins inside a period"))
def test_a_split_history_has_the_bits_of_the_whole(free, program):
    history = PROGRAMS[program]
    whole = solve(free, history, grid=grid_of(free, program))
    for cut in (3, 8, len(history) - 2):
        first = solve(free, history[:cut], grid=whole.grid)
        assert_same_bits(solve(free, history[cut:], start=first), whole[cut:])


def test_a_result_can_be_gone_on_from_more_than_once(held):
    first = solve(held, [{"P": 1.0}, *CYCLE * 3], nodes=61)
    one, other = (solve(held, CYCLE * 4, start=first) for _ in range(2))
    assert_same(one, other)
    assert one.statistics == {**other.statistics, "seconds": one.statistics["seconds"]}


def test_repeated_states_are_exact_copies(held):
    result = solve(held, [{"P": 1.0}, *CYCLE * 8], nodes=101)
    assert np.array_equal(result[-1].pressure, result[-3].pressure)
    shared = [state for state, before in zip(result[2:], result, strict=False) if state.pressure is before.pressure]
    assert len(shared) == result.statistics["repeated"] > 0
    with pytest.raises(ValueError, match="read-only"):
        shared[0].pressure[0] = 1.0
    with pytest.raises(TypeError, match="read-only"):
        shared[0].load["P"] = 0.0


def test_the_transient_as_numbers(free):
    """The free pin settles by a factor of a hundred a cycle, until nothing but rounding is left."""
    result = solve(free, LoadHistory.cycles({"P": 1.0}, {"Q": 0.275}, 14), nodes=101)
    cycles = result.cycles
    assert [cycle.number for cycle in cycles] == list(range(1, 15))
    assert [cycle.corner for cycle in cycles] == list(range(3, 31, 2))
    for place, cycle in enumerate(cycles):
        state, before = result[cycle.corner], result[cycle.corner - 2]
        peak = max(state.pressure.max(), before.pressure.max())
        assert cycle.pressure_change == pytest.approx(np.abs(state.pressure - before.pressure).max() / peak, abs=1e-15)
        assert cycle.shear_change == pytest.approx(np.abs(state.shear - before.shear).max() / peak, abs=1e-15)
        assert cycle.dissipation == pytest.approx(state.dissipation - before.dissipation, abs=1e-15)
        assert cycle.rotation_change == pytest.approx(state.rotation - before.rotation, abs=1e-15)
        if 1 <= place < 5:
            assert 30 < cycles[place - 1].shear_change / cycle.shear_change < 300
    steady = periodic_from(cycles)
    assert steady is not None
    assert 6 <= steady.number <= 10
    assert steady.solved
    assert not cycles[-1].solved
    assert periodic_from(cycles[:5]) is None
    assert periodic_from([]) is None


def test_ratcheting_is_seen():
    """A pin pushed round a small moment up and down creeps the same way in every cycle."""
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["steel"])
    problem = Problem.from_load_parameter(pair, 0.5, 0.3)
    turning = LoadHistory.harmonic({"P": 1.0}, {"Q": 0.4, "M": 0.15}, {"M": 90.0}, count=8, points=12)
    result = solve(problem, turning, nodes=61)
    changes = [cycle.rotation_change for cycle in result.cycles[1:]]
    assert sum(changes) == pytest.approx(result[-1].rotation - result[12].rotation, rel=1e-9)


def test_series_are_told_apart(held):
    result = solve(held, PROGRAMS["two levels"], nodes=61)
    lengths = [(one[0].length, len(one)) for one in consecutive_cycles(result.cycles)]
    assert sorted(lengths) == sorted([(2, 5), (2, 3)] * 4 + [(16, 4)])
    assert all(
        [cycle.number for cycle in one] == list(range(1, len(one) + 1)) for one in consecutive_cycles(result.cycles)
    )


def test_a_cycle_that_began_before_the_history_is_not_known(held):
    history = P + q(0.2, -0.2, 0.1).repeated(4)
    first = solve(held, history[:2], nodes=61, arc=(-3.0, -0.1))
    cut, second, *_ = solve(held, history[2:], start=first).cycles
    assert (cut.corner, cut.length) == (1, 3)
    assert math.isnan(cut.shear_change)
    assert math.isnan(cut.dissipation)
    whole = solve(held, history, nodes=61, arc=(-3.0, -0.1)).cycles[1]
    assert second[3:] == whole[3:]
    assert (second.corner, second.length) == (whole.corner - 2, 3)


def test_the_last_cycle_is_not_solved_for_its_last_state(held):
    history = PROGRAMS["spectrum"]
    whole = solve(held, history, grid=grid_of(held, "spectrum"), shortcut=False)
    for keep in ("all", "cycles", f"every {len(RANDOM) + 1}"):
        result = solve(held, history, grid=whole.grid, keep=keep)
        assert result.statistics["repeated"] == 2 * (len(RANDOM) + 1)
        assert_same(Result([result[-1]], *[None] * 6), Result([whole[-1]], *[None] * 6))


@pytest.mark.gate
def test_states_that_are_seldom_kept_do_not_cost_the_shortcut(held):
    history = P + q(0.2, -0.2, 0.1).repeated(120)
    result = solve(held, history, nodes=61, keep="every 150")
    assert [state.step for state in result] == [149, 299, 360]
    assert result.statistics["repeated"] > 340
    whole = solve(held, history, grid=result.grid, shortcut=False)
    for state in result:
        assert np.array_equal(state.shear, whole[state.step].shear)
        assert state.dissipation == whole[state.step].dissipation


def test_a_period_goes_on_after_a_kept_corner(held):
    """However long it lasts, the same corners at its beginning are solved."""
    solved = []
    for count in (16, 30):
        history = P + q(0.2, -0.2, 0.1).repeated(count)
        solved.append(len(history) - solve(held, history, nodes=41, keep="every 7").statistics["repeated"])
    assert solved[0] == solved[1]


@pytest.mark.parametrize(
    "cycles",
    [
        [{"Q": 0.275 * (1.0 - 0.01 * k) * sign} for k in range(8) for sign in (1, -1)],  # each one different
        [{"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}, {"Q": -0.275 * (1.0 + 1e-12)}, {"Q": 0.275}],
    ],
    ids=["variable", "almost"],
)
def test_different_loads_are_not_taken_for_repeats(held, cycles):
    assert solve(held, [{"P": 1.0}, *cycles], nodes=101).statistics["repeated"] == 0


def test_a_contact_that_still_settles_is_followed(titanium_in_aluminium):
    """It shakes down by a fifth a cycle: after twenty cycles a millionth of the peak is left to come."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.2, "centre", "fixed")
    cycle = LoadHistory([{"Q": -0.1}, {"Q": 0.05, "P": 1.2}, {"Q": 0.1, "P": 1.0}])
    result = solve(problem, LoadHistory([{"P": 1.0}, {"Q": 0.1}]) + cycle.repeated(20), nodes=101)
    assert result.statistics["repeated"] == 0
    assert periodic_from(result.cycles) is None
    assert 1e-8 < result.cycles[-1].shear_change < 1e-4


def test_the_place_of_an_error_after_repeats(similar):
    problem = Problem.from_load_parameter(similar, 0.5, 0.55)
    with pytest.raises(NoEquilibriumError) as caught:
        solve(problem, [{"P": 1.0}, *CYCLE * 16, {"M": 2.0}], nodes=61)
    assert caught.value.step == 33
    assert caught.value.result is not None
    assert len(caught.value.result) == 33
    assert caught.value.result.statistics["repeated"] > 0


def test_a_failed_history_can_be_gone_on_from_its_last_corner(similar):
    problem = Problem.from_load_parameter(similar, 0.5, 0.55)
    with pytest.raises(NoEquilibriumError) as caught:
        solve(problem, [{"P": 1.0}, {"Q": 0.2}, {"M": 2.0}], nodes=61)
    good = solve(problem, [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}], grid=caught.value.result.grid)
    assert np.array_equal(solve(problem, [{"Q": -0.2}], start=caught.value.result)[-1].shear, good[-1].shear)


# -- the memory ----------------------------------------------------------------------------------------------


def configuration(load: float, slip: float = 1.0) -> Configuration:
    ones = np.ones(5)
    return Configuration(
        ones, ones, ones, slip * ones, np.zeros(5, dtype=np.int8), np.zeros(3), np.full(6, load), np.zeros(2),
        np.zeros(2), ones, ones,
    )  # fmt: skip


def test_rounding_is_recognised_and_no_more():
    memory = Repeats()
    assert memory.recall(configuration(1.0), False, 0) is None
    found = memory.recall(configuration(1.0, 1.0 + 3e-14), False, 3)
    assert found is not None
    assert found.configuration.slip[0] == 1.0
    assert (found.last, found.period, found.since) == (3, 3, 0)
    assert memory.recall(configuration(1.0, 1.0 + 1e-13), False, 4) is None
    assert memory.recall(configuration(1.0 + 1e-15), False, 5) is None
    found = memory.recall(configuration(1.0), False, 6)
    assert (found.last, found.period, found.since) == (6, 3, 0)
    found = memory.recall(configuration(1.0), False, 8)
    assert (found.last, found.period, found.since) == (8, 2, 6)


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(Configuration)][2:11])
def test_every_part_of_a_configuration_counts(name):
    if name == "load":
        return
    memory, other = Repeats(), configuration(1.0)
    memory.recall(configuration(1.0), False, 0)
    setattr(other, name, getattr(other, name) + 1)
    assert memory.recall(other, False, 1) is None


def test_the_latest_and_the_ends_of_cycles_are_remembered():
    memory = Repeats()
    memory.recall(configuration(-1.0), True, 0)
    for k in range(1, 200):
        assert memory.recall(configuration(float(k)), False, k) is None
    assert len(list(memory)) == MOST_KEPT + 1
    assert memory.recall(configuration(-1.0), False, 200) is not None
    assert memory.recall(configuration(199.0), False, 201) is not None
    assert memory.recall(configuration(1.0), False, 202) is None


def test_little_memory_costs_time_but_changes_nothing(held, monkeypatch):
    history = [{"P": 1.0}, *CYCLE * 6]
    plenty = solve(held, history, nodes=61)
    monkeypatch.setattr(repeats, "MOST_KEPT", 1)
    little = solve(held, history, nodes=61)
    assert little.statistics["repeated"] == 0 < plenty.statistics["repeated"]
    assert np.abs(little[-1].shear - plenty[-1].shear).max() < 1e-11 * plenty[-1].pressure.max()
