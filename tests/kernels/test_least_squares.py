"""The compiled fits: compiled, as plain Python, and against NumPy's pseudo-inverse and eigenvalue roots."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from fastpin.kernels import least_squares

KERNELS = (
    "standard_error",
    "fit",
    "border",
    "corner",
    "refine_cusp",
    "cusp_bases",
    "search_cusp",
    "edge",
)
INNER = ("_product", "_turn", "_factor", "_substitute", "_first_row", "_solve", "_window", "_border_columns",
         "_left_cusp", "_misfit", "_orthonormalise", "_root")  # fmt: skip
WINDOWS = np.array([(8, 1), (8, 4), (12, 2), (18, 2), (90, 2)])
SHAPES = np.array([(3, 2), (4, 3)])
X = np.arange(-20.0, 21.0) + 0.3


def plain_python():
    """The kernels as plain Python: their parts are taken from the same module."""
    space = dict(vars(least_squares))
    for name in (*INNER, *KERNELS):
        function = getattr(getattr(least_squares, name), "py_func", None) or getattr(least_squares, name)
        space[name] = type(function)(function.__code__, space, name)
    return SimpleNamespace(**{name: space[name] for name in KERNELS})


@pytest.fixture(params=["compiled", "plain Python"], scope="module")
def kernels(request):
    return least_squares if request.param == "compiled" else plain_python()


def naive(columns, values):
    """Coefficients and the standard error of the first one, by the pseudo-inverse."""
    inverse = np.linalg.pinv(columns)
    coefficients = inverse @ values
    spare = values.size - columns.shape[1]
    misfit = np.sum((columns @ coefficients - values) ** 2)
    return coefficients, math.sqrt(misfit / spare) * np.linalg.norm(inverse[0]) * (1.0 + 10.0 / spare)


def cusp_columns(y, exponent, degree, terms):
    side = np.maximum(-y, 0.0)
    return np.column_stack([y**k for k in range(degree + 1)] + [side ** (exponent + k) for k in range(terms)])


def in_window(x, half, skipped):
    return (np.abs(x) > skipped + 0.5) & (np.abs(x) < half + 0.5)


# --- any columns ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shape", [(9, 1), (12, 7), (41, 5)])
def test_a_fit_is_that_of_the_pseudo_inverse(kernels, shape):
    """Measured: 3e-15 of the largest coefficient, and 1e-14 of the error."""
    rng = np.random.default_rng(1)
    columns, values = rng.normal(size=shape), rng.normal(size=shape[0])
    coefficients = np.empty(shape[1])
    error = kernels.fit(columns, values, coefficients)
    expected, expected_error = naive(columns, values)
    assert coefficients == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())
    assert error == pytest.approx(expected_error, rel=1e-12)


def test_powers_lose_no_more_digits_than_singular_values(kernels):
    """A polynomial of degree 8, whose columns have a condition of 500, is found again."""
    x = np.linspace(-1.0, 1.0, 40)
    columns, wanted = x[:, None] ** np.arange(9), np.arange(1.0, 10.0)
    assert np.linalg.cond(columns) > 400.0
    coefficients = np.empty(9)
    kernels.fit(columns, columns @ wanted, coefficients)
    assert coefficients == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_column_with_one_large_entry_loses_no_digits(kernels, sign):
    """A reflection adds to this entry, whatever its sign. It must not subtract nearly equal numbers."""
    rng = np.random.default_rng(6)
    columns, values, coefficients = rng.normal(size=(12, 3)), rng.normal(size=12), np.empty(3)
    columns[1:, 0] *= 1e-7
    columns[0, 0] = sign
    error = kernels.fit(columns, values, coefficients)
    expected, expected_error = naive(columns, values)
    assert coefficients == pytest.approx(expected, rel=1e-12)
    assert error == pytest.approx(expected_error, rel=1e-12)


@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_column_of_zeros_gets_the_coefficient_zero(kernels, place):
    """As by the pseudo-inverse, which takes the column's singular value for zero."""
    rng = np.random.default_rng(2)
    columns, values, coefficients = rng.normal(size=(12, 3)), rng.normal(size=12), np.full(3, np.nan)
    columns[:, place] = 0.0
    error = kernels.fit(columns, values, coefficients)
    expected, expected_error = naive(columns, values)
    assert coefficients[place] == expected[place] == 0.0
    assert coefficients == pytest.approx(expected, abs=1e-13)
    assert error == pytest.approx(expected_error, abs=1e-13)


def test_columns_that_depend_on_each_other_give_the_fit_of_the_pseudo_inverse(kernels):
    """The coefficients may differ, the fitted values do not."""
    rng = np.random.default_rng(3)
    columns, values, coefficients = rng.integers(-5, 5, (12, 3)).astype(float), rng.normal(size=12), np.empty(3)
    columns[:, 2] = columns[:, 1]
    kernels.fit(columns, values, coefficients)
    assert columns @ coefficients == pytest.approx(columns @ naive(columns, values)[0], abs=1e-12)


# --- borders, corners and cusps --------------------------------------------------------------------------------


@pytest.mark.parametrize("exponent", [0.42, 0.5])
def test_the_best_fit_about_a_border(kernels, exponent):
    values = 1.0 - 0.01 * X - 0.03 * np.maximum(X, 0.0) ** exponent + 1e-4 * np.sin(X)
    tried = []
    for half, skipped in WINDOWS[:-1]:  # the last one is wider than the nodes
        taken = in_window(X, half, skipped)
        for degree, terms in SHAPES:
            if taken.sum() >= degree + 1 + terms + 4:
                columns = cusp_columns(-X[taken] / half, exponent, degree, terms)
                coefficients, error = naive(columns, values[taken])
                tried.append((error, half, coefficients, degree, terms))
    assert 1 < len(tried) < 8
    error, half, coefficients, degree, terms = min(tried, key=lambda entry: entry[0])
    curve = np.empty(21)
    found = kernels.border(X, values, exponent, WINDOWS, SHAPES, 4, curve)
    assert found == pytest.approx((error, half), rel=1e-10)
    expected = cusp_columns(-(np.linspace(0.0, 1.0, 21) ** 2), exponent, degree, terms) @ coefficients
    assert curve == pytest.approx(expected, abs=1e-12)


def test_no_fit_about_a_border_with_few_nodes(kernels):
    assert kernels.border(X[15:26], X[15:26], 0.5, WINDOWS, SHAPES, 4, np.empty(3))[0] == math.inf
    assert kernels.border(X, X, 0.5, WINDOWS, SHAPES, 40, np.empty(3))[0] == math.inf


def test_the_best_corner(kernels):
    x = X - 0.3
    values = 3.0 - 0.02 * np.abs(x) - 0.004 * x - 1e-4 * x**2 + 1e-5 * np.sin(x)
    tried = []
    for half, skipped in WINDOWS[:-1]:
        taken = in_window(x, half, skipped)
        y = x[taken] / half
        for degree in (1, 2, 3):
            if taken.sum() >= 2 * degree + 5:
                columns = [y**k for k in range(degree + 1)] + [np.abs(y) * y**k for k in range(degree)]
                coefficients, error = naive(np.column_stack(columns), values[taken])
                assert -coefficients[degree + 1] > abs(coefficients[1])
                tried.append((error, coefficients[0]))
    degrees = np.array([1, 2, 3])
    assert kernels.corner(x, values, WINDOWS, degrees, 4, 2.0) == pytest.approx(min(tried), rel=1e-9)
    for other in (values + 0.1 * x, -values):  # the values rise on one side, or on both
        assert kernels.corner(x, other, WINDOWS, degrees, 4, 2.0)[0] == math.inf
    assert kernels.corner(x, values, WINDOWS, degrees, 4, 1e9)[0] == math.inf


def left_cusp(x, place, shape, exponent):
    degree, terms, decaying = shape
    columns = cusp_columns((x - place) / x[-1], exponent, degree, terms)
    falling = np.where(x < place, np.maximum(place - x, 1.0) ** (exponent - 2.0), 0.0)
    return np.column_stack([columns, *[falling] * decaying])


def cusped(x, place=0.4):
    side = np.maximum(place - x, 0.0)
    return 2.0 - 0.01 * x - 0.05 * np.sqrt(side) + 1e-4 * np.cos(2.0 * x) - 0.01 * np.where(side > 0, 1 / (1 + side), 0)


@pytest.mark.parametrize("shape", [(2, 2, False), (3, 2, True)])
def test_gauss_newton_steps_of_a_cusp(kernels, shape):
    x = X[np.abs(X) > 2.0]
    values, place = cusped(x), 0.1
    for _ in range(2):
        columns = left_cusp(x, place, shape, 0.5)
        coefficients = np.linalg.pinv(columns) @ values
        slope = (left_cusp(x, place + 1e-4, shape, 0.5) - columns) @ coefficients / 1e-4
        inverse = np.linalg.pinv(np.column_stack([columns, slope]))
        residual = columns @ coefficients - values
        place -= inverse[-1] @ residual
    spare = x.size - inverse.shape[0]
    error = np.linalg.norm(residual) / math.sqrt(spare) * np.linalg.norm(inverse[0]) * (1.0 + 10.0 / spare)
    found = np.empty(sum(shape) + 1)
    assert kernels.refine_cusp(x, values, 0.1, shape, 0.5, 2, 1e-4, found) == pytest.approx((place, error), rel=1e-8)
    assert found == pytest.approx(coefficients, abs=1e-8)


def test_a_cusp_in_zeros_stays(kernels):
    """Its place has no influence: the derivative is zero."""
    assert kernels.refine_cusp(X, np.zeros(X.size), 0.7, (2, 2, False), 0.5, 2, 1e-4, np.empty(5)) == (0.7, 0.0)


def test_the_search_for_the_place_of_a_cusp(kernels):
    x, places = X[np.abs(X) > 2.0], np.linspace(-2.0, 2.0, 33)
    all_columns = [left_cusp(x, place, (3, 2, True), 0.5) for place in places]
    smooth, bases = np.empty((4, x.size)), np.empty((33, 3, x.size))
    amplification = kernels.cusp_bases(x, places, (3, 2, True), 0.5, smooth, bases)
    assert amplification == pytest.approx(np.linalg.norm(np.linalg.pinv(all_columns[16])[0]), rel=1e-10)
    for columns, rest in zip(all_columns, bases, strict=True):
        basis = np.vstack([smooth, rest])
        assert basis @ basis.T == pytest.approx(np.eye(7), abs=1e-11)  # measured: 2e-13
        assert basis.T @ (basis @ columns) == pytest.approx(columns, abs=1e-12)
    for wanted in (0.4, -1.1):
        values = cusped(x, wanted)
        misfits = [columns @ naive(columns, values)[0] - values for columns in all_columns]
        misfits = [float(residual @ residual) for residual in misfits]
        best = int(np.argmin(misfits))
        bend = np.polyfit([-1.0, 0.0, 1.0], misfits[best - 1 : best + 2], 2)
        expected = places[best] - 0.5 * bend[1] / bend[0] * (places[1] - places[0])
        error, place = kernels.search_cusp(smooth, bases, values, 2.0, 2.0)
        assert place == pytest.approx(expected, abs=1e-9)
        assert error == pytest.approx(kernels.standard_error(misfits[best], x.size - 8, 2.0), rel=1e-9)
    assert kernels.search_cusp(smooth, bases[20:], cusped(x, -1.1), 2.0, 2.0) == (math.inf, 0.0)


# --- edges --------------------------------------------------------------------------------------------------------


def designs(x, choices):
    """The arrays of :func:`least_squares.edge` for (first, count, degree) of polynomials."""
    columns, inverses = np.zeros((2, len(choices), 5, 20))
    series = np.zeros((len(choices), 5, x.size))
    for k, (first, count, degree) in enumerate(choices):
        powers = x[first : first + count, None] ** np.arange(degree + 1)
        columns[k, : degree + 1, :count], inverses[k, : degree + 1, :count] = powers.T, np.linalg.pinv(powers)
        series[k, : degree + 1, first : first + count] = np.linalg.pinv(powers)
    windows = np.array([(first, count, degree + 1) for first, count, degree in choices])
    return series, windows, np.linalg.norm(series[:, 0], axis=1), columns, inverses


def expected_edge(x, values, choices, low, limits):
    inside, agreement, nearest_error, least = limits
    found, nearest = math.nan, None
    for first, count, degree in choices:
        columns = x[first : first + count, None] ** np.arange(degree + 1)
        coefficients, error = naive(columns, values[first : first + count])
        roots = np.roots(coefficients[::-1])
        root = float(np.real(roots[np.argmin(np.abs(roots))]))
        error /= abs(np.polyval(np.polyder(coefficients[::-1]), root))
        if nearest is None:
            nearest = root - 0.5
            if not 1.25 * low <= nearest <= inside:
                return math.nan
            found = max(nearest, low) if error <= nearest_error else math.nan
        elif 1.25 * low <= root - 0.5 <= inside and abs(root - 0.5 - nearest) <= agreement and error < least:
            least, found = error, max(root - 0.5, low)
    return found


@pytest.mark.parametrize("noise", [1e-6, 3e-3, 3e-2])
def test_the_best_fit_at_an_edge(kernels, noise):
    x = np.arange(25.0) + 0.5
    choices = [(2, 6, 2), (2, 8, 1), (2, 11, 2), (6, 11, 2), (6, 15, 3)]
    series, *arrays = designs(x, choices)
    rng, limits, seen = np.random.default_rng(4), (0.25, 0.12, 0.3, 0.1), set()
    for _ in range(20):
        place = rng.uniform(0.0, 0.5)
        values = (x - place) * (1.0 + 0.02 * (x - place)) + noise * rng.normal(size=x.size)
        found = kernels.edge(series @ values, *arrays, values, -0.45, limits)
        expected = expected_edge(x, values, choices, -0.45, limits)
        assert found == pytest.approx(expected, abs=1e-8, nan_ok=True)
        seen.add(math.isnan(expected))
    assert seen == ({False} if noise < 1e-2 else {False, True})


def test_an_edge_that_can_not_be(kernels):
    x = np.arange(25.0) + 0.5
    series, *arrays = designs(x, [(2, 6, 2)])
    limits = 0.25, 0.12, 0.3, 0.1
    for values in (x + 1.0, x - 2.0, np.ones(25), np.zeros(25)):  # too far outwards or inwards, and no root
        assert math.isnan(kernels.edge(series @ values, *arrays, values, -0.5, limits))
    assert kernels.edge(series @ (x + 0.1), *arrays, x + 0.1, -0.5, limits) == -0.5  # not beyond the next node
