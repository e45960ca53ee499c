"""The parts of the solver under prescribed displacements: Lemke's method, large systems, narrow contacts, unloading."""

import math

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.elasticity import build
from fastpin.elasticity.build import build_system
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN
from fastpin.model import LOADS
from fastpin.narrow.large import LargeSystem
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import worst_residual
from fastpin.solver.errors import ResolutionError
from fastpin.solver.first_contact import first_contact
from fastpin.solver.increment import implicit_step
from fastpin.solver.path import PathStep
from fastpin.solver.settling import FiniteStep, settle
from tests.support.programs import difference
from tests.support.tiers import gate

BOTTOM = -0.5 * np.pi
DRIVES = ["ux", "uy", "both"]
HELD = {"free": {}, "fixed": {}, "spring": {"hub_stiffness": 2.0}}
WAYS = {
    "ux": [{"P": 1.0}, {"ux": 0.05, "P": 0.9}],
    "uy": [{"uy": -0.4}, {"uy": -0.35, "Q": 0.15}],
    "both": [{"uy": -0.4}, {"ux": 0.06, "uy": -0.38}],
}


def vector(load):
    return np.array([load.get(name, 0.0) for name in LOADS])


def contact(pair, drive, grid, friction=0.4, rotation="free"):
    """A system, its configuration in the middle of a step with slip, and the loads at the ends of the step."""
    case = Problem.from_load_parameter(pair, 0.1, friction, "centre", rotation, drive=drive, **HELD[rotation])
    system = System.build(case, grid, 1.0)
    first, second = (vector(load) for load in WAYS[drive])
    second[(first != 0.0) & (second == 0.0)] = first[(first != 0.0) & (second == 0.0)]
    start, _ = first_contact(system, unloaded_configuration(system), 0.0 * first, first)
    now = PathStep(system, start, first).follow(1.0)
    return system, PathStep(system, now, second).follow(0.5), first, second


# --- Lemke's method on an operator that is not symmetric ------------------------------------------------------


@pytest.mark.parametrize("friction", [0.0, 0.4])
@pytest.mark.parametrize("drive", DRIVES)
def test_a_finite_step_is_an_implicit_increment(titanium_in_aluminium, drive, friction):
    grid = Grid.circle(61) if friction == 0.0 else Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 41)
    system, now, first, second = contact(titanium_in_aluminium, drive, grid, friction)
    weighted = np.r_[system.weights, system.weights][:, None] * system.operator
    assert np.abs(weighted - weighted.T).max() > 1e-2 * np.abs(weighted).max()
    for load in (now.load + 0.03 * (second - first), second, 0.9 * first):
        one, two = FiniteStep(system, now).to(load), implicit_step(system, now, load)
        assert worst_residual(system, one) < 1e-11
        assert np.array_equal(one.closed, two.closed)
        for field in ("pressure", "shear", "gap", "slip", "motion"):
            assert getattr(one, field) == pytest.approx(getattr(two, field), abs=1e-11)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("rotation", list(HELD))
@pytest.mark.parametrize("drive", DRIVES)
def test_settled_statuses_are_the_statuses_of_the_path(titanium_in_aluminium, drive, rotation, sense):
    """All slipping nodes are undecided, as at an event: forwards they slip on, backwards they stick."""
    grid = Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 81)
    system, now, first, second = contact(titanium_in_aluminium, drive, grid, rotation=rotation)
    assert np.any(np.abs(now.status) == 1)
    rate = sense * (second - first)
    status = settle(system, now, rate)
    after = PathStep(system, now, now.load + 1e-7 * rate).follow(1.0)
    assert np.array_equal(status, after.status)
    assert np.array_equal(status == OPEN, now.status == OPEN)


# --- large systems and narrow contacts --------------------------------------------------------------------------


def narrow(pair, drive, pin_load="centre", rotation="free"):
    return Problem.from_load_parameter(pair, 0.3, 0.4, pin_load, rotation, drive=drive, **HELD[rotation])


def circling(reach, *degrees):
    return [{"ux": reach * math.cos(angle), "uy": reach * math.sin(angle)} for angle in np.radians(degrees)]


@pytest.mark.parametrize("drive", DRIVES)
def test_a_large_system_has_the_dense_displacements(titanium_in_aluminium, drive, monkeypatch):
    monkeypatch.setattr(build, "MOST_DENSE", 50)
    case, grid = narrow(titanium_in_aluminium, drive), Grid.graded([(BOTTOM, 0.1)], 90, BOTTOM)
    system, dense = build_system(case, grid, 1.0), System.build(case, grid, 1.0)
    assert isinstance(system, LargeSystem)
    rng = np.random.default_rng(1)
    tractions, motion, load = rng.normal(size=180), rng.normal(size=3), rng.normal(size=len(LOADS))
    expected = dense.displacement(tractions, motion, load, 0.3)
    assert system.displacement(tractions, motion, load, 0.3) == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("rotation", list(HELD))
@pytest.mark.parametrize("drive", DRIVES)
def test_windows_give_the_states_of_the_whole_operator(titanium_in_aluminium, drive, rotation, monkeypatch):
    case, grid = narrow(titanium_in_aluminium, drive, rotation=rotation), Grid.graded([(BOTTOM, 0.1)], 240, BOTTOM)
    history = {
        "ux": [{"P": 0.003}, {"ux": 0.003}, {"ux": -0.002}, {"P": 0.001}],
        "uy": [{"uy": -0.303}, {"Q": 0.0004}, {"uy": -0.302}, {"uy": -0.2, "Q": 0.0}, {"uy": -0.301}],
        "both": [{"uy": -0.303}, {"ux": 0.003}, {"ux": -0.002}, {"uy": -0.2}, {"uy": -0.301}],
    }[drive]
    whole = solve(case, history, grid=grid)
    seen, open_window = [], LargeSystem.part

    def counted(system, nodes):
        seen.append(nodes.size)
        return open_window(system, nodes)

    monkeypatch.setattr(build, "MOST_DENSE", 50)
    monkeypatch.setattr(LargeSystem, "part", counted)
    windows = solve(case, history, grid=grid)
    assert min(seen) < 200
    assert difference(whole, windows) < 1e-9
    for one, two in zip(whole, windows, strict=True):
        assert [two.load[name] for name in LOADS] == pytest.approx([one.load[name] for name in LOADS], abs=1e-11)


@pytest.mark.gate
@pytest.mark.parametrize("rotation", HELD)
def test_narrow_contacts_that_travel_get_the_nodes_where_they_are(titanium_in_aluminium, rotation):
    """The pin goes from one place of the hole to another, and hardly touches it."""
    case, history = narrow(titanium_in_aluminium, "both", rotation=rotation), circling(0.30001, -90, 0, 130)
    coarse, fine = (solve(case, history, nodes=nodes) for nodes in (201, 2000))
    assert coarse.grid.size < 400
    for one, two, degrees in zip(coarse, fine, (-90, 0, 130), strict=True):
        assert max(one.residuals.values()) < 1e-12
        ((begin, end),) = one.contact
        assert math.cos(0.5 * (begin + end) - math.radians(degrees)) > 1.0 - 1e-6
        forces = [math.hypot(state.load["P"], state.load["Q"]) for state in (one, two)]
        assert forces[0] == pytest.approx(forces[1], rel=5e-3)


def test_an_overlap_between_two_nodes_is_too_narrow(titanium_in_aluminium):
    case = narrow(titanium_in_aluminium, "both")
    grid = Grid.circle(61, BOTTOM + math.pi / 61)
    with pytest.raises(ResolutionError, match="narrower than the nodes"):
        solve(case, [{"uy": -0.30001}], grid=grid)


@pytest.mark.parametrize("pin_load", ["centre", "body"])
@pytest.mark.parametrize("drive", [*gate("uy"), *gate("both")])
def test_a_pin_that_is_moved_back_exactly_has_no_contact(titanium_in_aluminium, drive, pin_load):
    for nodes in (101, 201, 401):
        result = solve(narrow(titanium_in_aluminium, drive, pin_load), [{"uy": -0.30002}, {"uy": -0.3}], nodes=nodes)
        assert result[0].contact
        assert not result[1].contact


@pytest.mark.parametrize("drive", DRIVES)
def test_an_interference_fit_without_reactions_keeps_its_contact(titanium_in_aluminium, drive):
    case = Problem.from_load_parameter(titanium_in_aluminium, -0.3, 0.4, drive=drive)
    corner = {"ux": 0.05} if drive == "ux" else {"uy": -0.05}
    state = solve(case, [corner, dict.fromkeys(corner, 0.0)], nodes=60)[-1]
    assert state.pressure.min() > 0.05
