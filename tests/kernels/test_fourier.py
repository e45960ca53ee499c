"""Fourier series of smooth kernels over hat functions, against quadrature and naive sums."""

import math

import mpmath
import numpy as np
import pytest

from fastpin.kernels import fourier, influence
from fastpin.model.grid import Grid

COEFFICIENTS = np.array([0.7 ** np.arange(40.0), -0.4 * 0.6 ** np.arange(40.0), 0.3 * 0.8 ** np.arange(40.0)])
COEFFICIENTS[2, 0] = 0.0

GRIDS = {
    "arc": Grid.arc(-2.6, -0.4, 23),
    "circle": Grid.circle(24, -1.1),
    "graded": Grid(-1.5 + 1.2 * np.sinh(np.linspace(-2.0, 2.0, 21)) / math.sinh(2.0)),
    "graded circle": Grid(np.sort(np.random.default_rng(3).uniform(-3.0, 3.0, 20)), closed=True),
}


def half_hats(grid):
    left, right = grid.knots()
    return grid.theta - left, right - grid.theta


def naive(seen, grid, coefficients):
    """The integrals of the three kernels over hats, shape (3, m, k), by Gauss quadrature over each half hat."""
    point, weight = np.polynomial.legendre.leggauss(40)
    found = np.zeros((3, seen.size, grid.size))
    n = np.arange(coefficients.shape[1])
    for j, (theta, h_left, h_right) in enumerate(zip(grid.theta, *half_hats(grid), strict=True)):
        for length, side in ((h_left, -1.0), (h_right, 1.0)):
            t = 0.5 * length * (point + 1.0)
            phi = seen[:, None] - (theta + side * t)
            hat = 0.5 * length * weight * (1.0 - t / length) if length else 0.0 * t
            for k, wave in enumerate((np.cos, np.cos, np.sin)):
                kernel = np.tensordot(coefficients[k], wave(np.multiply.outer(n, phi)), axes=1)
                found[k, :, j] += kernel @ hat
    return found


def half_moment(n, length):
    """int_0^h exp(-i n t) (1 - t/h) dt with many digits."""
    with mpmath.workdps(400):
        n, h = mpmath.mpf(n), mpmath.mpf(length)
        if n == 0 or h == 0:
            return complex(h / 2)
        z = 1j * n * h
        return complex(h * (mpmath.exp(-z) - 1 + z) / z**2)


@pytest.mark.parametrize("length", [0.0, 1e-100, 1e-9, 1e-3, 0.0499, 0.0501, 0.25, 1.0, math.pi])
def test_half_hats(length):
    """The series below |n h| = 1/2 and the quotient above it. Measured: 2e-16 and 5e-16 of the value."""
    order = np.array([0.0, 1.0, 2.0, 9.0, 10.0, 11.0, 100.0, 5000.0])
    none, lengths = np.zeros(1), np.array([length])
    right = fourier.hat_moments(order, none, lengths)[0]
    left = fourier.hat_moments(order, lengths, none)[0]
    for n, one, other in zip(order, right, left, strict=True):
        expected = half_moment(n, length)
        assert abs(one - expected) <= 1e-15 * abs(expected)
        assert other == np.conj(one)


def test_one_array_for_both_sides_is_a_whole_hat():
    """On uniform nodes a hat is h sinc^2(n h/2)."""
    order, h = np.arange(1.0, 60.0), np.full(3, 0.11)
    found = fourier.hat_moments(order, h, h)
    assert found == pytest.approx(fourier.hat_moments(order, h, h.copy()), abs=0.0)
    expected = 0.11 * np.sinc(order * 0.11 / (2.0 * math.pi)) ** 2
    assert found == pytest.approx(np.tile(expected, (3, 1)), abs=1e-16)


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
def test_columns_against_quadrature(grid):
    """At the nodes and between them. Measured: 5e-15."""
    seen = np.r_[grid.theta, -3.0, 0.3, 2.9]
    found = fourier.hat_columns(seen, grid.theta, *half_hats(grid), COEFFICIENTS)
    assert found == pytest.approx(naive(seen, grid, COEFFICIENTS), abs=2e-14)


def test_blocks_of_harmonics(monkeypatch):
    """Sums in blocks of 7 and in one block; the product too."""
    grid = GRIDS["graded"]
    tractions = np.random.default_rng(1).normal(size=(2, grid.size))
    arguments = (grid.theta, grid.theta, *half_hats(grid), COEFFICIENTS)
    columns, product = fourier.hat_columns(*arguments), fourier.product(*arguments, tractions)
    monkeypatch.setattr(fourier, "BLOCK", 7)
    assert fourier.hat_columns(*arguments) == pytest.approx(columns, abs=1e-14)
    assert fourier.product(*arguments, tractions) == pytest.approx(product, abs=1e-14)


def test_more_harmonics_than_a_block():
    """600 harmonics of a thin wall take three blocks."""
    n = np.arange(601.0)
    coefficients = np.array([0.99**n, 0.98**n, 0.97**n])
    grid = Grid.arc(-2.0, -1.0, 7)
    columns = fourier.hat_columns(grid.theta, grid.theta, *half_hats(grid), coefficients)
    phi = np.subtract.outer(grid.theta, grid.theta)
    moments = fourier.hat_moments(n, *half_hats(grid))
    for k, part in enumerate((np.real, np.real, np.imag)):
        expected = part(np.einsum("n,ijn,jn->ij", coefficients[k], np.exp(1j * np.multiply.outer(phi, n)), moments))
        assert columns[k] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
def test_product_is_the_columns_times_tractions(grid):
    """Gap = c_0 N + c_2 T, slip = -c_2 N + c_1 T. Measured: 2.5e-15."""
    tractions = np.random.default_rng(2).normal(size=(2, grid.size))
    first, second, cross = fourier.hat_columns(grid.theta, grid.theta, *half_hats(grid), COEFFICIENTS)
    expected = [first @ tractions[0] + cross @ tractions[1], second @ tractions[1] - cross @ tractions[0]]
    found = fourier.product(grid.theta, grid.theta, *half_hats(grid), COEFFICIENTS, tractions)
    assert found == pytest.approx(np.array(expected), abs=1e-14)


def test_coefficients_of_a_piecewise_linear_function():
    """int f exp(-i n xi) dxi by the trapezoidal rule over a fine grid with the nodes among its points."""
    grid = GRIDS["arc"]
    values = np.cos(3.0 * grid.theta)
    values[[0, -1]] = 0.0
    order = np.array([0.0, 1.0, 5.0, 12.0])
    found = fourier.hat_coefficients(order, grid.theta, *half_hats(grid), values)
    fine = np.linspace(-2.6, -0.4, 22 * 4000 + 1)
    f = np.interp(fine, grid.theta, values) * np.exp(-1j * np.multiply.outer(order, fine))
    assert found == pytest.approx(f.sum(axis=1) * (fine[1] - fine[0]), abs=1e-8)


@pytest.mark.parametrize("grid", GRIDS.values(), ids=GRIDS)
def test_the_operator_with_smooth_kernels(grid):
    """``fill_operator`` copies columns on uniform nodes; the smooth part is that of the naive sum. Measured: 5e-15."""
    left, right = grid.knots()
    size = 2 * grid.size

    def filled(smooth):
        operator = np.empty((size, size), order="F")
        influence.fill_operator(grid.theta, left, right, grid.uniform, grid.closed, 0.3, 0.8, operator, smooth)
        return operator

    first, second, cross = naive(grid.theta, grid, COEFFICIENTS)
    expected = np.block([[first, cross], [-cross, second]])
    assert filled(COEFFICIENTS) - filled(None) == pytest.approx(expected, abs=2e-14)
    assert np.array_equal(filled(np.zeros((3, 5))), filled(None))
