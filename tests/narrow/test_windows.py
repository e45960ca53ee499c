"""Narrow contacts: graded grids, the survey that chooses them, and the windows on which they are followed."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from fastpin import InputError, LoadHistory, Material, MaterialPair, Problem, SolveOptions, load, record, resume, solve
from fastpin.bodies import Bushing
from fastpin.elasticity import build
from fastpin.elasticity.build import build_system
from fastpin.elasticity.system import System
from fastpin.model import LOADS
from fastpin.model.grid import Grid, graded_size
from fastpin.narrow import survey as surveys
from fastpin.narrow import window
from fastpin.narrow.large import LargeSystem
from fastpin.narrow.survey import narrow_grids, survey
from fastpin.narrow.window import Window
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.errors import NoEquilibriumError, ResolutionError
from fastpin.solver.first_contact import first_contact
from fastpin.solver.task import Task
from tests.support.tiers import gate
from tests.survey.histories import generate

BOTTOM = -0.5 * np.pi
PAIR = MaterialPair(Material(9.0, 0.2), Material(7.0, 0.3))
SMALL_FIRST = [{"P": 1e-4, "Q": 2e-5}, {"P": 1.0, "Q": 0.1}, {"P": 1e-3, "Q": 4e-4}]
TRAVELLING = [{"P": 1.0}, {"P": 0.8, "Q": 0.7}, {"P": 0.8, "Q": -0.7}, {"P": 0.02, "Q": 0.01}]


def problem(load_parameter=20.0, friction=0.4, pin_load="centre", rotation="fixed"):
    return Problem.from_load_parameter(PAIR, load_parameter, friction, pin_load, rotation)


def worst(state):
    return max(state.residuals.values())


# --- graded grids -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("places", [[(BOTTOM, 0.01)], [(BOTTOM, 0.3), (-1.0, 0.001)], [(1.5, 0.1), (-4.7, 0.02)]])
def test_a_graded_grid_has_the_wanted_spacing(places):
    across = 20
    grid = Grid.graded(places, graded_size(places, across), node_at=places[0][0])
    spacing = np.diff(np.r_[grid.theta, grid.theta[0] + 2.0 * math.pi])
    assert grid.closed
    assert np.abs(grid.theta - places[0][0]).min() < 1e-12
    for angle, width in places:
        nearest = np.argmin(np.abs(grid.theta - angle))
        assert spacing[nearest] <= 1.05 * width / across
    ratio = spacing / np.roll(spacing, 1)
    assert ratio.max() < 1.13
    assert ratio.min() > 0.88


@pytest.mark.gate
def test_a_wide_contact_keeps_its_nodes_beside_a_narrow_one():
    """The first corner needs nodes at one place. The second must not pay for it."""
    case = Problem.from_load_parameter(PAIR, 0.03, 0.1)
    result = solve(case, [{"P": 3e-6}, {"P": 1.0, "Q": 0.4}], nodes=99)
    fine = solve(case, [{"P": 1.0, "Q": 0.4}], nodes=1201)
    assert not result.grid.uniform
    assert np.array(result[-1].contact) == pytest.approx(np.array(fine[-1].contact), abs=4e-3)
    assert result[-1].peak_pressure == pytest.approx(fine[-1].peak_pressure, rel=3e-3)


def test_places_of_a_graded_grid_are_checked():
    for places in ([], [(0.0, 0.0)], [(0.0, -1.0)], [0.0, 1.0], [(math.nan, 1.0)]):
        with pytest.raises(InputError, match="places"):
            Grid.graded(places, 100)
    with pytest.raises(InputError, match="nodes"):
        Grid.graded([(0.0, 0.1)], 3)


def test_more_nodes_keep_the_grading():
    coarse = Grid.graded([(BOTTOM, 0.01)], 120)
    fine = coarse.with_nodes(240)
    assert fine.closed
    assert fine.theta[::2] == pytest.approx(coarse.theta, abs=1e-12)
    arc_grid = Grid(np.unique(np.r_[np.linspace(-2.0, -1.0, 21), np.linspace(-1.54, -1.46, 8)]))
    assert arc_grid.with_nodes(arc_grid.size).theta == pytest.approx(arc_grid.theta, abs=1e-12)


# --- the survey and the grid it gives -----------------------------------------------------------------------


@pytest.mark.gate
def test_the_survey_finds_the_contacts_of_the_exact_run():
    case = problem()
    values = LoadHistory(SMALL_FIRST).values()
    places = survey(case, values, 1.0)
    result = solve(case, SMALL_FIRST, nodes=61)
    for state in result:
        ((start, stop),) = state.contact
        middle, width = 0.5 * (start + stop), stop - start
        assert any(abs(angle - middle) < 0.3 * width and abs(found - width) < 0.3 * width for angle, found in places)


def test_a_survey_begins_on_a_grid_for_the_width_of_the_contact(monkeypatch):
    case, load = problem(), np.array([{"P": 1e-4}.get(name, 0.0) for name in LOADS])
    (start, stop), *_ = solve(case, [{"P": 1e-4}], nodes=101)[0].contact
    seen = []
    monkeypatch.setattr(surveys._Survey, "_change_grid", lambda _, places: seen.extend(places))
    for finer in (1.0, 0.5):
        surveys._Survey(case, 1.0, 1.0)._look_where_it_begins(load, finer)
        angle, width = seen.pop()
        assert angle == pytest.approx(BOTTOM)
        assert width == pytest.approx(finer * (stop - start), rel=0.03)


def test_a_survey_ends_where_the_pin_snaps_and_snaps(monkeypatch):
    tried = []

    def lost():
        tried.append("again")
        raise NoEquilibriumError("lost")

    run = SimpleNamespace(follow=lost, statistics={"jumps": 1.0})
    monkeypatch.setattr(surveys, "Run", lambda *_, **__: run)
    monkeypatch.setattr(surveys, "MOST_JUMPS", 2)
    assert survey(problem(), LoadHistory(SMALL_FIRST).values(), 1.0) is None
    assert len(tried) == 3


@pytest.mark.gate
@pytest.mark.parametrize("corners", [SMALL_FIRST, TRAVELLING], ids=["small first", "travelling"])
@pytest.mark.parametrize("nodes", [61, 101])
def test_narrow_contacts_are_solved_with_few_nodes(corners, nodes):
    case = problem(200.0)
    result = solve(case, corners, nodes=nodes)
    assert result.complete
    assert not result.grid.uniform
    for state in result:
        assert worst(state) < 1e-10
        assert np.count_nonzero(state.pressure) >= 0.6 * surveys.LEAST_ACROSS[0]
    fine = solve(case, corners, grid=result.grid.with_nodes(2 * result.grid.size))
    for one, two in zip(result, fine, strict=True):
        assert one.peak_pressure == pytest.approx(two.peak_pressure, rel=0.02)


@pytest.mark.gate
def test_a_force_that_changes_sign_needs_no_nodes_between_its_contacts():
    case = problem(1.0)
    result = solve(case, [{"P": 1.0}, {"P": -2e-4}, {"P": 1.0}], nodes=61)
    assert result.grid.size < 200
    top = np.abs(np.array(result[1].contact) - 0.5 * np.pi)
    assert np.all(np.minimum(top, 2.0 * np.pi - top) < 0.1)
    for state, force in zip(result, (1.0, -2e-4, 1.0), strict=True):
        assert worst(state) < 1e-10
        assert state.resultants["P"] == pytest.approx(force, rel=1e-9)


@pytest.mark.gate
@pytest.mark.parametrize(("interference", "small"), [(2e-5, -2e-4), (0.0, 1e-5), (-4e-6, -2e-4)])
def test_small_loads_between_large_ones_leave_a_narrow_contact_in_a_bush(interference, small):
    bush = Bushing(Material(110e9, 0.34), 6.5e-3, interference, friction=0.15, bonded=False)
    pair = MaterialPair(Material(210e9, 0.3), Material(72e9, 0.33), plane="stress")
    case = Problem(pair, 5e-3, clearance=20e-6, friction=0.15, plate_body=bush)
    result = solve(case, [{"P": 2.5e6}, {"P": 2.5e6 * small}, {"P": 2.5e6}], nodes=61)
    assert not result.grid.uniform
    assert result.grid.size < 200
    fine = solve(case, result.history, grid=result.grid.with_nodes(2 * result.grid.size))
    for state, finer in zip(result, fine, strict=True):
        assert worst(state) < 1e-10
        assert worst(state.seat) < 1e-10
        assert np.count_nonzero(state.pressure) >= 0.6 * surveys.LEAST_ACROSS[0]
        assert state.resultants["P"] == pytest.approx(state.load["P"], rel=1e-9)
        assert state.peak_pressure == pytest.approx(finer.peak_pressure, rel=0.02)


@pytest.mark.gate
def test_a_bush_has_fewer_graded_nodes_than_a_plate(monkeypatch):
    monkeypatch.setattr(surveys, "MOST_IN_BUSH", 70)
    bush = Bushing(Material(9.0, 0.2), 1.3, friction=0.3, bonded=False)
    joint = replace(problem(200.0), plate_body=bush)
    assert not list(narrow_grids(joint, LoadHistory(SMALL_FIRST).values(), 1.0, SolveOptions(nodes=61)))


@pytest.mark.gate
def test_a_contact_lost_on_the_first_graded_grid_is_followed_on_a_second(monkeypatch):
    sizes = []
    follow = Task._follow_on

    def watched(task, recorder, progress, start, grid, strict):
        sizes.append(grid.size)
        if not grid.uniform and len(sizes) == 2:
            raise ResolutionError("lost")
        return follow(task, recorder, progress, start, grid, strict)

    monkeypatch.setattr(Task, "_follow_on", watched)
    result = solve(problem(200.0), SMALL_FIRST, nodes=61)
    assert result.complete
    assert sizes[2] == result.grid.size > 1.5 * sizes[1]


@pytest.mark.gate
def test_too_many_nodes_are_refused_with_the_first_error(monkeypatch):
    monkeypatch.setattr(surveys, "MOST_GRADED", 70)
    with pytest.raises(ResolutionError, match="narrower than the nodes"):
        solve(problem(200.0), SMALL_FIRST, nodes=61)


def test_given_arcs_and_grids_are_kept():
    for given in ({"arc": (BOTTOM - 0.5, BOTTOM + 0.5), "nodes": 61}, {"grid": Grid.circle(61)}):
        with pytest.raises(ResolutionError, match="more nodes"):
            solve(problem(200.0), SMALL_FIRST, **given)


@pytest.mark.gate
def test_states_inside_steps_do_not_change_the_corners():
    case = problem(200.0)
    plain, dense = (solve(case, SMALL_FIRST, nodes=61, between=between) for between in (0, 20))
    corners = [state for state in dense if state.fraction == 1.0]
    for one, two in zip(plain, corners, strict=True):
        assert one.peak_pressure == pytest.approx(two.peak_pressure, rel=0.01)


def test_a_contact_on_a_grid_that_is_coarse_elsewhere_starts():
    """The first contact takes the spacing where the pin touches, not a typical one."""
    for seed in range(6):
        rng = np.random.default_rng(seed)
        grid = Grid.graded([(BOTTOM + rng.uniform(-0.6, 0.6), 10.0 ** rng.uniform(-2.5, -1.0))], 160)
        state = solve(problem(0.2), [{"P": 1.0}], grid=grid)[-1]
        assert worst(state) < 1e-10


# --- windows ------------------------------------------------------------------------------------------------


def test_columns_on_demand_are_the_operator():
    case = problem()
    grid = Grid.graded([(BOTTOM, 0.05)], 150)
    dense = System.build(case, grid, 1.0)
    lazy = LargeSystem.build(case, grid, 1.0)
    rng = np.random.default_rng(0)
    tractions = np.where(rng.random(300) < 0.7, rng.normal(size=300), 0.0)
    assert not lazy.operator.is_stored
    assert lazy.elastic(tractions) == pytest.approx(dense.elastic(tractions), abs=1e-13)
    assert np.array_equal(lazy.elastic(np.zeros(300)), np.zeros(300))
    nodes = np.r_[140:150, 0:30]
    assert lazy.part(nodes).grid.theta[0] == grid.theta[140]
    inner = np.asarray(lazy.part(nodes).operator)[1:39, 1:39]
    whole = dense.operator.entries(nodes[1:39], nodes[1:39])
    assert inner == pytest.approx(whole, abs=1e-13)


def test_large_graded_grids_are_followed_on_windows():
    case = problem()
    assert isinstance(build_system(case, Grid.graded([(BOTTOM, 0.01)], 500), 1.0), LargeSystem)
    for grid in (Grid.circle(801), Grid.graded([(BOTTOM, 0.01)], 200), Grid.arc(-2.0, -1.0, 801)):
        assert not isinstance(build_system(case, grid, 1.0), LargeSystem)


@pytest.mark.gate
@pytest.mark.parametrize("pin_load", ["centre", *gate("body")])
def test_windows_lead_to_the_states_of_the_whole_grid(monkeypatch, pin_load):
    case = problem(20.0, 0.4, pin_load, "fixed" if pin_load == "centre" else "free")
    grid = Grid.graded([(BOTTOM + angle, 0.06) for angle in np.linspace(-0.8, 0.8, 27)], 500, BOTTOM)
    on_windows = solve(case, TRAVELLING, grid=grid, between=1)
    monkeypatch.setattr(build, "MOST_DENSE", 1000)
    whole = solve(case, TRAVELLING, grid=grid, between=1)
    for one, two in zip(on_windows, whole, strict=True):
        peak, length = two.pressure.max(), np.abs(two.slip).max()
        assert np.abs(one.pressure - two.pressure).max() < 1e-8 * peak
        assert np.abs(one.shear - two.shear).max() < 1e-8 * peak
        assert np.abs(one.gap - two.gap).max() < 1e-8 * two.gap.max()
        assert np.abs(one.slip - two.slip).max() < 1e-8 * length
        assert one.work == pytest.approx(two.work, rel=1e-8)
        assert one.dissipation == pytest.approx(two.dissipation, rel=1e-7)
        assert worst(one) < 1e-10


@pytest.mark.gate
def test_a_pin_released_in_a_window_lies_inside_the_whole_hole():
    """The pin lets go while the remote stress is still there. Its gap counts from one position at all nodes."""
    case = generate("narrow", 379)
    before, released, *_ = solve(case.problem, case.history, **case.options)
    assert not released.in_contact
    assert released.work - released.dissipation == pytest.approx(0.0, abs=1e-3 * abs(before.energy))
    columns = np.column_stack([np.cos(released.theta), np.sin(released.theta)])
    away = released.gap - case.problem.clearance
    centre = np.linalg.lstsq(columns, away, rcond=None)[0]
    assert columns @ centre == pytest.approx(away, abs=1e-9 * case.problem.clearance)


def test_a_first_contact_in_a_window_takes_the_part_of_the_whole_grid():
    """The hole must keep its shape all round while the first nodes close, not in the window only."""
    case, grid = problem(20.0), Grid.graded([(BOTTOM, 0.05)], 220, BOTTOM)
    load = np.array([{"P": 1e-3, "syy": 3.0}.get(name, 0.0) for name in LOADS])
    (small, part), (whole, expected) = (
        first_contact(system, unloaded_configuration(system), 0.0 * load, load, strict=True)
        for system in (kind.build(case, grid, 1.0) for kind in (LargeSystem, System))
    )
    assert expected < 1.0
    assert part == expected
    assert small.pressure == pytest.approx(whole.pressure, abs=1e-8 * whole.pressure.max())


def test_a_second_place_opens_a_wider_window(monkeypatch):
    """Compression across the load presses the pin at two places, which no window round the first place holds."""
    monkeypatch.setattr(build, "MOST_DENSE", 100)
    case = problem(1.0, 0.3)
    corners = [{"P": 1.0}, {"P": 0.2, "sxx": 3.0, "syy": -6.0}]
    grid = Grid.graded([(BOTTOM, 0.2), (-BOTTOM, 0.2)], 240, BOTTOM)
    on_windows = solve(case, corners, grid=grid)
    monkeypatch.setattr(build, "MOST_DENSE", 1000)
    whole = solve(case, corners, grid=grid)
    assert len(whole[-1].contact) == 2
    assert np.abs(on_windows[-1].pressure - whole[-1].pressure).max() < 1e-8 * whole[-1].pressure.max()


def test_a_window_holds_the_contact_across_the_first_node():
    system = LargeSystem.build(problem(), Grid.graded([(math.pi / 2, 0.05)], 300), 1.0)
    closed = np.zeros(300, dtype=bool)
    closed[[297, 298, 299, 0, 1]] = True
    opened = Window(system, closed)
    inside = np.flatnonzero(closed[opened.nodes])
    assert inside.tolist() == list(range(window.MARGIN, window.MARGIN + 5))
    assert np.all(np.diff(opened.system.grid.theta) > 0.0)


@pytest.mark.gate
def test_a_narrow_history_is_stored_resumed_and_continued(tmp_path):
    case = problem(200.0)
    path = tmp_path / "narrow.h5"
    record(case, SMALL_FIRST, path, nodes=61)
    stored, solved = load(path), solve(case, SMALL_FIRST, nodes=61)
    for one, two in zip(stored, solved, strict=True):
        assert np.array_equal(one.pressure, two.pressure)
        assert np.array_equal(one.slip, two.slip)
    first = solve(case, SMALL_FIRST[:2], grid=solved.grid)
    second = solve(case, SMALL_FIRST[2:], start=first)
    assert np.array_equal(second[-1].shear, solved[-1].shear)
    with pytest.raises(InputError, match="finished"):
        resume(path)


def test_an_interference_fit_needs_no_survey():
    values = LoadHistory([{"P": 1.0}]).values()
    fit = Problem.from_load_parameter(PAIR, -0.5, 0.4)
    assert all(grid.closed for grid in narrow_grids(fit, values, 1.0, SolveOptions()))
