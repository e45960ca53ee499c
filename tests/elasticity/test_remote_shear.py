"""Remote shear stress sxy as a load, (T16).

Pure shear sxy = s is sxx = s, syy = -s in axes turned by 45 degrees. On a whole circle of 240 nodes 45 degrees are 30
nodes. So all tractions must agree node by node.
"""

import math

import numpy as np
import pytest

import fastpin
from fastpin.casefile.reader import read_case
from fastpin.elasticity.system import System
from fastpin.figures.tractions import plot_tractions
from fastpin.kernels.status import OPEN
from fastpin.model.angles import BOTTOM
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS, SXX, SXY, SYY
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.report.case import load_columns
from fastpin.report.summary import document
from fastpin.solver.rest import hole_gap
from fastpin.solver.solving import solve
from fastpin.storage.layout import all_loads
from tests.support.checks.integral_equations import residuals_away
from tests.support.once import solve_once
from tests.support.samples import JOINT
from tests.support.tiers import gate

NODES = 240
CIRCLE = Grid.circle(NODES, -1.5 * math.pi)
REVERSALS = [
    {"P": 1.0},
    {"sxy": 0.15, "Q": 0.1},
    {"sxy": -0.15, "sxx": 0.05},
    {"Q": -0.15, "syy": -0.08},
    {"sxy": 0.1, "P": 0.6},
    {"sxy": -0.05, "P": 0.9},
]
PINCHED = [{"sxy": 0.8}, {"sxy": 1.2}, {"sxy": 0.5}, {"sxy": 0.0}, {"sxy": -1.0}, {"sxy": -0.6}]


def in_turned_axes(corner):
    """The same loads, turned counter-clockwise by an eighth of a turn."""
    force = complex(corner.get("Q", 0.0), -corner.get("P", 0.0)) * complex(math.sqrt(0.5), math.sqrt(0.5))
    total = corner.get("sxx", 0.0) + corner.get("syy", 0.0)
    oval = complex(corner.get("sxx", 0.0) - corner.get("syy", 0.0), 2.0 * corner.get("sxy", 0.0)) * 1j
    stresses = {"sxx": 0.5 * (total + oval.real), "syy": 0.5 * (total - oval.real), "sxy": 0.5 * oval.imag}
    kept = {name: corner[name] for name in ("M", "rotation") if name in corner}
    return {"P": -force.imag, "Q": force.real, **stresses, **kept}


def whole_corners(corners):
    """The corners with all loads that ever act, so that they can be turned."""
    names = [name for name in LOADS if any(name in corner for corner in corners)]
    values = LoadHistory(corners).values()
    return [{name: float(row[LOADS.index(name)]) for name in names} for row in values]


def turned_difference(problem, corners, **options):
    """Largest difference of tractions and gap, over the peak, between a run and the run of the turned joint."""
    corners, nodes = whole_corners(corners), NODES // 8
    one = solve_once(problem, corners, grid=CIRCLE, **options)
    two = solve(problem, [in_turned_axes(corner) for corner in corners], grid=CIRCLE, **options)
    assert len(one) == len(two)
    worst, contacts = 0.0, 0
    peak = max(state.peak_pressure for state in one)
    gap = max(float(np.abs(state.gap).max()) for state in one)
    for first, second in zip(one, two, strict=True):
        contacts += int(first.in_contact)
        for name, size in (("pressure", peak), ("shear", peak), ("gap", gap)):
            difference = np.roll(getattr(first, name), nodes) - getattr(second, name)
            worst = max(worst, float(np.abs(difference).max()) / size)
        worst = max(worst, abs(first.rotation - second.rotation), abs(first.dissipation - second.dissipation))
    assert contacts > 0
    return worst


def mirrored(corner):
    """The loads in a mirror, theta -> -pi - theta."""
    return {name: -value if name in ("Q", "M", "rotation", "sxy") else value for name, value in corner.items()}


def mirror_difference(problem, corners, **options):
    """Largest difference of tractions, over the peak, between a run and its mirror image."""
    one = solve_once(problem, whole_corners(corners), grid=CIRCLE, **options)
    two = solve(problem, [mirrored(corner) for corner in corners], grid=CIRCLE, **options)
    image = -np.arange(NODES) % NODES  # the node at -pi - theta
    away = CIRCLE.theta[image] + math.pi + CIRCLE.theta
    assert np.abs(away - 2.0 * math.pi * np.round(away / (2.0 * math.pi))).max() < 1e-12
    peak = max(state.peak_pressure for state in one)
    worst = 0.0
    for first, second in zip(one, two, strict=True):
        worst = max(worst, float(np.abs(first.pressure[image] - second.pressure).max()) / peak)
        worst = max(worst, float(np.abs(first.shear[image] + second.shear).max()) / peak)
        worst = max(worst, abs(first.rotation + second.rotation))
    return worst


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


# --- turned by 45 degrees, and in a mirror ------------------------------------------------------------------


@pytest.mark.parametrize("method", [{}, *gate({"method": "increment", "increments": 8})], ids=["path", "increment"])
@pytest.mark.parametrize(("pin_load", "rotation"), [("body", "free"), ("centre", "free"), ("centre", "fixed")])
@pytest.mark.parametrize("parameter", [0.3, 0.0, -0.05], ids=["loose", "neat", "interference"])
def test_turned_by_an_eighth(titanium_in_aluminium, parameter, pin_load, rotation, method):
    problem = problem_of(titanium_in_aluminium, parameter, pin_load, rotation)
    corners = [{"P": 1.0, "sxy": 0.1}, *REVERSALS[1:]] if parameter == 0.0 else REVERSALS
    if rotation == "fixed":
        corners = [*corners[:2], {**corners[2], "rotation": 0.02}, *corners[3:]]
    assert turned_difference(problem, corners, **method) < 1e-10


@pytest.mark.parametrize("between", [0, 4])
def test_a_pin_that_only_remote_shear_pinches(titanium_in_aluminium, between):
    problem = problem_of(titanium_in_aluminium, 0.1)
    assert turned_difference(problem, PINCHED, between=between) < 1e-10
    states = solve_once(problem, whole_corners(PINCHED), grid=CIRCLE)
    assert [state.in_contact for state in states] == [True, True, True, False, True, True]
    for state, angle in ((states[0], 0.75 * math.pi), (states[-1], 0.25 * math.pi)):  # where the hole closes
        assert len(state.contact) == 2
        middles = sorted(0.5 * (start + stop) % math.pi for start, stop in state.contact)
        assert middles == pytest.approx([angle, angle], abs=1e-3)


def test_stress_before_force_and_release(titanium_in_aluminium):
    """The pin comes to rest on a hole that shear has deformed, also on two points, and is let go again."""
    problem = problem_of(titanium_in_aluminium, 0.2)
    for stress in (0.1, 0.5, -0.5):
        corners = [{"sxy": stress}, {"P": 0.6, "Q": 0.2}, {"P": 0.0, "Q": 0.0}, {"P": 0.5}, {"sxy": 0.0}]
        assert turned_difference(problem, corners) < 1e-10


@pytest.mark.parametrize("parameter", [0.3, 0.0, -0.05], ids=["loose", "neat", "interference"])
@pytest.mark.parametrize(("pin_load", "rotation"), [("body", "free"), ("centre", "fixed")])
def test_mirror(titanium_in_aluminium, parameter, pin_load, rotation):
    problem = problem_of(titanium_in_aluminium, parameter, pin_load, rotation)
    corners = [{"P": 1.0, "sxy": 0.1}, *REVERSALS[1:]] if parameter == 0.0 else REVERSALS
    assert mirror_difference(problem, corners) < 1e-10


def test_mirror_of_a_pinched_pin(titanium_in_aluminium):
    assert mirror_difference(problem_of(titanium_in_aluminium, 0.1), PINCHED) < 1e-10


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
