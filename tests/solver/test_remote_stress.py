"""Remote stress as a load like the others: it varies with time, in any order with the loads on the pin.

Its displacements (42), and (44), (45) with the singular equations, are checked in test_integral_equations.py and
test_theory.py, full sliding under it in test_sliding.py, figure 10 of the paper in published/test_monotonic.py.
"""

import math

import numpy as np
import pytest

from fastpin import Grid, Material, MaterialPair, Problem, solve
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN, STICK
from fastpin.model import LOADS
from fastpin.solver.configuration import solve_statuses
from fastpin.verification import closed_forms
from tests.support.checks.integral_equations import residuals_away

BOTTOM = -0.5 * math.pi
ORDERS = [
    [{"P": 1.0}, {"sxx": 0.12, "syy": -0.08}],
    [{"sxx": 0.12}, {"P": 0.5, "syy": -0.08}, {"P": 1.0}],
    [{"P": 1.0, "sxx": 0.12, "syy": -0.08}],
    [{"P": 1.2, "sxx": -0.1}, {"P": 0.7, "syy": 0.1}, {"P": 1.0, "sxx": 0.12, "syy": -0.08}],
]


@pytest.mark.parametrize("order", ORDERS[1:])
def test_without_friction_the_order_does_not_matter(titanium_in_aluminium, order):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.0)
    grid = Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 121)
    one, two = (solve(problem, corners, grid=grid)[-1] for corners in (ORDERS[0], order))
    assert np.abs(one.pressure - two.pressure).max() < 1e-11


def test_with_friction_the_order_matters(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4)
    grid = Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 121)
    ends = [solve(problem, corners, grid=grid)[-1] for corners in ORDERS]
    shears = [np.abs(state.shear - ends[0].shear).max() / ends[0].peak_pressure for state in ends[1:]]
    assert min(shears) > 0.02


def test_a_symmetric_cycle_of_stress_keeps_the_contact_symmetric(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4, "body")
    cycle = [{"sxx": 0.1, "syy": -0.05}, {"sxx": -0.1, "syy": 0.05}]
    result = solve(problem, [{"P": 1.0}, *cycle * 3], grid=Grid.arc(BOTTOM - 1.5, BOTTOM + 1.5, 151))
    for state in result:
        assert np.abs(state.pressure - state.pressure[::-1]).max() < 1e-10
        assert np.abs(state.shear + state.shear[::-1]).max() < 1e-10
    assert result[-1].dissipation - result[-3].dissipation > 1e-4
    assert np.abs(result[-1].shear - result[-3].shear).max() < 1e-10
    assert np.abs(result[-1].shear - result[-2].shear).max() > 0.05


@pytest.mark.gate
def test_the_singular_equations_hold_in_any_order(titanium_in_aluminium):
    """(47) with G_p (45), and (46) with G_s (44), away from edges, if the pin first rested in the round hole."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4, "body")
    for order in (ORDERS[0], *ORDERS[2:]):
        worst = []
        for nodes in (101, 401):
            state = solve(problem, order, grid=Grid.arc(BOTTOM - 1.3, BOTTOM + 1.3, nodes))[-1]
            worst.append(residuals_away(state, 0.1))
        assert worst[1][1] < min(3e-6, 0.1 * worst[0][1])
        assert worst[1][0] < 5e-5


def test_reciprocity_of_stress_and_pin_loads():
    """Betti: displacement of the pin per stress is what the tractions of a unit pin load do on the hole's motion."""
    pair = MaterialPair(Material.rigid(), Material(70e9, 0.3))  # no displacements of the pin that hang on P alone
    problem = Problem.from_load_parameter(pair, 0.3, 0.4, "centre", "fixed")
    errors = []
    for nodes in (51, 201):
        system = System.build(problem, Grid.arc(BOTTOM - 1.2, BOTTOM + 1.2, nodes), 1.0)
        status = np.full(nodes, OPEN)
        status[nodes // 4 : -nodes // 4] = STICK
        rates = {}
        for name in ("P", "Q", "sxx", "syy"):
            load = np.zeros(len(LOADS))
            load[LOADS.index(name)] = 1.0
            found = solve_statuses(system, status, np.zeros(nodes), load, 0.0)
            rates[name] = found
        weights = np.r_[system.weights, system.weights]
        for force, direction in (("P", np.array([0.0, -1.0])), ("Q", np.array([1.0, 0.0]))):
            for stress in ("sxx", "syy"):
                moved = float(direction @ rates[stress].motion[:2])
                tractions = np.r_[rates[force].pressure, rates[force].shear]
                opened = system.loads[:, LOADS.index(stress)]
                errors.append((nodes, moved, float(weights * tractions @ opened)))
    for _, moved, work in errors[:4]:
        assert moved == pytest.approx(work, abs=3e-2)
    for _, moved, work in errors[4:]:
        assert moved == pytest.approx(work, abs=3e-3)
    assert max(abs(moved) for _, moved, _ in errors) > 0.3


def test_equal_stress_all_round_is_another_clearance(similar):
    """sxx = syy widens the hole by (R kappa'/2G) A/2: without friction the contact is Persson's for that clearance."""
    problem = Problem.from_load_parameter(similar, 0.2, 0.0)
    stress = 0.3
    state = solve(problem, [{"P": 1.0}, {"sxx": stress, "syy": stress}], nodes=301)[-1]
    widened = 0.2 + 0.25 * 0.5 * 2.0 * stress  # R kappa'/(2 G beta*) is 1/4 for like bodies
    half = closed_forms.persson_half_angle(widened)
    assert state.contact[0] == pytest.approx([BOTTOM - half, BOTTOM + half], abs=3e-4)
    assert state.peak_pressure == pytest.approx(closed_forms.persson_pressure(0.0, half), rel=1e-5)


@pytest.mark.gate
@pytest.mark.parametrize("kind", [("centre", "fixed"), ("body", "free")])
def test_the_first_nodes_stick_where_a_stress_has_moved_the_hole_before(titanium_in_aluminium, kind):
    """Slip counts from rest. The stress has moved the hole along the pin, not by the same way at all nodes."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4, *kind)
    history, arc = [{"sxx": 0.1, "syy": -0.05}, {"P": 0.5}], (BOTTOM - 1.2, BOTTOM + 1.2)
    exact, coarse = (solve(problem, history, nodes=nodes, arc=arc)[-1] for nodes in (1601, 201))
    assert np.abs(coarse.shear - exact.shear[::8]).max() < 0.004 * coarse.peak_pressure
