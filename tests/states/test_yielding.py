"""Warnings about von Mises stresses above yield strengths: closed forms of press fits, and states."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from fastpin import LoadHistory, Material, MaterialPair, Points, Problem, solve
from fastpin.bodies import Bushing, Disk, Plate, Ring, Tube
from fastpin.errors import InputWarning
from fastpin.model.doubts import EDGES, doubts, doubts_given
from fastpin.states import extremes
from fastpin.states.extremes import yield_doubts_of
from fastpin.states.yielding import Places, circles, von_mises_peak
from tests.support.bodies import softer_hole

R, SEAT = 10e-3, 12.5e-3
STEEL, BRONZE, ALUMINIUM = Material(210e9, 0.3), Material(103e9, 0.34), Material(71e9, 0.33)
BUSH = Bushing(BRONZE, SEAT, 30e-6)
AROUND = np.linspace(-3.0, 3.0, 9)


PLATES = {
    "plate": Plate(),
    "half": Ring(0.02, "half"),
    "held": Ring(0.02),
    "bush": BUSH,
    "bush in a ring": replace(BUSH, inside=Ring(0.025)),
    "compliance": softer_hole(R, 0.33, "strain"),
}
PINS = {"disk": Disk(), "tube": Tube(5e-3), "held": Tube(5e-3, "held")}


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("plate", PLATES)
@pytest.mark.parametrize("pin", PINS)
def test_closed_forms_of_press_fits_are_the_stresses_of_an_unloaded_state(pin, plate, plane):
    """Pin and hole press on one another; 1 N/m changes the stresses by 1e-7."""
    body = PLATES[plate] if plate != "compliance" else replace(softer_hole(R, 0.33, "strain"), plane=plane)
    problem = Problem(MaterialPair(STEEL, ALUMINIUM, plane), R, -20e-6, 0.3, pin_body=PINS[pin], plate_body=body)
    state = solve(problem, [{"P": 1.0}], nodes=101)[-1]
    expected = problem.joint.assembly_stresses(problem.assembled_clearance)
    edges = [circle for circle in circles(problem) if circle.is_edge]
    assert sorted(expected) == sorted(circle.edge for circle in edges)
    assert max(expected.values()) > 5e7
    for circle in edges:
        found = state.stress(Points.at_depth(circle.depth * R, AROUND), circle.body).von_mises
        assert found == pytest.approx(expected[circle.edge], abs=1e-6 * max(expected.values()))


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("owner", ["pin", "plate", "bush"])
def test_the_von_mises_stress_of_places_is_that_of_the_state(owner, plane):
    problem = Problem(MaterialPair(STEEL, ALUMINIUM, plane), R, 20e-6, 0.3, plate_body=BUSH)
    state = solve(problem, [{"P": 1e6}], nodes=61)[-1]
    places = Places.of(problem, state.grid, owner)
    there = state.stress(Points.at_depth(places.depth * R, places.theta), places.body, straight=True)
    found = places.von_mises(problem, np.stack([there.radial, there.hoop, there.shear]))
    np.testing.assert_allclose(found, there.von_mises, rtol=1e-12)
    assert von_mises_peak(state, owner).value == pytest.approx(found.max(), rel=1e-12)


def test_a_pin_with_clearance_has_no_stress_before_loads():
    problem = Problem(MaterialPair(STEEL, ALUMINIUM), R, 20e-6, 0.3)
    assert set(problem.joint.assembly_stresses(problem.assembled_clearance).values()) == {0.0}


def yielding(interference, clearance=40e-6, bush=138e6, plate=503e6, **more):
    body = Bushing(replace(BRONZE, yield_strength=bush), SEAT, interference)
    pair = MaterialPair(STEEL, replace(ALUMINIUM, yield_strength=plate))
    return Problem(pair, R, clearance, 0.15, plate_body=body, **more)


def test_a_press_fit_that_yields_is_noticed_before_any_load():
    assert doubts(yielding(10e-6)) == []
    problem = yielding(30e-6)
    stress = problem.joint.assembly_stresses(problem.assembled_clearance)["bore of the bush"] / 1e6
    found = [str(doubt) for doubt in doubts(problem)]
    assert found[0] == (
        f"von Mises stress: {stress:.4g} MPa in the bore of the bush, before any load, is above the yield strength "
        "138 MPa of the bush; fastpin is elastic, but a real bush yields there"
    )
    assert [words.split(",")[0].partition("MPa ")[2] for words in found[1:]] == ["on the outer rim of the bush"]
    words = [str(doubt) for doubt in doubts(yielding(30e-6, bush=400e6, plate=60e6))]
    assert len(words) == 1
    assert "of the plate at the seat of the bush, before any load, is above the yield strength 60 MPa" in words[0]


def test_a_pressed_pin_that_yields_is_noticed_before_any_load():
    pair = MaterialPair(replace(STEEL, yield_strength=30e6), replace(ALUMINIUM, yield_strength=40e6))
    found = [str(doubt) for doubt in doubts(Problem(pair, R, -20e-6, 0.3, pin_body=Tube(5e-3)))]
    assert len(found) == 3
    places = ("on the surface of the pin", "in the bore of the pin", "at the hole of the plate")
    assert all(any(place in words for words in found) for place in places)


HISTORY = [{"P": 1e6}, {"P": 4e6}, {"P": 2e6}]


def test_states_that_yield_are_noticed_with_their_places():
    problem = yielding(10e-6, plate=90e6)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = solve(problem, HISTORY, nodes=101)
    words = [str(each.message) for each in caught if issubclass(each.category, InputWarning)]
    mises = [each for each in words if each.startswith("von Mises stress")]
    assert any("of the plate at the seat of the bush, at " in each and "load point 2" in each for each in mises)
    found = yield_doubts_of(problem, LoadHistory(HISTORY), result.states)
    assert [str(doubt) for doubt in found] == mises
    # a finer search finds no more
    seat = result[1].stress(Points.at_depth(0.0, np.linspace(-np.pi, np.pi, 721)), "seat").von_mises.max() / 1e6
    (said,) = (each for each in mises if "at the seat" in each)
    assert float(said.split()[3]) == pytest.approx(seat, rel=1e-3)


def test_nothing_is_said_without_a_strength_or_while_doubts_are_given():
    plain = Problem(MaterialPair(STEEL, ALUMINIUM), R, 20e-6, 0.3, plate_body=BUSH)
    states = solve(plain, HISTORY, nodes=101).states
    assert yield_doubts_of(plain, LoadHistory(HISTORY), states) == []
    problem = yielding(10e-6, plate=90e6)
    with doubts_given():
        states = solve(problem, HISTORY, nodes=101).states
        assert yield_doubts_of(problem, LoadHistory(HISTORY), states) == []
    assert yield_doubts_of(problem, LoadHistory(HISTORY), states) != []


def test_the_largest_stress_is_that_of_all_states():
    """It may be in a state with neither the largest pressure nor a largest load."""
    lug = Bushing(replace(BRONZE, yield_strength=100e6), SEAT, 20e-6, inside=Ring(0.03))
    problem = Problem(MaterialPair(STEEL, ALUMINIUM), R, 30e-6, 0.3, plate_body=lug)
    history = [{"P": 2e6}, {"P": 2.9533e6, "Q": 4.9139e5}, {"P": 1e6, "Q": 8e5}, {"P": 3.6e6, "Q": 0.0}]
    with doubts_given():
        states = solve(problem, history, nodes=101).states
    peaks = [von_mises_peak(state, "bush") for state in states]
    place = int(np.argmax([peak.value for peak in peaks]))
    assert place == 1
    (said,) = map(str, yield_doubts_of(problem, LoadHistory(history), states))
    assert f"{peaks[place].value / 1e6:.4g} MPa" in said
    assert f"load point {place + 1}" in said


def test_the_largest_stress_under_a_narrow_contact_lies_below_the_edge():
    """In a Hertzian contact of half-width a it lies 0.7 a below. A finer search finds at most 4 % more."""
    pair = MaterialPair(replace(STEEL, yield_strength=5e6), replace(STEEL, yield_strength=5e6))
    problem = Problem(pair, R, 400e-6, 0.0)
    with doubts_given():
        state = solve(problem, [{"P": 5e5}], nodes=401)[0]
    half = 0.5 * (state.contact[0][1] - state.contact[0][0])
    for owner in ("pin", "plate"):
        peak = von_mises_peak(state, owner)
        assert 0.3 * half < peak.circle.depth < half
        fine = Points.at_depth(np.linspace(0.0, half * R, 200)[:, None], state.theta[::8])
        stress = state.stress(fine, owner, straight=True).von_mises
        assert 1.1 * stress[0].max() < peak.value <= 1.001 * stress.max()
        assert peak.value > 0.96 * stress.max()
    said = [str(each) for each in yield_doubts_of(problem, LoadHistory([{"P": 5e5}]), [state])]
    assert len(said) == 2
    assert all("below the edge, at " in each for each in said)


def test_every_edge_has_words():
    tube = Problem(MaterialPair(STEEL, ALUMINIUM), R, 20e-6, 0.3, pin_body=Tube(5e-3), plate_body=BUSH)
    plain = Problem(MaterialPair(STEEL, ALUMINIUM), R, 20e-6, 0.3)
    assert {circle.edge for problem in (tube, plain) for circle in circles(problem)} == set(EDGES)


def test_states_far_from_yield_are_not_searched(monkeypatch):
    """The largest stresses of all states are found only if a body comes near its yield strength."""
    asked = []
    monkeypatch.setattr(extremes, "find_extremes", lambda kept, wanted: asked.append(wanted) or extremes.Found())
    loads = [{"P": 4e5}, {"P": 8e5, "Q": 1e5}, {"P": 1e5}]
    for plate, near in ((503e6, None), (200e6, []), (100e6, [("von_mises_plate", "largest")])):
        pair = MaterialPair(STEEL, replace(ALUMINIUM, yield_strength=plate))
        states = solve(Problem(pair, R, 40e-6, 0.15), loads, nodes=61).states
        kept = extremes.KeptStates(states)
        if near is None:  # no state is read
            monkeypatch.setattr(kept, "read", lambda places: pytest.fail("a state was read"))
        asked.clear()  # by solve
        extremes.yield_extremes(kept)
        assert asked == ([] if near is None else [near])


@pytest.mark.parametrize(
    ("loads", "clearance", "friction"),
    [({"P": 1e6, "Q": 3e5}, 40e-6, 1.0), ({"P": 2e5}, 400e-6, 0.3), ({"sxx": 1e8, "syy": -1e8}, 40e-6, 0.3),
     ({"sxy": 1e8, "P": 1e5}, 40e-6, 0.3), ({"P": 1e6}, -20e-6, 0.3)],
)  # fmt: skip
def test_a_body_that_yields_is_never_plainly_elastic(loads, clearance, friction):
    problem = Problem(MaterialPair(STEEL, ALUMINIUM), R, clearance, friction)
    (state,) = solve(problem, [loads], nodes=61).states
    for owner, material in (("pin", STEEL), ("plate", ALUMINIUM)):
        strength = 0.999 * von_mises_peak(state, owner).value
        pair = replace(problem.pair, **{owner: replace(material, yield_strength=strength)})
        again = replace(state, problem=replace(problem, pair=pair))
        found = extremes.yield_extremes(extremes.KeptStates([again]))
        assert strength == 0.0 or (f"von_mises_{owner}", "largest") in found
