"""Compiled fits of the solutions of a half line: compiled, as plain Python, and against NumPy."""

import math

import numpy as np
import pytest

from fastpin.kernels import half_line
from fastpin.reading.half_line import End, Tries, Try
from fastpin.reading.half_line import half_line as line_of
from tests.support.half_line import NaiveFit, columns, powers, shift
from tests.support.kernels import in_python

LIKE, PRESSURE, RESERVE = line_of(0.5), line_of(0.46), line_of(0.53, 0.2)
FITS = {
    "an edge": (8, (End(PRESSURE, 0, 1, 4),), -1),
    "both edges": (19, (End(LIKE, 0, 1, 5), End(PRESSURE, 18, -1, 4)), -1),
    "an old border": (21, (End(LIKE, 10, 1, 3),), 4),
    "an edge and a known border": (15, (End(RESERVE, 0, 1, 4), End(RESERVE, 6, -1, 3, 0.2)), -1),
    "borders of unlike bodies": (
        29, (End(RESERVE, 14, -1, 3, None, (0.0, 1.0)), End(RESERVE, 17, 1, 3, -0.4, (1.0, -2.0))), 3
    ),
    "no place": (12, (End(LIKE, 6, 1, 3), End(LIKE, 3, -1, 3)), 0),
}  # fmt: skip


@pytest.fixture(params=["compiled", "plain Python"], scope="module")
def kernels(request):
    return half_line if request.param == "compiled" else in_python(half_line)


def values_of(name: str) -> np.ndarray:
    """Values like those of a contact, with an error of 1e-4; without any order for "no place"."""
    nodes, ends, degree = FITS[name]
    rng = np.random.default_rng(len(name))
    if name == "no place":
        return rng.uniform(0.5, 1.0, nodes)
    values = 1e-4 * rng.normal(size=nodes) + (1.0 + 0.01 * np.arange(nodes) if degree >= 0 else 0.0)
    for end in ends:
        place = -0.3 if end.place is None else end.place
        values += columns(end._replace(place=place), nodes) @ [1.0, 0.03, 0.001, 1e-4][: end.terms - 1]
    return values


@pytest.mark.parametrize("name", FITS)
def test_a_fit_is_that_of_the_pseudo_inverse(kernels, name):
    """Measured: 3e-12 of the places, 2e-11 of their errors; the scatter has the rounding of the values."""
    nodes, ends, degree = FITS[name]
    values, packed = values_of(name), Tries([Try(0, nodes, degree, ends)])
    expected = NaiveFit(values, ends, degree)
    n = expected.coefficients.size
    coefficients, spread, matches, levers = (
        np.empty(n),
        np.empty((n, n)),
        np.empty((len(ends), 3)),
        np.empty((len(ends), n)),
    )
    scatter = kernels.solve(values, degree, packed.ends, packed.tables, coefficients, spread)
    kernels.match(degree, packed.ends, packed.tables, coefficients, matches, levers)
    assert coefficients == pytest.approx(expected.coefficients, abs=1e-9 * np.abs(expected.coefficients).max())
    assert scatter == pytest.approx(expected.scatter, rel=1e-9)
    for at in range(len(ends)):
        place = expected.match(at)[0]
        assert matches[at, 0] == pytest.approx(place, rel=1e-9, nan_ok=True)
        assert matches[at, 2] == (0 if math.isnan(place) else 1)
        if not math.isnan(place):
            error = scatter * np.linalg.norm(levers[at] @ spread)
            assert error == pytest.approx(expected.place_error(at), rel=1e-8)
        series = np.zeros((ends[at].terms - 1, n))
        kernels.series(at, degree, packed.ends, packed.tables, matches, series)
        assert series @ coefficients == pytest.approx(expected.series(at), rel=1e-7, abs=1e-11)
    x = np.array([-0.9, 0.0, 2.3, 6.1, nodes - 1.0])
    rows = np.empty((x.size, n))
    kernels.evaluate(x, nodes - 1.0, degree, packed.ends, packed.tables, matches, rows)
    for each, row in zip(x, rows, strict=True):
        assert row @ coefficients == pytest.approx(expected.value(each), rel=1e-9, abs=1e-12)
        assert scatter * np.linalg.norm(row @ spread) == pytest.approx(expected.value_error(each), rel=1e-8, abs=1e-12)


def test_many_fits_in_one_call(kernels):
    """The same as one after the other. "At its place" has the error of the place, too."""
    names = list(FITS)
    values = [values_of(name) for name in names]
    starts = np.cumsum([0, *(each.size for each in values)])
    packed = Tries(
        [Try(int(start), *FITS[name][::2], FITS[name][1]) for name, start in zip(names, starts, strict=False)]
    )
    places, errors, at_place = np.empty((len(names), 2)), np.empty(len(names)), np.empty(len(names))
    flat, at = np.concatenate(values), np.full(len(names), 2.4)
    kernels.end_places(flat, packed.rows, packed.ends, packed.tables, places)
    kernels.value_errors(flat, packed.rows, packed.ends, packed.tables, at, errors)
    kernels.value_errors(flat, packed.rows, packed.ends, packed.tables, np.full(len(names), np.nan), at_place)
    for k, name in enumerate(names):
        _, ends, degree = FITS[name]
        fit = NaiveFit(values[k], ends, degree)
        place = fit.match(0)[0]
        assert places[k, 0] == pytest.approx(place, rel=1e-9, nan_ok=True)
        assert errors[k] == pytest.approx(fit.value_error(2.4), rel=1e-8, abs=1e-12)
        if math.isnan(place):
            assert name == "no place"
            assert math.isnan(at_place[k])
            continue
        assert places[k, 1] == pytest.approx(fit.place_error(0), rel=1e-8)
        x = ends[0].node + ends[0].inwards * place
        slope = abs(fit.value(x - 0.1 * ends[0].inwards) - fit.value(x)) / 0.1
        assert at_place[k] == pytest.approx(fit.value_error(x) + slope * fit.place_error(0), rel=1e-8, abs=1e-12)


def two_ends(distance):
    """Two ends with the same solutions, at the same node and so far apart; and values of a window of 17 nodes."""
    ends = (End(LIKE, 4, 1, 3, -0.2), End(LIKE, 4, 1, 3, -0.2 + distance))
    return ends, 1.0 + 2.0 * columns(ends[0], 17) @ [1.0, 0.1] + 1e-5 * np.random.default_rng(5).normal(size=17)


def fitted(kernels, ends, values):
    """Scatter, coefficients and spread of a fit of two ends and a constant."""
    packed = Tries([Try(0, 17, 0, ends)])
    coefficients, spread = np.empty(5), np.empty((5, 5))
    return kernels.solve(values, 0, packed.ends, packed.tables, coefficients, spread), coefficients, spread


def test_columns_that_depend_on_each_other_get_the_least_coefficients(kernels):
    """Two ends at the same place."""
    ends, values = two_ends(0.0)
    scatter, coefficients, spread = fitted(kernels, ends, values)
    expected = NaiveFit(values, ends, 0)
    assert coefficients == pytest.approx(expected.coefficients, abs=1e-10)
    assert scatter == pytest.approx(expected.scatter, rel=1e-8)
    amplified = np.linalg.norm(expected.row(6.3) @ expected.inverse)
    assert np.linalg.norm(expected.row(6.3) @ spread) == pytest.approx(amplified, rel=1e-8)
    assert expected.row(6.3) @ coefficients == pytest.approx(expected.value(6.3), rel=1e-10)


def test_the_fit_is_right_where_its_coefficients_are_not(kernels):
    """Two ends that are 1e-12 node distances apart. Measured: 1.4e-8 in the value, 2e-9 in the scatter.

    Their columns are combinations of four: 1, and the solutions whose far fields are the powers 0, 1, 2 of the
    distance from one place. The fit with these four is the reference. It has a condition number of 12, so every
    processor gives it to rounding. The pseudo-inverse of the five columns is none: times the values it is off by 1e-3.

    The five columns have three large singular values and a fourth one of 2e-13. The fifth is rounding, and the kernel
    drops it. Let the columns be rounded by E in total. The space of the fitted values is then tilted by the angle |E|
    over the fourth singular value. Only the part of the values outside the three large directions can move, by the
    angle times its norm. This norm is at most the misfit of the fit with one end. An entry of a column, at most 1,
    has some ten roundings, as its factorization has. The coefficients are large and cancel in the row.
    """
    ends, values = two_ends(1e-12)
    scatter, coefficients, _ = fitted(kernels, ends, values)
    free, line = ends[0]._replace(place=None), LIKE
    solutions = columns(free, 17) @ np.linalg.solve(line.matching[:3, :3], shift(0.2, 3))
    design, row = np.column_stack([np.ones(17), solutions]), np.append(1.0, powers(line, np.array([2.5]), 3))
    expected = np.linalg.lstsq(design, values)[0]
    alone = design[:, [0, 2, 3]]
    misfit, of_one = (np.linalg.norm(values - A @ np.linalg.lstsq(A, values)[0]) for A in (design, alone))
    five = np.column_stack([np.ones(17), columns(ends[0], 17), columns(ends[1], 17)])
    fourth = np.linalg.svd(five / np.abs(five).max(axis=0), compute_uv=False)[3]
    eps = np.finfo(float).eps
    moved = 10.0 * eps * math.sqrt(five.size) / fourth * of_one
    assert 0.0 < moved < 0.2 * of_one
    assert scatter == pytest.approx(misfit / math.sqrt(12.0) * (1.0 + 10.0 / 12.0), abs=moved)
    of_five = NaiveFit(values, ends, 0).row(6.3)
    cancelled = 5.0 * eps * np.abs(of_five) @ np.abs(coefficients)
    amplified = np.linalg.norm(row @ np.linalg.pinv(design))
    assert of_five @ coefficients == pytest.approx(row @ expected, abs=amplified * moved + cancelled)


def test_the_exponential_of_a_power_series(kernels):
    found = np.empty(6)
    kernels.exponential(np.array([0.3, 2.0, 0.0, 0.0, 0.0, 0.0]), found)
    assert found == pytest.approx([math.exp(0.3) * 2.0**k / math.factorial(k) for k in range(6)], rel=1e-15)
    kernels.exponential(np.array([0.0, -1.0, -0.5, -1.0 / 3.0, -0.25, -0.2]), found)  # log(1 - x)
    assert found == pytest.approx([1.0, -1.0, 0.0, 0.0, 0.0, 0.0], abs=1e-15)


# --- any columns ---------------------------------------------------------------------------------------------


def by_pseudo_inverse(columns, values):
    """Coefficients and the standard error of the first one."""
    inverse = np.linalg.pinv(columns)
    coefficients = inverse @ values
    spare = values.size - columns.shape[1]
    misfit = np.sum((columns @ coefficients - values) ** 2)
    return coefficients, math.sqrt(misfit / spare) * np.linalg.norm(inverse[0]) * (1.0 + 10.0 / spare)


@pytest.mark.parametrize("shape", [(9, 1), (12, 7), (41, 5)])
def test_a_fit_of_any_columns_is_that_of_the_pseudo_inverse(kernels, shape):
    rng = np.random.default_rng(1)
    of_fit, values = rng.normal(size=shape), rng.normal(size=shape[0])
    coefficients = np.empty(shape[1])
    error = kernels.least_squares(of_fit, values, coefficients)
    expected, expected_error = by_pseudo_inverse(of_fit, values)
    assert coefficients == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())
    assert error == pytest.approx(expected_error, rel=1e-12)


def test_powers_lose_no_more_digits_than_singular_values(kernels):
    """A polynomial of degree 8, whose columns have a condition of 500, is found again."""
    x = np.linspace(-1.0, 1.0, 40)
    of_fit, wanted = x[:, None] ** np.arange(9), np.arange(1.0, 10.0)
    assert np.linalg.cond(of_fit) > 400.0
    coefficients = np.empty(9)
    kernels.least_squares(of_fit, of_fit @ wanted, coefficients)
    assert coefficients == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_column_with_one_large_entry_loses_no_digits(kernels, sign):
    """A reflection adds to this entry, whatever its sign. It must not subtract nearly equal numbers."""
    rng = np.random.default_rng(6)
    of_fit, values, coefficients = rng.normal(size=(12, 3)), rng.normal(size=12), np.empty(3)
    of_fit[1:, 0] *= 1e-7
    of_fit[0, 0] = sign
    error = kernels.least_squares(of_fit, values, coefficients)
    expected, expected_error = by_pseudo_inverse(of_fit, values)
    assert coefficients == pytest.approx(expected, rel=1e-12)
    assert error == pytest.approx(expected_error, rel=1e-12)
