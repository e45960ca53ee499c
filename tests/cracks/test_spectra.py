"""Growth under spectra, against constant amplitudes, sums by hand and state by state."""

import math

import numpy as np
import pytest

import fastpin
from fastpin.assess import crack as words_of
from fastpin.assess import outputs
from fastpin.assess.crack import GROWTH
from fastpin.cracks import (
    Crack,
    CrackFate,
    Walker,
    growth,
    growth_along_edge,
    planned_growth,
    spectrum_growth,
    stress_intensity,
)
from fastpin.errors import InputError
from fastpin.model import CrackGrowth
from fastpin.model.units import units
from tests.support.cracks import LIKE, NASGRO, M, problem_of

LAW = Walker(1e-10, 3.0, 0.5, 1.0 * M, intrinsic_length=50e-6)
BESIDE = Crack(math.radians(-24.0))


@pytest.fixture(scope="module")
def levels() -> list[fastpin.State]:
    """Two peaks of P with the same valley between, frictionless: each stop has a force of its own."""
    loads = [{"P": force} for force in (3e6, 3e5, 1.5e6, 3e5, 1.5e6, 3e5)]
    return list(fastpin.solve(problem_of(LIKE, 20e-6, 0.0), loads, nodes=201))


@pytest.mark.parametrize("law", [LAW, NASGRO])
def test_a_constant_amplitude_grows_as_a_cycle_does(levels, law):
    stops = levels[:2]
    cycle, spectrum = growth(stops, BESIDE, law, 1e-4, 3e-3), spectrum_growth(stops, BESIDE, law, 1e-4, 3e-3)
    assert spectrum.rate == pytest.approx(cycle.rate, rel=1e-14)
    assert spectrum.life == pytest.approx(cycle.life, rel=1e-14)
    assert spectrum.delta_K == pytest.approx(cycle.delta_K, rel=1e-14)
    assert spectrum.counted.tolist() == [1] * cycle.length.size
    four = spectrum_growth(stops * 4, BESIDE, law, 1e-4, 3e-3)
    assert four.rate == pytest.approx(4.0 * cycle.rate, rel=1e-14)
    assert four.life == pytest.approx(0.25 * cycle.life, rel=1e-14)


def test_two_levels_by_hand(levels):
    found = spectrum_growth(levels, BESIDE, LAW, 1e-4, 3e-3)
    K = stress_intensity(levels, BESIDE, found.length[[0, -1]]).K_I
    for k, place in ((0, 0), (1, -1)):
        length = found.length[place]
        high, low = (LAW.rate(K[peak, k], K[1, k], length) for peak in (0, 2))
        assert high > 1.2 * low > 0.0
        assert found.rate[place] == pytest.approx(float(high + 2.0 * low), rel=1e-6)
    assert found.counted.tolist() == [3] * found.length.size
    assert found.words == f"grows from 100 um to 3 mm in {found.life:.3g} spectra"


def test_cycles_below_the_threshold_do_nothing(levels):
    """Only the large cycles are above the threshold at first: the crack starts by them alone."""
    K = stress_intensity(levels, BESIDE, [1e-4]).K_I[:, 0]
    small, large = K[2] - K[1], K[0] - K[1]
    law = Walker(1e-10, 3.0, threshold_range=0.5 * (small + large))
    found = spectrum_growth(levels, BESIDE, law, 1e-4, 1.1e-4)
    assert found.rate[0] == pytest.approx(1e-10 * (large / M) ** 3, rel=1e-6)
    never = spectrum_growth(levels, BESIDE, Walker(1e-10, 3.0, threshold_range=1.01 * large), 1e-4, 1.01e-4)
    assert (never.fate, never.life, never.rate.max()) == (CrackFate.NONE, math.inf, 0.0)
    assert never.arrest == never.length[0]


@pytest.mark.gate
def test_a_crack_stops_where_its_largest_cycle_does(cycle):
    stops, crack = cycle("small"), Crack(math.radians(-24.0))
    law = Walker(1e-10, 3.0, 0.5, 3.0 * M, intrinsic_length=50e-6)
    one, other = growth(stops, crack, law, 1e-5, 1e-2), spectrum_growth(stops, crack, law, 1e-5, 1e-2)
    assert other.fate == CrackFate.STOPS
    assert other.arrest == pytest.approx(one.arrest, rel=2e-2)  # the spectrum has several ranges in a cycle of K


def test_fracture_is_that_of_the_largest_intensity(levels):
    K = stress_intensity(levels, BESIDE, [1e-3]).K_I
    law = Walker(1e-10, 3.0, toughness=float(K.max()))
    found = spectrum_growth(levels, BESIDE, law, 1e-4, 3e-3)
    assert found.fate == CrackFate.BREAKS
    assert found.fracture == pytest.approx(1e-3, rel=1e-3)


@pytest.mark.gate
def test_straight_tractions_of_many_states_are_one_product(levels):
    lengths = np.geomspace(1e-4, 1e-3, 4)
    few = stress_intensity(levels, BESIDE, lengths, straight=True)
    many = stress_intensity(levels * 10, BESIDE, lengths, straight=True)
    refined = stress_intensity(levels, BESIDE, lengths)
    for name in ("K_I", "K_II"):
        size = np.abs(few.K_I).max()
        assert getattr(many, name)[:6] == pytest.approx(getattr(few, name), abs=1e-11 * size)
        assert getattr(few, name) == pytest.approx(getattr(refined, name), abs=3e-3 * size)
    assert not np.array_equal(few.K_I, refined.K_I)
    pressed = stress_intensity(levels * 10, BESIDE, lengths, lambda s: -1e7 + 0.0 * s, straight=True)
    one = stress_intensity(levels, BESIDE, lengths, lambda s: -1e7 + 0.0 * s, straight=True)
    assert pressed.K_I[:6] == pytest.approx(one.K_I, abs=1e-11 * size)


@pytest.mark.gate
def test_remote_stresses_and_two_cracks_are_products_too():
    history = [{"P": 1e6}, *({"sxx": 1e7 * k, "sxy": 3e6 * k} for k in range(60))]
    states = list(fastpin.solve(problem_of(LIKE, 20e-6, 0.3), history, nodes=101))
    pair = [BESIDE, Crack(math.radians(100.0), 0.2)]
    many = stress_intensity(states, pair, [1e-3], straight=True)
    one = stress_intensity(states[-3:], pair, [1e-3], straight=True)
    assert many.K_II[-3:] == pytest.approx(one.K_II, abs=1e-10 * np.abs(one.K_I).max())
    assert many.K_I[-3:] == pytest.approx(one.K_I, rel=1e-10)


@pytest.mark.gate
def test_a_planned_growth_is_the_same_one(levels):
    how = CrackGrowth(1e-4, 1e-3, LAW, BESIDE.theta, residual_stress=[(0.0, -3e7), (1e-3, 0.0)])

    def residual(s):
        return -3e7 * (1.0 - s / 1e-3)

    life = growth(levels[:2], BESIDE, LAW, 1e-4, 1e-3, residual).life  # the table between its points, by rounding
    assert planned_growth(levels[:2], how).life == pytest.approx(life, rel=1e-12)
    counted = planned_growth(levels, how, spectrum=True)
    life = spectrum_growth(levels, BESIDE, LAW, 1e-4, 1e-3, residual).life
    assert counted.life == pytest.approx(life, rel=1e-12)
    calls: list[tuple[float, float]] = []
    fastest = planned_growth(levels[:2], CrackGrowth(1e-4, 1e-3, LAW), progress=lambda *call: calls.append(call))
    assert fastest.life == growth_along_edge(levels[:2], LAW, 1e-4, 1e-3).fastest.life
    assert calls[-1] == (360, 360)


def test_the_law_of_a_case_is_its_own_or_that_of_the_material(levels):
    with pytest.raises(InputError, match="law: is missing: the material of the plate has no constants of crack"):
        planned_growth(levels, CrackGrowth(1e-4, 1e-3, theta=0.0))
    pair = fastpin.MaterialPair(LIKE, fastpin.Material(LIKE.E, LIKE.nu, growth=LAW))
    problem = fastpin.Problem(pair, 10e-3, 20e-6, 0.0)
    states = list(fastpin.solve(problem, [{"P": 3e6}, {"P": 3e5}], nodes=61))
    assert planned_growth(states, CrackGrowth(1e-4, 1e-3, theta=BESIDE.theta)).law == LAW
    assert planned_growth(states, CrackGrowth(1e-4, 1e-3, NASGRO, BESIDE.theta)).law == NASGRO


def test_a_growth_becomes_a_document(levels):
    found = spectrum_growth(levels, BESIDE, LAW, 1e-4, 1e-3)
    document = outputs.document(GROWTH, found, units(found.problem))
    assert document["repeated"] == "spectrum"
    assert (document["fate"], document["life"]) == ("grows", found.life)
    assert document["law"] == {
        "law": "walker", "C": 1e-10, "m": 3.0, "exponent": 0.5, "threshold_range": 1e6, "intrinsic_length": 50e-6,
    }  # fmt: skip
    assert math.isnan(document["arrest"])
    assert "spectra" in words_of.growth_table(found)
    assert "spectra" in words_of.growth_curve(found).columns


@pytest.mark.parametrize(
    ("given", "fault"),
    [
        ({"first": 0.0}, "first: must be positive, not 0"),
        ({"last": 1e-5}, "last: must be longer than the first length of 0.0001 m, not 1e-05"),
        ({"law": 3}, "law: must be a law with constants"),
        ({"theta": "up"}, "theta: must be a number"),
        ({"angle": 1.2}, "angle: must lie between"),
        ({"body": "pin"}, 'body: must be "plate" or "seat"'),
        ({"residual_stress": [(0.0, 1.0)]}, "residual_stress: must be a number or 2 to 1,000 pairs, not 1"),
        ({"residual_stress": [(1.0, 1.0), (0.5, 2.0)]}, "residual_stress: must have increasing distances"),
        ({"residual_stress": [(0.0, 1.0), (0.5,)]}, "residual_stress: must be pairs of a distance"),
    ],
)
def test_refusals_of_a_planned_crack(given, fault):
    with pytest.raises(InputError, match=fault):
        CrackGrowth(**{"first": 1e-4, "last": 1e-3} | given)
