"""The factor of all stresses until a life or the knee is missed."""

import math

import numpy as np
import pytest

import fastpin
from fastpin import InputError, damage
from fastpin.bodies import Bushing
from fastpin.damage.assessed import _edge_count
from fastpin.damage.counted import Spectrum
from fastpin.damage.lives import cycles_on_curve, smith_watson_topper_curve
from fastpin.model import FatigueAssessment
from fastpin.model.doubts import doubts_given
from tests.support.fatigue import ALUMINIUM as MATERIAL
from tests.support.tiers import for_gate, gate

SWT, FS = "smith-watson-topper", "fatemi-socie"
CURVE = smith_watson_topper_curve(70e9, 1100e6, -0.124, 0.22, -0.59)


def solved(history, **fields):
    problem = fastpin.Problem(fastpin.MaterialPair(MATERIAL, MATERIAL), 10e-3, 40e-6, 0.4, **fields)
    with doubts_given():
        return fastpin.solve(problem, history, nodes=61)


@pytest.fixture(scope="module")
@for_gate
def spectrum():
    """Twenty loads with small and large cycles, in a bush."""
    rng = np.random.default_rng(4)
    loads = [{"P": 3e6 * p, "Q": 1e6 * q} for p, q in zip(rng.uniform(0.2, 1.5, 20), rng.normal(size=20), strict=True)]
    return solved(loads, plate_body=Bushing(MATERIAL, 15e-3, 5e-6))


def parameter_at(cycles):
    """The parameter of Smith, Watson and Topper at a life, by bisection on the curve."""
    low, high = 1.0, 1e12
    for _ in range(200):
        tried = math.sqrt(low * high)
        low, high = (tried, high) if cycles_on_curve(tried, CURVE) > cycles else (low, tried)
    return low


@pytest.mark.parametrize(
    ("fields", "cycles"),
    [
        ({"life": 3e4}, 3e4),
        ({"life": 3e4, "small_cycles": "haibach", "knee": 1e6}, 3e4),
        ({"small_cycles": "haibach", "knee": 1e6}, 1e6),
        ({"small_cycles": "original", "knee": 1e5}, 1e5),
        ({}, 1.0),
    ],
)
def test_a_single_cycle_may_grow_to_its_point_on_the_curve(fields, cycles):
    """The parameter grows with the square of the stress, so the factor is a root of a ratio of parameters."""
    two = list(solved([{"P": 4e6}, {"Q": 1e6}]))
    hot = damage.fatigue(two, SWT).hot_spot
    (one,) = damage.assessed_reserves(two, FatigueAssessment(bodies="plate", **fields))
    assert one.factor == pytest.approx(math.sqrt(parameter_at(cycles) / hot.parameter), rel=1e-5)
    if cycles > 1e3:
        assert one.theta == hot.theta
        assert math.sin(one.plane - hot.plane) == pytest.approx(0.0, abs=2e-3)
    assert {one.start, one.stop} == {1.0, 2.0}
    assert one.loads == two[int(one.largest) - 1].load


@pytest.mark.parametrize("criterion", [SWT, FS])
@pytest.mark.parametrize(
    "fields", [{"life": 2e5}, {"life": 2e5, "small_cycles": "haibach", "knee": 1e7}, {"life": 50.0}]
)
def test_at_the_factor_the_largest_damage_of_all_points_is_the_goal(spectrum, criterion, fields):
    """All points are counted again under stresses times the factor: none misses the life, and one just reaches it."""
    how = FatigueAssessment(criterion, **fields)
    found = spectrum.assessed_reserves(how)
    assert [one.factor for one in found] == sorted(one.factor for one in found)
    assert {one.body for one in found} == {"plate", "seat", "pin"}
    for one in found:
        count = _edge_count(list(spectrum), how, criterion, one.body)
        order, ((_, counted),) = Spectrum.of(count.order), count.parts
        for block, history in count.blocks(lambda part: None):
            assert block == slice(0, count.theta.size)
            used = how.life * counted.worst(one.factor * history, order)[0]
            assert used.max() == pytest.approx(1.0, rel=1e-4)
            assert count.theta[np.argmax(used)] == pytest.approx(one.theta, abs=1e-9)
            assert (how.life * counted.worst(1.01 * one.factor * history, order)[0]).max() > 1.0


def test_without_damage_there_is_still_a_factor(spectrum):
    """Cycles below the knee of the original rule do no damage; they may grow to the knee, and then some."""
    rule = {"small_cycles": "original", "knee": 10.0, "bodies": "seat"}
    assert spectrum.assessed_fatigue(FatigueAssessment(**rule))[0].hot_spot.life == math.inf
    (endured,) = spectrum.assessed_reserves(FatigueAssessment(**rule))
    (lived,) = spectrum.assessed_reserves(FatigueAssessment(life=2.0, **rule))
    assert 1.0 < endured.factor < lived.factor < math.inf
    assert endured.goal == ("endurance", 10.0)
    (jumped,) = spectrum.assessed_reserves(FatigueAssessment(life=1e9, **rule))  # the first cycle is already too much
    assert jumped.factor == pytest.approx(endured.factor, rel=2e-3)  # candidate planes are 2.5 deg apart
    assert jumped.factor >= endured.factor * (1.0 - 1e-6)


def test_a_longer_life_leaves_a_smaller_factor(spectrum):
    factors = [
        spectrum.assessed_reserves(FatigueAssessment(life=life, bodies="seat"))[0].factor
        for life in (1.0, 1e2, 1e4, 1e6)
    ]
    assert factors == sorted(factors, reverse=True)
    life = spectrum.assessed_fatigue(FatigueAssessment(bodies="seat"))[0].hot_spot.life
    (just,) = spectrum.assessed_reserves(FatigueAssessment(life=life, bodies="seat"))
    assert just.factor == pytest.approx(1.0, rel=1e-5)


@pytest.mark.parametrize("method", ["line", *gate("point", "area")])
def test_the_place_at_a_distance_is_that_of_the_edge(spectrum, method):
    how = FatigueAssessment(life=1e4, bodies="seat", method=method)
    (edge,), (mean,) = (spectrum.assessed_reserves(each) for each in (how.changed(method="edge"), how))
    assert mean.theta == edge.theta
    assert mean.depth == spectrum.assessed_fatigue(how)[0].hot_spot.depth
    assert mean.factor > edge.factor


def test_a_body_in_compression_has_no_factor():
    """The pin is compressed from all sides by a press fit that a load barely changes."""
    problem = fastpin.Problem(fastpin.MaterialPair(MATERIAL, MATERIAL), 10e-3, -20e-6, 0.4)
    with doubts_given():
        result = fastpin.solve(problem, [{"P": 1e3}, {"P": 2e3}], nodes=61)
    (pin,) = result.assessed_reserves(FatigueAssessment(bodies="pin", life=10.0))
    assert pin.factor == math.inf
    assert math.isnan(pin.theta)
    assert not pin.is_finite


def test_the_life_is_checked():
    for life in (0.0, -1.0, 1e19, "long", math.nan):
        with pytest.raises(InputError, match="life"):
            FatigueAssessment(life=life)
    assert FatigueAssessment(life=20).toml() == {"life": 20.0}


def test_the_progress_ends_at_all_bodies(spectrum):
    told = []
    spectrum.assessed_reserves(FatigueAssessment(life=1e4), lambda done, total: told.append((done, total)))
    assert told[-1] == pytest.approx((3.0, 3.0))
    assert [done for done, _ in told] == sorted(done for done, _ in told)
