"""Damage of spectra: stresses of many states by a product, cases worked by hand, and laws that hold for all spectra."""

import dataclasses
import math
import pickle

import numpy as np
import pytest

import fastpin
from fastpin import InputError, damage
from fastpin.bodies import Bushing, Ring, Tube
from fastpin.damage import smith_watson_topper_life
from fastpin.damage.counted import CountedMaterial, Spectrum
from fastpin.damage.histories import history_blocks
from fastpin.model import FatigueConstants
from tests.support.fatigue import ALUMINIUM as MATERIAL
from tests.support.fatigue import PAIR, uniaxial
from tests.support.refusals import refused
from tests.support.tiers import seeds

SWT, FS = "smith-watson-topper", "fatemi-socie"
LIFE = {"fatigue_strength": 1100e6, "strength_exponent": -0.124, "fatigue_ductility": 0.22, "ductility_exponent": -0.59}


def random_loads(corners, seed=1, **steady):
    rng = np.random.default_rng(seed)
    loads = zip(rng.uniform(1e6, 5e6, corners).tolist(), rng.uniform(-1e6, 1e6, corners).tolist(), strict=True)
    return fastpin.LoadHistory([{"P": along, "Q": across, **steady} for along, across in loads])


def problem_of(**bodies):
    return fastpin.Problem(PAIR, 10e-3, 40e-6, 0.4, **bodies)


def sum_of(values, order=None):
    """The damage of a stress sxx, with its plane."""
    counted = CountedMaterial.of(SWT, MATERIAL, None, "plate")
    spectrum = Spectrum.of(np.arange(len(values)) if order is None else np.asarray(order))
    found, plane = counted.worst(uniaxial(np.asarray(values, dtype=float)), spectrum)
    return float(found[0]), float(plane[0])


def by_hand(low, high):
    """1/N of a cycle of sxx: the largest stress times the strain amplitude, without any plane."""
    return 1.0 / float(smith_watson_topper_life(high * (high - low) / 2.0 / 70e9, 70e9, **LIFE))


# -- stresses --------------------------------------------------------------------------------------------------------

CASES = {
    "infinite plate": ({}, ("plate", "pin"), {}),
    "remote stress": ({}, ("plate", "pin"), {"sxx": 4e7, "sxy": -1e7}),
    "ring": ({"plate_body": Ring(25e-3)}, ("plate",), {}),
    "tube": ({"pin_body": Tube(5e-3)}, ("pin",), {}),
    "bush": ({"plate_body": Bushing(MATERIAL, 12.5e-3, 10e-6)}, ("plate", "seat"), {}),
    "bush that slips": (
        {"plate_body": Bushing(MATERIAL, 12.5e-3, 30e-6, friction=0.2, bonded=False)},
        ("plate", "seat", "pin"),
        {"sxx": 1e7},
    ),
}


@pytest.mark.gate
@pytest.mark.parametrize("name", CASES)
def test_the_product_gives_the_stresses_of_each_state(name):
    """Straight lines: to 1e-9 of the largest stress. Refined tractions: the reading of the state, to the last bit."""
    bodies, edges, steady = CASES[name]
    corners = 24
    states = list(fastpin.solve(problem_of(**bodies), random_loads(corners, **steady), nodes=61))
    points = fastpin.Points.at_depth(np.array([[0.0], [4e-4], [4e-3]]), np.linspace(-3.0, 1.0, 7))
    for body in edges:
        for straight in (True, False):
            found = damage.stress_history(states, points, body, straight)
            assert found.shape == (corners, 21, 4)
            for k in (0, 3, corners - 1):
                stress = states[k].stress(points, body, straight)
                one = np.stack([stress.sxx, stress.syy, stress.axial, stress.sxy], axis=-1).reshape(-1, 4)
                if straight:
                    np.testing.assert_allclose(found[k], one, rtol=0.0, atol=1e-9 * np.abs(found).max())
                else:
                    np.testing.assert_array_equal(found[k], one)


@pytest.mark.gate
def test_blocks_of_points_and_points_deep_in_the_pin(monkeypatch):
    states = list(fastpin.solve(problem_of(), random_loads(45), nodes=31))
    points = fastpin.Points.at_depth(np.array([[0.0], [9e-3]]), np.linspace(-3.0, 1.0, 5))
    whole = damage.stress_history(states, points, "plate", True)
    deep = damage.stress_history(states, points, "pin", True)
    read = states[7].stress(points, "pin", True)  # state by state
    np.testing.assert_array_equal(deep[7, :, 0], read.sxx.ravel())
    monkeypatch.setattr("fastpin.damage.histories.ROOM", 3 * (8 * 31 + 4 * 45))
    blocks = list(history_blocks(states, points, "plate", True))
    assert [block.stop - block.start for block, _ in blocks] == [3, 3, 3, 1]
    found = np.concatenate([history for _, history in blocks], axis=1)
    np.testing.assert_allclose(found, whole, rtol=0.0, atol=1e-9 * np.abs(whole).max())
    done = []
    one = damage.spectrum_damage(states, straight=True, progress=lambda part, total: done.append(part / total))
    assert done == sorted(done)
    assert done[-1] == 1.0
    assert one.damage.any()


# -- cases worked by hand --------------------------------------------------------------------------------------------


LEVELS = {
    "one": ([0.0, 300e6], [0, 1], [(1, 0.0, 300e6)]),
    "two": ([0.0, 200e6, -100e6, 300e6], [0, 1] * 40 + [2, 3] * 3, [(40, 0.0, 200e6), (3, -100e6, 300e6)]),
    "one in another": (
        [0.0, 100e6, 250e6, 200e6],
        [0, *[2, 1] * 10, *[2, 3] * 100, 2],
        [(1, 0.0, 250e6), (10, 100e6, 250e6), (100, 200e6, 250e6)],
    ),
}
"""Stresses, their order, and the cycles that they make: how many, lowest and highest stress."""


@pytest.mark.parametrize("name", LEVELS)
def test_levels_worked_by_hand(name):
    values, order, cycles = LEVELS[name]
    found, plane = sum_of(values, order)
    assert found == pytest.approx(sum(times * by_hand(low, high) for times, low, high in cycles), rel=1e-9)
    assert plane == pytest.approx(0.0, abs=1e-4)


def test_fatemi_socie_under_pure_shear():
    """Reversed shear: the plane with the largest shear has no normal stress, and the worst one is a compromise."""
    history = np.zeros((2, 1, 4))
    history[:, 0, 3] = 100e6, -100e6
    constants = FatigueConstants(
        normal_stress_factor=1.0, yield_strength=379e6, shear_fatigue_strength=640e6, shear_strength_exponent=-0.124,
        shear_fatigue_ductility=0.38, shear_ductility_exponent=-0.59,
    )  # fmt: skip
    counted = CountedMaterial.of(FS, MATERIAL, constants, "plate")
    found, plane = counted.worst(history, Spectrum.of(np.arange(2)))
    worst = damage.fatemi_socie(history, MATERIAL.shear_modulus, 1.0, 379e6)
    names = ("shear_fatigue_strength", "shear_strength_exponent", "shear_fatigue_ductility", "shear_ductility_exponent")
    life = damage.fatemi_socie_life(worst.parameter, MATERIAL.shear_modulus, *constants.required(names, FS, "plate"))
    assert found[0] == pytest.approx(1.0 / life[0], rel=1e-8)
    assert abs(math.sin(2.0 * plane[0])) == pytest.approx(abs(math.sin(2.0 * worst.angle[0])), abs=1e-3)


# -- laws ------------------------------------------------------------------------------------------------------------


def test_laws_of_random_histories():
    """The beginning makes no difference, repeats multiply, and slow stops on the way do nothing."""
    for seed in seeds(100):
        rng = np.random.default_rng(seed)
        size = int(rng.integers(2, 40))
        values = rng.uniform(-2e8, 3e8, size)
        found, _ = sum_of(values)
        ranges = damage.rainflow(values)
        tops = ranges.mean + 0.5 * ranges.range
        expected = sum(by_hand(top - size, top) for size, top in zip(ranges.range, tops, strict=True) if top > 0.0)
        assert found == pytest.approx(expected, rel=1e-9)
        assert sum_of(np.roll(values, int(rng.integers(size))))[0] == pytest.approx(found, rel=1e-12)
        for times in (2, 3, 7):
            assert sum_of(values, np.tile(np.arange(size), times))[0] == pytest.approx(times * found, rel=1e-9)
        between = 0.5 * (values + np.roll(values, -1))
        assert sum_of(np.column_stack([values, between]).ravel())[0] == pytest.approx(found, rel=1e-12)


def on_plane(history, plane):
    """Normal stress and normal strain of a plane."""
    sxx, syy, szz, sxy = history.T
    normal = sxx * math.cos(plane) ** 2 + syy * math.sin(plane) ** 2 + sxy * math.sin(2.0 * plane)
    return normal, (1.33 * normal - 0.33 * (sxx + syy + szz)) / 70e9


def searched(history, plane):
    """The damage of one plane from the ranges and means of its strain, where all stresses grow with one load."""
    normal, strain = on_plane(history, plane)
    k = int(np.argmax(np.abs(strain)))
    ratio, counts = normal[k] / strain[k], damage.rainflow(strain)
    tops = np.maximum(ratio * (counts.mean + 0.5 * counts.range), ratio * (counts.mean - 0.5 * counts.range))
    parameters = np.maximum(tops, 0.0) * 0.5 * counts.range
    return (1.0 / smith_watson_topper_life(parameters, 70e9, **LIFE)).sum()


@pytest.mark.gate
def test_a_brute_search_finds_no_worse_plane():
    """Stresses of one load: every half degree, counted by pylife, with the stress at the upper reversals."""
    for seed in seeds(10):
        rng = np.random.default_rng(seed)
        history = rng.uniform(-1.0, 2.0, (25, 1, 1)) * rng.uniform(-1e8, 2e8, 4)
        counted, spectrum = CountedMaterial.of(SWT, MATERIAL, None, "plate"), Spectrum.of(np.arange(25))
        (found,), (plane,) = counted.worst(history, spectrum)
        sums = [searched(history[:, 0], x) for x in np.radians(np.arange(-90.0, 90.0, 0.5))]
        assert max(sums) * (1.0 - 1e-9) <= found <= max(sums) * 1.001  # the scan is the coarser search
        assert found == pytest.approx(searched(history[:, 0], plane), rel=1e-9)


def test_blocks_of_a_spectrum():
    spectrum = Spectrum.of(np.array([9, *[0, 1, 0, 2] * 5, 0, 3, 3, *[4, 5] * 4, 6]))
    assert spectrum.blocks.tolist() == [[0, 1, 1], [1, 5, 5], [5, 8, 1], [8, 10, 4], [10, 11, 1]]
    assert spectrum.order.tolist() == [9, 0, 1, 0, 2, 0, 3, 3, 4, 5, 6]
    for seed in range(50):
        rng = np.random.default_rng(seed)
        order = np.concatenate([np.tile(rng.integers(0, 4, rng.integers(1, 6)), rng.integers(1, 7)) for _ in range(5)])
        order, blocks = order.astype(np.int64), Spectrum.of(order.astype(np.int64))
        again = [np.tile(blocks.order[first:last], times) for first, last, times in blocks.blocks.tolist()]
        np.testing.assert_array_equal(np.concatenate(again), order)


# -- states ----------------------------------------------------------------------------------------------------------


def test_one_cycle_does_the_damage_of_the_criterion(fretting):
    cycle = damage.cycle_states(fretting, fretting.cycles[-1])
    points = fastpin.Points.at_depth(0.0, np.linspace(-3.0, 0.5, 40))
    for criterion in damage.SPECTRUM_CRITERIA:
        one = damage.fatigue(cycle, criterion, points=points)
        found = damage.spectrum_damage(cycle, criterion, points=points)
        assert np.all(found.damage >= (1.0 - 1e-6) / one.life)  # smaller cycles come on top
        at = int(np.argmax(found.damage))
        assert found.damage[at] == pytest.approx(1.0 / one.life[at], rel=1e-3)
        assert found.hot_spot.life == pytest.approx(found.life.min())


@pytest.mark.gate
def test_the_damage_of_a_result(fretting):
    found = fretting.spectrum_damage()
    spot, cycles = found.hot_spot, found.cycles
    assert found.damage.shape == found.plane.shape == found.theta.shape
    assert found.damage.max() == spot.damage == pytest.approx(1.0 / spot.life)
    assert cycles.damage.sum() == pytest.approx(spot.damage, rel=1e-12)
    assert np.all(np.diff(cycles.damage) <= 0.0)
    assert set(np.r_[cycles.start, cycles.stop, cycles.largest]) <= {s.step + s.fraction for s in fretting}
    assert "life" in repr(found)
    assert pickle.loads(pickle.dumps(found)).hot_spot == spot
    tripled = damage.spectrum_damage(list(fretting) * 5)
    np.testing.assert_allclose(tripled.damage, 5.0 * found.damage, rtol=1e-6)


@pytest.mark.gate
def test_bodies_are_ranked_with_their_own_constants():
    weak = dataclasses.replace(MATERIAL.fatigue, fatigue_strength=800e6)
    bush = Bushing(fastpin.Material(110e9, 0.34, "bronze", weak), 12.5e-3, 10e-6)
    states = list(fastpin.solve(problem_of(plate_body=bush), random_loads(12), nodes=61))
    found = damage.damage_ranking(states, straight=True)
    assert {one.body for one in found} <= {"plate", "seat"}
    assert [one.hot_spot.damage for one in found] == sorted((one.hot_spot.damage for one in found), reverse=True)
    for one in found:
        alone = damage.spectrum_damage(states, body=one.body, straight=True)
        np.testing.assert_array_equal(one.damage, alone.damage)
    wall = fastpin.Points.at_depth(np.array([[1e-3], [4e-3]]), np.linspace(-1.0, 0.0, 3))
    both = damage.spectrum_damage(states, points=wall, straight=True)
    points = fastpin.Points.at_depth(1.5e-3, wall.theta[1])
    beyond = damage.spectrum_damage(states, body="seat", points=points, straight=True)
    np.testing.assert_allclose(both.damage[1], beyond.damage, rtol=1e-9)


def test_no_hot_spot_without_damage():
    states = list(fastpin.solve(problem_of(), random_loads(6), nodes=61))
    inside = fastpin.Points.at_depth(0.0, [-0.5 * math.pi])  # under the pin there is pressure only
    found = damage.spectrum_damage(states, points=inside)
    assert not found.damage.any()
    assert math.isnan(found.hot_spot.theta)
    assert found.hot_spot.life == math.inf
    assert found.cycles.damage.size == 0
    assert "no damage" in repr(found)


def test_bad_input(fretting):
    steel = fastpin.MATERIALS["steel"]
    bare = fastpin.Problem(fastpin.MaterialPair(steel, steel), 10e-3, 4e-5, 0.4)
    states = list(fastpin.solve(bare, random_loads(3), nodes=61))
    names = "fatigue_strength, strength_exponent, fatigue_ductility, ductility_exponent"
    missing = f"fatigue: smith-watson-topper needs {names} of the plate's material"
    assert str(refused(damage.spectrum_damage, states)) == str(refused(damage.damage_ranking, states)) == missing
    points = fastpin.Points.at_depth(0.0, 0.0)
    error = refused(damage.spectrum_damage, fretting, depth=0.0, points=points)
    assert str(error) == "depth: can't be given together with points"
    for stops, sentence in (
        (fretting[:1], "states: must be the stops of a cycle, at least two, not 1"),
        ([fretting[0]] * 3, "states: must have a turning point: their stresses do not change"),
    ):
        assert str(refused(damage.spectrum_damage, stops)) == sentence
    with pytest.raises(InputError, match=r"^criterion: findley has no life; use "):
        damage.spectrum_damage(fretting, "findley")
    with pytest.raises(InputError, match=r"^states: must hold all corners of the history; 6 were not kept$"):
        dataclasses.replace(fretting, states=fretting.states[-1:]).spectrum_damage()
