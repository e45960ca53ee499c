"""The fatigue of a history as a section [fatigue] asks for it, in Python and in stored results."""

import dataclasses
import re
import warnings

import numpy as np
import pytest

import fastpin
from fastpin import damage
from fastpin.bodies import Bushing
from fastpin.errors import InputError, InputWarning
from fastpin.model import FatigueAssessment
from tests.support.fatigue import ALUMINIUM as MATERIAL
from tests.support.fatigue import PAIR

SWT, FS = "smith-watson-topper", "fatemi-socie"


@pytest.fixture(scope="module")
def result():
    """A constant P, and a Q that turns three times, in a bush that both bodies have constants for."""
    pair = fastpin.MaterialPair(MATERIAL, MATERIAL)
    problem = fastpin.Problem(pair, 10e-3, 40e-6, 0.4, plate_body=Bushing(MATERIAL, 15e-3, 5e-6))
    history = fastpin.LoadHistory([{"P": 4e6}]) + fastpin.LoadHistory([{"Q": 1e6}, {"Q": -1e6}]).repeated(3)
    return fastpin.solve(problem, history, nodes=61)


@pytest.mark.gate
def test_the_bodies_have_the_damage_of_each_one_alone(result):
    found = result.assessed_fatigue(FatigueAssessment([SWT, FS]))
    assert [one.criterion for one in found] == [SWT] * 3 + [FS] * 3
    for criterion, some in ((SWT, found[:3]), (FS, found[3:])):
        sizes = [one.hot_spot.damage for one in some]
        assert sizes == sorted(sizes, reverse=True)
        assert {one.body for one in some} == {"plate", "seat", "pin"}
        for one in some:
            same = result.spectrum_damage(criterion, one.body)
            np.testing.assert_allclose(one.damage, same.damage, rtol=1e-12)
            assert one.hot_spot == same.hot_spot


@pytest.mark.parametrize(
    "rule", [{}, {"small_cycles": "haibach", "knee": 1e6}, {"small_cycles": "original", "knee": 1e8}]
)
def test_one_place_has_the_damage_of_the_edge(result, rule):
    """The same damage as that of the one-point way, to 1e-9."""
    whole = result.assessed_fatigue(FatigueAssessment(bodies="plate", **rule))[0]
    spot = whole.hot_spot
    angle = np.degrees(spot.theta) + 90.0
    (one,) = result.assessed_fatigue(FatigueAssessment(bodies="plate", angles=angle, **rule))
    assert one.hot_spot.damage == pytest.approx(spot.damage, rel=1e-9)
    points = fastpin.Points.at_depth(0.0, spot.theta)
    assert float(result.spectrum_damage(points=points, **rule).damage) == pytest.approx(spot.damage, rel=1e-9)


@pytest.mark.parametrize("method", ["point", "line", "area"])
def test_a_single_cycle_at_a_distance(result, method):
    """Two stops are one cycle: the damage is 1/N of the criterion by the same method, at the same places."""
    stops = damage.cycle_states(result, result.cycles[-1])[:2]
    angles = np.array([70.0, 95.0])
    how = FatigueAssessment(bodies="plate", method=method, angles=angles.tolist(), straight=False)
    (found,) = damage.assessed_fatigue(stops, how)
    same = damage.fatigue_at_distance(stops, SWT, method, theta=np.radians(angles - 90.0))
    np.testing.assert_allclose(found.life, same.life, rtol=1e-7)
    np.testing.assert_array_equal(found.depth, same.depth)
    # without angles it is the hot spot of the edge
    edge = damage.assessed_fatigue(stops, FatigueAssessment(bodies="plate"))[0].hot_spot
    (alone,) = damage.assessed_fatigue(stops, how.changed(angles=None))
    assert alone.theta.tolist() == [edge.theta]
    assert alone.hot_spot.damage < edge.damage


def test_the_last_cycle_alone(result):
    (found,) = result.assessed_fatigue(FatigueAssessment(bodies="plate", over="cycle"))
    cycle = result.fatigue(SWT)
    assert found.hot_spot.life == pytest.approx(cycle.hot_spot.life, rel=1e-8)


def test_straight_lines(result):
    one, two = (result.assessed_fatigue(FatigueAssessment(bodies="plate", straight=each))[0] for each in (False, True))
    np.testing.assert_array_equal(two.damage, result.spectrum_damage(straight=True).damage)
    assert one.hot_spot.damage > two.hot_spot.damage > 0.0  # between so few nodes lines miss the peaks


def test_a_repeated_block_enters_with_its_number():
    """A history of two blocks, written once with repeats and once corner by corner."""
    problem = fastpin.Problem(fastpin.MaterialPair(fastpin.Material.rigid(), MATERIAL), 10e-3, 40e-6, 0.0)
    start, block = fastpin.LoadHistory([{"P": 5e6}]), [{"P": 1e6}, {"P": 3e6}]
    repeated = fastpin.solve(problem, start + fastpin.LoadHistory(block).repeated(25), nodes=61)
    written = fastpin.solve(problem, start + fastpin.LoadHistory(block * 25), nodes=61)
    assert [len(each.cycles) for each in (repeated, written)] == [25, 0]
    how = FatigueAssessment(small_cycles="haibach", knee=1e6)
    one, two = (each.assessed_fatigue(how)[0] for each in (repeated, written))
    assert one.hot_spot.damage == pytest.approx(two.hot_spot.damage, rel=1e-9)
    assert sum(one.cycles.times.tolist()) == sum(two.cycles.times.tolist())
    assert 20 < max(one.cycles.times.tolist()) <= 25


def test_progress_goes_on_to_the_end(result):
    done = []
    result.assessed_fatigue(FatigueAssessment([SWT, FS], method="line"), lambda part, total: done.append(part / total))
    assert done == sorted(done)
    assert done[-1] == pytest.approx(1.0)


def test_a_stored_result_knows_its_assessment(tmp_path):
    problem = fastpin.Problem(PAIR, 10e-3, 40e-6, 0.4)
    how = FatigueAssessment([SWT, FS], "plate", angles=[10.0, 95.5], small_cycles="original", knee=2e6, straight=True)
    fastpin.record(problem, [{"P": 1e6}, {"Q": 1e5}], tmp_path / "one.h5", fatigue=how, nodes=31)
    fastpin.record(problem, [{"P": 1e6}, {"Q": 1e5}], tmp_path / "two.h5", nodes=31)
    assert fastpin.storage.StoredResult(tmp_path / "one.h5").case.fatigue == how
    assert fastpin.storage.StoredResult(tmp_path / "two.h5").case.fatigue is None


BAD = {
    "criterion": ({"criterion": "findley"}, 'must be "smith-watson-topper", "fatemi-socie" or "stress-life", not'),
    "bodies": ({"bodies": ["plate", "plate"]}, "must be at least one word, each one once, not 2"),
    "over": ({"over": "block"}, 'must be "history" or "cycle", not "block"'),
    "method": ({"method": "volume"}, 'must be "edge", "point", "line" or "area", not "volume"'),
    "length": ({"length": 1e-5}, 'belongs to the methods "point", "line" and "area", but method is "edge"'),
    "angles": ({"angles": []}, "must be 1 to 10,000 angles, not 0"),
    "small_cycles": ({"small_cycles": "corten"}, 'must be "elementary", "original" or "haibach", not "corten"'),
    "straight": ({"straight": 2}, "must be true or false, not 2"),
}


@pytest.mark.parametrize("field", BAD)
def test_bad_fields(field):
    given, words = BAD[field]
    with pytest.raises(InputError, match=re.escape(f"{field}: {words}")):
        FatigueAssessment(**given)


def test_refused(result):
    pair, bare = fastpin.MaterialPair(MATERIAL, MATERIAL), dataclasses.replace(MATERIAL, fatigue=None)
    plain = fastpin.solve(fastpin.Problem(pair, 10e-3, 0.0, 0.4), [{"P": 1e6}, {"Q": 1e5}], nodes=31)
    bush = fastpin.Problem(fastpin.MaterialPair(bare, bare), 10e-3, 0.0, 0.4, plate_body=Bushing(bare, 15e-3))
    without = fastpin.solve(bush, [{"P": 1e6}, {"Q": 1e5}], nodes=31)
    with pytest.raises(InputError, match=r"smith-watson-topper needs fatigue_strength, .* of the bush's material"):
        without.assessed_fatigue()
    with pytest.raises(InputError, match='body: "seat" is the edge'):
        plain.assessed_fatigue(FatigueAssessment(bodies="seat"))
    with pytest.raises(InputError, match="over: the history has no cycles"):
        plain.assessed_fatigue(FatigueAssessment(over="cycle"))
    with pytest.raises(InputError, match="states: must have a turning point: their stresses do not change"):
        damage.assessed_fatigue([plain[0], plain[0]])
    with pytest.raises(InputError, match="states: must hold all corners of the history; 1 were not kept"):
        dataclasses.replace(plain, states=plain.states[:1]).assessed_fatigue()
    with pytest.raises(InputError, match="how: must be a FatigueAssessment"):
        result.assessed_fatigue("haibach")


@pytest.mark.gate
def test_straight_lines_on_a_coarse_grid_are_told(monkeypatch):
    """The worst cycle is read again with power laws, where straight lines are taken unasked."""
    rng = np.random.default_rng(1)
    loads = [{"P": p, "Q": q} for p, q in zip(rng.uniform(2e6, 6e6, 20), rng.uniform(-1e6, 1e6, 20), strict=True)]
    problem = fastpin.Problem(PAIR, 10e-3, 40e-6, 0.4)
    coarse, fine = (fastpin.solve(problem, loads, nodes=nodes) for nodes in (31, 201))
    monkeypatch.setattr("fastpin.damage.assessed.MOST_REFINED", 5)
    with pytest.warns(InputWarning, match=r"straight: with refined tractions the worst cycle .* 1\.3 times the damage"):
        coarse.assessed_fatigue()
    with warnings.catch_warnings():
        warnings.simplefilter("error", InputWarning)
        fine.assessed_fatigue()
        coarse.assessed_fatigue(FatigueAssessment(straight=True))
        coarse.assessed_fatigue(FatigueAssessment(straight=False))
