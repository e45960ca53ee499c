"""Stresses of solved states of hollow pins, rings, bushes, plates with a reaction and compliances."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from fastpin import InputError, Material, MaterialPair, Points, Problem, solve
from fastpin.bodies import Bushing, Compliance, Plate, Ring, Tube
from fastpin.damage import fatigue, fatigue_at_distance
from fastpin.model import FatigueConstants
from fastpin.report.states import hoop_line
from fastpin.report.stress import field_curves
from fastpin.verification.comparisons import stress_resultant
from tests.support.checks.stress_rows import strain_slip_difference
from tests.support.refusals import refused

UNLIKE = MaterialPair(Material(2.1, 0.3), Material(0.7, 0.2), "stress")
STRAIN = MaterialPair(Material(2.1, 0.3), Material(0.7, 0.2))
BRONZE = Material(1.5, 0.34)
BUSH = Bushing(BRONZE, 1.25, interference=0.3)
ARC = (-3.4, 0.26)


def compliance(nu=0.2):
    """A made-up compliance: the harmonics fall by a quarter."""
    rng, order = np.random.default_rng(5), 8
    harmonic = np.r_[0, 0, np.repeat(np.arange(1, order + 1), 4)]
    matrix = rng.normal(size=(harmonic.size, harmonic.size))
    matrix = 0.02 * (matrix @ matrix.T) * np.outer(0.25**harmonic, 0.25**harmonic)
    return Compliance(nu, "stress", 1.0, matrix, {"sxx": rng.normal(size=harmonic.size) * 0.3**harmonic})


BODIES = {
    "tube": {"pin_body": Tube(0.5)},
    "held tube": {"pin_body": Tube(0.8, "held")},
    "tube, body": {"pin_body": Tube(0.6, "body")},
    "held ring": {"plate_body": Ring(2.0)},
    "half ring": {"plate_body": Ring(2.0, "half")},
    "ring, body": {"plate_body": Ring(1.5, "body")},
    "reaction": {"plate_body": Plate((0.5, 3.0))},
    "bush": {"plate_body": BUSH},
    "compliance": {"plate_body": compliance()},
    "bush in a ring": {"plate_body": replace(BUSH, inside=Ring(2.2, "half"))},
    "both": {"pin_body": Tube(0.5, "shear"), "plate_body": replace(BUSH, inside=Plate((0.5, 3.0)))},
}


def problem(name, load_parameter=0.6, pair=UNLIKE, **options):
    return Problem.from_load_parameter(pair, load_parameter, 0.3, **BODIES[name], **options)


# --- strains, resultants ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", BODIES)
def test_hoop_strains_are_those_of_gap_and_slip(name):
    """With 201 nodes the differences are 4e-5 to 2.3e-4 of the largest slip, as for a solid pin in a plate."""
    case = problem(name)
    history = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}, {"Q": 0.1}]
    history[3] |= {"held ring": {}, "compliance": {"sxx": 0.05}}.get(name, {"sxx": 0.05, "sxy": 0.02})
    for state in solve(case, history, nodes=201, arc=ARC):
        assert strain_slip_difference(state) < 4e-4


@pytest.mark.parametrize("name", ["tube", "half ring", "bush", "both"])
def test_resultants_of_a_state(name):
    state = solve(problem(name), [{"P": 1.0, "Q": 0.2}], nodes=101, arc=ARC)[-1]
    for body, radius in (("plate", 1.2), ("plate", 1.7), ("pin", 0.7)):
        force, moment = stress_resultant(state, body, radius, 2000)
        assert force == pytest.approx(0.2 - 1.0j, abs=1e-12)
        assert moment == pytest.approx(0.0, abs=1e-12)


# --- components ------------------------------------------------------------------------------------------------


def test_axial_stress_takes_the_ratio_of_the_material_at_the_point():
    state = solve(problem("bush", pair=STRAIN), [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    radius = np.array([[1.0, 1.2, 1.25], [1.2500001, 1.5, 4.0]])
    found = state.stress(Points.at_radius(radius, -1.0))
    ratio = np.array([[0.34] * 3, [0.2] * 3])
    assert np.abs(found.axial).min() > 1e-3
    assert found.axial == pytest.approx(ratio * (found.radial + found.hoop), rel=1e-14)
    plane = solve(problem("bush"), [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    assert np.array_equal(plane.stress(Points.at_radius(radius, -1.0)).axial, np.zeros((2, 3)))


def test_the_press_fit_counts_without_any_contact():
    """Lame: the bore of a ring under pressure on its outer rim."""
    case = problem("bush")
    state = solve(case, [{"sxx": 1e-9}], nodes=101)[-1]
    assert not state.in_contact
    expected = -2.0 * case.press_fit_pressure / (1.0 - case.joint.seat_ratio**-2.0)
    assert expected < -0.1
    assert state.hoop_stress() == pytest.approx(expected, abs=1e-8)
    assert state.assembly_stress(Points.at_depth(0.0, [0.0, 2.0])).hoop == pytest.approx(expected, rel=1e-13)
    assert state.peak_hoop_stress().loads == pytest.approx(4e-9, rel=0.5)


# --- peaks -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["half ring", "bush", "bush in a ring", "tube"])
def test_parts_of_the_peak(name):
    state = solve(problem(name), [{"P": 1.0, "sxx": 0.1, "sxy": 0.03}], nodes=201, arc=ARC)[-1]
    case, peak = state.problem, state.peak_hoop_stress()
    whole = peak.kt_bearing_part * peak.bearing_stress + peak.kt_bypass_part * peak.gross_stress + peak.assembly
    assert whole == pytest.approx(peak.value, rel=1e-13)
    assert (peak.assembly < 0.0) == ("bush" in name)
    # far from contact, the remote stress alone
    alone = solve(case, [{"sxx": 1e-4, "sxy": 3e-5}], nodes=101)[-1]
    assert not alone.in_contact
    bypass = 1e3 * (alone.hoop_stress("plate", [peak.angle])[0] - peak.assembly)
    assert peak.bypass == pytest.approx(bypass, rel=1e-8)
    kirsch = 0.1 - 2.0 * (0.1 * math.cos(2.0 * peak.angle) + 0.06 * math.sin(2.0 * peak.angle))
    assert (abs(peak.bypass - kirsch) < 1e-12) == (name == "tube")
    pin = state.peak_hoop_stress("pin")
    assert (pin.bypass, pin.assembly) == (0.0, 0.0)
    assert pickle.loads(pickle.dumps(peak)) == peak


def test_the_report_tells_assembly_and_loads_apart():
    states = solve(problem("bush"), [{"P": 1.0, "sxx": 0.1}], nodes=101, arc=ARC)
    peak = states[-1].peak_hoop_stress()
    line = hoop_line(states[0].problem, states)
    assert (
        f"; it is {peak.assembly:.4g} F/R of the assembly + {peak.loads:.4g} F/R of the loads; Kt of the loads" in line
    )
    states = solve(problem("half ring"), [{"P": 1.0, "sxx": 0.1}], nodes=101, arc=ARC)
    line = hoop_line(states[0].problem, states)
    assert line.endswith(" x bearing stress")
    assert "assembly" not in line


# --- points outside --------------------------------------------------------------------------------------------


def refusal(case, points, body="plate"):
    state = solve(case, [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    return str(refused(state.stress, points, body))


def test_points_outside_are_refused():
    tube, ring, bush = problem("tube"), problem("half ring"), problem("bush in a ring")
    words = "radius: must be at least the bore radius of 0.5 in the pin"
    assert refusal(tube, Points.at_radius(0.49, 0.0), "pin") == words
    assert refusal(tube, Points.at_depth(0.51, 0.0), "pin") == "depth: must be at most the wall of 0.5 in the pin"
    assert refusal(ring, Points.at_xy(0.0, 2.1)) == "radius: must be at most the outer radius of 2 in the plate"
    assert refusal(ring, Points.at_depth(1.1, 0.0)) == "depth: must be at most the wall of 1 in the plate"
    words = "radius: must be at most the outer radius of 2.2 in the plate"
    assert refusal(bush, Points.at_radius([1.1, 2.3], 0.0)) == words
    assert refusal(ring, Points.at_depth(1.1, 0.0), "pin") == "depth: must be at most the radius of 1 in the pin"
    words = "points: the reaction acts at one of the points: the stress there is infinite"
    assert refusal(problem("reaction"), Points.at_xy([0.5, 2.0], [3.0, 2.0])) == words
    words = "points: a compliance gives the stress near the hole only, a file with the outline everywhere; here up to "
    assert refusal(problem("compliance"), Points.at_depth([0.0, 0.9], 0.0)).startswith(words)
    rigid = Problem.from_load_parameter(
        MaterialPair(Material(2.1, 0.3), Material.rigid()), 0.6, 0.3, plate_body=Bushing(BRONZE, 1.25)
    )
    words = "points: the plate round the bush is rigid: its stress is not determined"
    assert refusal(rigid, Points.at_radius(1.3, 0.0)) == words


def test_points_on_the_rims_are_taken():
    state = solve(problem("tube"), [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    theta = np.linspace(-3.0, 3.0, 9)
    bore = state.stress(Points.at_radius(0.5, theta), "pin", straight=True)
    assert state.stress(Points.at_depth(0.5, theta), "pin", straight=True).hoop == pytest.approx(bore.hoop, rel=1e-12)
    # on the bore the uniform traction P/(2 pi a) balances the contact
    assert bore.radial == pytest.approx(np.sin(theta) / np.pi, abs=1e-12)
    ring = solve(problem("ring, body"), [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    assert ring.stress(Points.at_radius(1.5, theta)).radial == pytest.approx(0.0, abs=1e-12)


def test_maps_end_at_the_rims():
    state = solve(problem("tube"), [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    (pin,) = field_curves(state, body="pin", fineness=5)
    radius = pin.columns["radius [R]"]
    assert (radius.min(), radius.max()) == pytest.approx((0.5, 1.0))
    state = solve(problem("ring, body"), [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    radius = field_curves(state, body="plate", fineness=5)[0].columns["radius [R]"]
    assert (radius.min(), radius.max()) == pytest.approx((1.0, 1.5))
    state = solve(problem("compliance"), [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    plate, _ = field_curves(state, fineness=5)
    assert plate.columns["radius [R]"].max() == pytest.approx(state.problem.plate_body.reach)


# --- fatigue ---------------------------------------------------------------------------------------------------


BRONZE_BUSH = Bushing(Material(1.5e11, 0.34), 0.0125)


def test_fatigue_takes_the_constants_of_the_bush():
    constants = FatigueConstants(bending_limit=5e8, torsion_limit=3e8)
    bush = Bushing(Material(1.5e11, 0.34, fatigue=constants), 0.0125, interference=1e-6)
    pair = MaterialPair(Material(2.1e11, 0.3), Material(0.7e11, 0.2))
    history = [{"P": 1e6}, {"Q": 2e5}, {"Q": -2e5}]
    states = solve(Problem(pair, 0.01, 3e-5, 0.3, plate_body=bush), history, nodes=101, arc=ARC)
    found = fatigue(states, "crossland")
    assert found.limit is not None
    assert fatigue(states, "crossland", points=Points.at_radius(0.0125, 0.0)).parameter.shape == ()
    error = refused(fatigue, states, "crossland", points=Points.at_radius([0.012, 0.013], 0.0))
    assert str(error) == "fatigue: crossland needs bending_limit, torsion_limit of the plate's material"
    bare = solve(Problem(pair, 0.01, 3e-5, 0.3, plate_body=BRONZE_BUSH), history, nodes=101, arc=ARC)
    with pytest.raises(InputError, match="crossland needs bending_limit, torsion_limit of the bush's material"):
        fatigue(bare, "crossland")
    error = refused(fatigue_at_distance, states, "crossland", "line", theta=-1.0, length=0.002)
    assert str(error) == "length: 0.002 reaches beyond the bush: a mean over two materials has no meaning"
    assert fatigue_at_distance(states, "crossland", "line", theta=-1.0, length=0.001).parameter > 0.0
