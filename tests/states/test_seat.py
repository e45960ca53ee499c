"""The stress of the plate at the seat of a bush: closed forms, depths, peaks, fatigue and words."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin import InputError, Material, MaterialPair, Points, Problem, solve
from fastpin.bodies import Bushing, Plate, Ring
from fastpin.damage import fatigue, fatigue_at_distance
from fastpin.lugs import Lug
from fastpin.model import FatigueConstants
from fastpin.report.states import hoop_line
from fastpin.report.stress import depth_curves, field_curves, hoop_curves
from fastpin.states.quantities import QUANTITIES, values
from tests.support.lugs import disc
from tests.support.refusals import refused
from tests.support.ring_compliance import held_ring

STEEL = Material(210e9, 0.3)
BRONZE = Material(103e9, 0.34)
ALUMINIUM = Material(71.7e9, 0.33)
PAIR = MaterialPair(STEEL, ALUMINIUM)
R, SEAT = 10e-3, 12.5e-3
BUSH = Bushing(BRONZE, SEAT, 30e-6)
INSIDES = {
    "plate": Plate(),
    "reaction": Plate((0.0, 0.05)),
    "held": Ring(0.03),
    "half": Ring(0.03, "half"),
    "uniform": Ring(0.025, "uniform"),
}
REMOTE = {"sxx": 20e6, "sxy": 5e6}
THETA = np.linspace(-3.0, 3.0, 50)


def joint(bush=BUSH, pair=PAIR, clearance=20e-6):
    return Problem(pair, R, clearance, 0.3, plate_body=bush)


def loaded(name, nodes=201, bush=BUSH):
    load = {"P": 1e6, "Q": 3e5} | ({} if name == "held" else REMOTE)
    return solve(joint(replace(bush, inside=INSIDES[name])), [{"P": 1e6}, load], nodes=nodes)[-1]


# --- stresses --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["plate", "half"])
def test_without_load_the_seat_has_the_stress_of_a_pressed_ring(name):
    """Lame: the pressure widens the plate's own hole."""
    problem = joint(replace(BUSH, inside=INSIDES[name]), clearance=40e-6)
    pressure = problem.press_fit_pressure
    state = solve(problem, [{"P": 1e-3}], nodes=101)[-1]
    q = 0.0 if name == "plate" else (SEAT / 0.03) ** 2
    stress = state.stress(Points.at_depth(0.0, THETA), "seat")
    assert pressure > 1e7
    assert stress.radial == pytest.approx(-pressure, rel=1e-7)
    assert stress.hoop == pytest.approx(pressure * (1.0 + q) / (1.0 - q), rel=1e-7)
    assert state.peak_hoop_stress("seat").assembly == pytest.approx(pressure * (1.0 + q) / (1.0 - q), rel=1e-12)


@pytest.mark.parametrize("name", INSIDES)
def test_the_seat_is_the_limit_of_points_in_the_plate(name):
    state = loaded(name)
    seat = state.hoop_stress("seat", THETA)
    size = np.abs(seat).max()
    for depth, most in ((1e-5, 4e-3), (1e-7, 4e-5), (1e-9, 4e-7)):
        beyond = state.stress(Points.at_radius(SEAT + depth, THETA)).hoop
        assert np.abs(beyond - seat).max() < most * size
    # the tractions of bush and plate are equal there
    stress, bush = state.stress(Points.at_depth(0.0, THETA), "seat"), state.stress(Points.at_radius(SEAT, THETA))
    assert stress.radial == pytest.approx(bush.radial, abs=1e-7 * size)
    assert stress.shear == pytest.approx(bush.shear, abs=1e-7 * size)
    assert stress.axial == pytest.approx(0.33 * (stress.radial + stress.hoop), rel=1e-12)


@pytest.mark.parametrize("name", ["plate", "half"])
def test_peaks_at_the_seat_converge(name):
    peaks = [loaded(name, nodes).peak_hoop_stress("seat") for nodes in (201, 401)]
    assert all(peak.resolved for peak in peaks)
    assert peaks[0].value == pytest.approx(peaks[1].value, rel=2e-4)


def test_a_bush_of_the_plates_material_does_not_disturb_the_plate():
    """Without a press fit the joint is a plain plate, and the stress at the seat that of the plate at this radius."""
    bush = Bushing(ALUMINIUM, SEAT)
    state = solve(joint(bush), [{"P": 1e6, **REMOTE}], nodes=201)[-1]
    plain = solve(Problem(PAIR, R, 20e-6, 0.3), [{"P": 1e6, **REMOTE}], nodes=201)[-1]
    expected = plain.stress(Points.at_radius(SEAT, THETA)).hoop
    assert state.hoop_stress("seat", THETA) == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


def test_parts_of_the_peak_at_the_seat():
    state = loaded("uniform")
    peak = state.peak_hoop_stress("seat")
    whole = peak.kt_bearing_part * peak.bearing_stress + peak.kt_bypass_part * peak.gross_stress + peak.assembly
    assert whole == pytest.approx(peak.value, rel=1e-13)
    assert peak.bearing_stress == pytest.approx(math.hypot(1e6, 3e5) / (2.0 * SEAT))
    assert peak.net_stress == pytest.approx(math.hypot(1e6, 3e5) / (2.0 * (0.025 - SEAT)))
    assert peak.value == pytest.approx(state.hoop_stress("seat").max(), rel=1e-2)


def test_bodies_that_are_not_there_are_refused():
    plain = solve(Problem(PAIR, R, 20e-6, 0.3), [{"P": 1e6}], nodes=101)[-1]
    words = 'body: "seat" is the edge of the plate round a bush; this plate has no bush'
    for call in (plain.hoop_stress, plain.peak_hoop_stress, lambda body: fatigue([plain, plain], "crossland", body)):
        assert str(refused(call, "seat")) == words
    rigid_plate = joint(replace(BUSH, interference=0.0), MaterialPair(STEEL, Material.rigid()))
    rigid = solve(rigid_plate, [{"P": 1e6}], nodes=101)
    with pytest.raises(InputError, match="the plate round the bush is rigid: its stress is not determined"):
        rigid[-1].hoop_stress("seat")
    assert math.isnan(values(rigid[-1])["peak_hoop_seat"])
    with pytest.raises(InputError, match=r"must be at least the seat's radius of 0\.0125 in the seat"):
        loaded("plate").stress(Points.at_radius(0.012, 0.0), "seat")


# --- quantities, words, curves ---------------------------------------------------------------------------------


def test_quantities_and_words_of_the_seat():
    state = loaded("half")
    peak, found = state.peak_hoop_stress("seat"), values(state)
    assert found["peak_hoop_seat"] == peak.value > 0.0
    assert found["peak_hoop_seat_angle"] == peak.angle
    assert {"peak_hoop_seat", "peak_hoop_seat_angle", "kt_net"} <= set(QUANTITIES)
    line = hoop_line(state.problem, [state], "seat")
    words = "largest hoop stress of the plate at the seat in all kept states:"
    assert line.startswith(f"{words} {peak.value / 1e6:.4g} MPa")
    pressed = solve(joint(), [{"P": 1e6}], nodes=101)[-1]
    line = hoop_line(pressed.problem, [pressed], "seat")
    peak = pressed.peak_hoop_stress("seat")
    parts = f"it is {peak.assembly / 1e6:.4g} MPa of the assembly + {peak.loads / 1e6:.4g} MPa of the loads"
    assert line.endswith(f"; {parts}; Kt of the loads {peak.loads / peak.bearing_stress:.4g} on the bearing stress")
    plain = solve(Problem(PAIR, R, 20e-6, 0.3), [{"P": 1e6}], nodes=101)[-1]
    assert hoop_line(plain.problem, [plain], "seat") == ""
    assert math.isnan(values(plain)["peak_hoop_seat"])


@pytest.mark.gate
def test_error_bars_of_the_seat():
    state = solve(joint(), [{"P": 1e6}], nodes=201, error_bars=True)[-1]
    fine = solve(joint(), [{"P": 1e6}], nodes=801)[-1]
    bar = state.error_bars["peak_hoop_seat"]
    assert abs(state.peak_hoop_stress("seat").value - fine.peak_hoop_stress("seat").value) <= bar < 1e6


def test_curves_of_the_seat():
    state = loaded("uniform")
    assert [curve.parameters["body"] for curve in hoop_curves([state])] == ["plate", "seat", "pin"]
    (curve,) = depth_curves([state], "seat", angle=0.0, depth=1.25)
    hoop = curve.columns["hoop stress [Pa]"]
    ends = state.stress(Points.at_radius([SEAT, 0.025], -0.5 * math.pi), "seat").hoop
    assert (hoop[0], hoop[-1]) == pytest.approx(tuple(ends), rel=1e-9)
    with pytest.raises(InputError, match=r"at most 1.25 radii, the wall of the seat"):
        depth_curves([state], "seat", depth=1.3)
    assert [curve.parameters["body"] for curve in field_curves(state, fineness=3)] == ["plate", "pin"]


# --- stress concentrations -------------------------------------------------------------------------------------


def test_the_net_section_of_a_ring():
    """Handbooks of lugs: the force over (W - D) t."""
    state = solve(Problem(PAIR, R, 20e-6, 0.3, plate_body=Ring(0.025, "half")), [{"P": 1e6}], nodes=201)[-1]
    peak = state.peak_hoop_stress()
    assert peak.kt_net == pytest.approx(peak.value / (1e6 / (0.05 - 0.02)), rel=1e-9)
    assert peak.kt_net == pytest.approx(1.5 * peak.kt_bearing, rel=1e-12)
    assert f"Kt {peak.kt_net:.4g} on the net-section stress" in hoop_line(state.problem, [state])
    assert math.isnan(state.peak_hoop_stress("pin").kt_net)
    plain = solve(Problem(PAIR, R, 20e-6, 0.3), [{"P": 1e6}], nodes=101)[-1]
    assert math.isnan(plain.peak_hoop_stress().kt_net)
    ring = held_ring(3.0, 8, PAIR.plate.nu)
    outline = Lug(PAIR.plate.nu, PAIR.plane, R, disc(3.0 * R), {"rim": "both"}, net_section=0.03).document()
    lug = replace(ring, hole_radius=R, plane=PAIR.plane, outline=json.dumps(outline))
    for body, width in ((lug, 0.03), (replace(lug, outline=""), math.inf)):
        peak = solve(Problem(PAIR, R, 20e-6, 0.3, plate_body=body), [{"P": 1e6}], nodes=101)[-1].peak_hoop_stress()
        assert peak.net_stress == pytest.approx(1e6 / width)


def test_the_loads_are_concentrated_in_a_compressed_bush():
    state = solve(joint(), [{"P": 1e5}], nodes=101)[-1]
    peak = state.peak_hoop_stress()
    assert peak.value < 0.0 < peak.loads
    assert peak.kt_bearing == peak.loads / peak.bearing_stress


def test_rounding_is_no_nominal_stress():
    """An interference fit without a force: the resultant of its tractions is rounding."""
    state = solve(Problem(PAIR, R, -20e-6, 0.3), [{"P": 0.0, "M": 10.0}], nodes=101)[-1]
    peak = state.peak_hoop_stress()
    assert peak.value > 1e7
    assert math.isnan(peak.kt_bearing)
    assert "Kt" not in hoop_line(state.problem, [state])


# --- fatigue ---------------------------------------------------------------------------------------------------

OF_BUSH = FatigueConstants(bending_limit=150e6, torsion_limit=90e6, threshold_range=1e6, limit_range=2e8)
OF_PLATE = FatigueConstants(
    bending_limit=160e6, torsion_limit=100e6, threshold_range=2e6, limit_range=1e8,
    fatigue_strength=1317e6, strength_exponent=-0.126, fatigue_ductility=0.19, ductility_exponent=-0.52,
)  # fmt: skip


def cycle(interference=30e-6):
    bush = Bushing(replace(BRONZE, fatigue=OF_BUSH), SEAT, interference)
    problem = joint(bush, MaterialPair(STEEL, replace(ALUMINIUM, fatigue=OF_PLATE)))
    return solve(problem, [{"P": 4e6}, {"P": 5e5}, {"P": 4e6}], nodes=101).states[1:]


def test_fatigue_of_the_seat_takes_the_constants_of_the_plate():
    states = cycle()
    seat, bore = fatigue(states, "smith-watson-topper", "seat"), fatigue(states, "smith-watson-topper")
    assert bore.life is None
    assert seat.hot_spot.life == pytest.approx(seat.life.min(), rel=1e-7)  # of equal places the rightmost
    assert seat.life.min() < math.inf
    assert seat.parameter.max() > 1e4
    # the same points by their radius, in the plate
    points = Points.at_radius(SEAT * (1.0 + 1e-9), seat.theta)
    beyond = fatigue(states, "smith-watson-topper", points=points)
    assert beyond.parameter == pytest.approx(seat.parameter, rel=1e-6)
    assert np.log(beyond.life) == pytest.approx(np.log(seat.life), rel=1e-6)
    assert fatigue(states, "crossland", "seat").limit != fatigue(states, "crossland").limit


def test_points_in_bush_and_plate_take_their_own_constants():
    states = cycle()
    points = Points.at_radius([[0.0105], [0.0125], [0.0126]], [0.0, 1.0])
    found = fatigue(states, "crossland", points=points)
    inner, outer = (fatigue(states, "crossland", points=Points.at_radius(r, 0.0)) for r in (0.0105, 0.0126))
    assert np.asarray(found.limit).tolist() == [[inner.limit] * 2, [inner.limit] * 2, [outer.limit] * 2]
    assert found.parameter[0, 0] == inner.parameter
    assert found.parameter[2, 0] == outer.parameter
    assert found.margin[2, 0] == outer.margin
    swt = fatigue(states, "smith-watson-topper", points=points)
    assert np.isnan(swt.life).tolist() == [[True] * 2, [True] * 2, [False] * 2]


def test_a_compressed_bore_has_no_hot_spot():
    """Rounding in the free surface is no tension."""
    found = fatigue(cycle(60e-6), "smith-watson-topper", constants=OF_PLATE)
    spot = found.hot_spot
    assert not found.parameter.any()
    assert spot.parameter == 0.0
    assert spot.life == math.inf
    assert math.isnan(spot.theta)
    assert repr(found) == "<Fatigue of the plate, smith-watson-topper: the parameter is 0 everywhere>"
    error = refused(fatigue_at_distance, cycle(60e-6), "smith-watson-topper", constants=OF_PLATE, length=1e-5)
    words = "theta: must be given: the edge has no hot spot, the parameter is 0 everywhere: no crack is expected"
    assert str(error) == words


@pytest.mark.parametrize("method", ["point", "line", "area"])
def test_critical_distances_count_from_the_seat(method):
    states = cycle()
    short = fatigue_at_distance(states, "smith-watson-topper", method, "seat", theta=0.3, length=1e-9)
    edge = fatigue(states, "smith-watson-topper", "seat", points=Points.at_depth(0.0, 0.3))
    assert short.parameter == pytest.approx(edge.parameter, rel=1e-6)
    found = fatigue_at_distance(states, "smith-watson-topper", method, "seat", theta=0.3)
    if method == "point":  # L of the plate's own constants
        depth = 0.5 * (2e6 / 1e8) ** 2 / math.pi
        assert float(found.depth) == pytest.approx(depth)
        inside = fatigue(states, "smith-watson-topper", points=Points.at_radius(SEAT + depth, 0.3))
        assert found.parameter == pytest.approx(inside.parameter, rel=1e-9)


def test_a_seat_of_another_class_is_refused():
    state = loaded("plate", nodes=61)
    assert str(refused(replace, state, seat=1.0)) == "seat: must be a State, not 1.0"
