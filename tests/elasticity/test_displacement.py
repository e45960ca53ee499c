"""The displacement of the hub over the gauge circle, (T27) to (T29): fields from potentials, and the matrices."""

import math

import numpy as np
import pytest

from fastpin import Grid, Material, MaterialPair, Problem
from fastpin.elasticity.drive import displacement_coupling
from fastpin.elasticity.system import System
from fastpin.model import LOADS
from fastpin.model.angles import BOTTOM
from fastpin.model.loads import ROTATION, UX, UY, M, P, Q
from tests.support.potentials import KOLOSOV, RADIUS, Potentials, pin_body, pin_normal, pin_shear, plate

PI = math.pi
CIRCLE = np.exp(2j * PI * (np.arange(720) + 0.5) / 720)
TURNS = [0.0, 0.8, -2.1]


def mean(body: Potentials, radius: float) -> complex:
    """The mean of 2G (u_x + i u_y) on a circle, for a load at z = a."""
    return complex(np.mean(body.displacement(radius * CIRCLE)))


@pytest.mark.parametrize("kappa", KOLOSOV)
def test_mean_in_the_plate(kappa):
    for force in (1.0, -1j, 0.6 + 0.3j):
        rim = mean(plate(kappa, force), 1.0001 * RADIUS)
        for part in (1.5, 4.0, 30.0):
            expected = -kappa * force / (PI * (kappa + 1.0)) * math.log(part)
            assert mean(plate(kappa, force), part * RADIUS) - rim == pytest.approx(expected, abs=2e-3)
        one, two = (mean(plate(kappa, force), part * RADIUS) for part in (1.5, 4.0))
        assert two - one == pytest.approx(-kappa * force / (PI * (kappa + 1.0)) * math.log(4.0 / 1.5), abs=1e-12)


@pytest.mark.parametrize("kappa", KOLOSOV)
@pytest.mark.parametrize("kind", ["N", "T"])
def test_mean_in_the_pin(kappa, kind):
    """A unit pressure or shear at theta = 0, with the load at the centre or as a body force."""
    force, J, pin = (1.0, 1.0, pin_normal) if kind == "N" else (-1j, 1j, pin_shear)
    body = pin_body(kappa)

    def at_centre(part):
        inside = 1.0 - part**2
        own = force / (PI * (kappa + 1.0)) * (inside - kappa * math.log(part))
        return own - inside * J / (2.0 * PI)

    for part in (0.2, 0.5, 0.9):
        moved = mean(pin(kappa), part * RADIUS) - mean(pin(kappa), 0.95 * RADIUS)
        assert moved == pytest.approx(at_centre(part) - at_centre(0.95), abs=1e-12)
        if kind == "N":
            moved += mean(body, part * RADIUS) - mean(body, 0.95 * RADIUS)
            expected = (force - J) / (2.0 * PI) * (0.95**2 - part**2)
            assert moved == pytest.approx(expected, abs=1e-12)
    rim = mean(pin(kappa), 0.9999 * RADIUS)
    assert mean(pin(kappa), 0.5 * RADIUS) - rim == pytest.approx(at_centre(0.5), abs=2e-3)


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("pin_load", ["centre", "body"])
def test_coefficients_of_the_problem(pin_load, turn):
    """g F - k J of the problem for a traction at one angle is the mean of the fields there."""
    pair = MaterialPair(Material(3.0, 0.3), Material(2.0, 0.2))
    hub = 0.4 if pin_load == "centre" else None
    problem = Problem.from_load_parameter(
        pair, 0.1, 0.4, pin_load, "free", hub, drive="both", gauge_radius=3.0
    )  # fmt: skip
    pair, a = problem.pair, RADIUS
    own, coupling = problem.drive_compliances
    angle = np.exp(1j * turn)
    for N, T in ((1.0, 0.0), (0.0, 1.0)):
        force, J = (N - 1j * T) * angle, (N + 1j * T) * angle
        given = own * force - coupling * J
        hole = plate(pair.plate_kolosov, N - 1j * T)
        far, near = mean(hole, 3.0 * a), mean(hole, 1.2 * a)
        # from the rim to 1.2 a by (T27): there the field is smooth enough for 720 points
        near += pair.plate_kolosov * (N - 1j * T) / (PI * (pair.plate_kolosov + 1.0)) * math.log(1.2)
        moved = 0.5 * pair.plate_compliance * (near - far)
        if pin_load == "centre":
            body = pin_normal(pair.pin_kolosov) if N else pin_shear(pair.pin_kolosov)
            inner = mean(body, 0.4 * a) - mean(body, 0.8 * a)
            moved += 0.5 * pair.pin_compliance * (inner + rim_to(0.8, pair.pin_kolosov, N, T))
        else:
            moved += 0.5 * pair.pin_compliance * (N - 1j * T - (N + 1j * T)) / (4.0 * PI)
        assert given * pair.beta_star == pytest.approx(moved * angle, abs=1e-12)


def rim_to(part, kappa, N, T):
    """(T28) from the rim to a circle beside it, where the field is too steep for a quadrature."""
    inside = 1.0 - part**2
    return (N - 1j * T) * (inside - kappa * math.log(part)) / (PI * (kappa + 1.0)) - inside * (N + 1j * T) / (2.0 * PI)


def test_the_rows_are_the_integrals():
    problem = Problem.from_load_parameter(
        MaterialPair(Material(3.0, 0.3), Material(2.0, 0.2)), 0.1, 0.4, "body", drive="both"
    )
    grid = Grid.arc(BOTTOM - 1.5, BOTTOM + 1.2, 2001)
    x = (grid.theta - grid.theta[0]) / np.ptp(grid.theta)
    N, T = x * (1.0 - x), x**2 * (1.0 - x)
    J = np.sum(grid.weights * (N + 1j * T) * np.exp(1j * grid.theta))
    found = displacement_coupling(problem, grid) @ np.r_[N, T]
    assert complex(*found) == pytest.approx(problem.drive_compliances[1] * J, rel=1e-6)


@pytest.mark.parametrize("drive", ["ux", "uy", "both"])
@pytest.mark.parametrize("pin_load", ["centre", "body"])
def test_a_driven_system_is_the_same_system(titanium_in_aluminium, pin_load, drive):
    """With the displacement that the forces cause, gap and slip are the same; the reactions are the forces."""
    keywords = {"hub_radius": 0.3} if pin_load == "centre" else {}
    driven = Problem.from_load_parameter(
        titanium_in_aluminium, 0.3, 0.4, pin_load, "free", drive=drive, gauge_radius=2.5, **keywords
    )  # fmt: skip
    pushed = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4, pin_load)
    grid = Grid.arc(BOTTOM - 1.5, BOTTOM + 1.2, 41)
    one, two = System.build(pushed, grid, 1.0), System.build(driven, grid, 1.0)
    assert (one.drive.has_displacements, two.drive.has_displacements) == (False, True)
    rng = np.random.default_rng(1)
    tractions, motion = rng.normal(size=82), rng.normal(size=3)
    load = np.zeros(len(LOADS))
    force = (one.equilibrium @ tractions)[:2]  # Q, -P
    load[[Q, P, M, ROTATION]] = force[0], -force[1], -(one.grid.weights @ tractions[41:]), 0.0
    own = driven.drive_compliances[0]
    displacement = motion[:2] + own * force - displacement_coupling(driven, grid) @ tractions
    given, slots = load.copy(), motion.copy()
    for axis, (force_place, place) in enumerate(((Q, UX), (P, UY))):
        if driven.driven[axis]:
            given[force_place], given[place], slots[axis] = 0.0, displacement[axis], force[axis]
    before = one.displacement(tractions, motion, load, 0.1)
    assert two.displacement(tractions, slots, given, 0.1) == pytest.approx(before, abs=1e-12)
    balance = two.equilibrium @ tractions + two.motion_rows @ slots
    assert balance == pytest.approx(two.load_forces(given), abs=1e-12)
    assert two.drive.position(tractions, slots, given, np.zeros(2)) == pytest.approx(motion[:2], abs=1e-12)
    assert two.drive.with_reactions(slots, given)[[P, Q]] == pytest.approx(load[[P, Q]], abs=1e-12)
    nodes = np.arange(5, 30)
    rows = np.r_[nodes, 41 + nodes]
    alone = np.zeros(82)
    alone[rows] = tractions[rows]
    for system, now, acting in ((one, motion, load), (two, slots, given)):
        whole, part = system.displacement(alone, now, acting, 0.1), system.part(nodes)
        assert part.displacement(alone[rows], now, acting, 0.1) == pytest.approx(whole[rows], abs=1e-12)
        assert part.drive.translation == pytest.approx(system.drive.translation[rows])
        held = system.held_displacement(acting)[rows]
        assert part.held_displacement(acting) == pytest.approx(held, abs=1e-12)


def test_forces_need_no_reactions(titanium_in_aluminium):
    """Under forces a drive adds nothing to operator, energy and work, and its forces are the loads."""
    pushed = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4, "body")
    system = System.build(pushed, Grid.arc(BOTTOM - 1.5, BOTTOM + 1.2, 41), 1.0)
    rng = np.random.default_rng(2)
    drive, tractions, motion, load = system.drive, rng.normal(size=82), rng.normal(size=3), rng.normal(size=len(LOADS))
    assert [factor.size for factor in drive.factors] == [0, 0]
    assert drive.energy(np.ones(82), tractions, motion) == 0.0
    assert not drive.reaction_terms(np.ones(82), load).any()
    assert drive.work(np.ones(82), tractions, motion, motion, load) == 0.0
    assert drive.force(motion, load).tolist() == [load[Q], -load[P]]
    assert drive.with_reactions(motion, load).tolist() == load.tolist()
    assert drive.prescribed(load).tolist() == [0.0, 0.0]
    place = drive.position(tractions, motion, load, np.array([0.1, 0.2]))
    assert place == pytest.approx([motion[0] + 0.1, motion[1] + 0.2])


def test_the_compliance_of_the_rim_is_negative_and_that_of_the_hub_is_not():
    """First harmonic of a contact all round, soft pin in a rigid plate: docs/theory.md, section 6."""
    pair = MaterialPair(Material(1.0, 0.3), Material.rigid())
    grid = Grid.circle(360)
    stiffness = []
    for hub in (1.0, None, 0.2):
        problem = Problem.from_load_parameter(pair, -0.1, 0.0, "centre", "fixed", hub, drive="both")
        system = System.build(problem, grid, 1.0)
        pressure = np.r_[np.cos(grid.theta), np.zeros(360)]
        reaction = (system.equilibrium @ pressure)[0]
        gap = (system.operator @ pressure + system.motion[:, 0] * reaction)[:360]
        stiffness.append(2.0 * float(np.mean(gap * np.cos(grid.theta))) / pair.scaled(1.0).pin_compliance * 4.0)
    kappa = pair.pin_kolosov
    inside, part = kappa / (kappa + 1.0), 1.0 / math.sqrt(kappa + 1.0)
    hub = 2.0 * (inside - kappa * math.log(part)) / (kappa + 1.0) - inside
    assert stiffness[0] == pytest.approx(0.5 * kappa - 1.0, abs=1e-3)
    assert stiffness[1] == pytest.approx(0.5 * kappa - 1.0 + hub, abs=1e-3)
    assert stiffness[0] < 0.0 < stiffness[1] < stiffness[2]
