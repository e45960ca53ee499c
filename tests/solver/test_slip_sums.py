"""Slip sums: the slip distance and the friction energy of each node, exact along every piece of a history."""

import itertools
import pickle
from typing import Any

import numpy as np
import pytest

from fastpin import LoadHistory, Problem, Result, load, record, save, solve
from tests.support.programs import EXTREMES, FIELDS, NUMBERS, PROGRAMS, SLIP, P, assert_same, grid_of, known, q
from tests.support.slip_cases import CASES, LIKE, UNLIKE, WAYS, assert_contains, random_states, solved, unitless
from tests.support.tiers import seeds, some_gate


def assert_balance(result: Result) -> None:
    """The friction energy of all nodes is the growth of the dissipation; no node slips without contact."""
    weights = result.problem.hole_radius * result.grid.weights
    energies = np.array([weights @ state.friction_energy for state in result])
    dissipation = np.array([state.dissipation for state in result])
    scale = max(float(np.abs(dissipation).max()), 1e-300)
    assert np.abs(energies - np.diff(dissipation, prepend=0.0)).max() <= 1e-12 * scale
    for before, after in itertools.pairwise(result):
        stuck = (before.status == 0) & (after.slip_distance == 0.0) & (after.status == 0)
        assert np.abs(after.slip - before.slip)[stuck].max(initial=0.0) <= 1e-12 * np.abs(after.slip).max()
        assert np.all(after.slip_distance >= 0.0)


@pytest.mark.gate
@pytest.mark.parametrize(("name", "method"), WAYS)
def test_the_friction_energy_of_all_nodes_is_the_dissipation_and_extremes_contain_the_states(
    name: str, method: str
) -> None:
    found = solved(name, 4, method)
    assert_balance(found)
    assert_contains(found)
    assert found[-1].dissipation > 0.0
    assert sum(float(state.slip_distance.max()) for state in found) > 0.0


@pytest.mark.parametrize("name", some_gate(CASES, "snap"))
def test_nothing_else_changes(name: str) -> None:
    summed = solved(name)
    plain = solve(*CASES[name][:2], grid=summed.grid)
    for one, two in zip(plain, summed, strict=True):
        assert all(getattr(one, field) is None for field in (*SLIP, *EXTREMES))
        assert all(np.array_equal(getattr(one, field), getattr(two, field)) for field in FIELDS)
        assert all(getattr(one, field) == getattr(two, field) for field in NUMBERS)
    assert {**plain.statistics, "seconds": 0.0} == {**summed.statistics, "seconds": 0.0}


def test_random_histories_balance_and_their_extremes_contain_the_states() -> None:
    for seed in seeds(30, first=100):
        assert_balance(random_states(seed))
        assert_contains(random_states(seed))


def test_the_sums_do_not_depend_on_the_states_that_are_kept() -> None:
    whole = solved("unlike bodies")
    for between in (1, [0.1, 0.35, 0.7]):
        parts = solve(whole.problem, whole.history, slip_sums=True, between=between, grid=whole.grid)
        size = len(parts) // len(whole)
        for place, state in enumerate(whole):
            mine = parts[place * size : (place + 1) * size]
            for field in SLIP:
                total, expected = np.sum([getattr(part, field) for part in mine], axis=0), getattr(state, field)
                assert np.abs(total - expected).max() <= 1e-12 * expected.max()


def test_without_friction_slip_has_a_distance_and_no_energy() -> None:
    found = solve(unitless(UNLIKE, 0.1, 0.0, "centre", "fixed"), [{"P": 1.0}, {"P": 0.5}], nodes=101, slip_sums=True)
    assert all(not state.friction_energy.any() for state in found)
    first, second = found
    both = (first.status != 2) & (second.status != 2)
    # The contact shrinks in proportion: slip has one sense, so its distance is its change.
    change = np.abs(second.slip - first.slip)
    assert second.slip_distance[both] == pytest.approx(change[both], rel=1e-9, abs=1e-12 * change.max())


# -- the same bits in every way ----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def held() -> Problem:
    return unitless(LIKE, 0.5, 0.55, "centre", "fixed")


@pytest.mark.parametrize("keep", ["all", "every 5", "cycles", "corners", "every 3"])
@pytest.mark.parametrize("program", some_gate(PROGRAMS, *(PROGRAMS.keys() - {"cycles", "corners", "minus zero"})))
def test_what_repeats_has_the_bits_of_what_is_solved_again(held: Problem, program: str, keep: str, tmp_path) -> None:
    history = PROGRAMS[program]
    keep = keep if history.longest_cycle or keep != "cycles" else "every 7"
    options: dict[str, Any] = {"keep": keep, "between": 1 if keep == "all" else 0, "slip_sums": True}
    options["grid"] = grid_of(held, program)
    short = solve(held, history, **options)
    whole = solve(held, history, shortcut=False, **options)
    assert_same(short, whole)
    assert known(short) == known(whole)
    assert_balance(short)
    record(held, history, tmp_path / "a.h5", **options)
    assert_same(load(tmp_path / "a.h5"), whole)


def test_repeated_states_share_their_sums(held: Problem) -> None:
    for keep in ("corners", "cycles"):
        found = solve(held, PROGRAMS["cycles"], nodes=61, keep=keep, slip_sums=True)
        last, before = (found[-1], found[-2]) if keep == "cycles" else (found[-1], found[-3])
        assert last.friction_energy is before.friction_energy
        assert last.slip_distance is before.slip_distance
        assert last.slip_lowest is before.slip_lowest
        with pytest.raises(ValueError, match="read-only"):
            last.slip_distance[0] = 1.0


@pytest.mark.parametrize("program", some_gate(list(PROGRAMS), "pressed again and again"))
def test_a_split_history_has_the_sums_of_the_whole(held: Problem, program: str) -> None:
    history = PROGRAMS[program]
    whole = solve(held, history, grid=grid_of(held, program), slip_sums=True)
    for cut in (3, 8, len(history) - 2):
        first = solve(held, history[:cut], grid=whole.grid, slip_sums=True)
        second = solve(held, history[cut:], start=first, slip_sums=True)
        for parts, states in ((first, whole[:cut]), (second, whole[cut:])):
            for one, two in zip(parts, states, strict=True):
                assert all(np.array_equal(getattr(one, name), getattr(two, name)) for name in SLIP)
                assert all(np.array_equal(getattr(one, name), getattr(two, name), equal_nan=True) for name in EXTREMES)


def test_a_branch_may_begin_to_sum_up(held: Problem) -> None:
    history = P + q(0.2, -0.2, 0.1)
    whole = solve(held, history, nodes=61, slip_sums=True)
    first = solve(held, history[:2], grid=whole.grid)
    second = solve(held, history[2:], start=first, slip_sums=True)
    assert np.array_equal(second[0].friction_energy, whole[2].friction_energy)
    bare = solve(held, history[2:], start=solve(held, history[:2], grid=whole.grid, slip_sums=True))
    assert bare[0].friction_energy is None


def test_states_keep_their_sums_through_pickle_and_files(held: Problem, tmp_path) -> None:
    found = solve(held, P + q(0.2, -0.2), nodes=61, slip_sums=True)
    copy = pickle.loads(pickle.dumps(found))
    assert_same(copy, found)
    assert not copy[1].slip_distance.flags.writeable
    save(found, tmp_path / "a.h5")
    assert_same(load(tmp_path / "a.h5"), found)


def test_error_bars_go_with_sums(held: Problem) -> None:
    found = solve(held, P + q(0.2, -0.2), nodes=101, slip_sums=True, error_bars=True)
    assert found[-1].error_bars is not None
    assert found[-1].slip_distance.max() > 0.0
    again = solve(held, q(0.2), start=found, slip_sums=True, error_bars=True)
    assert again[0].friction_energy.any()


def test_a_long_transient_is_summed_where_it_was_not_kept(held: Problem) -> None:
    """The contact settles shortly before the corners that repeat: their first kept state counts the transient too."""
    history = LoadHistory([{"P": 1.0}]) + q(0.3, -0.3).repeated(40)
    for keep in ("every 9", "every 16"):
        short = solve(held, history, nodes=61, keep=keep, slip_sums=True)
        assert short.statistics["repeated"] > 0
        assert_same(short, solve(held, history, nodes=61, keep=keep, slip_sums=True, shortcut=False))
        assert_balance(short)
