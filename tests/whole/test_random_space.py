"""Random histories over the whole space: the contact conditions anew, related cases, and the two solvers."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Grid, Material, MaterialPair, Problem, solve
from fastpin.bodies import Disk, Ring, Tube
from fastpin.elasticity.system import System
from tests.support.potentials import displacement_kernels
from tests.support.slip_cases import UNLIKE
from tests.support.tiers import seeds, some_gate
from tests.survey import conditions, two_roads
from tests.survey.histories import GENERATORS, generate, lug
from tests.survey.random_histories import Outcome, examine

QUICK = ("extreme", "remote", "fits", "rough", "laminates")
"""Classes of which three histories take less than half a second."""


KINDS = [kind for kind in GENERATORS if kind not in ("drift", "scales")]


def assert_right(outcome: Outcome) -> None:
    """No state is wrong. A refusal is no wrong state."""
    assert outcome.violations() == {}, f"{outcome.kind} {outcome.seed}"


@pytest.mark.parametrize("kind", some_gate(KINDS, *(kind for kind in KINDS if kind not in QUICK)))
def test_a_few_random_histories_of_each_class(kind):
    """Friction that changes and odd scales take more time than all others. The survey has them."""
    outcomes = [examine(kind, seed) for seed in seeds(3)]
    for outcome in outcomes:
        assert_right(outcome)
    assert sum(outcome.ending == "solved" for outcome in outcomes) >= 2


@pytest.mark.gate
@pytest.mark.parametrize(("kind", "seed"), [("wear", 29), ("wear", 107), ("wear", 164)])
def test_a_pin_comes_to_rest_in_a_worn_hole(kind, seed):
    outcome = examine(kind, seed)
    assert_right(outcome)
    assert outcome.ending == "solved"


@pytest.mark.gate
def test_increments_tend_to_the_path():
    found = two_roads.compare("fits", 0)
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


@pytest.mark.gate
def test_the_check_knows_the_displacement_of_a_lug_by_loads():
    """A driven pin meets the hole after some stress has acted. Its slip counts from there."""
    pair = MaterialPair(UNLIKE.pin, Material(UNLIKE.plate.E, 0.33), "strain")
    body = lug(0.33, "strain")
    problem = Problem.from_load_parameter(pair, 0.1, 0.5, "centre", "fixed", plate_body=body, drive="uy")
    states = solve(problem, [{"uy": 0.5, "sxx": 0.3}, {"uy": -0.5}], nodes=61).states
    found = conditions.check_states(states)
    assert max(each["slip"] for each in found) < 1e-12


@pytest.mark.gate
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
