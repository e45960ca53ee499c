"""The theory of critical distances."""

import math

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

import fastpin
from fastpin import damage
from fastpin.damage import distance
from tests.support.refusals import refused

ANGLES = np.array([-2.2, -0.85, 0.3])


def test_the_length_by_hand():
    """dK_th 5 MPa sqrt m, ds_0 500 MPa: 31.83 um."""
    assert damage.critical_distance(5e6, 500e6) == pytest.approx(31.83e-6, abs=5e-9)


def test_each_method_gives_the_limit_before_a_long_crack():
    """Before a crack with K = ds_0 sqrt(pi L) all three methods give ds_0, from the field of Westergaard."""
    radius = distance.AREA_RADIUS
    assert radius == pytest.approx(1.32, abs=5e-4)

    def opening(r):  # in units of ds_0, with L = 1
        return math.sqrt(math.pi) / math.sqrt(2.0 * math.pi * r)

    assert opening(0.5) == pytest.approx(1.0, rel=1e-15)
    assert quad(opening, 0.0, 2.0)[0] / 2.0 == pytest.approx(1.0, rel=1e-9)

    def principal(u, angle):  # with r = R u^2; the largest principal stress
        half = 0.5 * angle
        r = radius * u * u
        return opening(r) * math.cos(half) * (1.0 + abs(math.sin(half))) * r * 2.0 * radius * u

    whole = 2.0 * dblquad(principal, 0.0, 0.5 * math.pi, 1e-12, 1.0)[0]
    assert whole / (0.5 * math.pi * radius**2) == pytest.approx(1.0, rel=1e-8)


def test_the_point_method_takes_the_depth_of_half_the_length(cycle):
    length = damage.critical_distance(3e6, 200e6)
    found = damage.fatigue_at_distance(cycle, "smith-watson-topper", "point", theta=ANGLES)
    points = fastpin.Points.at_depth(0.5 * length, ANGLES)
    same = damage.fatigue(cycle, "smith-watson-topper", points=points)
    np.testing.assert_allclose(found.parameter, same.parameter, rtol=1e-13)
    np.testing.assert_allclose(found.depth, 0.5 * length)


@pytest.mark.gate
@pytest.mark.parametrize("body", ["plate", "pin"])
def test_the_line_method_against_a_sum_over_many_depths(cycle, body):
    length, count = 2e-4, 8_000
    depths = 2.0 * length * (np.arange(count) + 0.5) / count
    points = fastpin.Points.at_depth(depths[:, None], ANGLES)
    history = damage.stress_history(cycle, points, body).reshape(len(cycle), count, len(ANGLES), 4).mean(axis=1)
    material = getattr(cycle[0].problem.pair, body)
    expected = damage.smith_watson_topper(history, material.E, material.nu).parameter
    found = damage.fatigue_at_distance(cycle, "smith-watson-topper", "line", body, theta=ANGLES, length=length)
    np.testing.assert_allclose(found.parameter, expected, rtol=2e-4, atol=1e-4 * expected.max())


@pytest.mark.gate
@pytest.mark.parametrize("body", ["plate", "pin"])
def test_the_area_method_against_a_sum_over_small_squares(cycle, body):
    """Squares whose middles lie in the body, within 1.32 L of the point; a long L, so that the edge is curved."""
    length, radius = 2e-3, 10e-3
    away = distance.AREA_RADIUS * length
    side = np.linspace(-away, away, 201)[1::2]
    across, up = np.meshgrid(side, side)
    x, y = radius * np.cos(ANGLES[1]) + across, radius * np.sin(ANGLES[1]) + up
    beyond = np.hypot(x, y) > radius
    near = np.hypot(across, up) < away
    inside = near & (beyond if body == "plate" else ~beyond)
    history = damage.stress_history(cycle, fastpin.Points.at_xy(x[inside], y[inside]), body).mean(axis=1, keepdims=True)
    constants = cycle[0].problem.pair.plate.fatigue
    found = damage.fatigue_at_distance(
        cycle, "crossland", "area", body, theta=ANGLES[1], length=length, constants=constants
    )
    alpha, _ = damage.crossland_limit(140e6, 85e6)
    assert found.parameter.shape == ()
    assert float(found.parameter) == pytest.approx(damage.crossland(history, alpha)[0], rel=1e-2)


def test_a_small_length_gives_the_edge(cycle):
    edge = damage.fatigue(cycle, "crossland", points=fastpin.Points.at_depth(0.0, ANGLES)).parameter
    for method in ("point", "line", "area"):
        found = damage.fatigue_at_distance(cycle, "crossland", method, theta=ANGLES, length=1e-9)
        np.testing.assert_allclose(found.parameter, edge, rtol=2e-3)


def test_the_hot_spot_is_the_place_unless_given(fretting, cycle):
    found = damage.fatigue_at_distance(cycle, "smith-watson-topper", "line")
    assert found.hot_spot.theta == fretting.fatigue("smith-watson-topper").hot_spot.theta
    assert found.hot_spot.parameter < fretting.fatigue("smith-watson-topper").hot_spot.parameter
    assert found.hot_spot.life > fretting.fatigue("smith-watson-topper").hot_spot.life


BAD = {
    "method: must be": {"method": "volume"},
    'fatigue: method "line" needs threshold_range, limit_range of the pin\'s material': {
        "method": "line",
        "body": "pin",
    },
    "length: must be positive, not 0": {"length": 0.0},
    "depth: must be at most the radius of 0.01 in the pin": {"method": "line", "body": "pin", "length": 1.0},
    "theta: must be a finite number, not nan": {"theta": math.nan},
    "states: must be the stops of a cycle": {"states": []},
    "body: must be": {"body": "hub"},
}


@pytest.mark.parametrize("sentence", BAD)
def test_bad_input(cycle, sentence):
    given = {"states": cycle, "criterion": "smith-watson-topper", "theta": 0.0, **BAD[sentence]}
    assert str(refused(damage.fatigue_at_distance, **given)).startswith(sentence)


def test_bad_ranges_of_a_critical_distance():
    assert str(refused(damage.critical_distance, -1.0, 1.0)) == "threshold_range: must be positive, not -1"
    assert str(refused(damage.critical_distance, 1.0, 0.0)) == "limit_range: must be positive, not 0"
