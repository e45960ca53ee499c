"""Strength of a laminate round the hole of a solved state."""

import math

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, MaterialPair, Points, Problem, solve
from fastpin.damage import JointStrength, joint_strength, least_strength, ply_failure, ply_stresses
from fastpin.damage.hole_strength import JOINT_MODES
from fastpin.model import Laminate, StrengthAssessment
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
    least = every.ratio[:, found.least]  # a point of the other side may be as weak
    assert found.least_ratio == pytest.approx(least.min(), rel=1e-13)
    assert least.min() == pytest.approx(every.ratio.min(), rel=1e-13)
    assert found.ply_angle == PLATE.plies[int(np.argmin(least))][1]
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


@pytest.mark.parametrize(
    ("field", "words", "ask"),
    [
        ("distance", "must be given", lambda: joint_strength(state())),
        ("distance", "together", lambda: joint_strength(state(), distance=1e-3, tension=1e-3)),
        ("distance", "negative", lambda: joint_strength(state(), distance=-1e-3)),
        ("criterion", "did you mean", lambda: joint_strength(state(), "hill", distance=1e-3)),
        ("tension", "force on the pin", lambda: joint_strength(state(syy=1e6), tension=1e-3, compression=1e-3)),
        ("strength", "belongs to a plate", lambda: joint_strength(of(TURNED), distance=1e-3)),
        ("plate", "laminate", lambda: joint_strength(of(MATERIALS["aluminium"]), distance=1e-3)),
    ],
)
def test_what_is_refused(field, words, ask):
    with pytest.raises(InputError, match=words) as caught:
        ask()
    assert caught.value.field == field


def of(plate):
    return solve(problem(plate=plate), [{"P": 1e6}], nodes=61)[-1]


def test_the_least_of_several_states():
    how = StrengthAssessment(distance=0.5e-3)
    loads = [{"P": 1e6}, {"P": 5e5}]
    states = solve_once(problem(), loads, nodes=101)
    told = []
    worst, strength = least_strength(states, how, lambda done, total: told.append((done, total)))
    assert worst is states[0]
    assert strength.least_ratio < joint_strength(states[1], distance=0.5e-3).least_ratio
    assert told == [(1, 2), (2, 2)]
    with pytest.raises(InputError, match="states: must hold at least one state"):
        least_strength([], how)


def test_states_without_a_force_have_no_curve():
    how = StrengthAssessment(tension=0.5e-3, compression=1e-3)
    states = solve_once(problem(), [{"P": 1e6}, {"P": 0.0}], nodes=101)
    assert least_strength(states, how)[0] is states[0]
    with pytest.raises(InputError, match="tension: needs a force on the pin"):
        least_strength(states[1:], how)
