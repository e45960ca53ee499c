"""Random histories over the whole space: the contact conditions anew, related cases, and the two solvers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin.bodies import Disk, Ring, Tube
from fastpin.elasticity.system import System
from fastpin.model.grid import Grid
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from scripts import conditions, metamorphic, two_roads
from scripts.histories import GENERATORS, generate, lug
from scripts.random_histories import Outcome, examine, table
from tests.support.potentials import displacement_kernels
from tests.support.slip_cases import UNLIKE

FEW, MANY = range(1, 4), range(300, 310)


def assert_right(outcome: Outcome) -> None:
    """No state is wrong. A refusal is no wrong state."""
    assert outcome.violations() == {}, f"{outcome.kind} {outcome.seed}"


@pytest.mark.parametrize("kind", [*(kind for kind in GENERATORS if kind != "drift"), "drift"])
def test_a_few_random_histories_of_each_class(kind):
    """Friction that changes takes more time than all others, and has quick tests of its own."""
    outcomes = [examine(kind, seed) for seed in FEW]
    for outcome in outcomes:
        assert_right(outcome)
    assert sum(outcome.ending == "solved" for outcome in outcomes) >= 2


@pytest.mark.parametrize("kind", GENERATORS)
def test_random_histories_of_each_class(kind):
    outcomes = [examine(kind, seed) for seed in MANY]
    for outcome in outcomes:
        assert_right(outcome)
    assert sum(outcome.ending in ("solved", "spins") for outcome in outcomes) >= 0.8 * len(outcomes)
    assert kind.split("_")[0] in table(outcomes)


@pytest.mark.parametrize("seed", [371, 373])
def test_a_contact_under_force_is_not_lost(seed):
    assert_right(examine("scales", seed))


@pytest.mark.parametrize(("kind", "seed"), [("wear", 29), ("wear", 107), ("wear", 164)])
def test_a_pin_comes_to_rest_in_a_worn_hole(kind, seed):
    outcome = examine(kind, seed)
    assert_right(outcome)
    assert outcome.ending == "solved"


@pytest.mark.parametrize("seed", [47, 58])
def test_one_more_corner_changes_no_first_contact(seed):
    (pair,) = metamorphic.compare("moderate_stress", seed, ("split",))
    assert pair.difference < metamorphic.TOLERANCE


@pytest.mark.parametrize("kind", GENERATORS)
def test_the_way_between_the_corners(kind):
    for seed in FEW:
        assert_right(examine(kind, seed, dense=True))


@pytest.mark.parametrize(
    ("kind", "seeds"),
    [
        *((kind, (1, 2)) for kind in ("general", "extreme", "moderate_stress", "remote")),
        ("gap", (3, 7)),
        ("drift", (2, 5)),
    ],
)
def test_related_cases_have_related_states(kind, seeds):
    """Turned, mirrored, scaled, split and renumbered cases: sixty pairs in all."""
    for seed in seeds:
        pairs = metamorphic.compare(kind, seed)
        assert len(pairs) == len(metamorphic.RELATIONS)
        for pair in pairs:
            assert pair.ending == "compared"
            assert pair.difference < metamorphic.TOLERANCE, pair


@pytest.mark.parametrize("kind", two_roads.CLASSES)
def test_increments_tend_to_the_path(kind):
    found = two_roads.compare(kind, 0)
    assert found.verdict in ("agree", "falling"), found
    assert found.differences[1] < found.differences[0]


def test_the_recomputed_integrals_are_the_kernels_of_the_theory():
    """Against the kernels (9)-(12) by a fine midpoint rule at angles without tractions nearby."""
    case = generate("extreme", 4)
    grid = Grid.circle(40)
    loaded = np.zeros(40, dtype=bool)
    loaded[3:6] = True
    integrals = conditions.Integrals(case.problem, grid.theta, True, loaded)
    xi = grid.theta[2] + (np.arange(20000) + 0.5) / 20000 * (grid.theta[6] - grid.theta[2])
    hats = np.array([np.interp(xi, grid.theta, np.eye(40)[node]) for node in (3, 4, 5)])
    for node in (12, 25, 39):
        phi = (grid.theta[node] - xi + math.pi) % (2.0 * math.pi) - math.pi
        kernels = displacement_kernels(case.problem.pair, 0.0, phi)
        swelling = 0.5 * (case.problem.pair.pin_kolosov + 1.0) * case.problem.pair.pin_compliance
        step = xi[1] - xi[0]
        assert integrals.direct[node] == pytest.approx(hats @ (kernels[0] + swelling) * step, rel=1e-6)
        assert integrals.cross[node] == pytest.approx(hats @ kernels[1] * step, rel=1e-6)


@pytest.mark.parametrize("closed", [False, True])
def test_the_recomputed_integrals_equal_the_operator(closed):
    """Two independent ways to the same integrals, also where a node lies on the logarithm."""
    problem = generate("extreme", 4).problem
    spread = np.linspace(-1.0, 1.0, 31)
    grid = Grid(2.0 * spread + 0.4 * np.sin(math.pi * spread), closed)
    integrals = conditions.Integrals(problem, grid.theta, closed, np.ones(31, dtype=bool))
    swelling = 0.5 * (problem.pair.pin_kolosov + 1.0) * problem.pair.pin_compliance * grid.weights
    operator = 4.0 * math.pi * np.asarray(System.build(problem, grid, 1.0).operator)
    assert np.abs(operator[:31, :31] - (integrals.direct - swelling)).max() < 1e-12
    assert np.abs(operator[:31, 31:] - integrals.cross).max() < 1e-12


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("N >= 0", lambda s: {"pressure": s.pressure - 0.1 * s.pressure.max()}),
        ("|T| <= mu N", lambda s: {"shear": 1.01 * s.shear}),
        ("gap", lambda s: {"gap": np.where(s.gap > 0.0, 1.001 * s.gap, 0.0)}),
        ("gap >= 0", lambda s: {"gap": s.gap - 1e-3}),
        ("equilibrium", lambda s: {"pressure": 1.001 * s.pressure}),
        ("slip", lambda s: {"slip": s.slip + 1e-3 * np.sin(3.0 * s.theta)}),
        ("rotation", lambda s: {"rotation": s.rotation + 1e-3}),
        ("energy", lambda s: {"energy": 1.01 * s.energy}),
        ("balance", lambda s: {"work": 1.2 * s.work}),
    ],
)
def test_wrong_states_are_found(name, change):
    case = generate("fixed", 9)
    states = solve(case.problem, case.history, **case.options).states
    assert max(conditions.check_states(states)[-1].values()) < 1e-3
    wrong = replace(states[-1], **change(states[-1]))
    assert conditions.check_states([*states[:-1], wrong])[-1][name] > 1e-5


@pytest.mark.parametrize("pin", [Disk(), Tube(0.4)])
def test_the_check_knows_the_spring_of_a_hub(pin):
    problem = Problem.from_load_parameter(
        UNLIKE, 0.1, 0.5, "centre", "spring", hub_stiffness=2.0, pin_body=pin, plate_body=Ring(3.0)
    )
    states = solve(problem, [{"P": 1.0}, {"Q": 0.3, "rotation": 0.2}], nodes=41).states
    assert states[-1].rotation != pytest.approx(0.2, rel=0.1)
    assert max(found["rotation"] for found in conditions.check_states(states)) < 1e-12


def test_the_check_knows_the_displacement_of_a_lug_by_loads():
    """A driven pin meets the hole after some stress has acted. Its slip counts from there."""
    pair = MaterialPair(UNLIKE.pin, Material(UNLIKE.plate.E, 0.33), "strain")
    body = lug(0.33, "strain")
    problem = Problem.from_load_parameter(pair, 0.1, 0.5, "centre", "fixed", plate_body=body, drive="uy")
    states = solve(problem, [{"uy": 0.5, "sxx": 0.3}, {"uy": -0.5}], nodes=61).states
    found = conditions.check_states(states)
    assert max(each["slip"] for each in found) < 1e-12


def test_wrong_directions_of_slip_are_found():
    case = generate("moderate_stress", 2)
    result = solve(case.problem, case.history, between=39, **case.options)
    assert conditions.check_direction(result)[0] == 0.0
    turned = [replace(state, slip=-state.slip) for state in result.states]
    assert max(amount for _, _, amount in conditions.wrong_slips(turned)) > 0.01 * conditions.slip_size(turned)
    states = result.states
    assert conditions.check_dissipation(result) == 0.0
    for state in states:
        object.__setattr__(state, "dissipation", 2.0 * state.dissipation)
    assert conditions.dissipation_error(states, 0.5 * states[-1].dissipation) == 0.5
