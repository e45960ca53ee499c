"""The solution of the equations of given statuses: compiled, as plain Python, and against a factorisation."""

import numpy as np
import pytest

from fastpin import Grid, Problem
from fastpin.elasticity.interfaces import JointSystem
from fastpin.elasticity.system import System
from fastpin.kernels import equations
from fastpin.kernels.arrays import ContactValues
from fastpin.kernels.equations import MOST_UNKNOWNS
from fastpin.kernels.status import OPEN, STICK
from fastpin.model import LOADS
from fastpin.solver import configuration
from fastpin.solver.configuration import solve_statuses, solve_unknowns
from fastpin.solver.unknowns import DenseUnknowns
from tests.support.bodies import HOLDS
from tests.support.joints import joint

KERNELS = equations
BOTTOM = -0.5 * np.pi
CASES = {**HOLDS, "frictionless": {"friction": 0.0}}


@pytest.fixture
def solve(way):
    return equations.solve_few


def system_of(pair, case):
    options = {"friction": 0.4, "rotation": "free", **CASES[case]}
    return System.build(
        Problem.from_load_parameter(pair, 0.1, pin_load="centre", **options),
        Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 31),
        1.0,
    )


def drawn(system, rng):
    """Random statuses, a slip that sticking nodes hold, a load and a rest gap."""
    n = system.grid.size
    status = np.full(n, OPEN, dtype=np.int8)
    closed = rng.choice(np.arange(1, n - 1), int(rng.integers(3, 12)), replace=False)
    status[closed] = rng.choice([STICK, 1, -1], closed.size) if system.has_friction else 1
    if system.has_friction:
        status[closed[0]] = STICK
    load = np.array([{"P": 1.0, "Q": rng.normal()}.get(name, 0.0) for name in LOADS])
    return status, rng.normal(size=n), load, rng.random(n)


@pytest.mark.parametrize("case", CASES)
def test_it_is_the_solution_by_a_factorisation(titanium_in_aluminium, solve, case, monkeypatch):
    system, rng = system_of(titanium_in_aluminium, case), np.random.default_rng(3)
    monkeypatch.setattr(configuration.equations, "solve_few", solve)
    for _ in range(6):
        status, slip, load, gap = drawn(system, rng)
        expected = solve_unknowns(system, DenseUnknowns(system, status), slip, load, gap)
        found = solve_statuses(system, status, slip, load, gap)
        for name in ("pressure", "shear", "gap", "slip", "motion"):
            one, other = getattr(found, name), getattr(expected, name)
            scale = np.abs(np.r_[expected.pressure, expected.shear] if name in ("pressure", "shear") else other).max()
            assert np.abs(one - other).max() < 1e-9 * scale, name


def test_many_unknowns_are_left_to_lapack(titanium_in_aluminium, monkeypatch):
    system = system_of(titanium_in_aluminium, "plain")
    status = np.full(31, OPEN, dtype=np.int8)
    status[1 : 2 + MOST_UNKNOWNS // 2] = STICK
    monkeypatch.setattr(configuration.equations, "solve_few", None)
    assert solve_statuses(system, status, np.zeros(31), np.zeros(len(LOADS)), 0.0) is not None


def test_the_condition_number_is_that_of_the_definition(titanium_in_aluminium, solve):
    system, rng = system_of(titanium_in_aluminium, "plain"), np.random.default_rng(5)
    status, slip, load, gap = drawn(system, rng)
    unknowns = DenseUnknowns(system, status)
    inverse = unknowns.solve(np.eye(unknowns.size))
    inverse[: unknowns.count] *= system.width  # unknowns are forces
    solution = ContactValues(*np.empty((4, 31)), status, np.empty(3))
    condition = solve(
        system.operator.matrix, system.equations, system.load_displacement(load), system.load_forces(load), gap, slip,
        system.width, solution,
    )  # fmt: skip
    assert condition == pytest.approx(1.0 / np.linalg.cond(np.linalg.inv(inverse), 1), rel=1e-6)


@pytest.mark.parametrize(
    ("case", "closed", "as_status"),
    [("plain", [14, 15, 16], 1), ("plain", [15], STICK), ("frictionless", [15], 1), ("frictionless", [3], 1)],
)
def test_a_mechanism_has_no_solution(titanium_in_aluminium, solve, case, closed, as_status, monkeypatch):
    """All nodes slip, the pin turns about one node, or it slides off one node without friction."""
    system = system_of(titanium_in_aluminium, case)
    monkeypatch.setattr(configuration.equations, "solve_few", solve)
    status = np.full(31, OPEN, dtype=np.int8)
    status[closed] = as_status
    assert DenseUnknowns(system, status).singular
    with np.errstate(all="ignore"):
        assert solve_statuses(system, status, np.zeros(31), np.ones(len(LOADS)), 0.0) is None


def test_both_interfaces_of_a_joint(solve, monkeypatch):
    """There are six motions, and nodes of two rims."""
    system = JointSystem.join(joint(0.3, 0.25), (Grid.circle(24), Grid.circle(32)), 1.0)
    monkeypatch.setattr(configuration.equations, "solve_few", solve)
    status = np.full(56, OPEN, dtype=np.int8)
    status[[4, 5, 6, 30, 31, 32]] = [1, STICK, STICK, STICK, STICK, -1]
    load, slip = np.ones(len(LOADS)), np.linspace(0.0, 1.0, 56)
    found = solve_statuses(system, status, slip, load, system.concentric_gap)
    expected = solve_unknowns(system, DenseUnknowns(system, status), slip, load, system.concentric_gap)
    for name in ("pressure", "shear", "gap", "slip", "motion"):
        assert getattr(found, name) == pytest.approx(getattr(expected, name), rel=1e-8, abs=1e-8)
