"""Closed forms, reference values of an independent trial, and finite-element tractions."""

import math

import numpy as np
import pytest

from fastpin import InputError, Material, MaterialPair, Problem, solve
from fastpin.verification import closed_forms
from fastpin.verification.finite_elements import FiniteElements

BOTTOM = -0.5 * math.pi
CYCLE = [{"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}, {"Q": -0.275}]


# --- frictionless: closed forms -----------------------------------------------------------------------------


@pytest.mark.gate
def test_order_of_edge_and_peak_pressure(similar):
    """Edges read between nodes: no stair steps, and better than first order. Peaks: second order."""
    rng = np.random.default_rng(3)
    sizes = np.array([100, 200, 400, 800])
    edge, peak = np.zeros((2, sizes.size))
    for load_parameter in 10.0 ** rng.uniform(-2.0, 0.3, 6):
        exact = closed_forms.persson_half_angle(load_parameter)
        top = closed_forms.persson_pressure(0.0, exact)
        wide = exact * rng.uniform(1.08, 1.3, 2)
        for k, nodes in enumerate(sizes):
            arc = (BOTTOM - wide[0], BOTTOM + wide[1])
            state = solve(
                Problem.from_load_parameter(similar, load_parameter, 0.0), [{"P": 1.0}], nodes=int(nodes), arc=arc
            )[-1]
            edge[k] += (state.contact[0][1] - BOTTOM - exact) ** 2 + (state.contact[0][0] - BOTTOM + exact) ** 2
            peak[k] += (state.peak_pressure / top - 1.0) ** 2
    edge_order = -np.polyfit(np.log(sizes), 0.5 * np.log(edge), 1)[0]
    peak_order = -np.polyfit(np.log(sizes), 0.5 * np.log(peak), 1)[0]
    assert edge_order > 1.3
    assert peak_order > 1.8


# --- with friction: trial values ----------------------------------------------------------------------------


def test_monotonic_reference_values(similar, titanium_in_aluminium):
    for pair, peak, stick in ((titanium_in_aluminium, 0.52882, 0.435), (similar, 0.54031, None)):
        state = solve(Problem.from_load_parameter(pair, 0.1, 0.4, "body"), [{"P": 1.0}], nodes=401)[-1]
        assert state.peak_pressure == pytest.approx(peak, abs=2e-5)
        assert abs(state.peak_shear) == pytest.approx(0.2011, abs=1e-4)
        if stick is not None:
            assert 0.5 * np.ptp(state.contact[0]) == pytest.approx(1.136, abs=2e-3)
            assert 0.5 * np.ptp(state.stick[0]) == pytest.approx(stick, abs=1e-3)


FRETTING = {
    "fixed": (
        (0.5, 0.55, "centre", "fixed"), "M", 4e-6,
        [0.91864, 0.93755, 0.94690, 0.94671, 0.94690],
        [0.1385, -0.4095, 0.4046, -0.402, 0.4046],
        [0.0, 0.213796, -0.220463, 0.219292, -0.220463],
    ),
    "free": (
        (0.05, 0.55, "body", "free"), "rotation", 6e-5,
        [0.46529, 0.50477, 0.55305, 0.54587, 0.55164],
        [0.2272, -0.2347, 0.2309, -0.2228, 0.2312],
        [0.0, -0.0250, 0.0357, -0.0325, 0.0352],
    ),
}  # fmt: skip
"""Joint, what its peaks go with and how nearly, peak pressures, peak shears, and moments or rotations."""


@pytest.mark.gate
@pytest.mark.parametrize("name", FRETTING)
def test_reference_values_of_fretting(similar, name):
    joint, with_them, nearly, peaks, shears, turns = FRETTING[name]
    result = solve(Problem.from_load_parameter(similar, *joint), CYCLE, nodes=601)
    for state, peak, shear, turn in zip(result, peaks, shears, turns, strict=True):
        found = {"M": state.resultants["M"], "rotation": state.rotation}
        assert state.peak_pressure == pytest.approx(peak, abs=2e-5)
        assert abs(state.peak_shear) == pytest.approx(abs(shear), abs=1e-3)  # theirs are nodal maxima
        assert shear * state.peak_shear > 0.0 or turn == 0.0
        assert found[with_them] == pytest.approx(turn, abs=nearly)
        assert name == "fixed" or found["M"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("hub", "integral"), [(1.0, -0.230), (None, -0.214), (0.3, -0.160), (0.1, -0.043)])
def test_where_the_rotation_is_held(similar, hub, integral):
    """int T after the first +Q for a pin held at the rim, at the paper's datum and at hubs (finite elements)."""
    problem = Problem.from_load_parameter(similar, 0.5, 0.55, "centre", "fixed", hub_radius=hub)
    state = solve(problem, CYCLE[:2], nodes=301)[-1]
    assert -state.resultants["M"] == pytest.approx(integral, abs=5e-4)
    if hub is None:
        assert state.rotation == 0.0


def test_hub_at_the_papers_datum_is_the_default(similar):
    datum = 1.0 / math.sqrt(similar.pin_kolosov + 1.0)
    one, two = (
        solve(Problem.from_load_parameter(similar, 0.5, 0.55, "centre", "fixed", hub_radius=hub), CYCLE[:2], nodes=81)
        for hub in (None, datum)
    )
    assert np.abs(one[-1].shear - two[-1].shear).max() < 1e-10


# --- finite elements ----------------------------------------------------------------------------------------


def test_finite_elements_fretting_away_from_the_edges():
    """The stated errors are 5e-4 and 2e-3."""
    model = FiniteElements.read("fretting_fixed_rotation")
    states = solve(model.problem, model.history, grid=model.grid)
    for state, shear, difference in zip(states, model.shear, model.differences(states), strict=True):
        assert difference.normal_away < 5e-4
        assert difference.shear_away < 2e-3
        assert -state.resultants["M"] == pytest.approx(math.pi / 720.0 * shear.sum(), abs=3e-5)


def test_finite_elements_that_there_are_not():
    with pytest.raises(InputError, match=r"name: must be one of frictionless, .*, not 'spheres'"):
        FiniteElements.read("spheres")


# --- rigid limits -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rigid", ["pin", "plate"])
def test_rigid_bodies_are_the_limit_of_stiff_ones(rigid):
    soft = Material(70e9, 0.3)
    peaks = []
    for stiff in (Material(70e12, 0.3), Material(70e14, 0.3), Material.rigid()):
        pair = MaterialPair(stiff, soft) if rigid == "pin" else MaterialPair(soft, stiff)
        state = solve(Problem.from_load_parameter(pair, 0.2, 0.3, "centre"), [{"P": 1.0}, {"Q": 0.1}], nodes=121)[-1]
        peaks.append(state.peak_pressure)
    assert abs(peaks[1] - peaks[2]) < 0.05 * abs(peaks[0] - peaks[2])
    assert peaks[1] == pytest.approx(peaks[2], rel=1e-4)
