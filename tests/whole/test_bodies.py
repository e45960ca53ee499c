"""What must hold with hollow pins, rings, bushes and compliances: scales, arcs, drives and limits."""

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.bodies import Bushing, Plate, Ring, Tube
from fastpin.model.angles import BOTTOM
from tests.support.bodies import JOINTS, UNLIKE, joint_problem

ALL = [*JOINTS, "ring, compliance"]
ARC = (BOTTOM - 1.75, BOTTOM + 1.75)
HISTORY = [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}, {"P": 0.8, "Q": 0.2}]


@pytest.mark.parametrize("name", ALL)
def test_arc_and_circle_agree(name):
    """A circle, and its nodes that may touch. Measured: 1.5e-13."""
    problem = joint_problem(name, 0.1, 0.4)
    circle = solve(problem, HISTORY[:2], grid=Grid.circle(180))
    arc = solve(problem, HISTORY[:2], grid=Grid(circle.grid.theta[5:175]))
    for whole, part in zip(circle, arc, strict=True):
        assert whole.pressure[5:175] == pytest.approx(part.pressure, abs=1e-12)
        assert whole.shear[5:175] == pytest.approx(part.shear, abs=1e-12)
        assert not whole.pressure[:5].any()


def test_a_large_graded_circle_agrees_with_an_arc():
    """More than 400 graded nodes are solved in windows, without a whole operator. Measured: 4e-5 (peak), 3e-3."""
    problem = Problem.from_load_parameter(UNLIKE, 30.0, 0.4, pin_body=Tube(0.5), plate_body=Ring(2.0, "uniform"))
    graded = solve(problem, [{"P": 1.0}, {"Q": 0.2}], grid=Grid.graded([(BOTTOM, 0.02)], 500))[-1]
    arc = solve(problem, [{"P": 1.0}, {"Q": 0.2}], nodes=301)[-1]
    assert graded.peak_pressure == pytest.approx(arc.peak_pressure, rel=1e-4)
    assert graded.dissipation == pytest.approx(arc.dissipation, rel=1e-2)


@pytest.mark.parametrize("interference", [0.0, 2e-5])
def test_si_and_dimensionless_problems_agree(interference):
    """A hollow pin in a bush in a ring, in SI units and in units of R, F and beta*. Measured: 3e-14."""
    radius, force = 0.015, 2.0e6
    bronze = UNLIKE.pin

    def joint(unit, length):
        inside = Ring(2.0 * unit, "uniform")
        return {
            "pin_body": Tube(0.5 * unit),
            "plate_body": Bushing(bronze, 1.3 * unit, interference=length * interference, inside=inside),
        }

    surfaces = Problem(UNLIKE, radius, 0.0, 0.4, **joint(radius, 1.0)).surfaces
    length = force * surfaces.beta_star
    real = Problem(UNLIKE, radius, 0.1 * length, 0.4, **joint(radius, 1.0))
    plain = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, **joint(1.0, 1.0 / length))
    assert real.assembled_clearance / length == pytest.approx(plain.assembled_clearance, rel=1e-12)
    corners = [{"P": 1.0}, {"Q": 0.2, "sxx": 0.03}]
    units = {"P": force, "Q": force, "sxx": force / radius}
    si = solve(real, [{key: units[key] * value for key, value in corner.items()} for corner in corners], nodes=81)[-1]
    one = solve(plain, corners, nodes=81)[-1]
    assert si.pressure * radius / force == pytest.approx(one.pressure, abs=1e-12)
    assert si.slip / length == pytest.approx(one.slip, abs=1e-12)
    assert si.dy / length == pytest.approx(one.dy, rel=1e-9)


@pytest.mark.parametrize("bodies", [
    {"pin_body": Tube(0.5)}, {"plate_body": Ring(2.0)},
    {"pin_body": Tube(0.5, "held"), "plate_body": Bushing(UNLIKE.pin, 1.3, inside=Ring(2.0, "uniform"))},
])  # fmt: skip
@pytest.mark.parametrize(("friction", "tolerance"), [(0.0, 1e-12), (0.4, 2e-6)])
def test_displacements_in_place_of_forces(bodies, friction, tolerance):
    """Driven to the displacement (T29) at which the reaction is the force: the same state.

    With friction the first steps of the two paths differ: 5e-7 here, and 4e-7 with solid bodies.
    """
    forced = solve(Problem.from_load_parameter(UNLIKE, 0.1, friction, **bodies), [{"P": 1.0}], nodes=101, arc=ARC)[-1]
    driven_problem = Problem.from_load_parameter(UNLIKE, 0.1, friction, **bodies, drive="uy")
    g, k = driven_problem.drive_compliances
    cos, sin = forced.grid.trig_moments()
    J = sin @ forced.pressure + cos @ forced.shear
    rim = forced.dy - 0.1  # from the concentric position
    driven = solve(driven_problem, [{"uy": rim - g - k * J}], nodes=101, arc=ARC)[-1]
    assert driven.pressure == pytest.approx(forced.pressure, abs=tolerance)
    assert driven.load["P"] == pytest.approx(1.0, rel=tolerance)


def test_a_far_reaction_is_a_reaction_at_infinity():
    """The difference of the peak falls with the distance. Measured: 0.1 F/R at 10 R, 1.2e-3 at 1,000 R."""
    plain = solve(Problem.from_load_parameter(UNLIKE, 0.1, 0.3), [{"P": 1.0}], nodes=101, arc=ARC)[-1].pressure
    errors = []
    for distance in (10.0, 1000.0):
        problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.3, plate_body=Plate((0.0, distance)))
        errors.append(np.abs(solve(problem, [{"P": 1.0}], nodes=101, arc=ARC)[-1].pressure - plain).max())
    assert 1e-2 < errors[0] < 0.2
    assert errors[1] < 2e-2 * errors[0]


def test_a_thin_tube_touches_beyond_the_side():
    """A tube with the bore 0.9 R bends: the half-angle is 112 degrees, and 64 degrees with a solid pin."""
    halves = []
    for bodies in ({"pin_body": Tube(0.9)}, {}):
        state = solve(Problem.from_load_parameter(UNLIKE, 0.1, 0.2, **bodies), [{"P": 1.0}], grid=Grid.circle(160))[-1]
        halves.append(np.degrees(0.5 * np.ptp(state.contact[0])))
    assert halves == pytest.approx([112.0, 64.0], abs=1.0)
