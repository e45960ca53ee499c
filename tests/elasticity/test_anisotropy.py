"""The term of a laminate in the operator, (T51): its forms agree, and it has the limits of the theory."""

import math

import numpy as np
import pytest

from fastpin import Grid, Material, MaterialPair, Problem
from fastpin.bodies import Tube
from fastpin.elasticity import operator
from fastpin.elasticity.system import System
from fastpin.narrow.large import LargeSystem
from tests.support.laminates import RIGID, STEEL, TURNED, orthotropic
from tests.support.tiers import gate

GRIDS = {"circle": Grid.circle(90), "odd circle": Grid.circle(91), "arc": Grid.arc(-2.5, 0.7, 77)}


def problem(pin=STEEL, plate=TURNED, **fields) -> Problem:
    return Problem.from_load_parameter(MaterialPair(pin, plate, "stress"), 0.1, 0.3, **fields)


@pytest.mark.gate
@pytest.mark.parametrize("body", [*gate({}), {"pin_body": Tube(0.4)}], ids=["solid", "tube"])
@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS.keys())
def test_an_operator_without_stored_entries_is_the_same(monkeypatch, grid, body):
    stored = System.build(problem(**body), grid, 1.0).operator
    matrix = np.asarray(stored)
    inner = slice(None) if grid.closed else slice(1, -1)
    blocks = matrix.reshape(2, grid.size, 2, grid.size)[:, inner, :, inner]
    assert blocks == pytest.approx(blocks.transpose(2, 3, 0, 1), abs=1e-15)  # it is symmetric
    monkeypatch.setattr(operator, "LARGEST_DENSE", 10)
    other = System.build(problem(**body), grid, 1.0).operator
    assert not other.is_stored
    assert np.asarray(other) == pytest.approx(matrix, abs=1e-15)
    assert other.diagonal() == pytest.approx(stored.diagonal(), abs=1e-15)
    rows, columns = np.array([3, 0, 2 * grid.size - 1, 80]), np.array([grid.size, 5, 0, 2 * grid.size - 1])
    assert other.entries(rows, columns) == pytest.approx(matrix[np.ix_(rows, columns)], abs=1e-15)
    tractions = np.random.default_rng(1).normal(size=(2 * grid.size, 3))
    assert other @ tractions == pytest.approx(matrix @ tractions, abs=1e-13)
    assert other @ tractions[:, 0] == pytest.approx(matrix @ tractions[:, 0], abs=1e-13)


def test_columns_of_unequal_spacings_are_the_same():
    grid = Grid.graded([(-1.2, 0.2), (0.4, 0.3)], 90)
    matrix = np.asarray(System.build(problem(), grid, 1.0).operator)
    columns = LargeSystem.build(problem(), grid, 1.0).operator
    tractions = np.random.default_rng(1).normal(size=2 * grid.size)
    assert columns @ tractions == pytest.approx(matrix @ tractions, abs=1e-13)


@pytest.mark.parametrize("spacing", ["equal", "unequal"])
def test_a_uniform_pressure_widens_the_hole_by_lambda_less_s(spacing):
    """v = (Lambda - s) e_r R p: exact, except in the symmetric form, whose error is of second order."""
    errors = []
    for nodes in (100, 200):
        grid = Grid.circle(nodes)
        if spacing == "unequal":
            grid = Grid(grid.theta + 0.3 / nodes * np.sin(3.0 * grid.theta), closed=True)
        system = System.build(problem(RIGID), grid, 1.0)
        found = system.operator @ np.r_[np.ones(nodes), np.zeros(nodes)]
        plate = system.problem.joint.hole.laminate
        normal = np.array([np.cos(grid.theta), np.sin(grid.theta)])
        moved = (plate.edge_tensor - plate.s * np.eye(2)) @ normal / system.problem.surfaces.beta_star
        radial, along = (moved * normal).sum(axis=0), moved[1] * normal[0] - moved[0] * normal[1]
        errors.append(float(np.abs(found - np.r_[radial, -along]).max()))
    if spacing == "unequal":
        assert max(errors) < 1e-13
    else:
        assert errors[1] < 6e-5
        assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.15)


def test_an_isotropic_laminate_has_the_operator_and_loads_of_the_material():
    alike = orthotropic(1.0, 1.0 / 2.6, axis=0.4)
    one, other = (System.build(problem(plate=plate), GRIDS["arc"], 1.0) for plate in (alike, Material(1.0, 0.3)))
    assert np.asarray(one.operator) == pytest.approx(np.asarray(other.operator), abs=1e-15)
    assert one.loads == pytest.approx(other.loads, abs=1e-15)


def test_a_turned_laminate_has_a_turned_operator():
    """By four nodes of 90."""
    grid, turned = Grid.circle(90), TURNED.turned(4 * 2.0 * math.pi / 90)
    one, other = (System.build(problem(plate=plate), grid, 1.0) for plate in (TURNED, turned))
    order = np.r_[np.roll(np.arange(90), -4), 90 + np.roll(np.arange(90), -4)]
    assert np.asarray(other.operator)[np.ix_(order, order)] == pytest.approx(np.asarray(one.operator), abs=1e-14)
