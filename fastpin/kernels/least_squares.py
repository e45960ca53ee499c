"""Compiled least squares of a few unknowns, for the many small fits between the nodes.

A fit of 40 values with 7 unknowns takes 2 microseconds here, and 40 with ``numpy.linalg.pinv``. The columns of a fit
are orthogonalised by Householder's reflections, which lose no more digits than singular values do. A matrix A is held
by its columns: ``A[k]`` is a column, and the last one holds the values.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.runtime.jit import compiled, inner

RANK = 1e-15
"""A column with less than this part of the largest column, beside the columns before it, counts as zero.

``numpy.linalg.pinv`` takes smaller singular values for zero by the same number.
"""

NEWTON_STEPS = 4
"""Steps of Newton's method to the root of an edge's polynomial. Roots that count lie within 1.5 node distances."""


@inner
def _product(a, b, first):
    """The inner product of a[first:] and b[first:]. Four sums run side by side, always in the same order."""
    n = a.size
    s0 = s1 = s2 = s3 = 0.0
    i = first
    while i + 4 <= n:
        s0 += a[i] * b[i]
        s1 += a[i + 1] * b[i + 1]
        s2 += a[i + 2] * b[i + 2]
        s3 += a[i + 3] * b[i + 3]
        i += 4
    while i < n:
        s0 += a[i] * b[i]
        i += 1
    return (s0 + s1) + (s2 + s3)


@inner
def _turn(A, k, row, pivot, values):
    """Reflect `values` by the reflection that made column k of A a multiple of the unit vector of `row`."""
    part = _product(A[k], values, row) / (pivot * A[k, row])
    for i in range(row, values.size):
        values[i] += part * A[k, i]


@inner
def _factor(A, count, diagonal, rows):
    """Factor the first `count` columns of A, and turn all columns after them. Return the rank.

    The row rows[k] of the triangle R holds column k, with the diagonal entry diagonal[k]. R_ij stands in
    A[j, rows[i]]. A column that counts as zero has rows[k] = -1.
    """
    row, largest = 0, 0.0
    for k in range(count):
        largest = max(largest, _product(A[k], A[k], 0))
    for k in range(count):
        norm = math.sqrt(_product(A[k], A[k], row))
        rows[k], diagonal[k] = -1, 0.0
        if norm > RANK * math.sqrt(largest):
            rows[k], diagonal[k] = row, -norm if A[k, row] >= 0.0 else norm
            A[k, row] -= diagonal[k]
            for j in range(k + 1, A.shape[0]):
                _turn(A, k, row, diagonal[k], A[j])
            row += 1
    return row


@inner
def _substitute(A, count, diagonal, rows, coefficients):
    """Solve the triangle of :func:`_factor` for the turned column `count`. A column that counts as zero gets 0."""
    for k in range(count - 1, -1, -1):
        coefficients[k] = 0.0
        if rows[k] >= 0:
            left = A[count, rows[k]]
            for j in range(k + 1, count):
                left -= A[j, rows[k]] * coefficients[j]
            coefficients[k] = left / diagonal[k]


@inner
def _first_row(A, count, diagonal, rows, row):
    """Fill `row`, shape (count,), with the first row of the triangle's inverse. Return the square of its norm."""
    for j in range(count):
        row[j] = 0.0
        if rows[j] >= 0:
            left = 1.0 if j == 0 else 0.0
            for i in range(j):
                if rows[i] >= 0:
                    left -= A[j, rows[i]] * row[i]
            row[j] = left / diagonal[j]
    return _product(row[:count], row[:count], 0)


@compiled
def standard_error(misfit, spare, amplification):
    """Standard error of a fitted number, a little enlarged if there are few nodes beyond the unknowns.

    `misfit` is the sum of the squared residuals, `spare` the number of nodes beyond the unknowns, and `amplification`
    the norm of the row that gives the number.
    """
    return math.sqrt(misfit / spare) * amplification * (1.0 + 10.0 / spare)


@inner
def _solve(A, coefficients):
    """Fit the last column of A by the others. Return the standard error of the first coefficient. A is used up."""
    count = A.shape[0] - 1
    diagonal, rows, row = np.empty(count), np.empty(count, np.int64), np.empty(count)
    rank = _factor(A, count, diagonal, rows)
    _substitute(A, count, diagonal, rows, coefficients)
    misfit = _product(A[count], A[count], rank)
    return standard_error(misfit, A.shape[1] - count, math.sqrt(_first_row(A, count, diagonal, rows, row)))


@compiled
def fit(columns, values, coefficients):
    """Least squares of any columns, shape (m, n). Return the standard error of the first coefficient.

    `values` has shape (m,). Output are the `coefficients` (n,).
    """
    m, n = columns.shape
    A = np.empty((n + 1, m))
    for i in range(m):
        for k in range(n):
            A[k, i] = columns[i, k]
        A[n, i] = values[i]
    return _solve(A, coefficients)


@inner
def _window(x, half, skipped):
    """The window of half-width `half` about x = 0: its first node, the nodes left out, and the node after the last.

    All are 0 if the window does not lie inside the range of `x`.
    """
    if x[0] > 0.5 - half or x[-1] < half - 0.5:
        return 0, 0, 0, 0
    first = np.searchsorted(x, -half - 0.5, "right")
    left = np.searchsorted(x, -skipped - 0.5, "left")
    right = np.searchsorted(x, skipped + 0.5, "right")
    return first, left, max(left, right), np.searchsorted(x, half + 0.5, "left")


@inner
def _border_columns(x, powers, bound, exponent, half, nodes, degree, terms):
    """The columns of :func:`border`: y^k for y = -x/half, and |y|^(exponent + k) where y < 0; and the values."""
    first, left, right, last = nodes
    A = np.empty((degree + 1 + terms + 1, left - first + last - right))
    unit = half**exponent
    for i in range(A.shape[1]):
        node = first + i if first + i < left else right + i - (left - first)
        y = -x[node] / half
        power = 1.0
        for k in range(degree + 1):
            A[k, i] = power
            power *= y
        power = powers[node] / unit
        for k in range(terms):
            A[degree + 1 + k, i] = power
            power *= -y
        A[degree + 1 + terms, i] = bound[node]
    return A


@compiled
def border(x, bound, exponent, windows, shapes, spare, curve):
    """Fit the bound about a border by every window and shape, and evaluate the best fit on the slip side.

    The bound is p(y) + |y|^exponent q(y), the second part where y < 0, with y = -x/half and polynomials p and q.

    Parameters
    ----------
    x, bound : ndarray, shape (n,)
        Distances from the border in node distances, increasing; positive on the slip side. The bound there.
    exponent : float
    windows : ndarray of int, shape (w, 2)
        Half-width, and the number of nodes left out on either side.
    shapes : ndarray of int, shape (s, 2)
        Degree of p, and number of terms of q.
    spare : int
        Least number of nodes beyond the unknowns.
    curve : ndarray, shape (c,)
        Output: the best fit at y = -t^2, for equally spaced t from 0 to 1.

    Returns
    -------
    error, half : float
        Standard error of the bound at the border, infinite if no window has enough nodes; and the best half-width.
    """
    powers = np.zeros(x.size)
    for i in range(x.size):
        if x[i] > 0.0:
            powers[i] = x[i] ** exponent
    least, width, degree, terms = np.inf, 0.0, 0, 0
    coefficients, best = np.empty(x.size), np.empty(x.size)
    for w in range(windows.shape[0]):
        half = float(windows[w, 0])
        nodes = _window(x, half, float(windows[w, 1]))
        for s in range(shapes.shape[0]):
            unknowns = shapes[s, 0] + 1 + shapes[s, 1]
            if nodes[1] - nodes[0] + nodes[3] - nodes[2] < unknowns + spare:
                continue
            A = _border_columns(x, powers, bound, exponent, half, nodes, shapes[s, 0], shapes[s, 1])
            error = _solve(A, coefficients)
            if error < least:
                least, width, degree, terms = error, half, shapes[s, 0], shapes[s, 1]
                coefficients, best = best, coefficients
    for i in range(curve.size if width > 0.0 else 0):
        place = (i / (curve.size - 1)) ** 2
        smooth = cusp = 0.0
        for k in range(degree, -1, -1):
            smooth = best[k] - place * smooth
        for k in range(degree + terms, degree, -1):
            cusp = best[k] + place * cusp
        curve[i] = smooth + cusp * place**exponent
    return least, width


@compiled
def corner(x, values, windows, degrees, spare, bend):
    """Fit two branches that meet in a corner at x = 0, by every window and degree.

    With y = x/half the values are p(y) + |y| q(y). Fits count that fall on both sides of the corner, by more than
    `bend` standard errors over a node distance, mean of both sides.

    Parameters
    ----------
    x, values : ndarray, shape (n,)
        Distances from the corner in node distances, increasing; and the values there.
    windows : ndarray of int, shape (w, 2)
        Half-width, and the number of nodes left out on either side.
    degrees : ndarray of int, shape (d,)
        Degrees of p; q has one degree less.
    spare : int
        Least number of nodes beyond the unknowns.
    bend : float

    Returns
    -------
    error, value : float
        Standard error and height of the corner by the best fit; the error is infinite if none counts.
    """
    least, value, coefficients = np.inf, 0.0, np.empty(x.size)
    for w in range(windows.shape[0]):
        half = float(windows[w, 0])
        first, left, right, last = _window(x, half, float(windows[w, 1]))
        m = left - first + last - right
        for degree in degrees:
            if m < 2 * degree + 1 + spare:
                continue
            A = np.empty((2 * degree + 2, m))
            for i in range(m):
                node = first + i if first + i < left else right + i - (left - first)
                y, power = x[node] / half, 1.0
                for k in range(degree):
                    A[k, i], A[degree + 1 + k, i] = power, abs(y) * power
                    power *= y
                A[degree, i], A[2 * degree + 1, i] = power, values[node]
            error = _solve(A, coefficients)
            fall = -coefficients[degree + 1] / half
            if error < least and fall > max(abs(coefficients[1]) / half, bend * error):
                least, value = error, coefficients[0]
    return least, value


@inner
def _left_cusp(x, place, degree, terms, decaying, exponent, A):
    """Fill the columns of a cusp: y^k with y = (x - place)/x[-1], |y|^(exponent + k) and a falling part where y < 0."""
    for i in range(x.size):
        y = (x[i] - place) / x[-1]
        power = 1.0
        for k in range(degree + 1):
            A[k, i] = power
            power *= y
        power = (-y) ** exponent if y < 0.0 else 0.0
        for k in range(terms):
            A[degree + 1 + k, i] = power
            power *= -y
        if decaying:
            A[degree + 1 + terms, i] = max(place - x[i], 1.0) ** (exponent - 2.0) if y < 0.0 else 0.0


@compiled
def refine_cusp(x, values, place, shape, exponent, steps, shift, coefficients):
    """Move a cusp by the Gauss-Newton method to the place of the smallest misfit.

    Parameters
    ----------
    x, values : ndarray, shape (m,)
        Distances of the nodes in node distances, increasing; and the values there.
    place : float
        Place to begin at.
    shape : (int, int, bool)
        Degree of the polynomial, terms of the cusp, and whether a part like the distance to the power
        `exponent` - 2 is fitted too.
    exponent : float
        Power of the cusp.
    steps : int
    shift : float
        Change of the place for the derivative by a difference quotient.
    coefficients : ndarray, shape (n,)
        Output: the coefficients at the place before the last step.

    Returns
    -------
    place, error : float
        The place after all steps, and the standard error of the value at the cusp.
    """
    degree, terms, decaying = shape
    n, m = coefficients.size, x.size
    A, before, after, change = np.empty((n + 1, m)), np.empty((n, m)), np.empty((n, m)), np.empty(m)
    diagonal, rows, row = np.empty(n), np.empty(n, np.int64), np.empty(n)
    error = np.inf
    for _ in range(steps):
        _left_cusp(x, place, degree, terms, decaying, exponent, before)
        _left_cusp(x, place + shift, degree, terms, decaying, exponent, after)
        A[:n], A[n] = before, values
        rank = _factor(A, n, diagonal, rows)
        _substitute(A, n, diagonal, rows, coefficients)
        amplification = _first_row(A, n, diagonal, rows, row)
        for i in range(m):
            change[i] = 0.0
            for k in range(n):
                change[i] += (after[k, i] - before[k, i]) * coefficients[k] / shift
        across = 0.0
        for k in range(n):
            if rows[k] >= 0:
                _turn(A, k, rows[k], diagonal[k], change)
                across += row[k] * change[rows[k]]
        size = _product(change, change, rank)
        if math.sqrt(size) > RANK * abs(diagonal[0]):
            amplification += across**2 / size
            place += _product(change, A[n], rank) / size
        error = standard_error(_product(A[n], A[n], rank), m - n - 1, math.sqrt(amplification))
    return place, error


@inner
def _misfit(columns, inverse, values, left):
    """The sum of the squared residuals of a fit with a known pseudo-inverse.

    `columns` (n, m) and `inverse` (n, m) have one unknown in each row. `left` (m,) is filled with the residuals.
    """
    left[:] = values
    for k in range(columns.shape[0]):
        part = _product(inverse[k], values, 0)
        for i in range(left.size):
            left[i] -= part * columns[k, i]
    return _product(left, left, 0)


@inner
def _orthonormalise(column, others):
    """Subtract the parts of a column along orthonormal `others`, a row each, and divide it by its norm."""
    for k in range(others.shape[0]):
        part = _product(others[k], column, 0)
        for i in range(column.size):
            column[i] -= part * others[k, i]
    norm = math.sqrt(_product(column, column, 0))
    for i in range(column.size):
        column[i] = column[i] / norm if norm > 0.0 else 0.0


@compiled
def cusp_bases(x, places, shape, exponent, smooth, bases):
    """Fill the orthonormal columns of a cusp at every place. The polynomials are the same at all places.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Distances of the nodes in node distances, increasing.
    places : ndarray, shape (p,)
    shape : (int, int, bool)
        As for :func:`refine_cusp`.
    exponent : float
        Power of the cusp.
    smooth : ndarray, shape (degree + 1, m)
        Output: orthonormal polynomials, a row each.
    bases : ndarray, shape (p, terms + decaying, m)
        Output: what the columns of the cusp at each place add to them, orthonormal, a row each.

    Returns
    -------
    float
        Norm of the row that gives the value at a cusp at the middle place.
    """
    degree, terms, decaying = shape
    n, m = degree + 1 + bases.shape[1], x.size
    A = np.empty((n + 1, m))
    for k in range(degree + 1):
        for i in range(m):
            smooth[k, i] = (x[i] / x[-1]) ** k
        _orthonormalise(smooth[k], smooth[:k])
    for p in range(places.size):
        _left_cusp(x, places[p], degree, terms, decaying, exponent, A)
        for k in range(bases.shape[1]):
            bases[p, k] = A[degree + 1 + k]
            _orthonormalise(bases[p, k], smooth)
            _orthonormalise(bases[p, k], bases[p, :k])
    _left_cusp(x, places[places.size // 2], degree, terms, decaying, exponent, A)
    diagonal, rows, row = np.empty(n), np.empty(n, np.int64), np.empty(n)
    A[n] = 0.0
    _factor(A, n, diagonal, rows)
    return math.sqrt(_first_row(A, n, diagonal, rows, row))


@compiled
def search_cusp(smooth, bases, values, amplification, reach):
    """Find the place of a cusp with the smallest misfit, among equally spaced places.

    Parameters
    ----------
    smooth, bases : ndarray
        See :func:`cusp_bases`.
    values : ndarray, shape (m,)
    amplification : float
        Norm of the row that gives the value at the cusp.
    reach : float
        The places lie from -`reach` to `reach`.

    Returns
    -------
    error, place : float
        Approximate standard error of the value, infinite if the best place is the first or the last one. The extreme
        of the parabola through the misfits at the best place and its neighbours.
    """
    count, n, m = bases.shape
    rough, misfits, left = np.empty(m), np.empty(count), np.empty(m)
    _misfit(smooth, smooth, values, rough)
    for p in range(count):
        misfits[p] = _misfit(bases[p], bases[p], rough, left)
    lowest = np.argmin(misfits)
    if lowest == 0 or lowest == count - 1:
        return np.inf, 0.0
    before, middle, after = misfits[lowest - 1], misfits[lowest], misfits[lowest + 1]
    bend = before - 2.0 * middle + after
    shift = 0.5 * (before - after) / bend if bend != 0.0 else 0.0
    error = standard_error(middle, m - smooth.shape[0] - n - 1, amplification)
    return error, reach * (2.0 * (lowest + shift) / (count - 1) - 1.0)


@inner
def _root(series):
    """The root near 0 of a power series by Newton's method, and the slope there; NaN if there is none."""
    place, slope = 0.0, 0.0
    for _ in range(NEWTON_STEPS):
        value, slope = 0.0, 0.0
        for k in range(series.size - 1, -1, -1):
            slope = slope * place + value
            value = value * place + series[k]
        if slope == 0.0:
            return np.nan, slope
        place -= value / slope
    return place, slope


@compiled
def edge(series, windows, amplifications, columns, inverses, values, low, limits):
    """The edge by the best of many fits of a polynomial and perhaps a part like the inverse distance.

    Parameters
    ----------
    series : ndarray, shape (f, terms)
        The fitted polynomials. The first fit is that of the nearest nodes.
    windows : ndarray of int, shape (f, 3)
        First node, number of nodes and number of unknowns of each fit.
    amplifications : ndarray, shape (f,)
        Norms of the rows that give the constant terms.
    columns, inverses : ndarray, shape (f, most unknowns, most nodes)
        The columns of each fit, a row each, and its pseudo-inverse.
    values : ndarray, shape (n,)
        Values at the nodes, which fall linearly to zero at the edge.
    low : float
        Place of the next node outwards, from the outermost node, in node distances; < 0.
    limits : (float, float, float, float)
        Largest place inside the outermost node, largest distance from the place of the first fit, and largest standard
        errors of the first fit and of the others, in node distances.

    Returns
    -------
    float
        Place of the edge from the outermost node, in node distances, not below `low`. NaN if no fit is good enough.
    """
    inside, agreement, nearest_error, least = limits
    nearest, found, left = 0.0, np.nan, np.empty(columns.shape[2])
    for f in range(series.shape[0]):
        root, slope = _root(series[f])
        offset = root - 0.5
        if not 1.25 * low <= offset <= inside:
            if f == 0:
                return np.nan
            continue
        if f == 0:
            nearest = offset
        elif abs(offset - nearest) > agreement:
            continue
        first, m, n = windows[f]
        misfit = _misfit(columns[f, :n, :m], inverses[f, :n, :m], values[first : first + m], left[:m])
        error = standard_error(misfit, m - n, amplifications[f]) / abs(slope)
        if f == 0:
            found = max(offset, low) if error <= nearest_error else np.nan
        elif error < least:
            least, found = error, max(offset, low)
    return found
