"""Steps that one call of the kernel follows: the same bits as step by step, and the same nodes in coarse runs."""

import numpy as np
import pytest

from fastpin import Grid, LoadHistory, Problem, SolveOptions, solve
from fastpin.elasticity.build import latest_system
from fastpin.kernels import exchange
from fastpin.kernels.status import OPEN, STICK
from fastpin.solver import arc, held
from tests.support.programs import assert_same, difference
from tests.support.steps import step_by_step

BOTTOM = -0.5 * np.pi
HISTORIES = {
    "forces": [{"P": 1.0}, {"Q": 0.2}, {"P": 1.3, "Q": -0.2}, {"P": 0.2}, {"Q": 0.1}],
    "unloading": [{"P": 1.0}, {"P": 0.0}, {"P": 1.0, "Q": 0.3}],
    "reversal": [{"P": 1.0}, {"P": -1.0}, {"Q": 0.5}],
    "remote stress": [{"P": 1.0, "sxx": 0.02}, {"sxx": -0.02}, {"Q": 0.2}],
    "moment": [{"P": 1.0}, {"M": 0.1}, {"M": -0.1}],
    "friction": [{"P": 1.0}, {"friction_change": -0.3}, {"Q": 0.2}],
}


def problem_of(pair, **kind):
    return Problem.from_load_parameter(pair, 0.1, 0.4, **{"pin_load": "centre", "rotation": "free", **kind})


@pytest.mark.parametrize("name", HISTORIES)
def test_they_have_the_bits_of_steps_that_begin_the_usual_way(titanium_in_aluminium, monkeypatch, name):
    problem, options = problem_of(titanium_in_aluminium), {"nodes": 41, "slip_sums": True}
    whole = solve(problem, HISTORIES[name], **options)
    step_by_step(monkeypatch)
    usual = solve(problem, HISTORIES[name], **options)
    assert_same(whole.states, usual.states)


def test_nodes_are_held_anew_within_a_step_after_many_updates(titanium_in_aluminium, monkeypatch):
    """The contact is the same up to rounding."""
    problem, history = problem_of(titanium_in_aluminium), HISTORIES["forces"]
    plain = solve(problem, history, nodes=41)
    monkeypatch.setattr(held, "MOST_UPDATES", 20)
    anew = solve(problem, history, grid=plain.grid)
    assert difference(plain, anew) < 1e-12
    assert not np.array_equal(plain[0].shear, anew[0].shear)
    assert anew.statistics["rebuilds"] == 0.0
    step_by_step(monkeypatch)
    assert_same(anew, solve(problem, history, grid=plain.grid))


def test_nodes_that_can_not_be_held_anew_keep_their_statuses(titanium_in_aluminium, monkeypatch):
    """The step goes on with a factorisation, to the same contact up to rounding."""
    problem, history, follow = problem_of(titanium_in_aluminium), HISTORIES["forces"], held.held.step
    plain = solve(problem, history, nodes=41)

    def lost(begins, *given):
        status, counts = given[9].status, given[12].counts
        if not (begins and counts[exchange.EVENTS] > 0):
            return follow(begins, *given)
        status[status != OPEN] = STICK
        counts[exchange.QUEUED] = 3
        return exchange.NO_SUPPORT, False, (0.0, 0.0, 0.0, 0.0)

    monkeypatch.setattr(held, "MOST_UPDATES", 20)
    monkeypatch.setattr(held.held, "step", lost)
    again = solve(problem, history, grid=plain.grid)
    assert again.statistics["rebuilds"] > 0
    assert difference(plain, again) < 1e-12


@pytest.mark.parametrize("rotation", ["free", "fixed"])
@pytest.mark.parametrize("name", ["forces", "remote stress"])
def test_a_coarse_run_in_whole_steps_finds_the_same_nodes(titanium_in_aluminium, name, rotation):
    problem = problem_of(titanium_in_aluminium, rotation=rotation)
    history = LoadHistory(HISTORIES[name][:3])
    system = latest_system(problem, Grid.arc(BOTTOM - 1.5, BOTTOM + 1.5, 61), 2.0)
    run = arc.CoarseRun(history, system, SolveOptions())
    run.follow()
    reached = []
    found = arc._touched_in_whole_steps(
        system, history.distinct() / system.scales.loads, lambda done, total: reached.append((done, total))
    )
    assert np.array_equal(found, run.touched)
    assert reached == [(done, len(history)) for done in range(1, len(history) + 1)]


@pytest.mark.parametrize("name", ["unloading", "reversal", "moment", "friction"])
def test_other_coarse_runs_are_left_to_the_solver(titanium_in_aluminium, name):
    system = latest_system(problem_of(titanium_in_aluminium), Grid.circle(61), 2.0)
    values = LoadHistory(HISTORIES[name]).distinct()
    assert arc._touched_in_whole_steps(system, values / system.scales.loads, None) is None
