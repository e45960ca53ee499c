"""Joints of two interfaces: the bush between two loaded rims, and the matrices of the whole."""

import numpy as np
import pytest

from fastpin.bodies import harmonics
from fastpin.elasticity.interfaces import PIN, SEAT, JointSystem, seat_grid
from fastpin.elasticity.stress import bush_stress
from fastpin.elasticity.tractions import Tractions
from fastpin.model.grid import Grid
from tests.support.joints import joint
from tests.survey.joint_conditions import ring_responses

KOLOSOV = 1.64


@pytest.mark.parametrize("outer", [1.02, 1.25, 2.0])
@pytest.mark.parametrize("from_outer", [False, True])
def test_one_rim_of_a_ring_feels_the_other_as_its_potentials_say(outer, from_outer):
    order = np.arange(40.0)
    found = harmonics.across(order, outer, KOLOSOV)
    if from_outer:
        found = -outer * found.transpose(0, 2, 1)
    for n in range(order.size):
        expected = ring_responses(n, outer, KOLOSOV, from_outer)
        np.testing.assert_allclose(found[n], expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("outer", [1.1, 1.6])
def test_the_matrix_of_a_joint_is_symmetric(outer):
    problem = joint(0.3, 0.25, outer)
    pin = Grid.circle(144)
    system = JointSystem.join(problem, (pin, seat_grid(problem, pin)), 1.0)
    weighted = np.r_[system.weights, system.weights][:, None] * np.asarray(system.operator)
    np.testing.assert_allclose(weighted, weighted.T, atol=1e-13 * np.abs(weighted).max())


def test_an_interface_alone_is_a_system_of_its_own():
    problem = joint(0.3, 0.25)
    system = JointSystem.join(problem, (Grid.circle(24), Grid.circle(32)), 1.0)
    for place, nodes in ((PIN, 24), (SEAT, 32)):
        rows = system.nodes.rows(place)
        assert rows.size == 2 * nodes
        np.testing.assert_array_equal(system.operator.entries(rows, rows), system.alone[place].operator.entries())
    assert [each.nodes for each in system.interfaces] == [slice(0, 24), slice(24, 56)]
    assert not system.ends.any()


def test_the_bush_between_two_rims_of_equal_pressure_has_it_everywhere():
    problem = joint(0.3, 0.25)
    theta = np.linspace(-np.pi, np.pi, 65)
    uniform = Tractions((np.column_stack([theta, np.full(65, 2.0), np.zeros(65)]),))
    angles = np.array([0.0, 1.0, 2.0])
    found = bush_stress(problem, uniform, uniform, angles, np.array([0.0, 0.1, 0.25]))
    np.testing.assert_allclose(found, [[-2.0] * 3, [-2.0] * 3, [0.0] * 3], atol=1e-12)


def test_the_stress_in_the_bush_carries_the_tractions_of_both_rims():
    problem = joint(0.3, 0.25, pin_load="centre")
    theta = np.linspace(-np.pi, np.pi, 129)
    pin = np.column_stack([theta, 1.0 - np.sin(theta), 0.3 * np.cos(theta)])
    seat = np.column_stack([theta, 2.0 - 0.8 * np.sin(theta), 0.24 * np.cos(theta)])
    tractions = [Tractions((each,)) for each in (pin, seat)]
    for depth, patch in ((0.0, pin), (0.25, seat)):
        found = bush_stress(problem, *tractions, theta, np.full(theta.size, depth))
        np.testing.assert_allclose(found[0], -patch[:, 1], atol=1e-12)
        np.testing.assert_allclose(found[2], patch[:, 2], atol=1e-12)
