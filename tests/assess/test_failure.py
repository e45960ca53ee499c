"""The load at which the first ply of a laminate fails round the hole."""

import math

import pytest

from fastpin import MATERIALS, InputError, MaterialPair, Problem, solve
from fastpin.assess import failure_load
from fastpin.assess.strength import _next_factor
from fastpin.damage import joint_strength
from fastpin.model import Laminate

PLATE = Laminate.from_layup("[0/45/-45/90]2s", "T300/914")


def problem(clearance: float = 20e-6, plate: Laminate = PLATE) -> Problem:
    return Problem(MaterialPair(MATERIALS["steel"], plate, "stress"), 3e-3, clearance, 0.2)


@pytest.mark.parametrize("lengths", [{"distance": 0.4e-3}, {"tension": 0.5e-3, "compression": 1.5e-3}])
@pytest.mark.parametrize("criterion", ["hashin", "tsai-wu", "yamada-sun"])
def test_at_the_load_of_failure_the_ratio_is_one(criterion, lengths):
    found = failure_load(problem(), [{"P": 1e6, "syy": 20e6}], criterion, **lengths, nodes=101)
    assert found.strength.least_ratio == pytest.approx(1.0, abs=2e-6)
    again = solve(problem(), [{"P": 1e6 * found.factor, "syy": 20e6 * found.factor}], nodes=101)[-1]
    assert joint_strength(again, criterion, **lengths).least_ratio == pytest.approx(1.0, abs=2e-6)


def test_a_neat_fit_fails_at_its_ratio():
    """Its stresses are in proportion to the load."""
    neat = problem(0.0)
    ratio = joint_strength(solve(neat, [{"P": 1e6}], nodes=101)[-1], "maximum-stress", distance=0.5e-3).least_ratio
    found = failure_load(neat, [{"P": 1e6}], "maximum-stress", distance=0.5e-3, nodes=101)
    assert found.factor == pytest.approx(ratio, rel=1e-6)
    assert found.solved == 2


def test_a_laminate_and_its_load_in_another_direction_fail_alike():
    def factor(plate: Laminate, loads: dict[str, float]) -> float:
        return failure_load(problem(plate=plate), [loads], distance=0.5e-3, nodes=101).factor

    assert factor(PLATE, {"P": 1e6}) == pytest.approx(factor(PLATE.turned(0.5 * math.pi), {"Q": 1e6}), rel=1e-4)


def test_the_next_factor_stays_between_those_that_are_known():
    assert _next_factor([(0.0, 0.5)]) == 0.5
    assert _next_factor([(0.0, 0.5), (0.5, -0.5)]) == 0.25
    known = [(0.0, 0.5), (0.5, -0.1), (0.45, 0.4)]
    assert 0.45 < _next_factor(known) < 0.5


@pytest.mark.gate
def test_a_ply_may_fail_in_any_state_or_at_the_end():
    loads = [{"P": 1e6}, {"P": 5e5}]
    factors = [
        failure_load(problem(), loads, distance=0.5e-3, over=over, nodes=101).factor for over in ("history", "end")
    ]
    assert factors[0] < factors[1]
    alone = failure_load(problem(), loads[:1], distance=0.5e-3, nodes=101)
    assert factors[0] == pytest.approx(alone.factor, rel=1e-5)
    with pytest.raises(InputError, match='over: must be "end" or "history"'):
        failure_load(problem(), loads, distance=0.5e-3, over="all")


def test_without_stress_there_is_no_factor():
    with pytest.raises(InputError, match="history: must stress the laminate"):
        failure_load(problem(), [{"P": 0.0}], distance=1e-3, nodes=61)
