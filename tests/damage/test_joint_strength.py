"""Strength of a laminate round the hole of a solved state, and the load at failure."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fastpin.damage import JointStrength, failure_load, joint_strength, ply_failure, ply_stresses
from fastpin.damage.joint_strength import JOINT_MODES, _next_factor
from fastpin.errors import InputError
from fastpin.model.laminate import Laminate
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.points import Points
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from tests.support.laminates import TURNED
from tests.support.once import solve_once

PLATE = Laminate.from_layup("[0/45/-45/90]2s", "T300/914")


def problem(clearance: float = 20e-6, plate: Laminate = PLATE, friction: float = 0.2) -> Problem:
    return Problem(MaterialPair(MATERIALS["steel"], plate, "stress"), 3e-3, clearance, friction)


def state(**loads: float):
    return solve_once(problem(), [loads or {"P": 1e6}], nodes=101)[-1]


def test_stresses_of_plies_add_up_to_those_of_the_whole():
    points = Points.at_depth(0.5e-3, np.linspace(-3.0, 3.0, 7))
    found, whole = ply_stresses(state(), points), state().stress(points)
    assert found.shape == (16, 7, 3)
    total = np.zeros((7, 3))
    for (ply, angle), stress in zip(PLATE.plies, found, strict=True):
        turn = PLATE.axis + math.radians(angle)
        c, s = math.cos(turn), math.sin(turn)
        along, across, shear = stress.T
        total[:, 0] += ply.thickness * (c * c * along + s * s * across - 2.0 * c * s * shear)
        total[:, 1] += ply.thickness * (s * s * along + c * c * across + 2.0 * c * s * shear)
        total[:, 2] += ply.thickness * (c * s * (along - across) + (c * c - s * s) * shear)
    total /= PLATE.thickness
    assert total == pytest.approx(np.array([whole.sxx, whole.syy, whole.sxy]).T, rel=1e-9, abs=1e-3)


def test_the_least_ratio_is_that_of_the_worst_point_and_ply():
    found = joint_strength(state(), "hashin", distance=0.5e-3)
    stress = state().stress(Points.at_depth(0.5e-3, found.theta))
    whole = np.stack([stress.sxx, stress.syy, stress.sxy], axis=-1)
    every = ply_failure(PLATE, whole, "hashin")
    assert found.least_ratio == every.ratio.min()
    ply, point = np.unravel_index(np.argmin(every.ratio), every.ratio.shape)
    assert found.theta[found.least] == found.theta[point]
    assert found.ply_angle == PLATE.plies[ply][1]
    assert found.theta.size == 720


def test_the_curve_lies_about_the_force_on_the_pin():
    found = joint_strength(state(P=1e6, Q=1e6), "yamada-sun", tension=0.5e-3, compression=1.5e-3)
    assert found.direction == pytest.approx(-0.25 * math.pi, abs=1e-6)
    middle = found.theta.size // 2
    assert found.theta[middle] == pytest.approx(found.direction)
    assert found.depth[[0, middle, -1]] == pytest.approx([0.5e-3, 1.5e-3, 0.5e-3])


def test_modes_by_the_angle_from_the_force():
    found = joint_strength(state(), distance=0.5e-3)
    for away, mode in ((0.0, 0), (14.0, 0), (20.0, 1), (45.0, 2), (-65.0, 3), (88.0, 4), (100.0, None)):
        ratio = np.full(found.theta.size, 2.0)
        at = int(np.argmin(np.abs(found.theta - (found.direction + math.radians(away)))))
        ratio[at] = 1.0
        moved = JointStrength(found.theta, found.depth, ratio, found.ply, found.mode, found.direction, PLATE)
        assert moved.joint_mode == ("" if mode is None else JOINT_MODES[mode])


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


@pytest.mark.parametrize(
    ("field", "words", "ask"),
    [
        ("distance", "must be given", lambda: joint_strength(state())),
        ("distance", "together", lambda: joint_strength(state(), distance=1e-3, tension=1e-3)),
        ("distance", "negative", lambda: joint_strength(state(), distance=-1e-3)),
        ("criterion", "did you mean", lambda: joint_strength(state(), "hill", distance=1e-3)),
        ("tension", "force on the pin", lambda: joint_strength(state(syy=1e6), tension=1e-3, compression=1e-3)),
        ("plies", "unknown", lambda: joint_strength(of(TURNED), distance=1e-3)),
        ("plate", "laminate", lambda: joint_strength(of(MATERIALS["aluminium"]), distance=1e-3)),
        ("history", "stress the laminate", lambda: failure_load(problem(), [{"P": 0.0}], distance=1e-3, nodes=61)),
    ],
)
def test_what_is_refused(field, words, ask):
    with pytest.raises(InputError, match=words) as caught:
        ask()
    assert caught.value.field == field


def of(plate):
    return solve(problem(plate=plate), [{"P": 1e6}], nodes=61)[-1]
