"""Fatigue and margins at the pins of a joint, against those of a single pin."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import Grid, InputError, Material, MaterialPair, Problem
from fastpin.damage import stress_history
from fastpin.errors import InputWarning
from fastpin.joints import Joint, JointPin, JointPlate, JointResult, solve_joint
from fastpin.model import FatigueAssessment, FatigueConstants, Points
from fastpin.model.angles import BOTTOM
from fastpin.states.extremes import KeptStates, marked_extremes
from fastpin.states.margins import static_margins
from fastpin.states.stress_map import share_map

CONSTANTS = FatigueConstants(
    fatigue_strength=1e9, strength_exponent=-0.1, fatigue_ductility=0.5, ductility_exponent=-0.6
)
ALUMINIUM, STEEL = Material(72e9, 0.33, yield_strength=300e6, fatigue=CONSTANTS), Material(210e9, 0.30)
RADIUS, CLEARANCE, FRICTION, THICKNESS = 5e-3, 2e-5, 0.3, 2e-3
FORCES, STRESSES = (6e3, 1e3, 5e3), (40e6, 10e6, 30e6)


def in_sheet(*centres: complex, material: Material = ALUMINIUM) -> Joint:
    pins = [
        JointPin(name, at, STEEL, RADIUS, ("sheet",), CLEARANCE, FRICTION)
        for name, at in zip("AB", centres, strict=False)
    ]
    return Joint((JointPlate("sheet", material, THICKNESS),), tuple(pins))


@cache
def one_pin() -> tuple[JointResult, fastpin.Result]:
    """One pin in an infinite sheet under force and remote stress: as a joint, and as a problem."""
    corners = [{"A.y": -force, "sheet.sxx": stress} for force, stress in zip(FORCES, STRESSES, strict=True)]
    loads = [{"P": force / THICKNESS, "sxx": stress} for force, stress in zip(FORCES, STRESSES, strict=True)]
    problem = Problem(
        MaterialPair(STEEL, ALUMINIUM, "stress"), RADIUS, CLEARANCE, FRICTION, pin_load="body", thickness=THICKNESS
    )
    with pytest.warns(InputWarning):  # it yields
        alone = fastpin.solve(problem, loads, grid=Grid.circle(48, BOTTOM))
    return solve_joint(in_sheet(0j), corners, nodes=48), alone


@pytest.mark.parametrize(
    "how", [{}, {"method": "line", "length": 2e-4}, {"method": "point", "length": 1e-3}, {"straight": True}]
)
def test_one_pin_has_the_life_of_a_problem(how: dict[str, Any]) -> None:
    joint, alone = one_pin()
    assessment = FatigueAssessment(**how)
    (found,), (expected,) = joint.assessed_fatigue(assessment), alone.assessed_fatigue(assessment)
    assert (found.pin, found.plate, found.found.body) == ("A", "sheet", "plate")
    np.testing.assert_allclose(found.found.hot_spot, expected.hot_spot, rtol=1e-4)


def test_one_pin_has_the_margins_of_a_problem() -> None:
    joint, alone = one_pin()
    kept = KeptStates(list(alone))
    expected = static_margins(alone.problem, marked_extremes(kept), kept.read)
    found = joint.margins()
    assert [each.margin.subject for each in found] == [each.subject for each in expected]
    assert found[0].margin.margin == pytest.approx(expected[0].margin, rel=1e-4)
    assert found[0].margin.part == "near the hole only"
    assert found[0].margin.load_point == expected[0].load_point == 1.0


def test_other_pins_change_the_stress_of_a_hole_from_state_to_state() -> None:
    """The tractions at A stay nearly the same while B is pushed: one linear map does not give the stresses at A."""
    joint = in_sheet(-8e-3, 8e-3)
    result = solve_joint(joint, [{"A.y": -2e3}, {"B.y": -8e3}, {"B.y": 0.0}], nodes=32)
    states = result.of("A", "sheet")
    assert share_map(states[:1])
    assert not share_map(states)
    points = Points.at_depth([0.0, 2e-4], 0.0)
    together = stress_history(states, points, straight=True)
    alone = [stress_history([state], points, straight=True)[0] for state in states]
    np.testing.assert_array_equal(together, alone)
    assert np.abs(together[1] - together[0]).max() > 0.1 * np.abs(together[0]).max()


def test_the_last_cycle_is_the_shortest_repeated_run_of_loads() -> None:
    cycle = [{"A.y": -2e3}, {"A.y": -1e3}]
    result = solve_joint(in_sheet(0j), [{"A.y": -3e3}, *cycle, *cycle], nodes=24)
    assert [state.step for state in result.last_cycle] == [2, 3, 4]
    of_cycle = result.assessed_fatigue(FatigueAssessment(over="cycle"))[0].found
    whole = result.assessed_fatigue()[0].found
    assert 0.0 < of_cycle.hot_spot.damage < whole.hot_spot.damage
    once = solve_joint(in_sheet(0j), cycle, nodes=24)
    assert once.last_cycle == ()
    with pytest.raises(InputError, match="over: the history has no cycles"):
        once.assessed_fatigue(FatigueAssessment(over="cycle"))


def test_progress_ends_at_the_whole() -> None:
    done: list[tuple[float, float]] = []
    one_pin()[0].assessed_fatigue(progress=lambda *at: done.append(at))
    assert done[-1] == (1.0, 1.0)
    assert all(before <= after for (before, _), (after, _) in pairwise(done))


def test_a_material_without_constants_is_left_out_or_refused() -> None:
    plain = Material(72e9, 0.33)
    result = solve_joint(in_sheet(0j, material=plain), [{"A.y": -2e3}, {"A.y": -1e3}], nodes=24)
    with pytest.raises(InputError, match="material"):
        result.assessed_fatigue()
    assert [each.margin.remark for each in result.margins()] == ["not known: no yield strength given"] * 2
