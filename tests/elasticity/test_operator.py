"""The operator of many equally spaced nodes against the stored one: entries, products, bodies, drives."""

from dataclasses import replace

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.bodies import Ring, Tube
from fastpin.elasticity import build, operator
from fastpin.elasticity.operator import DenseOperator, ToeplitzOperator
from fastpin.elasticity.system import System
from fastpin.kernels import toeplitz
from fastpin.narrow.large import LargeSystem
from fastpin.solver import path, tableau
from tests.support.checks.body_cases import ring_compliance
from tests.support.kernels import python
from tests.support.steps import as_with_many_nodes

BOTTOM = -0.5 * np.pi
GRIDS = {"arc": Grid.arc(BOTTOM - 1.7, BOTTOM + 1.6, 61), "circle": Grid.circle(72), "odd circle": Grid.circle(61)}


@pytest.fixture(params=["solid", "bodies", "compliance", "driven"])
def problem(request, titanium_in_aluminium):
    plain = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "centre")
    if request.param == "bodies":
        return replace(plain, pin_body=Tube(0.5), plate_body=Ring(2.0))
    if request.param == "compliance":
        ring = replace(plain, plate_body=Ring(2.0, "normal"))
        return replace(ring, plate_body=ring_compliance(ring, 12))
    return replace(plain, drive="both") if request.param == "driven" else plain


def both(problem, grid, monkeypatch):
    """The stored operator, and the other one."""
    dense = System.build(problem, grid, 1.0).operator
    monkeypatch.setattr(operator, "LARGEST_DENSE", 3)
    found = System.build(problem, grid, 1.0).operator
    assert isinstance(dense, DenseOperator)
    assert isinstance(found, ToeplitzOperator)
    assert not found.is_stored
    return dense.matrix, found


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
def test_entries_and_products_are_those_of_the_stored_operator(problem, grid, monkeypatch):
    """Measured: entries 3e-16 (the same bits without an added matrix), products 2e-15 of their largest value."""
    matrix, found = both(problem, grid, monkeypatch)
    everything = np.arange(2 * grid.size)
    rank = found.entries(everything, everything) - matrix
    if problem.drive == "force" and problem.plate_body is None:
        assert not rank.any()
    assert np.abs(rank).max() < 2e-15
    rows, columns = np.array([0, 60, 3, 61, 100]), np.array([121, 0, 60, 61, 7, 20, 80])
    assert found.entries(rows, columns) == pytest.approx(matrix[np.ix_(rows, columns)], rel=0.0, abs=2e-15)
    assert found.diagonal() == pytest.approx(np.diagonal(matrix), rel=0.0, abs=2e-15)
    tractions = np.random.default_rng(3).normal(size=(2 * grid.size, 5))
    tractions[20:, 1] = 0.0
    tractions[:, 2] *= 1e-200
    wanted = matrix @ tractions
    for product in (found @ tractions, np.column_stack([found @ column for column in tractions.T])):
        assert np.all(np.abs(product - wanted).max(axis=0) < 1e-14 * np.abs(wanted).max(axis=0))
    assert not (found @ np.zeros(2 * grid.size)).any()


def test_the_kernel_as_plain_python(titanium_in_aluminium, monkeypatch):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4)
    monkeypatch.setattr(toeplitz, "fill_column", python(toeplitz.fill_column))
    matrix, found = both(problem, Grid.arc(BOTTOM - 0.3, BOTTOM + 0.2, 17), monkeypatch)
    assert np.array_equal(np.asarray(found), matrix)


@pytest.mark.gate
def test_entries_of_an_operator_that_only_has_products(titanium_in_aluminium):
    """The entries of unequal nodes from products with unit vectors. Measured: 3e-17."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4)
    grid = Grid.graded([(BOTTOM, 0.05)], 30)
    stored, lazy = System.build(problem, grid, 1.0).operator, LargeSystem.build(problem, grid, 1.0).operator
    assert np.asarray(lazy) == pytest.approx(np.asarray(stored), rel=0.0, abs=2e-15)
    assert lazy.diagonal() == pytest.approx(stored.diagonal(), rel=0.0, abs=2e-15)


@pytest.fixture
def _transforms(monkeypatch):
    """Small grids too are followed in the way of large ones."""
    as_with_many_nodes(monkeypatch)
    monkeypatch.setattr(build, "MOST_KEPT", 0)
    monkeypatch.setattr(tableau, "WORTHWHILE", 1)


@pytest.mark.gate
@pytest.mark.usefixtures("_transforms")
@pytest.mark.parametrize("drive", ["force", "both"])
def test_histories_are_those_of_the_stored_operator(titanium_in_aluminium, monkeypatch, drive):
    """The same statuses, tractions and energies. Measured: 3e-13 of the largest traction."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "centre", drive=drive)
    grid = Grid.arc(BOTTOM - 1.8, BOTTOM + 1.8, 301)
    names = ("P", "Q") if drive == "force" else ("uy", "ux")
    size = 1.0 if drive == "force" else -2.0 * problem.clearance
    corners = [{names[0]: size}, {names[1]: 0.3 * size}, {names[1]: -0.3 * size}, {names[0]: 0.5 * size}]
    stored = solve(problem, corners, grid=grid)
    monkeypatch.setattr(operator, "LARGEST_DENSE", 3)
    found = solve(problem, corners, grid=grid)
    for one, two in zip(found, stored, strict=True):
        assert np.array_equal(one.status, two.status)
        for name in ("pressure", "shear"):
            scale = np.abs(two.pressure).max()
            assert np.abs(getattr(one, name) - getattr(two, name)).max() < 1e-11 * scale
        assert one.dissipation == pytest.approx(two.dissipation, rel=1e-10, abs=1e-13)
        assert max(one.residuals.values()) < 1e-13


@pytest.mark.gate
@pytest.mark.usefixtures("_transforms")
def test_corrections_in_the_middle_of_a_step_change_nothing(titanium_in_aluminium, monkeypatch):
    """Configuration and rates are corrected after every chunk of updates. Measured: 2e-13 of the largest traction."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "centre")
    monkeypatch.setattr(operator, "LARGEST_DENSE", 3)
    corners = [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}]
    plain = solve(problem, corners, nodes=301, arc=(BOTTOM - 1.8, BOTTOM + 1.8))
    monkeypatch.setattr(path, "MOST_DRIFT", 0.0)
    found = solve(problem, corners, nodes=301, arc=(BOTTOM - 1.8, BOTTOM + 1.8))
    assert found.statistics["exchanges"] > 400
    assert found.statistics["rebuilds"] == plain.statistics["rebuilds"]
    for one, two in zip(found, plain, strict=True):
        assert np.array_equal(one.status, two.status)
        scale = np.abs(two.pressure).max()
        assert max(np.abs(one.pressure - two.pressure).max(), np.abs(one.shear - two.shear).max()) < 1e-11 * scale


@pytest.mark.usefixtures("_transforms")
def test_a_tableau_that_can_not_correct_is_built_anew(titanium_in_aluminium, monkeypatch):
    """Where its corrections leave too much, a factorisation corrects the configuration, but not the tableau."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "centre")
    monkeypatch.setattr(operator, "LARGEST_DENSE", 3)
    monkeypatch.setattr(path, "MOST_DRIFT", 0.0)
    monkeypatch.setattr(path, "MOST_ERROR", -1.0)
    kept, repair = [], path.PathStep._repair

    def watched(step):
        before = step._columns
        is_new = repair(step)
        kept.append(step._columns is before or not is_new)
        return is_new

    monkeypatch.setattr(path.PathStep, "_repair", watched)
    solve(problem, [{"P": 1.0}, {"Q": 0.3}], nodes=301, arc=(BOTTOM - 1.8, BOTTOM + 1.8))
    assert kept
    assert not any(kept)
