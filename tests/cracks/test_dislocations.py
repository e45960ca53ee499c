"""Stress intensities in closed fields: limits, known values, energy, and orders of convergence."""

import itertools
import math

import numpy as np
import pytest

from fastpin.cracks.dislocations import (
    CrackLine,
    FreeRim,
    _freed,
    _influence,
    _rim_influence,
    _rim_traction,
    needed_points,
    places,
    rule,
    weights,
)

SHORT, LONG = 1.12152226, math.sqrt(0.5)


def uniaxial(r, theta):
    """Stresses round a free hole under syy = 1."""
    square = r**-2.0
    radial = 0.5 * (1.0 - square) * (1.0 - (1.0 - 3.0 * square) * np.cos(2.0 * theta))
    hoop = 0.5 * (1.0 + square + (1.0 + 3.0 * square**2) * np.cos(2.0 * theta))
    return radial, hoop, 0.5 * (1.0 - square) * (1.0 + 3.0 * square) * np.sin(2.0 * theta)


def biaxial(r, theta):
    return 1.0 - r**-2.0, 1.0 + r**-2.0, 0.0 * r


def pressure(r, theta):
    """Stresses under a pressure of 1 in the hole."""
    return -(r**-2.0), r**-2.0, 0.0 * r


def lame(c):
    """Stresses of a ring under a pressure of 1 in its hole."""
    mean = 1.0 / (c * c - 1.0)
    return lambda r, theta: (mean * (1.0 - (c / r) ** 2), mean * (1.0 + (c / r) ** 2), 0.0 * r)


def tractions(field, line, n):
    depth, angle = places(line, n)
    radial, hoop, shear = field(1.0 + depth, line.mouth + angle)
    both = 0.5 * (radial + hoop) + np.exp(2j * (line.angle - angle)) * (0.5 * (hoop - radial) + 1j * shear)
    return np.stack([both.real, both.imag], axis=-1)


def factors(field, *lines, far=math.inf, n=None):
    """(F_I, F_II) = K/sqrt(pi a) of each crack."""
    n = n or needed_points(lines, FreeRim(far))
    loads = np.array([tractions(field, line, n) for line in lines])
    K = np.einsum("cmdpt,dpt->cm", weights(lines, FreeRim(far), n), loads)
    return K / np.sqrt(np.pi * np.array([line.length for line in lines]))[:, None]


TABLE = {
    0.1: (2.772722, 2.786499, 1.989085, 1.998729, 0.935791),
    1.0: (1.306096, 1.472125, 1.225612, 1.367561, 0.351638),
    5.0: (0.845527, 1.098221, 0.850550, 1.094896, 0.069129),
}


@pytest.mark.parametrize("a", TABLE)
def test_cracks_of_an_open_hole(a):
    one, two = (CrackLine(0.0, 0.0, a),), (CrackLine(0.0, 0.0, a), CrackLine(math.pi, 0.0, a))
    cases = (uniaxial, one), (uniaxial, two), (biaxial, one), (biaxial, two), (pressure, one)
    assert [factors(field, *lines, n=80)[0, 0] for field, lines in cases] == pytest.approx(TABLE[a], abs=1.1e-6)
    few = [factors(field, *lines)[0, 0] for field, lines in cases]
    assert few == pytest.approx([factors(field, *lines, n=160)[0, 0] for field, lines in cases], rel=2e-6)


@pytest.mark.parametrize(("a", "opening", "sliding"), [(0.1, 2.380083, 0.711556), (1.0, 1.056201, 0.458434)])
def test_inclined_cracks(a, opening, sliding):
    found = factors(uniaxial, CrackLine(0.0, math.radians(30.0), a))[0]
    assert found == pytest.approx([opening, sliding], abs=1.1e-6)
    mirrored = factors(uniaxial, CrackLine(0.0, -math.radians(30.0), a))[0]
    assert mirrored == pytest.approx([opening, -sliding], abs=1.1e-6)


def test_two_cracks_of_different_lengths():
    found = factors(uniaxial, CrackLine(0.0, 0.0, 0.2), CrackLine(math.pi, 0.0, 0.5), n=80)
    assert found[:, 0] == pytest.approx([2.521063, 1.755425], abs=1.1e-6)
    assert found[:, 1] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_an_inclined_crack_of_a_half_plane():
    found = factors(lambda r, theta: (0.0 * r, 1.0 + 0.0 * r, 0.0 * r), CrackLine(0.0, 0.25 * math.pi, 1e-7), n=160)[0]
    assert found == pytest.approx([0.70491, 0.36449], abs=6e-6)


def test_short_and_long_cracks():
    assert factors(uniaxial, CrackLine(0.0, 0.0, 1e-7))[0, 0] / 3.0 == pytest.approx(SHORT, rel=3e-6)
    assert factors(uniaxial, CrackLine(0.0, 0.0, 1e4))[0, 0] == pytest.approx(0.70719, abs=3e-5)
    long = factors(uniaxial, CrackLine(0.0, 0.0, 1e3), n=80)[0, 0]
    assert LONG < long < math.sqrt(0.5 + 1.2e-3)


@pytest.mark.parametrize("a", [1e-3, 0.1, 1.0, 10.0])
def test_a_pressure_in_hole_and_crack_is_a_biaxial_tension(a):
    line = CrackLine(0.0, 0.0, a)
    inside = factors(
        lambda r, theta: tuple(one + two for one, two in zip(pressure(r, theta), (0, 1, 0), strict=True)), line
    )
    assert inside[0, 0] == pytest.approx(factors(biaxial, line)[0, 0], rel=1e-13)


@pytest.mark.parametrize(
    ("c", "part", "value"), [(2.0, 0.1, 1.68339), (2.0, 0.5, 1.69325), (1.5, 0.2, 3.00330)], ids=str
)
def test_cracks_of_a_ring(c, part, value):
    found = factors(lame(c), CrackLine(0.0, 0.0, part * (c - 1.0)), far=c)[0]
    assert found == pytest.approx([value, 0.0], rel=6e-6, abs=1e-12)


def test_a_wide_ring_is_a_plate():
    line = CrackLine(0.3, 0.0, 1.0)
    gain = [factors(pressure, line, far=far)[0, 0] / factors(pressure, line, n=80)[0, 0] - 1.0 for far in (30.0, 60.0)]
    assert 0.0 < gain[0] < 3e-3
    assert gain[0] / gain[1] == pytest.approx(4.0, rel=0.03)


@pytest.mark.parametrize("far", [math.inf, 2.0], ids=["plate", "ring"])
def test_turned_and_mirrored_cracks(far):
    lines = (CrackLine(0.2, 0.3, 0.3), CrackLine(2.0, -0.2, 0.5))
    first = weights(lines, FreeRim(far), 80)
    turned = weights(tuple(line._replace(mouth=line.mouth + 1.0) for line in lines), FreeRim(far), 80)
    assert turned == pytest.approx(first, rel=1e-9, abs=1e-12)
    mirrored = weights(tuple(CrackLine(-line.mouth, -line.angle, line.length) for line in lines), FreeRim(far), 80)
    sign = np.array([1.0, -1.0])
    assert mirrored * sign[:, None, None, None] * sign == pytest.approx(first, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(("one", "other"), [(0.1, 0.1), (0.1, 1.0), (0.1, 0.01)])
def test_near_cracks(one, other):
    lines = CrackLine(0.0, 0.0, one), CrackLine(0.2 * min(one, other), 0.0, other)
    exact = factors(uniaxial, *lines, n=320)
    alone = np.array([factors(uniaxial, line)[0, 0] for line in lines])
    errors = np.abs(factors(uniaxial, *lines) - exact).max(axis=1)
    assert np.all(errors < 1e-4 * alone), errors / alone
    assert np.all(exact[:, 0] < alone)


def test_far_cracks_do_not_feel_one_another():
    alone = factors(uniaxial, CrackLine(0.0, 0.0, 1e-3))[0]
    pair = factors(uniaxial, CrackLine(0.0, 0.0, 1e-3), CrackLine(math.pi, 0.0, 1e-3))
    assert pair[0] == pytest.approx(alone, rel=1e-5, abs=1e-9)
    assert pair[1] == pytest.approx(alone, rel=1e-5, abs=1e-9)


def test_orders_of_convergence():
    """The errors fall like n^-6."""

    def errors(line, far, field):
        exact = factors(field, line, far=far, n=320)[0]
        return [np.abs(factors(field, line, far=far, n=n)[0] - exact).max() for n in (40, 80, 160)]

    for line, far, field, order in (
        (CrackLine(0.0, 0.0, 0.1), math.inf, uniaxial, 5.5),
        (CrackLine(0.0, math.radians(45.0), 0.1), math.inf, uniaxial, 5.5),
        (CrackLine(0.0, 0.0, 0.5), 2.0, lame(2.0), 5.5),
    ):
        found = errors(line, far, field)
        assert all(coarse / fine > 2.0**order for coarse, fine in itertools.pairwise(found)), found


@pytest.mark.parametrize("far", [math.inf, 2.0], ids=["plate", "ring"])
def test_energy(far):
    """K^2 = 2 pi d/da int g(s) int_0^s s_nn: the work of a field on the opening of the crack."""
    n, field = 160, biaxial if math.isinf(far) else lame(2.0)
    mean, part = (1.0, 1.0) if math.isinf(far) else (1.0 / (far**2 - 1.0), far**2 / (far**2 - 1.0))

    def work(a):
        line = CrackLine(0.0, 0.0, a)
        along, G = rule(n), densities(line, far, n, field)
        r = 1.0 + a * along.source
        inside = a * along.source * mean + part * (1.0 - 1.0 / r)
        return a * float(np.sum(along.weight * G * inside))

    a, h = 0.3, 1e-2
    slope = (8.0 * (work(a + h) - work(a - h)) - (work(a + 2 * h) - work(a - 2 * h))) / (12.0 * h)
    K = factors(field, CrackLine(0.0, 0.0, a), far=far, n=n)[0, 0] * math.sqrt(math.pi * a)
    assert 2.0 * math.pi * slope == pytest.approx(K**2, rel=1e-6)


def densities(line, far, n, field):
    """G at the sources of one radial crack, from the equation itself."""
    along = rule(n)
    s, t = line.length * along.place, line.length * along.source
    z, z0, ones = 1.0 + s + 0j, 1.0 + t + 0j, np.ones(n // 2, dtype=complex)
    own = np.ones((n // 2, n // 2), dtype=bool)
    A, B = _influence((z, s, ones, ones), (z0, t, ones), own)
    matrix = 1.0 / (s[:, None] - t) + 0.5 * (A + B)
    if math.isfinite(far):
        matrix = matrix + sum(_rim_influence((z, ones), (z0, ones), far))
    return np.linalg.solve((matrix * line.length * along.weight).real, -tractions(field, line, n)[:, 0])


def test_a_dislocation_leaves_the_hole_and_the_rim_free():
    """Tractions across the edge of the hole, from the potentials; and the rim's, from a ring's far field."""
    z0, gamma = np.array([[1.3 + 0.2j]]), np.array([[0.4 - 0.7j]])
    theta = np.linspace(0.1, 6.1, 50)
    assert np.abs(_rim_traction(np.exp(1j * theta), z0, gamma)).max() < 1e-14
    far, count = 2.0, 128
    rim = far * np.exp(2j * math.pi * np.arange(2 * count) / (2 * count))
    own = _rim_traction(rim, z0, gamma)
    t = np.fft.fft(-own, axis=1) / (2 * count)
    # A line along the edge: its normal traction is s_rr - i s_rt, up to the sign of the shear.
    for radius, expected in ((1.0, 0.0 * theta), (far, None)):
        z = radius * np.exp(1j * theta)
        found = _freed(t, count, far, z, 1j * z / radius)[:, 0]
        if expected is None:
            expected = -_rim_traction(z, z0, gamma)[0]
        assert found.real == pytest.approx(expected.real, abs=1e-11)
        assert np.abs(found.imag) == pytest.approx(np.abs(expected.imag), abs=1e-11)
