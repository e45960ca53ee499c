"""What must hold whatever the numbers are: friction, scale, grids, and random histories."""

from itertools import pairwise

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.kernels.status import OPEN, STICK
from tests.support.tiers import gate, seeds
from tests.survey.histories import NODES, random_case
from tests.survey.random_histories import examine

BOTTOM = -0.5 * np.pi
ARC = (BOTTOM - 1.75, BOTTOM + 1.75)
HISTORY = [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}, {"Q": 0.3}]


@pytest.fixture
def problem(titanium_in_aluminium):
    return Problem.from_load_parameter(titanium_in_aluminium, 0.05, 0.5, "body")


def test_states_between_corners_do_not_change_the_corners(problem):
    plain = solve(problem, HISTORY, nodes=81, arc=ARC)
    dense = solve(problem, HISTORY, nodes=81, arc=ARC, between=[0.25, 0.5])
    assert [(state.step, state.fraction) for state in dense[:3]] == [(0, 0.25), (0, 0.5), (0, 1.0)]
    for state in plain:
        same = next(s for s in dense if s.step == state.step and s.fraction == 1.0)
        assert np.abs(same.shear - state.shear).max() < 1e-12
    half = next(s for s in dense if s.step == 1 and s.fraction == 0.5)
    corner = solve(problem, [{"P": 1.0}, {"Q": 0.15}], nodes=81, arc=ARC)[-1]
    assert half.load["Q"] == 0.15
    assert np.abs(half.shear - corner.shear).max() < 1e-11


@pytest.mark.parametrize(("load", "rotation"), [("body", "free"), ("centre", "fixed")])
def test_friction_opposes_the_slip_of_every_node(titanium_in_aluminium, load, rotation):
    """Between states close together, slip has the direction opposite to the shear, and happens at the cone."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.05, 0.4, load, rotation)
    result = solve(problem, HISTORY, nodes=101, between=60)
    slipped = 0
    for before, after in pairwise(result):
        closed = (before.status != OPEN) & (after.status != OPEN)
        slid = np.where(closed, after.slip - before.slip, 0.0)
        moved = np.abs(slid) > 1e-9
        assert np.all(slid[moved] * after.shear[moved] <= 0.0)
        if before.step == after.step:
            reserve = problem.friction * after.pressure - np.abs(after.shear)
            freed = moved & (before.status == after.status) & (after.status == STICK)
            assert np.all(np.abs(slid[freed]) < 1e-4 * np.abs(after.slip).max())  # stuck again in between
            assert np.all(reserve > -1e-12)
        slipped += int(moved.sum())
    assert slipped > 1000


def test_graded_nodes_give_the_same_answer(similar):
    problem = Problem.from_load_parameter(similar, 0.1, 0.4, "body")
    t = np.linspace(-1.0, 1.0, 201)
    graded = Grid(BOTTOM + 1.5 * (t + 0.1 * np.sin(np.pi * t)))
    one = solve(problem, [{"P": 1.0}, {"Q": 0.2}], grid=graded)[-1]
    two = solve(problem, [{"P": 1.0}, {"Q": 0.2}], nodes=201, arc=(BOTTOM - 1.5, BOTTOM + 1.5))[-1]
    assert one.peak_pressure == pytest.approx(two.peak_pressure, rel=1e-4)
    assert one.rotation == pytest.approx(two.rotation, rel=1e-2)
    assert np.allclose(one.contact, two.contact, atol=3e-3)


def test_random_histories():
    """No wrong state, and no error: all of these have an equilibrium."""
    for seed in seeds(60, first=1000):
        outcome = examine("general", seed)
        assert outcome.ending == "solved"
        assert outcome.violations() == {}
        assert outcome.states == len(random_case(seed)[1])


@pytest.mark.parametrize("seed", [3, *gate(11, 19, 24, 30, 42)])
def test_random_histories_by_increments(seed):
    problem, history = random_case(seed)
    path = solve(problem, history, nodes=NODES)
    grid = path.grid
    steps = solve(problem, history, grid=grid, method="increment", increments=200)
    for one, two in zip(path, steps, strict=True):
        assert np.abs(one.pressure - two.pressure).sum() < 0.01 * one.pressure.sum() + 1e-12
        assert np.abs(one.shear - two.shear).sum() < 0.03 * problem.friction * one.pressure.sum() + 1e-12
