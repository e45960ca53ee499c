"""Very long histories: the memory of a count does not grow with the number of points."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin import damage
from fastpin.damage.counted import MOST_PATHS, _together
from fastpin.model import FatigueAssessment, FatigueConstants

MATERIAL = fastpin.Material(70e9, 0.33, "aluminium", FatigueConstants(1100e6, -0.124, 0.22, -0.59))
STATES, FEW, MANY = 3_000, 4, 24


@pytest.fixture(scope="module")
def states():
    """Three thousand states with different remote stresses, made from ten that were solved."""
    rng = np.random.default_rng(1)
    problem = fastpin.Problem(fastpin.MaterialPair(MATERIAL, MATERIAL), 10e-3, 40e-6, 0.4)
    loads = [{"P": p, "Q": q} for p, q in zip(rng.uniform(2e6, 6e6, 10), rng.uniform(-1e6, 1e6, 10), strict=True)]
    solved = list(fastpin.solve(problem, loads, nodes=41))
    extra = rng.uniform(-1e7, 1e7, STATES).tolist()
    return [replace(solved[k % 10], load={**solved[k % 10].load, "syy": extra[k]}) for k in range(STATES)]


def peak(count):
    """The most memory in use while a count runs, in bytes."""
    tracemalloc.start()
    try:
        count()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.gate
@pytest.mark.parametrize("what", ["damage", "reserve"])
def test_the_memory_of_a_count_does_not_grow_with_the_points(states, what, monkeypatch):
    """Each block has a few points. All points at once would need 5 MB for the stresses, and 14 MB beside them."""
    monkeypatch.setattr("fastpin.damage.histories.ROOM", FEW * (8 * 41 + 4 * STATES))

    def count(points):
        angles = np.linspace(-170.0, 170.0, points).tolist()
        how = FatigueAssessment(bodies="plate", angles=angles, straight=True, life=10.0)
        return damage.assessed_fatigue(states, how) if what == "damage" else damage.assessed_reserves(states, how)

    count(2)  # what is computed once
    few, many = (peak(lambda points=points: count(points)) for points in (FEW, MANY))
    assert many < 1.2 * few + 5e5
    assert few > 5e5


@pytest.mark.gate
def test_blocks_change_no_damage(states, monkeypatch):
    angles = np.linspace(-170.0, 170.0, 6).tolist()
    how = FatigueAssessment(bodies="plate", angles=angles, straight=True, life=10.0)
    (whole,), (all_at_once,) = damage.assessed_fatigue(states[:500], how), damage.assessed_reserves(states[:500], how)
    for name, room in (("histories.ROOM", 1), ("counted.MOST_PATHS", 1), ("reserve.MOST_SCALED", 1)):
        monkeypatch.setattr(f"fastpin.damage.{name}", room)
    (parts,), (one_by_one,) = damage.assessed_fatigue(states[:500], how), damage.assessed_reserves(states[:500], how)
    np.testing.assert_allclose(parts.damage, whole.damage, rtol=1e-9)
    assert one_by_one.factor == pytest.approx(all_at_once.factor, rel=1e-6)
    assert one_by_one.theta == all_at_once.theta


def test_few_points_of_a_long_history_are_counted_at_a_time():
    for states, steps in ((100, [64, 6]), (MOST_PATHS // 30, [30, 30, 10]), (2 * MOST_PATHS, [1] * 70)):
        history = np.broadcast_to(0.0, (states, 70, 4))
        assert [part.stop - part.start for part in _together(history)] == steps
