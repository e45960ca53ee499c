"""Damage that belongs to the material, and goes with it when it is worn off."""

from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin.damage import Race, fatigue, worn_fatigue
from fastpin.damage.hot_spots import edge_angles
from fastpin.model import FatigueConstants
from fastpin.model.angles import from_bottom
from fastpin.wear_lives import WornCycle
from tests.support.refusals import refused

ALUMINIUM = FatigueConstants(
    fatigue_strength=1.014e9, strength_exponent=-0.11, fatigue_ductility=0.21, ductility_exponent=-0.52
)


@pytest.fixture(scope="module")
def states():
    """The corners of a cycle with partial slip."""
    plate = fastpin.Material(71e9, 0.33, fatigue=ALUMINIUM)
    pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], plate)
    problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=5e-5, friction=0.6)
    history = fastpin.LoadHistory([{"P": 5e6, "Q": 2e6}, {"Q": -2e6}, {"Q": 2e6}])
    return tuple(fastpin.solve(problem, history, nodes=41))


def _life(states, worn):
    """Chosen cycles with the same states, by the number of cycles and the depth worn off the plate (n,), m."""
    nothing = np.zeros_like(states[0].theta)
    return [WornCycle(n, 1, n, nothing, nothing + depth, 0.0, 0.0, states) for n, depth in worn.items()]


@pytest.mark.gate
def test_without_wear_the_life_is_that_of_the_cycle(states):
    today = fatigue(states, "smith-watson-topper").hot_spot
    life = int(2 * today.life)
    found = worn_fatigue(_life(states, {0: 0.0, life // 3: 0.0, life: 0.0}))
    assert found.life == pytest.approx(today.life, rel=1e-14)
    assert found.first_life == pytest.approx(today.life, rel=1e-14)  # products of other sizes
    assert (found.crack.theta, found.crack.depth) == (today.theta, 0.0)
    assert found.error < 1e-14
    assert not found.is_gone.any()
    assert np.isinf(found.gone).all()
    assert found.race is Race.CRACK
    assert not found.wear_wins
    assert worn_fatigue(_life(states, {0: 0.0, life // 3: 0.0})).race is Race.OPEN


@pytest.mark.gate
def test_damage_under_a_surface_that_wears_at_a_constant_rate_is_an_integral(states):
    """Seen from the material at the depth z, the surface comes nearer: D = int dn / N_f(z - w' n)."""
    spot = fatigue(states, "smith-watson-topper").hot_spot
    depth, cycles, rate = 0.4e-3, 40_000, 5e-9
    ends = np.linspace(0, cycles, 201).astype(int)
    found = worn_fatigue(_life(states, {int(n): rate * n for n in ends}), theta=[spot.theta], depth=[depth])
    u, weight = np.polynomial.legendre.leggauss(40)
    n = 0.5 * cycles * (1.0 + u)
    lives = fatigue(states, "smith-watson-topper", points=fastpin.Points.at_depth(depth - rate * n, spot.theta)).life
    expected = 0.5 * cycles * weight @ (1.0 / lives)
    assert lives.max() > 5.0 * lives.min()
    assert found.damage[-1, 0, 0] == pytest.approx(expected, rel=1e-4)
    errors = []
    for steps in (10, 20):
        few = np.linspace(0, cycles, steps + 1).astype(int)
        life = worn_fatigue(_life(states, {int(n): rate * n for n in few}), theta=[spot.theta], depth=[depth])
        errors.append(life.damage[-1, 0, 0] / expected - 1.0)
        assert abs(errors[-1]) < life.error
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)  # the trapezoidal rule


def test_material_that_is_gone_neither_breaks_nor_sums_up_more(states):
    """The rates at a surface point with its depth reached inside an interval, by hand."""
    spot = fatigue(states, "smith-watson-topper").hot_spot
    life, depth = spot.life, 1e-6
    # The depth z is reached after a quarter of the first interval, before the damage is 1; nothing wears later.
    cycles = {0: 0.0, int(2 * life): 4 * depth, int(5 * life): 4 * depth}
    found = worn_fatigue(_life(states, cycles), theta=[spot.theta], depth=[0.0, depth, 4 * depth, 8 * depth])
    assert found.is_gone[1:, :, 0].tolist() == [[True, True, False, False]] * 2
    assert found.damage[-1, 0, 0] == 0.0  # the first surface is gone at once
    below = fatigue(states, "smith-watson-topper", points=fastpin.Points.at_depth(depth, [spot.theta])).life[0]
    rate = 7 / 8 / below + 1 / 8 / life  # in the middle of the quarter, between those of z and of the surface
    assert found.damage[-1, 1, 0] == pytest.approx(int(2 * life) / 4 * rate, rel=1e-12)
    assert found.damage[-1, 1, 0] == found.damage[1, 1, 0]
    assert np.isinf(found.broken[:2, 0]).all()
    assert np.isfinite(found.broken[2:, 0]).all()
    assert found.crack.depth == 4 * depth  # its surface at the end
    assert found.gone[:, 0].tolist() == pytest.approx([0.0, int(2 * life) / 4, np.inf, np.inf])
    assert found.race is Race.CRACK
    place = f"at {from_bottom(spot.theta):.4g} deg, 4 um below the first surface"
    assert f"{float(f'{found.life:.4g}'):,.0f} cycles {place}" in found.words
    # The shallow material alone: wear takes it before it breaks.
    shallow = worn_fatigue(_life(states, cycles), theta=[spot.theta], depth=[0.0, depth])
    assert np.isinf(shallow.life)
    assert shallow.race is Race.WEAR
    assert shallow.wear_wins
    assert f"on the first profile one after {life:.4g}" in repr(shallow)


@pytest.mark.gate
def test_each_body_wears_by_its_own_depth(states):
    pin = replace(_life(states, {0: 0.0})[0], cycle=1000, pin_depth=np.full(41, 3e-6), plate_depth=np.full(41, 1e-6))
    cycles = [*_life(states, {0: 0.0}), pin]
    constants = {"constants": ALUMINIUM, "theta": states[0].theta[10:12]}
    assert worn_fatigue(cycles, body="pin", **constants).worn[-1].tolist() == [3e-6] * 2
    assert worn_fatigue(cycles, body="plate", **constants).worn[-1].tolist() == [1e-6] * 2
    default = worn_fatigue(cycles)
    assert np.array_equal(default.theta, edge_angles(states))
    beyond = default.worn[-1][(default.theta > states[0].theta[-1]) & (default.theta < states[0].theta[0] + 2 * np.pi)]
    assert beyond.size
    assert not beyond.any()  # beyond the arc nothing wears


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"criterion": "findley"}, "fatigue"),
        ({"criterion": "nonsense"}, "criterion"),
        ({"body": "seat"}, "body"),
        ({"body": "plate", "constants": FatigueConstants()}, "criterion"),
        ({"depth": [-1e-6]}, "depth"),
        ({"theta": []}, "theta"),
        ({"cycles": 1}, "cycles"),
    ],
)
def test_bad_input_is_refused_in_one_sentence(states, arguments, field):
    cycles = _life(states, {0: 0.0, 10: 1e-7})[: arguments.pop("cycles", 2)]
    assert refused(worn_fatigue, cycles, **arguments).field == field
