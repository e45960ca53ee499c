"""Joints with finite bodies: closed forms of interference fits, and convergence in nodes and harmonics."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin.bodies import Bushing, Ring
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from fastpin.verification.body_cases import CASES, ring_compliance
from tests.support.bodies import UNLIKE, joint_problem
from tests.support.tiers import some_survey

FINE = (1601, 0.0)
"""The nodes of the table, and the change of the peak pressure with more nodes."""

ROUND = ["tube", "held tube", "tube, body load", "held ring", "tube in a ring", "bush", "tube, bush, ring"]
"""Joints whose bodies and loads are symmetric about the axis."""


def first_harmonics(problem):
    """g11 and g12 of pin and plate, 1/Pa times 2."""
    joint, surfaces = problem.joint, problem.surfaces
    pin, plate = joint.pin_first.displacement(), joint.plate_first.displacement()
    return surfaces.pin_compliance * pin - surfaces.plate_compliance * plate


@pytest.mark.parametrize("name", ROUND)
def test_an_interference_fit_without_friction(name):
    """N = N0 - P/pi sin theta for any round bodies, until the top opens. Measured with 200 nodes: 2.7e-5 of P/R."""
    problem, force = joint_problem(name, -0.1, 0.0), 0.3
    state = solve(problem, [{"P": force}], nodes=200)[-1]
    uniform = 0.1 / problem.joint.uniform_compliance
    assert force < math.pi * uniform
    expected = uniform - force / math.pi * np.sin(state.theta)
    assert np.abs(state.pressure - expected).max() < 5e-5 * force


@pytest.mark.parametrize("name", ROUND)
def test_a_stuck_interference_fit(name):
    """N = N0 - tau (1 + m) sin theta, T = tau (1 - m) cos theta. Measured with 200 nodes: 2.3e-5 of P/R."""
    problem, force = joint_problem(name, -0.1, 1.0), 0.1
    state = solve(problem, [{"P": force}], nodes=200)[-1]
    assert not state.slip_zones
    g11, g12 = first_harmonics(problem)
    uniform, tau, m = 0.1 / problem.joint.uniform_compliance, force / (2.0 * math.pi), -g12 / g11
    pressure = uniform - tau * (1.0 + m) * np.sin(state.theta)
    assert np.abs(state.pressure - pressure).max() < 5e-5 * force
    assert np.abs(state.shear - tau * (1.0 - m) * np.cos(state.theta)).max() < 5e-5 * force


def test_a_moment_on_an_interference_fit():
    """T = -M/2 pi all round; the pin turns less in a ring, by M/(4 pi G c^2)."""
    turned = []
    for body in ({"plate_body": Ring(1.7, "uniform")}, {}):
        problem = Problem.from_load_parameter(UNLIKE, -0.1, 0.5, **body)
        state = solve(problem, [{"M": 0.05}], grid=Grid.circle(120))[-1]
        assert state.shear == pytest.approx(np.full(120, -0.05 / (2.0 * math.pi)), abs=1e-13)
        turned.append(state.rotation)
    less = 0.05 * problem.pair.plate_compliance / (4.0 * math.pi * 1.7**2)
    assert turned[1] - turned[0] == pytest.approx(less, rel=1e-11)


def test_a_press_fit_makes_the_clearance_smaller():
    """A bush with an interference behaves as one without, with the smaller clearance."""
    bush = Bushing(UNLIKE.plate, 1.25, interference=0.05)
    pressed = Problem.from_load_parameter(UNLIKE, 0.1, 0.3, plate_body=bush)
    assert pressed.assembled_clearance < 0.1
    smaller = Problem.from_load_parameter(
        UNLIKE, pressed.assembled_clearance, 0.3, plate_body=replace(bush, interference=0.0)
    )
    grid = Grid.arc(-3.1, -0.05, 101)
    one, two = (solve(problem, [{"P": 1.0}], grid=grid)[-1] for problem in (pressed, smaller))
    assert one.pressure == pytest.approx(two.pressure, abs=1e-13)
    assert one.shear == pytest.approx(two.shear, abs=1e-13)


def test_a_compliance_converges_with_its_harmonics():
    """Pressure in a ring to 2 R by its compliance with 5, 7, 9 and 11 harmonics: 20 to 30 times closer each time."""
    ring = Problem.from_load_parameter(UNLIKE, 0.1, 0.3, plate_body=Ring(2.0, "normal"))
    grid = Grid.arc(-3.1, -0.05, 201)
    exact, errors = solve(ring, [{"P": 1.0}], grid=grid)[-1].pressure, []
    for order in (5, 7, 9, 11):
        found = solve(replace(ring, plate_body=ring_compliance(ring, order)), [{"P": 1.0}], grid=grid)[-1].pressure
        errors.append(np.abs(found - exact).max() / exact.max())
    assert errors[0] < 1e-2
    assert np.all(np.divide(errors[:-1], errors[1:]) > 15.0)


@pytest.mark.gate
@pytest.mark.parametrize(("nodes", "change"), some_survey([(801, 1e-6), FINE], FINE))
@pytest.mark.parametrize("name", CASES)
def test_nodes(name, nodes, change):
    """With 1,601 nodes the values are those of the table: 5e-7 (peak), 5e-7 (int N), 5e-5 (half-angle, rounded).

    From 801 to 1,601 nodes the peak changes by up to 9e-7, and int N by up to 3.5e-6.
    """
    case = CASES[name]
    found = solve(case.problem, case.history, nodes=nodes)[-1]
    assert found.peak_pressure == pytest.approx(case.peak, abs=6e-7 + change)
    assert found.grid.weights @ found.pressure == pytest.approx(case.total, abs=6e-7 + 3.5 * change)
    assert 0.5 * np.ptp(found.contact[0]) == pytest.approx(case.half_angle, abs=6e-5)
