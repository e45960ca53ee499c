"""Statuses from complementarity problems: events at which exchanging violators cycles, and snaps of the pin."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from fastpin import ConvergenceError, Grid, Material, MaterialPair, Problem, solve
from fastpin.elasticity.system import System
from fastpin.kernels import complementarity, conditions, exchange
from fastpin.kernels.status import OPEN, STICK
from fastpin.model import LOADS
from fastpin.model.loads import P
from fastpin.solver import path, settling
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import Correction, solve_statuses, worst_residual
from fastpin.solver.first_contact import first_contact
from fastpin.solver.increment import implicit_step
from fastpin.solver.path import PathStep
from fastpin.solver.settling import FiniteStep, settle
from tests.support.steps import step_by_step
from tests.support.tiers import some_gate

BOTTOM = -0.5 * np.pi


def problem(pin, plate, load_parameter, friction, pin_load="centre", rotation="fixed", plane="strain"):
    pair = MaterialPair(Material(*pin), Material(*plate), plane)
    return Problem.from_load_parameter(pair, load_parameter, friction, pin_load, rotation)


NARROW = (
    problem((9, 0.2), (7, 0.2), 400, 0.5),
    [{"P": 0.38, "Q": -0.22}, {"P": 0.88, "Q": 0.24}, {"P": 0.34, "Q": 0.089}],
)
OVAL = (problem((4, 0.3), (40, 0.4), 2, 0.3), [{"P": 0.8, "Q": 0.1, "sxx": 10, "syy": -20}])
RELIEVED = (
    problem((4, 0.2), (40, 0.2), 1, 0.2, "body", "free"),
    [{"P": 0.7, "Q": -0.02, "sxx": -20, "syy": -10}, {"P": 0.5, "Q": -0.07, "sxx": 20}],
)
VERY_ROUGH = (problem((1, 0.3), (3, 0.3), 0.1, 1000, "body", "free"), [{"P": 1}, {"Q": 0.5}, {"Q": -0.5}])
CASES = {"narrow": NARROW, "oval": OVAL, "relieved": RELIEVED, "very rough": VERY_ROUGH}


def rate_violation(system, now, status, load_rate):
    """Largest violation of the conditions on the rates of `status`, in parts of the largest rate."""
    rates = solve_statuses(system, status, np.zeros(status.size), load_rate, 0.0)
    mu, closed, stick = system.friction, status != OPEN, status == STICK
    traction = max(np.abs(rates.pressure).max(), np.abs(rates.shear).max())
    length = max(np.abs(rates.gap).max(), np.abs(rates.slip).max())
    touching = (status == OPEN) & (now.gap == 0.0)
    bare = closed & (now.pressure == 0.0)
    limit = stick & ~bare & (np.abs(now.shear) >= mu * now.pressure)
    shear, growth = np.sign(now.shear) * rates.shear, mu * rates.pressure
    violations = [
        -rates.gap[touching].min(initial=0.0) / length,
        -(status * rates.slip)[closed & ~stick & (mu > 0.0)].min(initial=0.0) / length,
        -rates.pressure[bare].min(initial=0.0) / traction,
        (np.abs(rates.shear) - growth)[bare & stick].max(initial=0.0) / traction,
        (shear - growth)[limit].max(initial=0.0) / traction,
    ]
    return max(violations)


@pytest.fixture
def met(monkeypatch):
    """The events (system, configuration, load rate, statuses) at which Lemke's method is asked."""
    events = []

    def remembered(system, now, load_rate):
        status = settle(system, now, load_rate)
        events.append((system, now.copy(), load_rate.copy(), status))
        return status

    monkeypatch.setattr(path, "settle", remembered)
    return events


@pytest.mark.parametrize("name", some_gate(CASES, "very rough"))
@pytest.mark.parametrize("nodes", some_gate([61, 101], 101))
def test_histories_whose_statuses_cycle_are_solved(name, nodes, met):
    case, history = CASES[name]
    result = solve(case, history, nodes=nodes)
    assert result.complete
    assert all(max(state.residuals.values()) < 1e-12 for state in result)
    for system, now, load_rate, status in met:
        if status is not None:
            assert rate_violation(system, now, status, load_rate) < 1e-9


@pytest.mark.gate
def test_lemke_finds_the_only_statuses_among_all_combinations(met):
    for name, nodes in (("narrow", 61), ("narrow", 101), ("oval", 61), ("relieved", 101)):
        case, history = CASES[name]
        solve(case, history, nodes=nodes)
    compared = 0
    for system, now, load_rate, status in met:
        limit = np.flatnonzero(
            now.closed & (now.pressure > 0.0) & (np.abs(now.shear) >= system.friction * now.pressure)
        )
        bare = np.where(now.closed, now.pressure == 0.0, now.gap == 0.0)
        if limit.size > 11 or bare.any() or status is None:
            continue
        good = []
        for slipping in itertools.product([False, True], repeat=limit.size):
            trial = now.status.copy()
            trial[limit] = np.where(slipping, -np.sign(now.shear[limit]), STICK)
            if solve_statuses(system, trial, now.slip, now.load, 0.0) is None:
                continue
            if rate_violation(system, now, trial, load_rate) < 1e-9:
                good.append(trial)
        assert len(good) == 1
        assert np.array_equal(good[0], status)
        compared += 1
    assert compared >= 2


@pytest.mark.gate
@pytest.mark.parametrize("name", ["relieved", "narrow"])
def test_increments_tend_to_the_path_beyond_such_events(name):
    """First order as a whole; single numbers of increments may be lucky."""
    case, history = CASES[name]
    exact = solve(case, history, nodes=101)
    differences = []
    for increments in (100, 1600):
        steps = solve(case, history, grid=exact.grid, method="increment", increments=increments)
        last, end = steps[-1], exact[-1]
        differences.append(np.abs(last.shear - end.shear).sum() / np.abs(end.pressure).sum())
    assert differences[1] < differences[0] / 6.0
    assert differences[1] < 2e-3


@pytest.mark.parametrize("turn", [-1.0, 1.0])
def test_nodes_without_friction_settle_beside_others(titanium_in_aluminium, turn):
    """They slip or open. A node that came to stick there is let go."""
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    system = System.build(case, Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 41), 1.0)
    bare = np.arange(41) % 3 == 0
    system = replace(system, friction=np.where(bare, 0.0, system.friction))
    loads = {load: np.eye(len(LOADS))[place] for place, load in enumerate(LOADS)}
    start, _ = first_contact(system, unloaded_configuration(system), 0.0 * loads["P"], loads["P"])
    now = PathStep(system, start, loads["P"] + 0.2 * loads["Q"]).follow(1.0)
    now.status[bare & now.closed] = STICK
    open_, edge = np.flatnonzero(~now.closed), np.flatnonzero(now.closed)[0]
    now.gap[open_[open_ > edge][0]], now.pressure[edge], now.shear[edge] = 0.0, 0.0, 0.0
    status = settle(system, now, turn * loads["Q"])
    assert rate_violation(system, now, status, turn * loads["Q"]) < 1e-9
    assert not np.any(status[bare] == STICK)
    assert np.count_nonzero(status[~bare] == STICK) > 3


def test_statuses_that_are_left_alone_settle_without_lemke(met, titanium_in_aluminium):
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    result = solve(case, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}], nodes=101)
    assert not met
    assert result.statistics["resettled"] == result.statistics["jumps"] == 0


def test_each_settling_allows_a_step_its_rebuilds_once_more(titanium_in_aluminium):
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    system = System.build(case, Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 41), 1.0)
    load = np.eye(len(LOADS))[P]
    start, _ = first_contact(system, unloaded_configuration(system), 0.0 * load, load)
    step = PathStep(system, start, load)
    step.rebuilds, step.resettled = path.MOST_REBUILDS, 1
    step._rebuild()
    step.rebuilds = 2 * path.MOST_REBUILDS
    with pytest.raises(path.StepLostError):
        step._rebuild()


@pytest.mark.gate
def test_jumps_are_counted_and_end_in_states(met):
    case, history = VERY_ROUGH
    result = solve(case, history, nodes=61)
    assert result.statistics["jumps"] > 0
    assert result.statistics["resettled"] >= result.statistics["jumps"]


@pytest.mark.parametrize("friction", [0.0, 0.4, "varied"])
@pytest.mark.parametrize("closed", [False, True])
def test_a_finite_step_is_an_implicit_increment(titanium_in_aluminium, friction, closed):
    """Both solve the same problem. Where the increment's iteration ends, Lemke's method finds its state."""
    varied, friction = friction == "varied", 0.4 if friction == "varied" else friction
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, friction, "body")
    grid = Grid.circle(61) if closed else Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 41)
    system = System.build(case, grid, 1.0)
    if varied:
        spots = np.arange(grid.size) % 3 == 0
        system = replace(system, friction=np.where(spots, 0.0, 0.2 + 0.1 * np.sin(3.0 * grid.theta)))
    nothing, first, last = (
        np.array([load.get(name, 0.0) for name in LOADS]) for load in ({}, {"P": 1.0}, {"P": 0.9, "Q": 0.2})
    )
    start, part = first_contact(system, unloaded_configuration(system), nothing, first)
    now = PathStep(system, start, first).follow(1.0)
    assert part < 1.0
    for load in (0.97 * first, last, 0.3 * first):
        one, two = FiniteStep(system, now).to(load), implicit_step(system, now, load)
        assert worst_residual(system, one) < 1e-12
        rough = system.friction > 0.0
        assert np.array_equal(one.status[rough], two.status[rough])
        assert np.array_equal(one.closed, two.closed)
        for field in ("pressure", "shear", "gap", "slip", "motion"):
            assert getattr(one, field) == pytest.approx(getattr(two, field), abs=1e-12)


def test_without_rates_lemke_finds_none(titanium_in_aluminium):
    """A frictionless pin in contact at one node can't be held sideways: no statuses give rates."""
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.0, "body")
    system = System.build(case, Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 41), 1.0)
    now = unloaded_configuration(system)
    now.status[20], now.pressure[20], now.gap[20] = 1, 1.0, 0.0
    assert settle(system, now, np.eye(len(LOADS))[1]) is None
    assert settling.lemke(-np.eye(1), np.array([-1.0])) is None


def test_the_cap_of_variables(monkeypatch):
    monkeypatch.setattr(settling, "MOST_VARIABLES", 1)
    assert settling.lemke(np.eye(2), -np.ones(2)) is None


def test_only_gaps_may_miss_their_bounds_by_the_rounding_of_displacements(titanium_in_aluminium):
    """At a stop where gaps have opened this instant, the largest gap is itself rounding."""
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    settled = unloaded_configuration(System.build(case, Grid.circle(6), 1.0))
    settled.pressure[:3], settled.shear[:3], settled.status[:3] = [1.0, 2.0, 1.0], [0.1, 0.0, -0.1], STICK
    settled.gap[:], settled.slip[:] = 0.0, 1.0
    for name, node, error, is_rounding in [
        ("gap", 4, -0.9 * conditions.ROUNDING, True),
        ("gap", 4, -1.1 * conditions.ROUNDING, False),
        ("pressure", 1, 1.9 * path.MOST_DRIFT, True),
        ("pressure", 1, 2.1 * path.MOST_DRIFT, False),
        ("shear", 0, -1.9 * path.MOST_DRIFT, True),
        ("shear", 0, -2.1 * path.MOST_DRIFT, False),
    ]:
        solution = settled.copy().values
        getattr(solution, name)[node] += error
        beyond = conditions.beyond_bounds(solution, settled.values)
        assert path.exceeds_bounds(Correction(settled, 0.0, 0.0, beyond), last=True) != is_rounding


def test_too_many_events_are_told_from_a_snap(monkeypatch, titanium_in_aluminium):
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    pressed = solve(case, [{"P": 1.0}], grid=Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 81))
    monkeypatch.setattr(path, "MOST_EVENTS", 0)
    step_by_step(monkeypatch)
    with pytest.raises(ConvergenceError, match="did not settle"):
        solve(case, [{"Q": 0.3}, {"Q": -0.3}], start=pressed)
    assert exchange.ENDLESS != exchange.CYCLING


@pytest.mark.parametrize("friction", [0.3, 1.0, 3.0])
def test_a_reversal_has_one_branch(monkeypatch, friction):
    """Lemke's method may end in any solution. From any covering vector it finds the statuses that the path takes."""
    rng = np.random.default_rng(1)
    case = problem((9, 0.2), (2, 0.4), 0.3, friction, "centre", "free")
    result = solve(case, [{"P": 1.0, "Q": 0.1}, {"Q": 0.4}], nodes=101)
    system, now = System.build(case, result.grid, result.restart.force), result.restart.configuration
    for corner in ({"P": 0.9, "Q": 0.1}, {"P": 1.2, "Q": 0.3}, {"P": 0.7, "Q": 0.5}):
        target = np.array([corner.get(name, 0.0) for name in LOADS])
        after = now.load + 0.1 * (target / system.scales.loads - now.load)
        path_step = PathStep(system, now, after)
        expected = path_step.follow(1e-7).status
        for _ in range(6):
            monkeypatch.setattr(settling, "lemke", lambda *given: lemke_from(rng, *given))
            assert np.array_equal(settle(system, now, after - now.load), expected)


def lemke_from(rng, matrix, vector):
    """Lemke's method with a random covering vector."""
    k = vector.size
    z, tableau, basis = np.zeros(k), np.empty((k, 2 * k + 2)), np.empty(k, dtype=np.int64)
    cover = 10.0 ** rng.uniform(-2.0, 2.0, k)
    assert complementarity.lemke(matrix, vector, cover, 20 * k + 100, tableau, basis, z)
    return z
