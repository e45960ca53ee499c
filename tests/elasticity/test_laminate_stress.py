"""Stresses in a laminate: Lekhnitskii's open hole, tractions on the edge, equilibrium and compatibility inside."""

import math

import numpy as np
import pytest

from fastpin.elasticity.stress import hole_stress, laminate_stress
from fastpin.elasticity.tractions import Tractions
from fastpin.model.laminate import Laminate
from tests.support.laminates import TURNED, orthotropic

ANGLES = np.linspace(-2.4, -0.5, 41)
PART = (ANGLES - ANGLES[0]) / (ANGLES[-1] - ANGLES[0])
PATCH = np.column_stack([ANGLES, np.sin(math.pi * PART), 0.3 * np.sin(2.0 * math.pi * PART)])
PATCH[[0, -1], 1:] = 0.0
LOADED, NONE = Tractions((PATCH,)), Tractions(())
REMOTE = np.array([0.2, -0.3, 0.1])
FAR = np.random.default_rng(2).uniform(1.2, 3.0, 40) * np.exp(1j * np.random.default_rng(3).uniform(-3.0, 3.0, 40))


@pytest.mark.parametrize("axis", [0.0, 0.4])
@pytest.mark.parametrize("angle", [0.0, 0.7, 1.2])
def test_lekhnitskii_s_hoop_stress_of_the_open_hole(axis, angle):
    E1, E2, G, nu = 15.0, 1.0, 0.55, 0.3
    plate, theta = orthotropic(E1, G, nu, axis), np.linspace(-math.pi, math.pi, 73)
    k, n = math.sqrt(E1 / E2), math.sqrt(2.0 * (math.sqrt(E1 / E2) - nu) + E1 / G)
    cos, sin, along, across = np.cos(theta), np.sin(theta), math.cos(angle), math.sin(angle)
    modulus = 1.0 / (sin**4 / E1 + (1.0 / G - 2.0 * nu / E1) * sin**2 * cos**2 + cos**4 / E2)
    hoop = (-(along**2) + (k + n) * across**2) * k * cos**2 + ((1.0 + n) * along**2 - k * across**2) * sin**2
    hoop = modulus / E1 * (hoop - n * (1.0 + k + n) * sin * cos * across * along)
    pull = np.array([math.cos(angle + axis), math.sin(angle + axis)])
    remote = np.array([pull[0] ** 2, pull[1] ** 2, pull[0] * pull[1]])
    found = laminate_stress(plate, NONE, remote, theta + axis, np.zeros(73))
    assert found == pytest.approx(np.array([0.0 * hoop, hoop, 0.0 * hoop]), abs=2e-14)


def test_stresses_on_the_edge_are_the_tractions():
    theta = np.random.default_rng(0).uniform(-3.0, 3.0, 100)
    found = laminate_stress(TURNED, LOADED, REMOTE, theta, np.zeros(100))
    pressure, shear = (np.interp(theta, ANGLES, PATCH[:, column], 0.0, 0.0) for column in (1, 2))
    assert found[[0, 2]] == pytest.approx(np.array([-pressure, shear]), abs=1e-14)
    near = laminate_stress(TURNED, LOADED, REMOTE, theta, np.full(100, 1e-7))
    assert near == pytest.approx(found, abs=1e-5)


def in_xy(plate: Laminate, z: np.ndarray) -> np.ndarray:
    """Stresses (sxx, syy, sxy) at the points z (m,), shape (3, m)."""
    theta = np.angle(z)
    radial, hoop, shear = laminate_stress(plate, LOADED, REMOTE, theta, np.abs(z) - 1.0)
    cos, sin = np.cos(2.0 * theta), np.sin(2.0 * theta)
    mean, half = 0.5 * (radial + hoop), 0.5 * (radial - hoop)
    return np.array([mean + half * cos - shear * sin, mean - half * cos + shear * sin, half * sin + shear * cos])


@pytest.mark.parametrize("plate", [TURNED, orthotropic(150.0, 0.3, axis=1.0)], ids=["[0/30]", "150"])
def test_equilibrium_and_compatibility_inside(plate):
    e = 1e-3
    along = (in_xy(plate, FAR + e) - in_xy(plate, FAR - e)) / (2.0 * e)
    across = (in_xy(plate, FAR + 1j * e) - in_xy(plate, FAR - 1j * e)) / (2.0 * e)
    size = np.abs(along).max()
    assert np.abs(along[0] + across[2]).max() < 2e-5 * size
    assert np.abs(along[2] + across[1]).max() < 2e-5 * size

    def strain(z: np.ndarray) -> np.ndarray:
        return plate.matrix @ in_xy(plate, z)

    e = 3e-3
    middle = 2.0 * strain(FAR)
    xx = (strain(FAR + 1j * e)[0] - middle[0] + strain(FAR - 1j * e)[0]) / e**2
    yy = (strain(FAR + e)[1] - middle[1] + strain(FAR - e)[1]) / e**2
    corners = [
        sign * strain(FAR + e * place)[2] for sign, place in ((1, 1 + 1j), (-1, 1 - 1j), (-1, -1 + 1j), (1, -1 - 1j))
    ]
    xy = sum(corners) / (4.0 * e**2)
    assert np.abs(xx + yy - xy).max() < 1e-3 * np.abs([xx, yy, xy]).max()


def test_the_force_goes_far_away():
    angles = 2.0 * math.pi * np.arange(4000) / 4000
    sxx, syy, sxy = in_xy(TURNED, 5.0 * np.exp(1j * angles))
    sxx, syy, sxy = sxx - REMOTE[0], syy - REMOTE[1], sxy - REMOTE[2]
    cos, sin = np.cos(angles), np.sin(angles)
    found = 10.0 * math.pi * np.array([np.mean(sxx * cos + sxy * sin), np.mean(sxy * cos + syy * sin)])
    pressure, shear = LOADED.low_coefficients
    force = 2.0 * math.pi * np.conj(pressure[1] + 1j * shear[1])
    assert found == pytest.approx([-force.real, -force.imag], rel=1e-9)


@pytest.mark.parametrize(("size", "allowed"), [(0.0, 2e-7), (1e-7, 1e-6), (1e-3, 2e-3)])
def test_equal_roots_are_a_limit(size, allowed):
    """Of isotropic materials both roots are i. A little beside, the stress is a little off."""
    theta, depth = np.angle(FAR), np.abs(FAR) - 1.0
    plate = orthotropic(1.0 + size, 1.0 / 2.6)
    found = laminate_stress(plate, LOADED, REMOTE, theta, depth)
    assert found == pytest.approx(hole_stress(2.7 / 1.3, LOADED, REMOTE, theta, depth), abs=allowed)


def test_equal_roots_that_are_not_i_are_a_limit():
    k, nu = 2.0, 0.2  # n = 2 sqrt(k) makes the roots equal
    moduli = [k**2, k**2 / (2.0 * (k + nu))]
    one, other = (
        laminate_stress(
            orthotropic(moduli[0], moduli[1] * (1.0 + shift), nu), LOADED, REMOTE, np.angle(FAR), abs(FAR) - 1
        )
        for shift in (0.0, 1e-5)
    )
    assert one == pytest.approx(other, abs=1e-5)
