"""Stress near the hole of a finite plate from its compliance: closed forms of rings, and another discretisation."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Material, MaterialPair, Points, Problem, solve
from fastpin.bodies import Compliance, Ring
from fastpin.elasticity.stress import plate_stress
from fastpin.elasticity.tractions import Tractions
from fastpin.lugs import Lug, Part, plate_compliance
from fastpin.states.margins import part_of
from fastpin.states.yielding import von_mises_peak
from tests.support.ring_compliance import held_ring

STEEL = Material(2.6, 0.3)


def problem_with(body, plane="strain"):
    return Problem.from_load_parameter(MaterialPair(STEEL, STEEL, plane=plane), 0.6, 0.3, plate_body=body)


@pytest.mark.parametrize(("outer", "order"), [(2.0, 24), (1.25, 48), (1.5, 30), (3.0, 20), (10.0, 6), (20.0, 4)])
def test_a_held_ring_has_the_stress_of_its_closed_form(outer, order):
    """Measured: 1e-8 of the peak pressure with a ring to 2 R, 6e-8 at most with all harmonics above 1e-7."""
    state = solve(problem_with(Ring(outer)), [{"P": 1.0, "Q": 0.2}], nodes=101)[-1]
    body = held_ring(outer, order)
    other = replace(state, problem=problem_with(body))
    points = Points.at_radius(np.linspace(1.0, body.reach, 7)[:, None], np.linspace(-3.0, 3.0, 41))
    for component in ("radial", "hoop", "shear", "von_mises"):
        found, expected = (getattr(each.stress(points), component) for each in (other, state))
        assert np.abs(found - expected).max() < 1e-7 * state.peak_pressure


@pytest.mark.parametrize(
    ("outer", "order"), [(1.25, 16), (2.0, 8), (2.0, 16), (5.0, 8), (5.0, 16), (20.0, 8), (20.0, 16)]
)
def test_the_reach_is_a_quarter_of_the_way_to_the_nearest_edge(outer, order):
    assert 0.2 * (outer - 1.0) < held_ring(outer, order).reach - 1.0 < 0.26 * (outer - 1.0)


def test_noise_does_not_shorten_the_reach():
    """A wide plate has more harmonics than it needs. The last ones are noise."""
    body = held_ring(10.0, 30)
    noisy = body.matrix + 1e-12 * np.eye(len(body.matrix))
    assert Compliance(0.3, "strain", 1.0, noisy).reach == pytest.approx(body.reach, rel=1e-3)
    assert Compliance(0.3, "strain", 1.0, 0.0 * noisy).reach > 10.0


@pytest.mark.gate
def test_a_lug_has_the_stress_of_another_discretisation():
    """Nose and sides at 2.2 R, held at y = 10 R, t_r = -sin(theta)/pi on the hole: panels of 12 and 16 points."""
    side, top = 2.2, 10.0
    corners = side, side + 1j * top, -side + 1j * top, -side
    outline = [Part(name, *corners[k : k + 2]) for k, name in enumerate(("right", "top", "left"))]
    nose = Part("nose", -side, side, -1j * side)
    body = plate_compliance(Lug(0.3, "stress", 1.0, (*outline, nose), {"top": "both"})).compliance
    theta = np.linspace(-math.pi, math.pi, 2001)
    pulled = Tractions((np.column_stack([theta, -np.sin(theta) / math.pi, np.zeros(theta.size)]),))
    places = np.zeros(2), np.array([0.0, 0.2])
    radial, hoop, shear = plate_stress(problem_with(body, "stress"), pulled, np.zeros(4), *places)
    assert hoop == pytest.approx([0.631529819, 0.383631804], abs=2e-6)
    assert (radial[1], shear[1]) == pytest.approx((0.056795158, 0.019360577), abs=2e-6)


def test_the_largest_von_mises_stress_of_a_finite_plate_lies_below_the_edge():
    """In a wide plate it is that of the infinite plate. On the edge it is two thirds as large."""
    pair, wide = MaterialPair(STEEL, STEEL, plane="strain"), held_ring(20.0, 4)
    of_infinite, of_wide = (
        solve(Problem.from_load_parameter(pair, 7.0, 0.0, **given), [{"P": 1.0}], nodes=61)[-1]
        for given in ({}, {"plate_body": wide})
    )
    found, expected = (von_mises_peak(state, "plate") for state in (of_wide, of_infinite))
    assert found.circle.depth == expected.circle.depth > 0.0
    assert found.value == pytest.approx(expected.value, rel=0.01)
    assert von_mises_peak(of_wide, "plate", edges_only=True).value < 0.7 * found.value
    assert part_of(of_wide.problem, "plate") == "near the hole only"
