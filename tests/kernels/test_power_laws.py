"""Power laws of nodes: compiled, as plain Python, and against NumPy's least squares."""

import numpy as np
import pytest

from fastpin.kernels import half_line, power_laws
from fastpin.reading.power_laws import WINDOWS
from tests.support.kernels import run_as_python

KERNELS = power_laws


@pytest.fixture(autouse=True)
def least_squares_too(way, monkeypatch):
    """Run the least squares of the other file in the same way."""
    if way == "python":
        run_as_python(half_line, monkeypatch)


def naive(x, values, exponent, turns):
    """The fit with the smallest error of those of all windows: error, series and last x; None without a window."""
    best = None
    for first, count, degree, decaying in WINDOWS.tolist():
        window = x[first : first + count]
        if window.size < count:
            continue
        powers = [window ** (exponent + k) for k in range(degree + 1)]
        parts = [np.imag(powers[0])] * turns + [window ** (exponent.real - 2.0)] * decaying
        columns = np.column_stack([*np.real(powers), *parts])
        inverse = np.linalg.pinv(columns)
        found = inverse @ values[first : first + count]
        spare = count - found.size
        left = np.linalg.norm(columns @ found - values[first : first + count])
        error = left / np.sqrt(spare) * (1.0 + 10.0 / spare) * np.linalg.norm(inverse[0])
        if best is None or error < best[0]:
            series = found[: degree + 1].astype(complex)
            if turns:
                series[0] -= 1j * found[degree + 1]
            best = error, series, window[-1]
    return best


@pytest.mark.parametrize("exponent", [0.5 + 0j, 0.43 + 0j, 0.5 + 0.08j])
@pytest.mark.parametrize("nodes", [8, 14, 40])
def test_fits_against_least_squares(way, exponent, nodes):
    rng, x = np.random.default_rng(nodes), np.arange(nodes) + 0.3
    values = np.real(x**exponent * (1.0 - 0.02 * x + 0.3j)) + 1e-4 * rng.normal(size=nodes)
    turns, series = exponent.imag != 0.0, np.empty(4, dtype=complex)
    error, last = power_laws.fit(x, values, exponent, turns, WINDOWS, series)
    expected = naive(x, values, exponent if turns else exponent.real, turns)
    assert (error, last) == pytest.approx((expected[0], expected[2]), rel=1e-8)
    assert series[: expected[1].size] == pytest.approx(expected[1], rel=1e-8)
    assert not series[expected[1].size :].any()


def test_without_enough_nodes_there_is_no_fit(way):
    series = np.empty(4, dtype=complex)
    assert power_laws.fit(np.arange(1.0, 8.0), np.ones(7), 0.5 + 0j, False, WINDOWS, series) == (0.0, 0.0)


@pytest.mark.parametrize("exponent", [0.5 + 0j, 0.5 + 0.08j])
def test_values_are_powers(way, exponent):
    x, series, found = np.array([-1.0, 0.0, 1e-9, 0.4, 7.0]), np.array([1.0 + 0.2j, -0.1j, 0.03 + 0j]), np.empty(5)
    power_laws.evaluate(x, exponent, series, found)
    assert found[2:] == pytest.approx(np.real(x[2:] ** exponent * np.polynomial.polynomial.polyval(x[2:], series)))
    assert not found[:2].any()
