"""Images of dislocations in plates of any outline: a ring's closed kernel, stress intensities of lugs, reciprocity."""

import math

import numpy as np
import pytest

from fastpin.cracks.dislocations import CrackLine, FreeRim, needed_points, rule, weights
from fastpin.lugs import images
from fastpin.lugs.cauchy import HOLE, EdgeField
from fastpin.lugs.images import OtherEdges, dislocation
from fastpin.lugs.outline import Hole, Lug, Part, rectangle
from fastpin.lugs.panels import Edges, Fineness
from fastpin.lugs.plates import PlateEquations, boundaries
from tests.support.lugs import disc, lug_with_nose, outlined, plate
from tests.support.outlines import FreeOutline


def points(line, n):
    """Points of collocation and the direction of a crack."""
    direction = np.exp(1j * (line.mouth + line.angle))
    return np.exp(1j * line.mouth) + line.length * rule(n).place * direction, direction


def intensities(lines, beyond, traction):
    """(K_I, K_II) of each crack, from s_nn + i s_tn at points on a line with a direction."""
    n = needed_points(lines, beyond)
    both = np.array([traction(*points(line, n)) for line in lines])
    return np.einsum("cakne,kne->ca", weights(lines, beyond, n), np.stack([both.real, both.imag], axis=-1))


def lame(c):
    """Tractions in a ring under a pressure of 1 in its hole."""
    return lambda z, direction: (1.0 + (c * direction / z) ** 2).astype(complex) / (c * c - 1.0)


def pulled(equations):
    """Tractions in a plate whose hole has the radial traction -sin(theta)/pi, by integrals over all edges."""
    edges = equations.edges
    on_hole = edges.part_of_node < HOLE
    given = np.where(on_hole, -edges.z.imag * edges.z / math.pi, 0.0)[:, None]
    (u_x, u_y), (t_x, t_y) = equations.solve(given)
    field = EdgeField.of(edges, equations.kolosov, u_x + 1j * u_y, t_x + 1j * t_y, True)

    def traction(z, direction):
        potential, spread = (each[:, 0] for each in field.inside(z))
        return 2.0 * potential.real + direction**2 * spread

    return traction


def test_a_dislocation_leaves_the_hole_free_and_jumps_on_its_crack_only():
    mouth, kolosov, gamma = np.exp(0.3j), 1.8, np.array(0.3 + 0.2j)
    z0 = np.array(mouth + 0.7 * np.exp(0.8j))
    at = np.exp(1j * np.linspace(0.5, 6.0, 7))
    potential, spread, _ = dislocation(at, z0, gamma, mouth, kolosov)
    assert np.abs(2.0 * potential.real - (at**2).conj() * spread.conj()).max() < 1e-14
    middle, across = 0.5 * (mouth + z0), 1e-9j * (z0 - mouth)
    one, other = (dislocation(np.array(middle + side * across), z0, gamma, mouth, kolosov)[2] for side in (1.0, -1.0))
    assert abs(other - one) == pytest.approx(2.0 * math.pi * (kolosov + 1.0) * abs(gamma), rel=1e-6)
    around = dislocation(3.0 * np.exp(1j * np.linspace(0.0, 2.0 * math.pi, 2001)), z0, gamma, mouth, kolosov)[2]
    assert np.abs(np.diff(around)).max() < 0.02 * np.abs(around).max()


def test_displacements_of_a_dislocation_have_its_stresses():
    z0, gamma, kolosov, tau = np.array(1.4 * np.exp(0.4j)), np.array(0.2 - 0.5j), 2.1, np.exp(1.1j)
    z = np.array([2.0 + 1.0j, -1.5j, -3.0 + 0.2j])
    potential, spread, _ = dislocation(z, z0, gamma, np.exp(0.4j), kolosov)
    before, after = (dislocation(z + h * tau, z0, gamma, np.exp(0.4j), kolosov)[2] for h in (-1e-5, 1e-5))
    traction = -1j * tau * (2.0 * potential.real + np.conj(spread * tau**2))
    assert (after - before) / 2e-5 + 1j * traction == pytest.approx((kolosov + 1.0) * potential * tau, abs=1e-9)


def test_rays_meet_the_nearest_edge():
    edges = OtherEdges(outlined(plate(holes=(Hole("bolt", 3.5j, 0.5),))))
    assert edges.ligament(0.0, 0.0) == pytest.approx(1.5)
    assert edges.ligament(0.5 * math.pi, 0.0) == pytest.approx(2.0)
    assert edges.ligament(0.0, 0.5) == pytest.approx(1.5 / math.cos(0.5))
    corner = math.atan2(-2.5, 2.5)
    assert edges.ligament(corner, 0.0) == pytest.approx(2.5 * math.sqrt(2.0) - 1.0)
    nose = OtherEdges(outlined(lug_with_nose()))
    for mouth in (-math.pi, -2.0, -0.5 * math.pi, 0.0):
        assert nose.ligament(mouth, 0.0) == pytest.approx(1.2)
    assert nose.deepest((CrackLine(0.0, 0.0, 0.3), CrackLine(-1.0, 0.0, 0.6))) == pytest.approx(0.5)


def test_kept_points_interpolate_polynomials():
    places = images._chebyshev(24)
    share = np.array([[0.0, 0.3, places[3], 1.0]])
    assert images._interpolation(share, 24) @ places**20 == pytest.approx(share[0] ** 20, abs=1e-12)


@pytest.mark.parametrize("part", [0.3, 0.78])
def test_edges_of_all_cracks_suit_short_ones(part):
    body = outlined(Lug(0.3, "stress", 1.0, disc(2.0), {"rim": "both"}))
    hole = [(each, images.APART * (1.0 - images.SHALLOW)) for each in Hole("", 0j, 1.0).parts]
    first, rim = boundaries(images.lug_of(body), 4)
    edges = Edges([first, images.replace(rim, beside=tuple(hole))], images.FINENESS)
    assert images.is_fine(edges, [Part("", 1.0 + 0.0j, 1.0 + part + 0.0j)])
    assert not images.is_fine(edges, [Part("", 1.0 + 0.0j, 1.95 + 0.0j)])
    assert images._count(edges, [Part("", 1.0 + 0.0j, 1.0 + part + 0.0j)]) == 24


@pytest.mark.gate
@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_a_free_ring_has_its_closed_kernel(angle):
    outline = FreeOutline(2.0)
    for part in (0.1, 0.5, 0.8):
        lines = (CrackLine(0.3, angle, part),)
        assert intensities(lines, outline, lame(2.0)) == pytest.approx(
            intensities(lines, FreeRim(2.0), lame(2.0)), abs=1e-6
        )  # measured: 2e-7


INTENSITIES = {  # of a lug with nose and sides at 2.2 R, held at 10 R: two discretisations agree to 4e-7, 1e-7, 4e-8
    ((0.0, 0.0, 0.1),): [(0.32418939, 0.00496053)],
    ((0.0, 0.0, 0.3),): [(0.44124149, 0.02085743)],
    ((0.0, 0.0, 0.6),): [(0.52400608, 0.04882791)],
    ((0.0, 0.0, 0.9),): [(0.63582178, 0.08899321)],
    ((0.0, 0.0, 1.1),): [(0.9157156, 0.1569953)],
    ((-20.0, 0.0, 0.5),): [(0.48719494, -0.06843906)],
    ((0.0, 30.0, 0.5),): [(0.3739733, 0.1461766)],
    ((0.0, 0.0, 0.6), (180.0, 0.0, 0.3)): [(0.5698313, 0.0607465), (0.5465966, -0.0345182)],
}


@pytest.mark.gate
def test_cracks_of_a_lug_have_the_intensities_of_another_program():
    body = outlined(lug_with_nose())
    traction = pulled(images._equations(body, [(Part("", 1.0 + 0.0j, 2.1 + 0.0j), 1.0)]))
    for degrees, expected in INTENSITIES.items():
        lines = tuple(CrackLine(math.radians(mouth), math.radians(angle), a) for mouth, angle, a in degrees)
        assert intensities(lines, OtherEdges(body), traction) == pytest.approx(np.array(expected), abs=4e-7)


@pytest.mark.gate
def test_images_are_reciprocal():
    """The work of one dislocation's tractions on the opening of another one is the same with both exchanged."""
    lug = plate()
    loops = boundaries(lug, 4)
    equations = PlateEquations(lug, Edges(loops, Fineness(10, 8)), lambda done: None)
    gauss, weight = np.polynomial.legendre.leggauss(12)
    ends = np.array([0.3, 0.6])
    s = np.concatenate([0.5 * end * (1.0 + gauss) for end in ends] + [ends])
    z, direction = np.exp(0.2j) + s * np.exp(0.6j), np.full(s.size, np.exp(0.6j))
    straight, mirrored = images.image(equations, z, direction, np.full(s.size, np.exp(0.2j)))
    modes = straight + mirrored, 1j * (straight - mirrored)  # tractions s_nn + i s_tn of g = 1 and g = i
    opening = [[mode[12 * k : 12 * k + 12, 24 + 1 - k] @ weight * 0.5 * ends[k] for k in (0, 1)] for mode in modes]
    assert opening[0][0].real == pytest.approx(opening[0][1].real, rel=1e-6)
    assert opening[1][0].imag == pytest.approx(opening[1][1].imag, rel=1e-6)
    assert opening[0][0].imag == pytest.approx(opening[1][1].real, rel=1e-6)


@pytest.mark.gate
def test_a_wide_plate_is_the_infinite_plate():
    lines = (CrackLine(0.2, 0.1, 0.5),)
    infinite = weights(lines, FreeRim(math.inf), 80)
    off = []
    for half in (10.0, 20.0):
        body = outlined(Lug(0.3, "stress", 1.0, rectangle((-half, half), (-half, half)), {"top": "both"}))
        found = weights(lines, OtherEdges(body), 80)
        off.append(float(np.abs(found - infinite).sum(axis=(2, 3, 4)).max() / np.abs(infinite).sum()))
    assert off[0] < 5e-3
    assert off[1] / off[0] == pytest.approx(0.25, abs=0.05)
