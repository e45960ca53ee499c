"""Remote shear stress sxy as a load, (T16). tests/whole/test_relations.py turns and mirrors joints under it."""

import math

import numpy as np
import pytest

import fastpin
from fastpin import Grid, Material, MaterialPair, Problem, plot_tractions, read_case, solve
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model import LOADS
from fastpin.model.angles import BOTTOM
from fastpin.model.loads import SXX, SXY, SYY
from fastpin.report.case import load_columns
from fastpin.report.summary import document
from fastpin.solver.rest import hole_gap
from fastpin.storage.layout import all_loads
from tests.support.checks.integral_equations import residuals_away
from tests.support.samples import JOINT

NODES = 240
CIRCLE = Grid.circle(NODES, -1.5 * math.pi)
PINCHED = [{"sxy": 0.8}, {"sxy": 1.2}, {"sxy": 0.5}, {"sxy": 0.0}, {"sxy": -1.0}, {"sxy": -0.6}]


def problem_of(pair, parameter, pin_load="body", rotation="free"):
    return Problem.from_load_parameter(pair, parameter, 0.4, pin_load, rotation)


# --- column, gap of the hole --------------------------------------------------------------------------------


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_column_and_gap_of_the_hole(plane):
    """The displacements (R kappa'/G) sxy (sin 2 theta, cos 2 theta) of the hole open the gap and oppose the slip."""
    plate = Material(70e9, 0.33)
    pair = MaterialPair(Material(200e9, 0.3), plate, plane)
    problem = Problem(pair, 12e-3, 20e-6, 0.4)
    force, stress, n = 2e6, 5e7, CIRCLE.size
    system = System.build(problem, CIRCLE, force)
    kolosov = 3.0 - 4.0 * 0.33 if plane == "strain" else (3.0 - 0.33) / 1.33
    size = 12e-3 * 0.5 * (kolosov + 1.0) / (70e9 / 2.66) * stress
    moved = system.loads[:, SXY] * stress / system.scales.loads[SXY] * system.scales.displacement
    assert moved[:n] == pytest.approx(size * np.sin(2.0 * CIRCLE.theta), abs=1e-12 * size)
    assert moved[n:] == pytest.approx(-size * np.cos(2.0 * CIRCLE.theta), abs=1e-12 * size)


def test_gap_of_the_hole_is_that_of_the_columns_and_has_its_derivatives(titanium_in_aluminium):
    system = System.build(problem_of(titanium_in_aluminium, 0.3), CIRCLE, 1.0)
    load = np.zeros(len(LOADS))
    load[[SXX, SYY, SXY]] = 0.2, -0.1, 0.3
    gap, slope, curvature = hole_gap(system, load, CIRCLE.theta)
    assert gap == pytest.approx(0.3 + (system.loads @ load)[:NODES], abs=1e-15)
    step = 1e-3
    before, after = (hole_gap(system, load, CIRCLE.theta + turn) for turn in (-step, step))
    assert slope == pytest.approx((after[0] - before[0]) / (2.0 * step), abs=1e-5)
    assert curvature == pytest.approx((after[1] - before[1]) / (2.0 * step), abs=1e-5)


# --- a pin that shear alone pinches ---------------------------------------------------------------------------


@pytest.mark.parametrize("between", [0, 4])
def test_a_pin_that_only_remote_shear_pinches(titanium_in_aluminium, between):
    states = solve(problem_of(titanium_in_aluminium, 0.1), PINCHED, grid=CIRCLE, between=between)
    states = [state for state in states if state.fraction == 1.0]
    assert [state.in_contact for state in states] == [True, True, True, False, True, True]
    for state, angle in ((states[0], 0.75 * math.pi), (states[-1], 0.25 * math.pi)):  # where the hole closes
        assert len(state.contact) == 2
        middles = sorted(0.5 * (start + stop) % math.pi for start, stop in state.contact)
        assert middles == pytest.approx([angle, angle], abs=1e-3)


# --- other ways to the same numbers -------------------------------------------------------------------------


@pytest.mark.gate
def test_the_singular_equations_hold(titanium_in_aluminium):
    problem = problem_of(titanium_in_aluminium, 0.3)
    worst = []
    for nodes in (101, 401):
        grid = Grid.arc(BOTTOM - 1.3, BOTTOM + 1.3, nodes)
        state = solve(problem, [{"P": 1.0}, {"Q": 0.2, "sxx": 0.1, "sxy": 0.12}], grid=grid)[-1]
        worst.append(residuals_away(state, 0.15)[1])
    assert worst[1] < 3e-5
    assert worst[1] < 0.3 * worst[0]


def test_the_chosen_arc_holds_the_contact(titanium_in_aluminium):
    """The arc search sees the shear: contact edges are those of the whole circle."""
    problem = problem_of(titanium_in_aluminium, 0.3)
    corners = [{"P": 1.0}, {"sxy": 0.4}, {"sxy": -0.4}]
    chosen = solve(problem, corners, nodes=201)
    assert not chosen.grid.closed
    for one, two in zip(chosen, solve(problem, corners, grid=Grid.circle(480)), strict=True):
        assert np.ravel(one.contact) == pytest.approx(np.ravel(two.contact), abs=5e-3)
    pinched = solve(problem_of(titanium_in_aluminium, 0.1), PINCHED, nodes=120)
    assert pinched.grid.closed


# --- files, tables, figures ---------------------------------------------------------------------------------

CASE = (
    JOINT
    + """
[[load]]
P = 1e6
[[load]]
mean = { P = 1e6 }
amplitude = { sxy = 2e7, Q = 1e5 }
phase = { sxy = 90 }
points = 4
repeat = 2
[[load]]
csv = "shear.csv"
[solve]
nodes = 61
"""
)


@pytest.fixture
def case(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "shear.csv").write_text("sxy, P\n1e7, \n-1e7, 9e5\n")
    return read_case(tmp_path / "case.toml")


@pytest.mark.gate
def test_case_file_table_summary_and_figure(case):
    shear = case.history.values()[:, SXY]
    assert shear == pytest.approx([0.0, 0.0, -2e7, 0.0, 2e7, 0.0, -2e7, 0.0, 2e7, 0.0, 1e7, -1e7], abs=1e-6)
    result = solve(case.problem, case.history, **case.options.keywords())
    columns = {name: (unit, cells) for name, unit, cells in load_columns(case.problem, [s.load for s in result])}
    assert columns["sxy"][0] == "MPa"
    assert columns["sxy"][1][-2:] == ["10", "-10"]
    found = document(case, result)
    assert found["history"]["loads"][SXY] == "sxy"
    assert found["states"][-1]["load"]["sxy"] == -1e7
    (legend,) = plot_tractions(result[-2:]).legends
    assert legend.get_texts()[1].get_text() == "12:  P = 0.9 MN/m,  sxy = −10 MPa"


def test_result_file(case, tmp_path):
    result = solve(case.problem, case.history, **case.options.keywords())
    fastpin.record(case.problem, case.history, tmp_path / "case.h5", **case.options.keywords())
    loaded = fastpin.load(tmp_path / "case.h5")
    assert [state.load for state in loaded] == [state.load for state in result]
    assert np.array_equal(loaded.history.values(), case.history.values())


def test_older_files_have_no_shear():
    assert all_loads(np.ones((2, 6)), 0.0)[:, SXY].tolist() == [0.0, 0.0]
    assert np.isnan(all_loads(np.ones((2, 6)), np.nan)[:, SXY]).all()


def test_no_contact_without_pinching(titanium_in_aluminium):
    state = solve(problem_of(titanium_in_aluminium, 0.3), [{"sxy": 0.2}], grid=CIRCLE)[-1]
    assert np.all(state.status == OPEN)
    assert state.gap.min() > 0.0
