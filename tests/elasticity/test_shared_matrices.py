"""Problems that differ in friction and fit only share their matrices: the same arrays, and the same bits of results."""

from dataclasses import fields, replace

import numpy as np
import pytest

from fastpin import Grid, Material, Problem, solve
from fastpin.elasticity import build
from fastpin.elasticity.build import build_system
from fastpin.elasticity.system import System
from tests.support.bodies import HOLDS
from tests.support.programs import assert_same_bits

BOTTOM = -0.5 * np.pi
GRID = Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 61)


@pytest.fixture
def kept(monkeypatch):
    """No system is kept before a test."""
    monkeypatch.setattr(build, "_KEPT", [])


def problem_of(pair, case="plain", **changes):
    options = {"friction": 0.4, "pin_load": "centre", **HOLDS[case], **changes}
    return Problem.from_load_parameter(pair, 0.1, **options)


@pytest.mark.usefixtures("kept")
@pytest.mark.parametrize("case", HOLDS)
def test_a_changed_system_is_the_one_that_is_built(titanium_in_aluminium, case):
    first = problem_of(titanium_in_aluminium, case)
    known = build_system(first, GRID, 1.0)
    for changes in ({"friction": 0.7}, {"clearance": 0.3}, {"friction": 0.2, "clearance": 0.0}):
        problem = replace(first, **changes)
        found, built = build_system(problem, GRID, 1.0), System.build(problem, GRID, 1.0)
        assert found.operator is known.operator
        assert found.problem is problem
        for each in fields(System):
            one, other = getattr(found, each.name), getattr(built, each.name)
            if isinstance(other, np.ndarray):
                assert np.array_equal(one, other), each.name
        assert found.rest_clearance == built.rest_clearance
        assert np.array_equal(found.drive.columns, built.drive.columns)


@pytest.mark.usefixtures("kept")
def test_other_problems_have_matrices_of_their_own(titanium_in_aluminium):
    first = problem_of(titanium_in_aluminium)
    known = build_system(first, GRID, 1.0)
    assert build_system(first, GRID, 1.0) is known
    stiff = replace(first.pair, plate=Material(2.0 * first.pair.plate.E, 0.3))
    others = [
        (replace(first, friction=0.0), GRID, 1.0), (replace(first, rotation="fixed"), GRID, 1.0),
        (replace(first, pair=stiff), GRID, 1.0), (first, GRID, 2.0), (first, Grid.circle(61), 1.0),
    ]  # fmt: skip
    for problem, grid, force in others:
        assert build_system(problem, grid, force).operator is not known.operator


@pytest.mark.usefixtures("kept")
def test_results_have_the_same_bits_with_shared_matrices(titanium_in_aluminium):
    history = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}]
    problems = [problem_of(titanium_in_aluminium, friction=friction) for friction in (0.3, 0.31, 0.32, 0.9)]
    shared = [solve(problem, history, nodes=61) for problem in problems]
    for problem, result in zip(problems, shared, strict=True):
        build._KEPT.clear()
        alone = solve(problem, history, nodes=61)
        assert np.array_equal(result.grid.theta, alone.grid.theta)
        assert_same_bits(result, alone)
