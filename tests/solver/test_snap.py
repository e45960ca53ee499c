"""Snaps: where no state is near, the pin creeps under a damper to the next one."""

from dataclasses import replace

import numpy as np
import pytest

import fastpin.solver.path_stepper as path_stepper
from fastpin import Grid, NoEquilibriumError, Problem, solve
from fastpin.elasticity.system import System
from fastpin.kernels.status import STICK
from fastpin.model.angles import BOTTOM
from fastpin.model.loads import LOADS, M, P
from fastpin.solver import ArcError
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import review, worst_residual
from fastpin.solver.first_contact import first_contact
from fastpin.solver.path import PathStep
from fastpin.solver.snap import _on_springs, find_state_beyond
from tests.support.snap_cases import GRIPPED, TURNED, problem
from tests.support.tiers import some_survey


@pytest.fixture
def snaps(monkeypatch):
    """Snaps of the present test: the system, and the configurations before and after."""
    found = []

    def watched(system, now, load):
        after = find_state_beyond(system, now, load)
        found.append((system, now, after))
        return after

    monkeypatch.setattr(path_stepper, "find_state_beyond", watched)
    return found


@pytest.fixture
def pressed(titanium_in_aluminium):
    """The system of a pin that is pressed down, and its contact."""
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    system = System.build(case, Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 61), 1.0)
    load = np.eye(len(LOADS))[P]
    start, _ = first_contact(system, unloaded_configuration(system), np.zeros(len(LOADS)), load)
    return system, PathStep(system, start, load).follow(1.0)


@pytest.mark.gate
@pytest.mark.parametrize(
    ("case", "history"), [GRIPPED, pytest.param(*TURNED, marks=pytest.mark.survey)], ids=["gripped", "turned"]
)
def test_snaps_converge_with_the_nodes(snaps, case, history):
    """The load of the snap and the way of the pin are properties of the joint, not of the grid."""
    loads, ways, peaks = [], [], []
    for nodes in (121, 241, 481):
        result = solve(case, history, nodes=nodes)
        assert result.statistics["jumps"] == 1
        system, before, after = snaps[-1]
        assert system.grid.size == result.grid.size
        loads.append(before.load)
        ways.append(after.motion - before.motion)
        peaks.append(result[-1].peak_pressure)
        assert all(max(state.residuals.values()) < 1e-9 for state in result)
    assert np.abs(loads[1] - loads[2]).max() < 2e-3 * np.abs(loads[2]).max()
    assert np.abs(ways[1] - ways[2]).max() < 0.02 * np.abs(ways[2]).max()
    assert np.abs(ways[0] - ways[2]).max() < 0.2 * np.abs(ways[2]).max()
    assert peaks[1] == pytest.approx(peaks[2], rel=5e-3)


@pytest.mark.parametrize(("case", "history"), [GRIPPED, TURNED], ids=["gripped", "turned"])
def test_a_snap_sets_energy_free(snaps, case, history):
    """The pin goes far while the load hardly changes; the loads work more than the contact stores and dissipates."""
    solve(case, history, nodes=121)
    system, before, after = snaps[-1]
    assert np.abs(after.load - before.load).max() < 1e-4 * np.abs(before.load).max()
    assert np.abs(after.motion - before.motion).max() > 0.05
    assert worst_residual(system, after) < 1e-9
    stored = review(system, after).energy - review(system, before).energy
    dissipated = after.dissipation - before.dissipation
    assert dissipated > 0.0
    assert after.work - before.work > stored + dissipated


def test_where_a_state_is_near_no_creep_is_needed(pressed):
    system, now = pressed
    load = 1.01 * now.load
    exact = PathStep(system, now, load).follow(1.0)
    found = find_state_beyond(system, now, load)
    assert np.array_equal(found.status, exact.status)
    assert found.pressure == pytest.approx(exact.pressure, abs=1e-4)
    assert found.work == pytest.approx(exact.work, rel=1e-6)


def test_springs_carry_the_force_that_the_contact_does_not(pressed):
    system, now = pressed
    stiffness, load = np.array([2.0, 3.0, 0.5]), 1.05 * now.load
    found = _on_springs(system, now, load, stiffness)
    tractions = np.r_[found.pressure, found.shear]
    carried = system.equilibrium @ tractions + stiffness * (found.motion - now.motion)
    assert carried == pytest.approx(system.load_forces(load), abs=1e-12)
    n = system.grid.size
    true = system.displacement(tractions, found.motion, load, found.rest_gap)
    assert np.abs(true[:n][found.closed]).max() < 1e-12
    assert np.abs(true[n:] - found.slip)[found.closed].max() < 1e-12
    stick = found.status == STICK
    assert np.array_equal(found.slip[stick], now.slip[stick]) or np.abs(found.slip - now.slip)[stick].max() < 1e-14


def test_slack_springs_move_nothing(pressed):
    system, now = pressed
    found = _on_springs(system, now, now.load, np.full(3, 2.0))
    for field in ("pressure", "shear", "motion", "slip"):
        assert getattr(found, field) == pytest.approx(getattr(now, field), abs=1e-12)


def test_a_pin_that_spins_comes_to_rest_nowhere(pressed):
    system, now = pressed
    load = now.load.copy()
    load[M] = 0.9  # friction of 0.4 carries at most 0.4/sqrt(1.16) times the force
    with pytest.raises(NoEquilibriumError, match="it spins"):
        find_state_beyond(system, now, load)


def test_a_pin_whose_moment_falls_beyond_a_peak_spins():
    """Under much friction the pin climbs the hole. At the peak of the moment it snaps, and turns without end."""
    case = problem((31, 0.4), (4.3, 0.2), 0.018, 2.9)
    with pytest.raises(NoEquilibriumError, match="it spins") as caught:
        solve(case, [{"P": 0.3, "Q": 0.1}, {"P": 0.09, "Q": 0.04, "M": 0.12}], nodes=77)
    assert 0.0 < caught.value.fraction < 1.0


def test_a_pin_that_creeps_to_an_end_of_the_arc_is_an_error(pressed):
    system, now = pressed
    turned = np.zeros(len(LOADS))
    turned[LOADS.index("Q")] = 1.0
    part = system.part(np.arange(15, 46))
    with pytest.raises(ArcError):
        find_state_beyond(part, now.part(np.arange(15, 46)), turned)


@pytest.mark.parametrize(
    "nodes",
    some_survey([{"grid": Grid.circle(120)}, {"nodes": 121}], {"nodes": 121}),
    ids=["a given grid", "a grid that is searched for"],
)
def test_a_snap_to_nowhere_is_told(nodes, monkeypatch):
    """The search for an arc follows the history on many grids."""
    monkeypatch.setattr(path_stepper, "find_state_beyond", lambda *_: None)
    case, history = GRIPPED
    with pytest.raises(NoEquilibriumError, match="the pin snaps") as caught:
        solve(case, history, **nodes)
    assert len(caught.value.result) == 2


def test_the_system_on_springs_leaves_the_system_alone(pressed):
    system, now = pressed
    before = replace(system).motion_rows.copy()
    _on_springs(system, now, now.load, np.ones(3))
    assert np.array_equal(system.motion_rows, before)
