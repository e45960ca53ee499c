"""Laurent series of stresses: compiled, as plain Python, and against sums of potentials."""

import numpy as np
import pytest

from fastpin.kernels import laurent

KERNELS = laurent


def test_sums_are_those_of_potentials(way):
    """Omega = A z^(n+1) + B z^(1-n), omega = C z^(n-1) + D z^(-n-1), between the radii 0.7 and 1.9."""
    rng, smallest, largest = np.random.default_rng(3), 0.7, 1.9
    n = np.arange(2, 9)
    A, B, C, D = rng.normal(size=(4, n.size)) + 1j * rng.normal(size=(4, n.size))
    growing, decaying = np.zeros((3, 9), dtype=complex), np.zeros((3, 9), dtype=complex)
    scale, low = largest**n, smallest**-n
    growing[:, 2:] = (n + 1) * A * scale, n * (n + 1) * A * scale, (n - 1) * C * scale / largest**2
    decaying[:, 2:] = (1 - n) * B * low, n * (n - 1) * B * low, -(n + 1) * D * low / smallest**2
    theta, radius = rng.uniform(-3.0, 3.0, 30), rng.uniform(smallest, largest, 30)
    found = np.full((30, 2), 1.0 + 2.0j)
    laurent.add_polar(theta, radius, growing, decaying, smallest, largest, found)
    z = (radius * np.exp(1j * theta))[:, None]
    slope = ((n + 1) * A * z**n + (1 - n) * B * z**-n).sum(axis=1)
    slope_2 = (n * (n + 1) * A * z ** (n - 1) - n * (1 - n) * B * z ** (-n - 1)).sum(axis=1)
    omega_1 = ((n - 1) * C * z ** (n - 2) - (n + 1) * D * z ** (-n - 2)).sum(axis=1)
    z = z[:, 0]
    first = 2.0 * slope.real - np.exp(2j * theta) * (np.conj(z) * slope_2 + omega_1)
    expected = np.array([4.0 * slope.real, first]).T + (1.0 + 2.0j)
    assert found == pytest.approx(expected, rel=1e-13)


def test_no_series_add_nothing(way):
    found = np.zeros((2, 2), dtype=complex)
    laurent.add_polar(np.zeros(2), np.ones(2), np.zeros((3, 1), complex), np.zeros((3, 1), complex), 1.0, 2.0, found)
    assert np.array_equal(found, np.zeros((2, 2)))
