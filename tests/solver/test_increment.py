"""The increment solver: the second road to the same states."""

from dataclasses import replace

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.elasticity.system import System
from fastpin.kernels.arrays import ContactValues
from fastpin.kernels.status import STICK
from fastpin.model import LOADS
from fastpin.model.loads import P, Q
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import worst_residual
from fastpin.solver.first_contact import first_contact
from fastpin.solver.increment import _hold_one, implicit_step
from fastpin.solver.path import PathStep

ARC = (-0.5 * np.pi - 1.25, -0.5 * np.pi + 1.25)


@pytest.mark.gate
def test_tends_to_the_path_at_first_order(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    exact = solve(problem, [{"P": 1.0}], nodes=201, arc=ARC)[-1]
    counts = [20, 40, 80, 160]
    runs = [solve(problem, [{"P": 1.0}], nodes=201, arc=ARC, method="increment", increments=m)[-1] for m in counts]
    errors = [abs(state.peak_pressure - exact.peak_pressure) for state in runs]
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert 0.9 < order < 1.6
    assert errors[-1] < 1e-4 * exact.peak_pressure
    shears = [np.abs(state.shear - exact.shear).sum() for state in runs]
    assert -np.polyfit(np.log(counts), np.log(shears), 1)[0] > 0.7


@pytest.mark.gate
@pytest.mark.parametrize(("load", "rotation", "lp"), [("body", "free", 0.05), ("centre", "fixed", 0.5)])
def test_fretting_cycle_agrees(similar, load, rotation, lp):
    problem = Problem.from_load_parameter(similar, lp, 0.55, load, rotation)
    history = [{"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}]
    path = solve(problem, history, nodes=61)
    arc = (path.grid.theta[0], path.grid.theta[-1])
    counts = [40, 120, 360]
    runs = [solve(problem, history, nodes=61, arc=arc, method="increment", increments=m) for m in counts]
    for k, exact in enumerate(path):
        errors = [np.abs(run[k].shear - exact.shear).sum() / exact.pressure.sum() for run in runs]
        assert 0.6 < -np.polyfit(np.log(counts), np.log(errors), 1)[0] < 1.6
        assert errors[-1] < 1e-3
        finest = runs[-1][k]
        assert finest.peak_pressure == pytest.approx(exact.peak_pressure, rel=2e-4)
        assert finest.dissipation == pytest.approx(exact.dissipation, rel=0.02, abs=1e-6 * exact.work)
        assert max(finest.residuals.values()) < 1e-9


@pytest.mark.gate
@pytest.mark.parametrize("bare", [False, True])
def test_both_solvers_agree_under_friction_that_varies(titanium_in_aluminium, bare):
    """From the same first contact, with a smooth coefficient, also beside nodes without friction."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    system = System.build(problem, Grid.circle(91), 1.0)
    friction = 0.35 + 0.2 * np.sin(3.0 * system.grid.theta)
    system = replace(system, friction=np.where(bare & (np.arange(91) % 4 == 0), 0.0, friction))
    pull, push = np.eye(len(LOADS))[[P, Q]]
    start, _ = first_contact(system, unloaded_configuration(system), 0.0 * pull, pull)
    targets = [pull, pull + 0.15 * push, pull - 0.15 * push]
    exact, errors = start, []
    for target in targets:
        exact = PathStep(system, exact, target).follow(1.0)
    for count in (20, 80, 320):
        now = start
        for target in targets:
            for load in np.linspace(now.load, target, count + 1)[1:]:
                now = implicit_step(system, now, load)
        errors.append(np.abs(now.shear - exact.shear).sum() / exact.pressure.sum())
        assert worst_residual(system, now) < 1e-9
    assert 0.6 < -np.polyfit(np.log((20, 80, 320)), np.log(errors), 1)[0] < 1.6
    assert errors[-1] < 2e-3


def test_too_large_increments_are_halved(similar):
    problem = Problem.from_load_parameter(similar, 0.05, 0.55, "body")
    history = [{"P": 1.0}, {"Q": 0.5}, {"Q": -0.5}]
    result = solve(problem, history, nodes=161, method="increment", increments=1)
    assert result.complete
    assert all(max(state.residuals.values()) < 1e-9 for state in result)


def test_a_first_corner_on_few_nodes(similar):
    """The whole first step is one increment; the next one goes on from there."""
    problem = Problem.from_load_parameter(similar, 0.5, 0.3, "centre", "fixed")
    result = solve(problem, [{"P": 0.01}, {"P": 1.0}], nodes=41, method="increment", increments=40)
    exact = solve(problem, [{"P": 1.0}], nodes=41)[-1]
    assert result[1].peak_pressure == pytest.approx(exact.peak_pressure, rel=1e-2)


@pytest.mark.parametrize("count", [2, 3])
def test_of_the_nodes_that_let_go_the_nearest_to_sticking_holds(count):
    nothing, friction, pressure = np.zeros(4), np.full(4, 0.5), np.array([2.0, 2.0, 2.0, 1.0])
    shear = np.array([1.3, -1.1, 1.2, -0.5])
    status, wanted = np.full(4, STICK), np.array([-1, 1, -1, 1])
    status[count:] = wanted[count:]
    _hold_one(wanted, ContactValues(pressure, shear, nothing, nothing, status, nothing), friction, nothing)
    assert wanted.tolist() == [-1, STICK, -1, 1]
