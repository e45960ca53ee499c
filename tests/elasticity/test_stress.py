"""Stresses of piecewise linear tractions by other ways: point loads, many digits, Clausen's function, mirror images."""

import functools
import itertools
import math

import mpmath
import numpy as np
import pytest

from fastpin import Material, MaterialPair, Problem
from fastpin.elasticity.stress import pin_stress, plate_stress
from fastpin.elasticity.tractions import Tractions
from tests.support.potentials import pin_body, pin_normal, pin_shear, plate

UNLIKE = MaterialPair(Material(2.1, 0.3), Material(0.7, 0.2), "stress")
REMOTE = np.array([0.3, -0.2, 0.1, 0.0])
BODIES = [("plate", "centre"), ("pin", "centre"), ("pin", "body")]
"""Each body, with the load of the pin."""


def problem(pin_load):
    return Problem.from_load_parameter(UNLIKE, 0.05, 0.55, pin_load)


def some_tractions(nodes=14, seed=4):
    """Random values at uneven nodes on two arcs."""
    rng, patches = np.random.default_rng(seed), []
    for start, stop in ((-2.9, -0.4), (0.6, 1.5)):
        theta = np.r_[start, np.sort(rng.uniform(start, stop, nodes - 2)), stop]
        values = np.column_stack([theta, rng.uniform(0.2, 1.0, nodes), rng.uniform(-0.5, 0.6, nodes)])
        values[[0, -1], 1:] = 0.0
        patches.append(values)
    return Tractions(tuple(patches))


def stresses(body, pin_load, tractions, theta, depth, remote=REMOTE):
    theta, depth = np.broadcast_arrays(np.asarray(theta, dtype=float), depth)
    if body == "plate":
        return plate_stress(problem(pin_load), tractions, remote, theta, depth)
    return pin_stress(problem(pin_load), tractions, theta, depth)


# --- point loads ----------------------------------------------------------------------------------------------


def polar(field, z):
    """Components (srr, stt, srt) of a field of potentials."""
    outwards = z / np.abs(z)
    across = field.traction(z, outwards) * np.conj(outwards)
    along = field.traction(z, 1j * outwards) * np.conj(1j * outwards)
    return np.array([across.real, along.real, across.imag])


def point_load(body, pin_load, xi, normal, shear, z):
    """Stresses of the pressure `normal` and the shear `shear` on the pin at the angle xi, from potentials."""
    turned = z * np.exp(-1j * xi)
    if body == "plate":
        return polar(plate(UNLIKE.plate_kolosov, normal - 1j * shear, 1.0), turned)
    kappa = UNLIKE.pin_kolosov
    found = normal * polar(pin_normal(kappa, 1.0), turned) + shear * polar(pin_shear(kappa, 1.0), turned)
    if pin_load == "body":
        held = pin_body(kappa, 1.0)
        found += normal * polar(held, turned) + shear * polar(held, 1j * turned)
    return found


def points(body):
    theta = np.linspace(-3.0, 3.1, 11)
    return theta, np.linspace(0.2, 3.0, 11) if body == "plate" else np.linspace(0.15, 0.9, 11)


@pytest.mark.parametrize(("body", "pin_load"), BODIES)
def test_stresses_are_integrals_of_point_loads(body, pin_load):
    tractions, (theta, depth) = some_tractions(), points(body)
    z = (1.0 + depth if body == "plate" else 1.0 - depth) * np.exp(1j * theta)
    part, weight = np.polynomial.legendre.leggauss(40)
    expected = np.zeros((3, theta.size))
    for patch in tractions.patches:
        for left, right in itertools.pairwise(patch):
            for share, portion in zip(0.5 * (part + 1.0), 0.5 * weight * (right[0] - left[0]), strict=True):
                xi, normal, shear = left + share * (right - left)
                expected += portion * point_load(body, pin_load, xi, normal, shear, z)
    found = stresses(body, pin_load, tractions, theta, depth, np.zeros(4))
    assert found == pytest.approx(expected, abs=2e-14)


@pytest.mark.parametrize(("body", "pin_load"), BODIES)
def test_narrow_hats_tend_to_point_loads_with_order_two(body, pin_load):
    theta, depth = points(body)
    z = (1.0 + depth if body == "plate" else 1.0 - depth) * np.exp(1j * theta)
    expected, errors = point_load(body, pin_load, -1.1, 0.8, 0.3, z), []
    for half in (0.02, 0.01, 0.005):
        hat = np.array([[-1.1 - half, 0.0, 0.0], [-1.1, 0.8 / half, 0.3 / half], [-1.1 + half, 0.0, 0.0]])
        found = stresses(body, pin_load, Tractions((hat,)), theta, depth, np.zeros(4))
        errors.append(np.abs(found - expected).max())
    assert errors[0] < 3e-3
    assert [errors[0] / errors[1], errors[1] / errors[2]] == pytest.approx([4.0, 4.0], abs=6e-3)


# --- many digits ----------------------------------------------------------------------------------------------


@functools.cache
def dilogarithm(w):
    """Li_2(w) with the digits of the first call; the two loads of the pin share the arguments."""
    return mpmath.polylog(2, w)


def exact(body, pin_load, tractions, theta, depth):
    """(T30) to (T32) with 50 digits, by dilogarithms at all nodes."""
    mp = mpmath
    outside = body == "plate"
    radius = 1 + mp.mpf(depth) if outside else 1 - mp.mpf(depth)
    zeta = radius * mp.expj(mp.mpf(theta))
    whole, of_shear, slope, mean, first = 0, 0, 0, 0, 0
    for patch in tractions.patches:
        nodes = [[mp.mpf(value) for value in row] for row in patch]
        slopes = [(0, 0)]
        for (x0, n0, t0), (x1, n1, t1) in itertools.pairwise(nodes):
            slopes.append(((n1 - n0) / (x1 - x0), (t1 - t0) / (x1 - x0)))
            mean += (x1 - x0) * (n0 + n1 - 1j * (t0 + t1)) / (4 * mp.pi)
        for (before, after), node in zip(itertools.pairwise([*slopes, (0, 0)]), nodes, strict=True):
            t, shear = mp.expj(node[0]), after[1] - before[1]
            both = after[0] - before[0] - 1j * shear
            w = t / zeta if outside else zeta / t
            sign, li = 1 if outside else -1, dilogarithm(w)
            whole, of_shear = whole + sign * both * li, of_shear + sign * shear * li
            slope += both * mp.log(1 - w)
            first -= both * t  # the force is the coefficient -1 of p
    whole, of_shear, slope, force = (value / (2 * mp.pi) for value in (whole, of_shear, slope, 2 * mp.pi * first))
    square = radius**-2
    if outside:
        kappa = mp.mpf(UNLIKE.plate_kolosov)
        share = kappa / (2 * mp.pi * (1 + kappa)) * force / zeta
        total = 4 * mp.re(whole + share)
        radial = 2 * mp.re(whole) - (1 - square) * (slope - 2 * share) + square * (2j * of_shear - mp.conj(mean))
    else:
        whole, of_shear = whole + mean, of_shear - mp.im(mean)
        total = -4 * mp.re(whole) + 2 * mp.re(mean)
        radial = -2 * mp.re(whole) + mp.re(mean) + (1 - square) * slope
        radial -= square * (2j * of_shear + 1j * mp.im(mean))
        if pin_load == "centre":
            share = 1 / (mp.pi * (1 + mp.mpf(UNLIKE.pin_kolosov)))
            total += 4 * share * mp.re(mp.conj(force) * zeta - force / (2 * zeta))
            radial += share * force * (mp.conj(zeta) - 1 / zeta)
        else:
            radial += mp.conj(force) / (2 * mp.pi) * (1 / mp.conj(zeta) - zeta)
    return [float(mp.re(radial)), float(total - mp.re(radial)), float(-mp.im(radial))]


@pytest.mark.gate
@pytest.mark.parametrize(("body", "pin_load"), BODIES)
def test_no_digit_is_lost_near_the_edge(body, pin_load):
    """At depths of 1e-12, 1e-4 and 0.1, at nodes and beside them, against 50 digits. The largest slope is 42."""
    tractions = some_tractions()
    nodes = tractions.patches[0][:, 0]
    theta = np.r_[nodes[[0, 3, 7]], nodes[3] + 1e-9, nodes[7] - 1e-5, 0.5 * (nodes[4] + nodes[5]), 2.5]
    with mpmath.workdps(50):
        for depth in (1e-12, 1e-4, 0.1):
            expected = np.transpose([exact(body, pin_load, tractions, angle, depth) for angle in theta])
            found = stresses(body, pin_load, tractions, theta, depth, np.zeros(4))
            assert found == pytest.approx(expected, abs=7e-15)


# --- the edges ------------------------------------------------------------------------------------------------


@pytest.mark.gate
@pytest.mark.parametrize(("body", "pin_load"), BODIES)
def test_hoop_stress_on_the_edge_by_clausens_function(body, pin_load):
    """The principal value of the shear's integral is a sum of Clausen's function over the jumps of slope."""
    tractions = some_tractions()
    theta = np.r_[tractions.patches[0][::3, 0], np.linspace(-3.0, 3.0, 13)]
    pressure, shear = (value[1] for value in tractions.coefficients(1))
    force = 2.0 * np.pi * np.conj(pressure + 1j * shear)
    radial_force = np.real(force * np.exp(-1j * theta))
    mean, clausen, own = tractions.coefficients(0)[0][0].real, 0.0, 0.0
    for nodes in tractions.patches:
        jumps = np.diff(np.diff(nodes[:, 2]) / np.diff(nodes[:, 0]), prepend=0.0, append=0.0)
        for place, jump in zip(nodes[:, 0], jumps, strict=True):
            clausen = clausen + jump * np.array([float(mpmath.clsin(2, angle - place)) for angle in theta])
        own = own + np.interp(theta, nodes[:, 0], nodes[:, 1])
    if body == "plate":
        kappa, (sxx, syy, sxy) = UNLIKE.plate_kolosov, REMOTE[:3]
        expected = 2.0 * mean - own - 2.0 / np.pi * clausen + 2.0 * kappa / (np.pi * (kappa + 1.0)) * radial_force
        expected += sxx + syy - 2.0 * (sxx - syy) * np.cos(2.0 * theta) - 4.0 * sxy * np.sin(2.0 * theta)
    else:
        share = {"centre": 1.0, "body": 0.0}[pin_load]
        expected = 2.0 / np.pi * clausen - own
        expected += 2.0 * share / (np.pi * (UNLIKE.pin_kolosov + 1.0)) * radial_force
    assert stresses(body, pin_load, tractions, theta, 0.0)[1] == pytest.approx(expected, abs=2.5e-14)


@pytest.mark.parametrize(("body", "pin_load"), BODIES)
def test_stresses_tend_to_those_on_the_edge(body, pin_load):
    """As the depth times its logarithm, because the slopes of the tractions jump."""
    tractions = some_tractions()
    theta = np.r_[tractions.patches[0][:, 0], np.linspace(-3.0, 3.0, 20)]
    edge, depths = stresses(body, pin_load, tractions, theta, 0.0), np.geomspace(1e-11, 1e-5, 7)
    slopes = [
        np.abs(stresses(body, pin_load, tractions, theta, depth) - edge).max() / (depth * -math.log(depth))
        for depth in depths
    ]
    assert 6.0 < min(slopes) < max(slopes) < 8.5


@pytest.mark.parametrize(("body", "pin_load"), BODIES)
def test_mirror_image(body, pin_load):
    """theta becomes -pi - theta, and the shear changes its sign."""
    tractions, theta = some_tractions(), np.linspace(-3.0, 3.0, 25)
    mirrored = Tractions(tuple(
        np.column_stack([-math.pi - patch[::-1, 0], patch[::-1, 1], -patch[::-1, 2]]) for patch in tractions.patches
    ))  # fmt: skip
    for depth in (0.0, 1e-6, 0.3, 0.8):
        here = stresses(body, pin_load, tractions, theta, depth)
        there = stresses(body, pin_load, mirrored, -math.pi - theta, depth, REMOTE * [1.0, 1.0, -1.0, 0.0])
        assert there == pytest.approx(here * np.array([[1.0], [1.0], [-1.0]]), abs=4e-14)


def test_the_blocks_of_the_tree_hold_their_own_nodes_tightly():
    """A block that reached over its nodes would be summed piece by piece at more points than it must."""
    nodes, _, blocks, centres, radii, _ = some_tractions(nodes=40).tree
    places = np.exp(1j * nodes[:, 0])
    for (first, last, child, _), centre, radius in zip(blocks, centres, radii, strict=True):
        away = np.abs(places[first : last + 1] - centre)
        assert away.max() <= radius + 1e-15
        if child < 0:
            assert centre == pytest.approx(0.5 * (places[first] + places[last]), abs=1e-15)
            assert radius == pytest.approx(away.max(), abs=1e-15)
