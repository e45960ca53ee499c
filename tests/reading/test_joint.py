"""The displacement of a joint, and the interface between bush and plate."""

import math

import numpy as np
import pytest

from fastpin import Material, MaterialPair, Problem, State, solve
from fastpin.bodies import Bushing, Plate, Ring, Tube
from fastpin.reading import BushFit
from fastpin.states import QUANTITIES
from tests.support.refusals import refused

LIKE = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
BODIES = {
    "solid pin, plate": {},
    "tube, plate": {"pin_body": Tube(0.5)},
    "tube under a body force, ring": {"pin_body": Tube(0.4, "body"), "plate_body": Ring(2.0, "uniform")},
    "solid pin, held ring": {"plate_body": Ring(3.0, "held")},
    "tube, half ring": {"pin_body": Tube(0.6, "normal"), "plate_body": Ring(2.5, "half")},
    "bush in a ring": {"plate_body": Bushing(Material(2.0, 0.25), 1.3, inside=Ring(2.5, "shear"))},
    "bush in a plate": {"pin_body": Tube(0.5, "shear"), "plate_body": Bushing(Material(2.0, 0.25), 1.3)},
}
STEEL, BRONZE, ALUMINIUM = Material(210e9, 0.3), Material(110e9, 0.34), Material(69e9, 0.33)


def problem(name: str, friction: float = 0.0, **fields) -> Problem:
    return Problem.from_load_parameter(LIKE, 0.1, friction, **BODIES[name], **fields)


@pytest.mark.parametrize("name", list(BODIES))
def test_the_displacement_of_the_joint_can_be_prescribed(name):
    """Without friction the same displacement gives the same force. It counts from the concentric position there."""
    pushed = solve(problem(name), [{"P": 1.0}], nodes=101)
    moved = pushed[-1].joint_displacement()["uy"] - 0.1  # the pin rested on the bottom of the hole, 0.1 lower
    driven = solve(problem(name, drive="uy"), [{"uy": moved}], grid=pushed.grid)
    assert driven[-1].load["P"] == pytest.approx(1.0, abs=2e-10)
    assert driven[-1].joint_displacement()["uy"] == pytest.approx(moved, abs=1e-12)
    assert driven[-1].pressure == pytest.approx(pushed[-1].pressure, abs=1e-9)


@pytest.mark.parametrize("name", list(BODIES))
def test_rim_to_rim_the_displacement_is_that_of_the_pin(name):
    state = solve(problem(name, 0.3), [{"P": 1.0}, {"Q": 0.2}], nodes=101)[-1]
    found = state.joint_displacement(hub_radius=1.0, gauge_radius=1.0)
    assert found["ux"] == pytest.approx(state.dx, abs=1e-13)
    assert found["uy"] == pytest.approx(state.dy, abs=1e-13)


def test_the_gauge_passes_from_the_bush_to_the_ring_without_a_jump():
    state = solve(problem("bush in a ring", 0.3), [{"P": 1.0}], nodes=101)[-1]
    inside, outside = (state.joint_displacement(gauge_radius=1.3 * part)["uy"] for part in (1.0 - 1e-9, 1.0 + 1e-9))
    assert inside == pytest.approx(outside, abs=1e-8)
    assert state.joint_displacement(gauge_radius=2.5) == state.joint_displacement()


def test_a_bush_of_the_material_of_the_ring_changes_no_displacement():
    whole = Problem.from_load_parameter(LIKE, 0.1, 0.3, plate_body=Ring(2.5, "shear"))
    lined = Problem.from_load_parameter(LIKE, 0.1, 0.3, plate_body=Bushing(LIKE.plate, 1.3, inside=Ring(2.5, "shear")))
    one, two = (solve(each, [{"P": 1.0}, {"Q": 0.2}], nodes=101)[-1] for each in (whole, lined))
    for gauge in (None, 1.0, 1.2, 1.7, 2.5):
        first, second = one.joint_displacement(gauge_radius=gauge), two.joint_displacement(gauge_radius=gauge)
        assert first == pytest.approx(second, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "radii", "sentence"),
    [
        ("tube, plate", {"hub_radius": 0.4}, "hub_radius: must lie between 0.5 and 1, not 0.4"),
        ("tube, plate", {"hub_radius": 1.1}, "hub_radius: must lie between 0.5 and 1, not 1.1"),
        ("solid pin, held ring", {"gauge_radius": 3.1}, "gauge_radius: must lie between 1 and 3, not 3.1"),
        ("solid pin, held ring", {"gauge_radius": 0.9}, "gauge_radius: must lie between 1 and 3, not 0.9"),
        ("bush in a ring", {"gauge_radius": math.nan}, "gauge_radius: must be a finite number, not nan"),
    ],
)
def test_a_circle_outside_its_body_is_refused(name, radii, sentence):
    state = solve(problem(name), [{"P": 1.0}], nodes=41)[-1]
    assert str(refused(state.joint_displacement, **radii)) == sentence


# -- the interface of a bush ----------------------------------------------------------------------------------


def bushed(interference: float = 0.0) -> State:
    body = Bushing(BRONZE, 1.25, interference)
    pair = MaterialPair(STEEL, ALUMINIUM)
    clearance = 0.1
    if interference:  # the same clearance after the press fit
        clearance += 0.1 - Problem.from_load_parameter(pair, 0.1, 0.2, "body", plate_body=body).assembled_clearance
    problem = Problem.from_load_parameter(pair, clearance, 0.2, "body", plate_body=body)
    assert problem.assembled_clearance == pytest.approx(0.1, abs=1e-14)
    return solve(problem, [{"P": 1.0}], nodes=801)[-1]


@pytest.mark.gate
def test_the_interface_of_case_a10():
    """Table A of a trial of these formulas: the interface carries -0.07299 to 0.46486, and shear up to 0.06845."""
    fit = bushed().bush_fit()
    assert (fit.theta[0], fit.theta[720]) == pytest.approx((-1.5 * math.pi, -0.5 * math.pi), abs=1e-12)
    assert fit.pressure.min() == pytest.approx(-0.07299, abs=1e-5)
    assert fit.pressure.max() == pytest.approx(0.46486, abs=1e-5)
    assert np.abs(fit.shear).max() == pytest.approx(0.06845, abs=1e-5)
    assert fit.press_fit_pressure == 0.0
    assert fit.open_margin == fit.pressure.min()
    assert fit.pressure_to_close == pytest.approx(0.0730, abs=1e-4)
    assert math.isnan(fit.slip_margin)
    assert math.isnan(fit.slip_angle)
    assert math.isnan(fit.pressure_to_stick)
    assert fit.least_friction == math.inf
    for friction, needed in ((0.1, 0.744), (0.2, 0.403), (0.3, 0.290)):
        assert bushed().bush_fit(friction).pressure_to_stick == pytest.approx(needed, abs=5e-4)


@pytest.mark.gate
def test_the_press_fit_holds_the_bush():
    body = Bushing(BRONZE, 1.25, 1.0)
    unit = Problem.from_load_parameter(MaterialPair(STEEL, ALUMINIUM), 0.1, 0.2, plate_body=body).press_fit_pressure
    bare, pressed = bushed().bush_fit(), bushed(0.5 / unit).bush_fit(0.2)
    assert pressed.press_fit_pressure == pytest.approx(0.5, rel=1e-12)
    assert pressed.pressure == pytest.approx(bare.pressure + 0.5, abs=1e-9)
    assert pressed.shear == pytest.approx(bare.shear, abs=1e-9)
    assert pressed.friction == 0.2
    assert pressed.slip_margin == pytest.approx(0.5 - 0.403, abs=5e-4)
    assert pressed.pressure_to_stick == pytest.approx(0.403, abs=5e-4)
    assert 0.1 < pressed.least_friction < 0.2
    exact = bushed(0.5 / unit).bush_fit(pressed.least_friction)
    assert exact.slip_margin == pytest.approx(0.0, abs=1e-12)
    assert not -0.5 * math.pi - 1.2 < pressed.open_angle < -0.5 * math.pi + 1.2
    assert pressed.slip_angle <= 0.5 * math.pi


def test_without_friction_an_interface_sticks_where_it_has_no_shear():
    theta, pressure = np.array([-2.0, -1.0, 0.0]), np.array([0.3, 0.2, 0.1])
    free = BushFit(theta, pressure, np.zeros(3), 0.0, 0.0)
    assert (free.slip_margin, free.slip_angle) == (0.1, 0.0)
    sheared = BushFit(theta, pressure, np.array([0.0, 0.01, 0.0]), 0.0, 0.0)
    assert (sheared.slip_margin, sheared.slip_angle) == (-math.inf, -1.0)


def test_a_press_fit_is_lame_s():
    """delta/c = 1e-3 gives p = 4.70702e-4 G and moves the inner rim by -8.62954e-4 R, for the bush of case A10."""
    pair = MaterialPair(STEEL, ALUMINIUM)
    problem = Problem(pair, 0.01, 1e-4, 0.2, plate_body=Bushing(BRONZE, 0.0125, 0.0125e-3))
    assert problem.press_fit_pressure == pytest.approx(4.70702e-4 * BRONZE.shear_modulus, rel=2e-6)
    assert problem.assembled_clearance - problem.clearance == pytest.approx(-8.62954e-6, rel=2e-6)
    assert Problem(pair, 0.01, 1e-4, 0.2, plate_body=Bushing(BRONZE, 0.0125)).assembled_clearance == 1e-4


@pytest.mark.parametrize(
    ("body", "friction", "words"),
    [
        (Plate(), None, "plate_body: the plate has no bush: there is no interface"),
        (Ring(2.0), None, "plate_body: the plate has no bush: there is no interface"),
        (Bushing(BRONZE, 1.25), -0.1, "friction: must"),
    ],
)
def test_an_interface_needs_a_bush_and_a_friction(body, friction, words):
    state = solve(Problem.from_load_parameter(LIKE, 0.1, 0.0, plate_body=body), [{"P": 1.0}], nodes=41)[-1]
    assert str(refused(state.bush_fit, *([] if friction is None else [friction]))).startswith(words)


@pytest.mark.gate
def test_joint_and_bush_are_quantities_of_a_state():
    state = bushed()
    assert QUANTITIES["joint_uy"].of(state) == state.joint_displacement()["uy"] < 0.0
    assert QUANTITIES["joint_ux"].of(state) == pytest.approx(0.0, abs=1e-12)
    assert QUANTITIES["bush_open_margin"].of(state) == state.bush_fit().open_margin
    assert math.isnan(QUANTITIES["bush_slip_margin"].of(state))  # a bonded bush has no friction
    plain = solve(problem("solid pin, held ring"), [{"P": 1.0}], nodes=41)[-1]
    assert math.isnan(QUANTITIES["bush_open_margin"].of(plain))
