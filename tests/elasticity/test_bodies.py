"""The matrices of hollow pins, ring lugs, bushes and compliances: limits, other bodies, raw conditions, reciprocity."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from fastpin import Grid, Problem
from fastpin.bodies import Bushing, Disk, Plate, Ring, Tube
from fastpin.elasticity.system import System
from fastpin.elasticity.terms import body_terms
from fastpin.model.angles import BOTTOM
from fastpin.model.loads import LOADS, REMOTE, SXX, SXY, SYY, P, Q
from fastpin.narrow.large import LargeSystem
from tests.support import walls
from tests.support.bodies import JOINTS, UNLIKE, joint_problem
from tests.support.checks.body_cases import ring_compliance
from tests.support.potentials import first_harmonic, plate
from tests.support.tiers import gate

GRIDS = {
    "arc": Grid.arc(BOTTOM - 1.7, BOTTOM + 1.7, 61),
    "circle": Grid.circle(72, -1.5 * math.pi),
    "graded": Grid.graded([(BOTTOM, 0.05)], 90),
}
FORCES = np.array([Q, P])
ALL = [*JOINTS, "ring, compliance"]


def unlike(**bodies):
    return Problem.from_load_parameter(UNLIKE, 0.1, 0.3, **bodies)


def assert_same(one, two, tolerance=1e-13):
    """Check that two systems have the same matrices."""
    assert one.operator == pytest.approx(two.operator, abs=tolerance)
    assert one.loads == pytest.approx(two.loads, abs=tolerance)
    assert one.rest_clearance == pytest.approx(two.rest_clearance, rel=tolerance)
    load = np.zeros(len(LOADS))
    load[[SXX, SYY, SXY]] = 0.3, -0.2, 0.1
    found, expected = (hole_displacement(system, load) for system in (one, two))
    assert found == pytest.approx(expected, abs=10.0 * tolerance)


def hole_displacement(system, load):
    """v_r of the hole under remote stresses, and two derivatives, from the columns of a circle of nodes."""
    if system.bodies is not None:
        return system.bodies.radial(load, system.grid.theta)
    theta, A, D = system.grid.theta, load[SXX] + load[SYY], load[SXX] - load[SYY] - 2j * load[SXY]
    oval = D * np.exp(2j * theta)
    none = 0.0 * theta
    return system.plate * np.array([0.5 * A + oval.real, none - 2.0 * oval.imag, none - 4.0 * oval.real])


# --- symmetry and limits ----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ALL)
def test_the_operator_is_symmetric(name):
    """On uniform nodes of a circle the collocation is symmetric, as the kernels are (Betti). Measured: 2.6e-16."""
    system = System.build(joint_problem(name, 0.1, 0.3), GRIDS["circle"], 1.0)
    assert np.abs(system.operator).max() > 1e-2
    matrix = np.asarray(system.operator)
    assert matrix == pytest.approx(matrix.T, abs=1e-15)


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("load", ["uniform", "normal", "shear", "held"])
def test_a_vanishing_bore_is_a_solid_pin(load, grid):
    """The change falls with the square of the bore."""
    solid = System.build(unlike(), grid, 1.0)
    for bore in (1e-2, 1e-4, 1e-6):
        hollow = System.build(unlike(pin_body=Tube(bore, load)), grid, 1.0)
        assert_same(hollow, solid, max(5.0 * bore**2, 1e-14))


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("support", ["uniform", "normal", "shear", "body"])
def test_a_far_rim_is_an_infinite_plate(support, grid):
    """The stresses on the rim are then the remote stresses of the plate."""
    infinite = System.build(unlike(), grid, 1.0)
    for rim in (1e2, 1e4, 1e6):
        ring = System.build(unlike(plate_body=Ring(rim, support)), grid, 1.0)
        assert_same(ring, infinite, max(20.0 / rim**2, 2e-14))


def test_a_far_held_rim_is_an_infinite_plate_without_remote_stress():
    infinite = System.build(unlike(), GRIDS["circle"], 1.0)
    ring = System.build(unlike(plate_body=Ring(1e6)), GRIDS["circle"], 1.0)
    assert ring.operator == pytest.approx(infinite.operator, abs=1e-11)
    assert ring.loads[:, FORCES] == pytest.approx(infinite.loads[:, FORCES], abs=1e-11)
    assert not ring.loads[:, list(REMOTE)].any()


def test_the_default_bodies_build_the_same_bits():
    for grid in GRIDS.values():
        one, two = (
            System.build(problem, grid, 1.0) for problem in (unlike(), unlike(pin_body=Disk(), plate_body=Plate()))
        )
        assert one.bodies is None
        assert np.array_equal(one.operator, two.operator)
        assert np.array_equal(one.loads, two.loads)


def test_a_body_loaded_tube_becomes_a_body_loaded_disk():
    solid = System.build(Problem.from_load_parameter(UNLIKE, 0.1, 0.3, "body"), GRIDS["arc"], 1.0)
    assert_same(System.build(unlike(pin_body=Tube(1e-5, "body")), GRIDS["arc"], 1.0), solid, 2e-10)


# --- layers and compliances -------------------------------------------------------------------------------

INSIDES = {
    "plate": Plate(), "reaction": Plate((0.7, 2.5)), "held": Ring(2.0), "uniform": Ring(2.0, "uniform"),
    "normal": Ring(2.0, "normal"), "shear": Ring(2.0, "shear"), "half": Ring(2.0, "half"), "body": Ring(2.0, "body"),
}  # fmt: skip


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("name", [name for name in INSIDES if name != "body"])
def test_a_bush_of_the_plates_own_material_is_part_of_the_plate(name, grid):
    """Operator, forces, remote stresses. Measured: 9e-16."""
    whole = System.build(unlike(plate_body=INSIDES[name]), grid, 1.0)
    bush = Bushing(UNLIKE.plate, 1.3, inside=INSIDES[name])
    assert_same(System.build(unlike(plate_body=bush), grid, 1.0), whole, 1e-14)


def test_a_bush_carries_no_body_force():
    """The body force of a ring round a bush balances the whole force: a ring without a bush has less outside R."""
    whole = System.build(unlike(plate_body=INSIDES["body"]), GRIDS["arc"], 1.0)
    parts = System.build(unlike(plate_body=Bushing(UNLIKE.plate, 1.3, inside=INSIDES["body"])), GRIDS["arc"], 1.0)
    assert parts.operator == pytest.approx(whole.operator, abs=1e-13)
    assert 1e-4 < np.abs(parts.loads[:, P] - whole.loads[:, P]).max() < 1e-2


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
@pytest.mark.parametrize("support", ["held", "uniform", "normal", "shear", "body"])
def test_a_ring_by_its_compliance(support, grid):
    """The same ring as a matrix between Fourier coefficients: operator, forces, stresses. Measured: 4e-16."""
    ring = unlike(plate_body=Ring(2.0, support))
    by_file = replace(ring, plate_body=ring_compliance(ring, 32))
    assert_same(System.build(by_file, grid, 1.0), System.build(ring, grid, 1.0), 1e-14)
    assert by_file.joint.uniform_compliance == pytest.approx(ring.joint.uniform_compliance, rel=1e-14, abs=0.0)


def test_a_compliance_with_few_harmonics_converges():
    """The error falls like K q^K, q = 1/4, with the highest harmonic K of the compliance of a ring to 2 R."""
    ring = unlike(plate_body=Ring(2.0, "normal"))
    exact, errors = np.asarray(System.build(ring, GRIDS["arc"], 1.0).operator), []
    for order in (5, 7, 9, 11, 13):
        found = System.build(replace(ring, plate_body=ring_compliance(ring, order)), GRIDS["arc"], 1.0)
        errors.append(np.abs(np.asarray(found.operator) - exact).max())
    ratios = np.divide(errors[:-1], errors[1:])
    assert np.all((ratios > 8.0) & (ratios < 20.0))
    assert errors[-1] < 1e-8


@pytest.mark.parametrize("name", ALL)
def test_the_product_of_a_large_system_is_the_operators(name):
    """Columns of the logarithm and Fourier sums against the filled operator. Measured: 5e-15."""
    problem, grid = joint_problem(name, 0.1, 0.3), GRIDS["graded"]
    dense, lazy = System.build(problem, grid, 1.0), LargeSystem.build(problem, grid, 1.0)
    assert not lazy.operator.is_stored
    assert np.array_equal(dense.loads, lazy.loads)
    tractions = np.random.default_rng(4).normal(size=2 * grid.size)
    tractions[grid.size // 2 : grid.size] = tractions[-grid.size // 2 :] = 0.0
    assert lazy.elastic(tractions) == pytest.approx(dense.elastic(tractions), abs=3e-14)


# --- columns of the loads from raw conditions -------------------------------------------------------------


def rim_columns(problem, traction):
    """v_r + i v_theta of a ring's hole at 90 angles under `traction` (complex, a function of theta) on its rim.

    Kolosov's equations with many digits, for the harmonics from 2 to 40; harmonic 1 is left out.
    """
    joint = problem.joint
    rim, kappa = joint.plate_body.lug.far(joint.hole), problem.pair.plate_kolosov
    compliance = problem.pair.plate_compliance / problem.surfaces.beta_star

    def coefficient(n):
        real, imaginary = (
            quad(lambda x, part=part: part(traction(x) * np.exp(-1j * n * x)), -math.pi, math.pi,
                 points=[-math.pi / 2, 0.0, math.pi / 2], epsabs=1e-13, limit=400)[0]
            for part in (np.real, np.imag)
        )  # fmt: skip
        return complex(real, imaginary) / (2.0 * math.pi)

    theta = 2.0 * math.pi * np.arange(90) / 90
    with_pressure = walls.Layers(0, [(rim, kappa, compliance)])
    found = float(with_pressure.uniform(contact=0, outer=1)) * coefficient(0).real + 0j * theta
    for n in range(2, 41):
        moved = np.array([walls.Layers(n, [(rim, kappa, compliance)]).solve((0, 0), t) for t in ((1, 0), (0, 1))])
        up, down = moved.T.astype(float) @ np.array([coefficient(n), np.conj(coefficient(-n))])
        found += up * np.exp(1j * n * theta) + np.conj(down) * np.exp(-1j * n * theta)
    return theta, found


@pytest.mark.gate
@pytest.mark.parametrize(("load", "middle"), [(P, -0.5 * math.pi), *gate((Q, 0.0))])
def test_half_of_a_rim(load, middle):
    """Pressure like the cosine on half of the rim, 2 force/(pi c) at most. Measured: 2e-16."""
    problem = unlike(plate_body=Ring(2.0, "half"))
    theta, expected = rim_columns(problem, lambda x: -max(0.0, math.cos(x - middle)) / math.pi)  # c = 2
    grid = Grid(theta, closed=True)
    column = System.build(problem, grid, 1.0).loads[:, load]
    normal = System.build(unlike(plate_body=Ring(2.0, "normal")), grid, 1.0).loads[:, load]  # its first harmonic
    assert column - normal == pytest.approx(np.r_[expected.real, -expected.imag], abs=3e-14)
    assert np.abs(column - normal).max() > 1e-2


@pytest.mark.gate
@pytest.mark.parametrize(("load", "stress"), [(SXX, (1.0, 0.0, 0.0)), (SYY, (0.0, 1.0, 0.0)), (SXY, (0.0, 0.0, 1.0))])
def test_stress_on_the_rim_of_a_ring(load, stress):
    """The tractions of a uniform stress on the rim. Measured: 8e-15."""
    sxx, syy, sxy = stress
    problem = unlike(plate_body=Ring(1.6, "uniform"))

    def traction(x):
        oval, skew = 0.5 * (sxx - syy), sxy
        radial = 0.5 * (sxx + syy) + oval * math.cos(2.0 * x) + skew * math.sin(2.0 * x)
        return complex(radial, -oval * math.sin(2.0 * x) + skew * math.cos(2.0 * x))

    theta, expected = rim_columns(problem, traction)
    column = System.build(problem, Grid(theta, closed=True), 1.0).loads[:, load]
    assert column == pytest.approx(np.r_[expected.real, -expected.imag], abs=5e-14)
    assert body_terms(problem).radial(np.eye(len(LOADS))[load], theta)[0] == pytest.approx(expected.real, abs=5e-14)


@pytest.mark.parametrize("load", [P, Q])
@pytest.mark.parametrize("place", [(0.0, -3.0), (0.7, 2.5), (1.2, 0.1)])
def test_a_reaction_at_a_point_is_reciprocal(place, load):
    """A force on the rim moves the place of the reaction as the reaction moves the rim, up to a translation (T5).

    Measured: 2e-16.
    """
    problem = unlike(plate_body=Plate(place))
    reaction = -(1.0 if load == Q else -1j)  # it balances the force Q - iP on the pin
    theta, kappa = 2.0 * math.pi * (np.arange(40) + 0.5) / 40, problem.pair.plate_kolosov
    moved = np.zeros(40, dtype=complex)  # v_r + i v_theta of the rim under the reaction
    for k, angle in enumerate(theta):
        turn = np.exp(1j * angle)
        for unit in (1.0, 1j):  # a radial and a tangential force on the rim
            field = plate(kappa, unit, 1.0)
            there = turn * field.displacement(np.array([complex(*place) / turn]))[0]
            moved[k] += unit * (np.conj(reaction) * there).real
    # displacement() is 2G times the displacement
    moved *= 0.5 * problem.pair.plate_compliance / problem.surfaces.beta_star
    column = System.build(problem, Grid(theta, closed=True), 1.0).loads[:, load]
    centre = System.build(unlike(), Grid(theta, closed=True), 1.0).loads[:, load]
    found = (column - centre)[:40] - 1j * (column - centre)[40:]
    shift = np.mean((found - moved) * np.exp(1j * theta))
    assert found == pytest.approx(moved + shift * np.exp(-1j * theta), abs=5e-15)
    assert np.ptp(np.abs(found)) > 1e-2


# --- first harmonic, rotation, drive ----------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name in ALL if name != "reaction"])
def test_the_first_harmonic_of_the_force_is_that_of_the_joint(name):
    """The w terms: -g12/(4 pi), with the whole c12 of both bodies. A reaction has a first harmonic of its own."""
    problem = joint_problem(name, 0.1, 0.3)
    grid = GRIDS["circle"]
    system = System.build(problem, grid, 1.0)
    cos, sin = np.cos(grid.theta), np.sin(grid.theta)
    first = system.loads[:, P] @ np.r_[sin, cos] / grid.size  # half of it is gap, half of it slip
    pair, joint = problem.pair, problem.joint
    of_plate = problem.surfaces.plate_compliance * joint.plate_first.displacement()[1]
    if name == "ring, compliance":
        ring = Problem.from_load_parameter(UNLIKE, 0.1, 0.3, plate_body=Ring(2.0, "normal"))
        of_plate = ring.pair.plate_compliance * ring.joint.plate_first.displacement()[1]
    g12 = pair.pin_compliance * joint.pin_first.displacement()[1] - of_plate
    assert first == pytest.approx(-g12 / (4.0 * math.pi * problem.surfaces.beta_star), abs=1e-15)


@pytest.mark.parametrize("rim", [1.5, 3.0])
def test_a_moment_turns_the_hole_of_a_ring(rim):
    """Uniform shear T on the pin, -T on the ring: v_theta = T (1 - 1/c^2)/2G against the rim. Measured: 3e-16."""
    ring, infinite = unlike(plate_body=Ring(rim)), unlike()
    grid = GRIDS["circle"]
    shear = np.r_[np.zeros(grid.size), np.ones(grid.size)]
    slips = [(System.build(problem, grid, 1.0).operator @ shear)[grid.size :] for problem in (ring, infinite)]
    turned = -0.5 * infinite.pair.plate_compliance / rim**2  # the ring turns less: v_theta = -T/2G far away
    assert slips[0] - slips[1] == pytest.approx(np.full(grid.size, turned), abs=3e-15)


def test_a_moment_turns_a_bush_in_a_ring():
    """Two rings in series: (1 - 1/c^2)/2G_b + (1/c^2 - 1/b^2)/2G."""
    bush, rim = 1.3, 2.6
    joint = unlike(plate_body=Bushing(UNLIKE.pin, bush, inside=Ring(rim)))
    grid = GRIDS["circle"]
    shear = np.r_[np.zeros(grid.size), np.ones(grid.size)]
    slip = (System.build(joint, grid, 1.0).operator @ shear)[grid.size :]
    infinite = replace(joint, plate_body=Plate(), pair=joint.surfaces)
    solid = (System.build(infinite, grid, 1.0).operator @ shear)[grid.size :]
    of_bush, of_ring = joint.surfaces.plate_compliance, joint.pair.plate_compliance
    turned = 0.5 * (of_bush * (1.0 - bush**-2.0) + of_ring * (bush**-2.0 - rim**-2.0)) - 0.5 * of_bush
    assert slip - solid == pytest.approx(np.full(grid.size, turned), abs=3e-15)


CIRCLE = np.exp(2j * math.pi * (np.arange(64) + 0.5) / 64)


def moved(first, radius):
    """2G times the mean displacement of the circle `radius` over the contact rim, for t_1 = 1 and conj t_-1 = 1."""
    fields = first_harmonic(first)
    return np.array(
        [np.mean(field.displacement(radius * CIRCLE) - field.displacement(CIRCLE)).real for field in fields]
    )


@pytest.mark.parametrize("tube", [Tube(0.6), Tube(0.6, "held"), Tube(0.6, "normal"), Tube(0.6, "body")])
@pytest.mark.parametrize("hub", [None, 0.8])
def test_the_drive_of_a_hollow_pin_from_potentials(tube, hub):
    """g and k of the hub over the rim, with conj t_1 = -J/2 pi and t_-1 = -F/2 pi on the pin. Measured: 2e-16."""
    problem = unlike(pin_body=tube, drive="both", hub_radius=hub)
    first, (nodes, weights) = problem.joint.pin_first, np.polynomial.legendre.leggauss(24)
    of_traction, of_force = moved(first, hub or 0.6)
    if hub is None and tube.load == "body":  # the mean over the wall
        radii = 0.8 + 0.2 * nodes
        of_traction, of_force = (weights * radii) @ [moved(first, radius) for radius in radii] / 1.6
    unit = problem.pair.pin_compliance / (4.0 * math.pi * problem.surfaces.beta_star)
    assert problem.drive_compliances == pytest.approx((-unit * of_force, unit * of_traction), rel=1e-13, abs=0.0)


@pytest.mark.parametrize("support", ["held", "uniform", "normal", "body"])
@pytest.mark.parametrize("gauge", [None, 1.2])
def test_the_drive_of_a_ring_from_potentials(support, gauge):
    """g and k of the rim over the gauge, by default the outer rim. Measured: 3e-16."""
    problem = unlike(plate_body=Ring(2.0, support), drive="both", gauge_radius=gauge)
    of_traction, of_force = moved(problem.joint.plate_first, gauge or 2.0)
    unit = problem.pair.plate_compliance / (4.0 * math.pi * problem.surfaces.beta_star)
    of_pin = np.array(unlike(drive="both").drive_compliances)
    expected = of_pin + unit * np.array([of_force, -of_traction])
    assert problem.drive_compliances == pytest.approx(expected, rel=1e-13, abs=0.0)


@pytest.mark.parametrize("gauge", [None, 1.1, 1.7])
def test_the_drive_of_a_bush_in_a_ring_from_potentials(gauge):
    """The gauge in the bush, in the ring, and by default on the outer rim. Measured: 3e-16."""
    rim = 1.3
    problem = unlike(plate_body=Bushing(UNLIKE.pin, rim, inside=Ring(2.0, "uniform")), drive="both", gauge_radius=gauge)
    joint, surfaces = problem.joint, problem.surfaces
    far = 2.0 if gauge is None else gauge
    change = surfaces.plate_compliance * moved(joint.plate_first, min(far, rim))
    if far > rim:
        tractions = np.array([joint.plate_first.traction(rim), [0.0, 1.0 / rim]])
        lug_first = joint.plate_body.lug.first(problem.plate_body.around(joint.hole)[1])
        change += problem.pair.plate_compliance * rim * (moved(lug_first, far / rim) @ tractions)
    of_pin = np.array(replace(problem, pair=surfaces, plate_body=Plate(), gauge_radius=None).drive_compliances)
    expected = of_pin + np.array([change[1], -change[0]]) / (4.0 * math.pi * surfaces.beta_star)
    assert problem.drive_compliances == pytest.approx(expected, rel=1e-13, abs=0.0)


@pytest.mark.parametrize("tube", [Tube(0.6), Tube(0.6, "held"), Tube(0.6, "body")])
@pytest.mark.parametrize("ring", [Ring(2.0), Ring(2.0, "uniform"), Bushing(UNLIKE.pin, 1.3, inside=Ring(2.0))])
def test_the_coupling_of_a_drive_is_the_column_of_the_force(tube, ring):
    """Betti: tractions move bore and outer rim by k J, as the force there moves the contact rims by its w term."""
    problem = unlike(pin_body=tube, plate_body=ring, drive="both")
    forced = replace(problem, drive="force")
    assert problem.drive_compliances[1] == pytest.approx(body_terms(forced).force_factor, rel=1e-13, abs=0.0)


@pytest.mark.parametrize("drive", ["ux", "uy", "both"])
def test_a_load_with_the_reactions_of_a_drive_moves_nothing_more(drive):
    """The reactions are unknowns. They stand in the load of a state, too, where they are no loads."""
    system = System.build(unlike(drive=drive), GRIDS["circle"], 1.0)
    load, reactions = np.zeros(len(LOADS)), np.array([0.3, 0.7, 0.0])
    complete = system.drive.with_reactions(reactions, load)
    assert np.count_nonzero(complete) == (2 if drive == "both" else 1)
    assert not system.load_displacement(complete).any()
    assert not system.held_displacement(complete).any()


def test_remote_stress_turns_no_hole():
    """The mean slip of its columns is 0."""
    for name in ALL:
        system = System.build(joint_problem(name, 0.1, 0.3), GRIDS["circle"], 1.0)
        slip = system.loads[GRIDS["circle"].size :, list(REMOTE)]
        assert slip.mean(axis=0) == pytest.approx(np.zeros(3), abs=1e-15)
