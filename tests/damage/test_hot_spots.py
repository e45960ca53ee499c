"""Fatigue over a cycle of a solved history, from the states to the hot spot."""

import dataclasses
import math
import pickle

import numpy as np
import pytest

import fastpin
from fastpin import InputError, damage
from fastpin.damage.hot_spots import edge_angles
from fastpin.model import FatigueConstants
from tests.support.refusals import refused

DEGREE = math.pi / 180.0


def test_the_states_of_a_cycle(fretting):
    """From the end of the cycle before to its own end: two steps of ten states, and the state at the beginning."""
    assert [one.corner for one in fretting.cycles] == [2, 4, 6]
    places = [state.step + state.fraction - 1.0 for state in damage.cycle_states(fretting, fretting.cycles[-1])]
    np.testing.assert_allclose(places, np.arange(4.0, 6.05, 0.1))


def test_a_cycle_without_its_corners_is_refused(fretting):
    states = [state for state in fretting if state.step != 5]
    with pytest.raises(InputError, match=r"^states: must hold all corners of the cycle, 5 to 7$"):
        damage.cycle_states(states, fretting.cycles[-1])


def test_the_hot_spot_lies_at_the_trailing_contact_edge(fretting, cycle):
    """The plate is torn there by the hoop stress. At full Q the trailing edge is the end opposite to Q."""
    found = fretting.fatigue("smith-watson-topper")
    spot = found.hot_spot
    edges = [end for state in cycle for start, stop in state.contact for end in (start, stop)]
    spacing = np.diff(cycle[0].theta).max()
    assert min(abs(spot.theta - end) for end in edges) < 1.5 * spacing
    largest = max(cycle, key=lambda state: state.hoop_stress("plate", spot.theta))
    assert abs(abs(largest.load["Q"]) - 6e5) < 1.0
    start, stop = largest.contact[0]
    trailing = start if largest.load["Q"] > 0.0 else stop
    assert abs(spot.theta - trailing) < 1.5 * spacing
    assert spot.depth == 0.0
    tangent = spot.theta + 0.5 * math.pi  # the hoop stress pulls along the edge; friction turns the plane
    assert abs(math.sin(spot.plane - tangent)) < math.sin(15.0 * DEGREE)
    assert 1e3 < spot.life < 1e12


def test_the_parameter_is_that_of_the_stresses(cycle):
    theta = np.array([-2.4, -0.8, 0.1])
    points = fastpin.Points.at_depth(np.array([[0.0], [2e-4]]), theta)
    found = damage.fatigue(cycle, "smith-watson-topper", points=points)
    assert found.parameter.shape == found.life.shape == found.plane.shape == found.depth.shape == (2, 3)
    hoop = np.array([state.hoop_stress("plate", theta) for state in cycle])
    pressure = np.array([-state.stress(fastpin.Points.at_depth(0.0, theta)).radial for state in cycle])
    free = np.all(np.abs(pressure) < 1e-9 * hoop.max(), axis=0)
    assert free.tolist() == [False, False, True]  # there the stress is one tension, in plane strain
    amplitude = 0.5 * np.ptp(hoop[:, 2]) * (1.0 - 0.33**2) / 70e9
    assert found.parameter[0, 2] == pytest.approx(hoop[:, 2].max() * amplitude, rel=1e-9)
    stresses = damage.stress_history(cycle, points)
    np.testing.assert_array_equal(damage.smith_watson_topper(stresses, 70e9, 0.33).parameter, found.parameter.ravel())


@pytest.mark.parametrize("criterion", damage.CRITERIA)
def test_every_criterion(fretting, cycle, criterion):
    found = fretting.fatigue(criterion)
    assert found.parameter.shape == found.theta.shape == found.depth.shape
    assert found.hot_spot.parameter == found.parameter.max() > 0.0
    by_planes = criterion not in ("crossland", "dang-van")
    assert (found.plane is not None) == by_planes
    if criterion in damage.SPECTRUM_CRITERIA:
        assert found.limit is None
        assert found.margin is None
        assert found.hot_spot.life == found.life.min()
    else:
        assert found.life is None
        assert math.isnan(found.hot_spot.life)
        np.testing.assert_allclose(found.margin, found.limit / found.parameter - 1.0)
    mixed = damage.fatigue(cycle[::-1], criterion)
    np.testing.assert_allclose(mixed.parameter, found.parameter, rtol=1e-12)


def test_the_unit_is_that_of_the_parameter(fretting):
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
    plain = fastpin.Problem.from_load_parameter(pair, 0.3, 0.4)
    for criterion, units in {
        "smith-watson-topper": ("Pa", "F^2 beta*/R^2"),
        "fatemi-socie": ("rad", "F beta*/R"),
        "findley": ("Pa", "F/R"),
    }.items():
        found = fretting.fatigue(criterion)
        assert (found.unit, dataclasses.replace(found, problem=plain).unit) == units


def test_edge_angles_hold_nodes_and_ends(cycle):
    angles = edge_angles(cycle)
    assert np.all(np.diff(angles) > 0.0)
    assert np.all(np.isin(cycle[0].theta, angles))
    for state in cycle:
        for start, stop in (*state.contact, *state.stick):
            assert np.isin([start, stop], angles).all()
    assert np.diff(angles).max() <= DEGREE * (1.0 + 1e-9)


def test_below_the_edge_the_parameter_falls(fretting):
    depths = np.array([0.0, 1e-4, 1e-3, 5e-3])
    largest = fretting.fatigue("smith-watson-topper", depth=depths[:, None]).parameter.max(axis=1)
    assert np.all(np.diff(largest) < 0.0)


def test_scaled_loads_scale_the_parameter():
    """With a neat fit all stresses scale with the load, and Smith, Watson and Topper's parameter with its square."""
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
    problem = fastpin.Problem(pair, 10e-3, 0.0, 0.4, pin_load="body")
    largest = []
    for scale in (1.0, 2.0):
        history = fastpin.LoadHistory([{"P": scale * 1e6}, {"Q": scale * 2e5}, {"Q": -scale * 2e5}])
        states = fastpin.solve(problem, history, nodes=101)[1:]
        largest.append(damage.fatigue(states, "smith-watson-topper").parameter)
    np.testing.assert_allclose(largest[1], 4.0 * largest[0], rtol=1e-8, atol=1e-8 * largest[0].max())


def test_a_mirrored_history_mirrors_the_parameter():
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["2024-T3"])
    problem = fastpin.Problem(pair, 10e-3, 2e-5, 0.4, pin_load="body")
    points = [fastpin.Points.at_depth(1e-4, -0.5 * math.pi + sign * np.linspace(-2.0, 2.0, 41)) for sign in (1, -1)]
    found = []
    for sign, place in zip((1.0, -1.0), points, strict=True):
        history = fastpin.LoadHistory([{"P": 2e6}, {"Q": sign * 5e5}, {"Q": -sign * 2e5}])
        states = fastpin.solve(problem, history, nodes=101, arc=(-3.4, 3.4 - math.pi))
        found.append(damage.fatigue(states, "smith-watson-topper", points=place))
    np.testing.assert_allclose(found[0].parameter, found[1].parameter, rtol=1e-7)
    np.testing.assert_allclose(np.cos(2 * found[0].plane), np.cos(2 * found[1].plane), atol=1e-5)


@pytest.mark.gate
def test_damage_sum_is_that_of_its_cycles(fretting):
    cycles = fretting.cycles[1:]
    theta, total = damage.damage_sum(fretting, cycles, "smith-watson-topper", repeats=100)
    points = fastpin.Points.at_depth(0.0, theta)
    stops = [damage.cycle_states(fretting, one) for one in cycles]
    lives = [damage.fatigue(each, "smith-watson-topper", points=points).life for each in stops]
    np.testing.assert_allclose(total, sum(100.0 / life for life in lives), rtol=1e-14)
    once = damage.damage_sum(fretting, cycles, "smith-watson-topper")[1]
    np.testing.assert_allclose(total, 100.0 * once, rtol=1e-14)
    assert total.max() >= 100.0 / fretting.fatigue("smith-watson-topper").life.min()


def test_all_states_without_cycles():
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["SAE 1020"])
    problem = fastpin.Problem(pair, 0.01, 1e-5, 0.3, pin_load="body")
    result = fastpin.solve(problem, [{"P": 1e6}, {"P": 5e5}, {"P": 1e6}], nodes=51)
    assert not result.cycles
    found, same = result.fatigue("smith-watson-topper"), damage.fatigue(result.states, "smith-watson-topper")
    np.testing.assert_array_equal(found.parameter, same.parameter)


def test_constants_replace_those_of_the_material(fretting):
    stronger = FatigueConstants(bending_limit=280e6, torsion_limit=170e6)
    found = fretting.fatigue("crossland", constants=stronger)
    np.testing.assert_allclose(found.parameter, fretting.fatigue("crossland").parameter, rtol=1e-14)
    assert found.limit == 2.0 * fretting.fatigue("crossland").limit


def test_without_constants_for_a_life_there_is_none(fretting):
    assert fretting.fatigue("smith-watson-topper", constants=FatigueConstants()).life is None
    assert fretting.fatigue("smith-watson-topper", "pin").life is None


def test_a_copy_and_a_text(fretting):
    found = fretting.fatigue("smith-watson-topper")
    copy = pickle.loads(pickle.dumps(found))
    np.testing.assert_array_equal(copy.parameter, found.parameter)
    assert copy.hot_spot == found.hot_spot
    assert repr(found).startswith("<Fatigue of the plate, smith-watson-topper: largest parameter ")
    assert repr(found).endswith(" cycles>")


@pytest.mark.gate
def test_bad_input(fretting, cycle):
    rigid = fastpin.MaterialPair(fastpin.Material.rigid(), fastpin.MATERIALS["steel"])
    other = dataclasses.replace(cycle[0], problem=dataclasses.replace(cycle[0].problem, pair=rigid))
    points = fastpin.Points.at_depth(0.0, 0.0)
    fatigue = {
        "states: must be the stops of a cycle, at least two, not 1": {"states": cycle[:1]},
        "states: must be a sequence of fastpin.State, not 3": {"states": [3, 4]},
        "states: must be a sequence of fastpin.State, not true": {"states": True},
        "states: must be states of one problem": {"states": [cycle[0], other]},
        "criterion: must be": {"criterion": "swt"},
        "body: must be": {"body": "hole"},
        "points: must be fastpin.Points": {"points": [0.0]},
        "depth: can't be given together with points": {"points": points, "depth": 1e-3},
        "depth: must be at least 0": {"depth": -1.0},
        "fatigue: crossland needs bending_limit, torsion_limit of the pin's material": {"body": "pin"},
        "fatigue: fatemi-socie needs normal_stress_factor of the plate's material": {
            "criterion": "fatemi-socie",
            "constants": FatigueConstants(yield_strength=1.0),
        },
        "constants: must be": {"constants": {}},
        # first: a rigid body has no stress at any depth
        "body: the pin is rigid: its stress is not determined": {"states": [other] * 2, "body": "pin", "depth": 1e3},
    }
    for sentence, given in fatigue.items():
        error = refused(damage.fatigue, **{"states": cycle, "criterion": "crossland", **given})
        assert str(error).startswith(sentence)
    sums = {
        "cycles: must be at least one": ([], "crossland"),
        "criterion: the plate's material has no constants for a life by crossland": (fretting.cycles, "crossland"),
    }
    for sentence, arguments in sums.items():
        assert str(refused(damage.damage_sum, fretting, *arguments)).startswith(sentence)
    error = refused(damage.damage_sum, fretting, fretting.cycles, "smith-watson-topper", repeats=0)
    assert str(error) == "repeats: must be a whole number of at least 1, not 0"
    assert str(refused(damage.cycle_states, fretting, 3)).startswith("cycle: must be")
