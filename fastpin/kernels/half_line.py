"""Compiled fits of the solutions of a half line to the nodes of a window: whole fits, many in one call.

A fit of 20 values with 8 unknowns takes some 3 microseconds. With NumPy it takes 100.

The values at the nodes 0, 1, ... of a window are fitted by a polynomial and by the solutions at some ends. The
polynomial of k has the variable k/(m - 1) for m nodes. The solutions stand in tables, one for each half line
(:func:`fastpin.reading.half_line.table`). The rows of a table, with TERMS entries each, are

    0 to 2 MOST_NODES - 2   the fitted quantity at the nodes from -MOST_NODES + 1 to MOST_NODES - 1, a solution a column
    MATCHING and on         the far fields: times the coefficients of the solutions, the coefficients of the powers
    GAMMAS                  the gamma functions Gamma(a + m), m = 0, 1, ..., by which the powers are divided
    LAW                     the exponent a, and the factors of the powers inside the zone and beyond its end

The ends of a fit are the rows of an array: the number of the table, the outermost node of the zone, the direction
inwards (1 or -1), the number of solutions, and the place of the end if it is known, otherwise NaN. Places are in node
distances inwards from the outermost node. An end with a known place has one unknown less: its solutions are combined
to the powers 1, 2, ... of the distance from the place.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.runtime.jit import compiled, inner

TERMS = 6
"""Most terms of a fit at one end."""

MOST_NODES = 64
"""Nodes for which the solutions are tabulated. The widest window is smaller."""

MIDDLE = MOST_NODES - 1
"""Row of a table with the outermost node."""

MATCHING = 2 * MOST_NODES - 1
"""First row of a table with the far fields."""

GAMMAS = MATCHING + TERMS
"""Row of a table with the gamma functions."""

LAW = GAMMAS + 1
"""Row of a table with the exponent and the factors of the powers."""

TABLE, NODE, INWARDS, SOLUTIONS, PLACE = range(5)
"""Columns of the ends of a fit."""

LEAST_PLACE, MOST_PLACE = -1.3, 0.5
"""Least and largest distance of an end from its outermost node, in node distances inwards.

The next node outwards is at -1, and the solution of the nodes has an end up to 0.3 of a node distance beyond.
"""

AT_END = 1e-12
"""Distance from an end that is rounding, in node distances. Its root, 1e-6, would be none."""


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


@compiled
def exponential(series, found):
    """Fill `found` (n,) with the coefficients of the exponential of a power series, from those of `series` (n,)."""
    found[0] = math.exp(series[0])
    for k in range(1, found.size):
        found[k] = 0.0
        for j in range(1, k + 1):
            found[k] += j * series[j] * found[k - j] / k


@inner
def _unknowns(degree, ends):
    """Number of unknowns of a fit."""
    count = degree + 1
    for e in range(ends.shape[0]):
        count += int(ends[e, SOLUTIONS]) - (0 if math.isnan(ends[e, PLACE]) else 1)
    return count


@inner
def _known_solution(table, place, k, solution):
    """Fill `solution` with the sum of solutions whose far field is the power k of the distance from a known place."""
    for j in range(k, -1, -1):  # the far fields are a triangle
        left = 1.0
        for p in range(1, k - j + 1):  # (-place)^(k - j)/(k - j)!
            left *= -place / p
        for q in range(j + 1, k + 1):
            left -= table[MATCHING + j, q] * solution[q]
        solution[j] = left / table[MATCHING + j, j]


@inner
def _fill(degree, ends, tables, A):
    """Fill the rows of A with the columns of a fit: the polynomial, then the solutions of all ends. A row is left."""
    m, solution = A.shape[1], np.empty(TERMS)
    for k in range(degree + 1):
        for i in range(m):
            A[k, i] = (i / (m - 1.0)) * A[k - 1, i] if k > 0 else 1.0
    row = degree + 1
    for e in range(ends.shape[0]):
        table, place = tables[int(ends[e, TABLE])], ends[e, PLACE]
        node, inwards, terms = int(ends[e, NODE]), int(ends[e, INWARDS]), int(ends[e, SOLUTIONS])
        if math.isnan(place):
            for k in range(terms):
                for i in range(m):
                    A[row + k, i] = table[MIDDLE + inwards * (i - node), k]
            row += terms
        else:
            for k in range(1, terms):
                _known_solution(table, place, k, solution)
                for i in range(m):
                    A[row, i] = 0.0
                    for j in range(k + 1):
                        A[row, i] += table[MIDDLE + inwards * (i - node), j] * solution[j]
                row += 1


@inner
def _factor(A, diagonal):
    """Factor all rows of A but the last by Householder's reflections, and turn the last one.

    The entry R_ij of the triangle stands in A[j, i], and R_jj in diagonal[j].
    """
    n = diagonal.size
    for k in range(n):
        norm = math.sqrt(_product(A[k], A[k], k))
        diagonal[k] = -norm if A[k, k] >= 0.0 else norm
        if norm > 0.0:
            A[k, k] -= diagonal[k]
            for j in range(k + 1, n + 1):
                part = _product(A[k], A[j], k) / (diagonal[k] * A[k, k])
                for i in range(k, A.shape[1]):
                    A[j, i] += part * A[k, i]


@inner
def _invert(A, diagonal, inverse):
    """Fill `inverse` (n, n) with the inverse of the triangle of :func:`_factor`."""
    n = diagonal.size
    inverse[:] = 0.0
    for j in range(n):
        inverse[j, j] = 1.0 / diagonal[j]
        for i in range(j - 1, -1, -1):
            left = 0.0
            for k in range(i + 1, j + 1):
                left -= A[k, i] * inverse[k, j]
            inverse[i, j] = left / diagonal[i]


@inner
def _rotate(a, b, also_a, also_b):
    """Rotate the vectors `a` and `b` until they are orthogonal, and two others alike. Return whether they were so."""
    size_a, size_b, part = _product(a, a, 0), _product(b, b, 0), _product(a, b, 0)
    if abs(part) <= 1e-14 * math.sqrt(size_a * size_b):  # rounding of ten to twenty products
        return True
    ratio = 0.5 * (size_b - size_a) / part
    if abs(ratio) > 1e150:  # the turn is far below rounding, and the square would overflow
        return True
    tangent = (1.0 if ratio >= 0.0 else -1.0) / (abs(ratio) + math.sqrt(1.0 + ratio**2))
    cosine = 1.0 / math.sqrt(1.0 + tangent**2)
    sine = cosine * tangent
    for i in range(a.size):
        a[i], b[i] = cosine * a[i] - sine * b[i], sine * a[i] + cosine * b[i]
        also_a[i], also_b[i] = cosine * also_a[i] - sine * also_b[i], sine * also_a[i] + cosine * also_b[i]
    return False


@inner
def _pseudo_invert(A, diagonal, inverse):
    """Fill `inverse` (n, n) with the pseudo-inverse of the triangle of :func:`_factor`, by Jacobi's method.

    Rotations make the columns of the triangle orthogonal. Their norms are its singular values.
    """
    n = diagonal.size
    columns, turns = np.zeros((n, n)), np.zeros((n, n))  # a column each, and the columns of the rotation
    for j in range(n):
        for i in range(j):  # a slice that takes a slice would compile for seconds: the text of its error
            columns[j, i] = A[j, i]
        columns[j, j], turns[j, j] = diagonal[j], 1.0
    for _ in range(30):  # it ends by itself after some seven
        are_orthogonal = True
        for i in range(n):
            for j in range(i + 1, n):
                if not _rotate(columns[i], columns[j], turns[i], turns[j]):
                    are_orthogonal = False
        if are_orthogonal:
            break
    largest = 0.0
    for k in range(n):
        largest = max(largest, _product(columns[k], columns[k], 0))
    inverse[:] = 0.0
    small = 1e-15  # a singular value below this part of the largest one is zero, as in numpy.linalg.pinv
    for k in range(n):
        square = _product(columns[k], columns[k], 0)
        if square > small**2 * largest:
            for i in range(n):
                for j in range(n):
                    inverse[i, j] += turns[k, i] * columns[k, j] / square


@inner
def _solve(values, degree, ends, tables, coefficients, spread):
    """See :func:`solve`."""
    m, n = values.size, coefficients.size
    A, diagonal, sizes = np.empty((n + 1, m)), np.empty(n), np.empty(n)
    _fill(degree, ends, tables, A)
    for k in range(n):
        sizes[k] = 0.0
        for i in range(m):
            sizes[k] = max(sizes[k], abs(A[k, i]))
        for i in range(m):
            A[k, i] /= sizes[k]
    for i in range(m):
        A[n, i] = values[i]
    _factor(A, diagonal)
    misfit, least, largest = _product(A[n], A[n], n), np.inf, 0.0
    for k in range(n):
        least, largest = min(least, abs(diagonal[k])), max(largest, abs(diagonal[k]))
    are_independent = least > 1e-10 * largest  # the ratio is above 1e-7 in other fits
    if are_independent:
        _invert(A, diagonal, spread)
    else:  # solutions of two ends some nodes apart depend on each other: take the least coefficients
        _pseudo_invert(A, diagonal, spread)
    for k in range(n):
        coefficients[k] = _product(spread[k], A[n, :n], 0)
    if not are_independent:
        for i in range(n):
            left = diagonal[i] * coefficients[i] - A[n, i]
            for k in range(i + 1, n):
                left += A[k, i] * coefficients[k]
            misfit += left**2
    for k in range(n):
        coefficients[k] /= sizes[k]
        for i in range(n):
            spread[k, i] /= sizes[k]
    spare = m - n
    return math.sqrt(misfit / spare) * (1.0 + 10.0 / spare)


@inner
def _match(end, table, coefficients, lever):
    """The place where the far field of some solutions has no first power. See :func:`match`."""
    terms = int(end[SOLUTIONS])
    if not math.isnan(end[PLACE]):
        lever[:] = 0.0
        return end[PLACE], end[PLACE], 1
    series, factorial = np.zeros(terms), 1.0
    for q in range(terms):
        factorial *= max(q, 1)
        for j in range(q, terms):
            series[q] += table[MATCHING + q, j] * coefficients[j] / factorial
    slope = series[1]
    place = -series[0] / slope
    for _ in range(5):  # Newton's method starts within half a node distance
        value = slope = 0.0
        for q in range(terms - 1, -1, -1):
            slope = slope * place + value
            value = value * place + series[q]
        place -= value / slope
    for j in range(terms):
        lever[j], power = 0.0, 1.0
        for q in range(j + 1):
            lever[j] += power * table[MATCHING + q, j]
            power *= place / (q + 1)
        lever[j] /= slope
    if LEAST_PLACE <= place <= MOST_PLACE:
        return place, place, 1
    return np.nan, -0.5, 0


@inner
def _end_row(x, end, table, origin, least, row):
    """Fill `row` with the continuous functions of the coefficients of an end at the place x."""
    terms, exponent = int(end[SOLUTIONS]), table[LAW, 0]
    inside = end[INWARDS] * (x - end[NODE]) - origin
    powers = np.zeros(TERMS)
    if inside > AT_END:
        power = table[LAW, 1] * inside ** (exponent - 1.0)
        for q in range(terms):
            powers[q] = power / table[GAMMAS, q]
            power *= inside
    elif inside < -AT_END and table[LAW, 2] != 0.0:
        power = -table[LAW, 2] * (-inside) ** (exponent - 1.0)
        for q in range(terms):
            powers[q] = power / table[GAMMAS, q]
            power *= inside
    if not math.isnan(end[PLACE]):
        for j in range(1, terms):
            row[j - 1] = powers[j]
        return
    for j in range(terms):
        row[j] = 0.0
    for q in range(least, terms):
        shifted, factor = 0.0, 1.0  # the powers of the distance from the origin, in those from the outermost node
        for p in range(q, least - 1, -1):
            shifted += powers[p] * factor
            factor *= origin / (q - p + 1)
        for j in range(q, terms):
            row[j] += shifted * table[MATCHING + q, j]


@inner
def _row(x, last, degree, ends, tables, matches, row):
    """Fill `row` with the functions of all coefficients of a fit at the place x. `matches` is that of :func:`match`."""
    power = 1.0
    for k in range(degree + 1):
        row[k] = power
        power *= x / last
    first = degree + 1
    for e in range(ends.shape[0]):
        count = int(ends[e, SOLUTIONS]) - (0 if math.isnan(ends[e, PLACE]) else 1)
        table = tables[int(ends[e, TABLE])]
        _end_row(x, ends[e], table, matches[e, 1], int(matches[e, 2]), row[first : first + count])
        first += count


@inner
def _match_all(degree, ends, tables, coefficients, matches, levers):
    """See :func:`match`."""
    first = degree + 1
    levers[:] = 0.0
    for e in range(ends.shape[0]):
        count = int(ends[e, SOLUTIONS]) - (0 if math.isnan(ends[e, PLACE]) else 1)
        own = slice(first, first + count)
        place, origin, least = _match(ends[e], tables[int(ends[e, TABLE])], coefficients[own], levers[e, own])
        matches[e, 0], matches[e, 1], matches[e, 2] = place, origin, least
        first += count


@inner
def _norm_of(row, spread):
    """Norm of `row` (n,) times `spread` (n, n)."""
    square = 0.0
    for i in range(row.size):
        part = 0.0
        for k in range(row.size):
            part += row[k] * spread[k, i]
        square += part**2
    return math.sqrt(square)


@compiled
def least_squares(columns, values, coefficients):
    """Fit `values` (m,) by independent columns, shape (m, n). Return the standard error of the first coefficient.

    Output are the `coefficients` (n,). The error is a little enlarged if there are few values beyond the unknowns.
    """
    m, n = columns.shape
    A, diagonal, inverse = np.empty((n + 1, m)), np.empty(n), np.empty((n, n))
    for i in range(m):
        for k in range(n):
            A[k, i] = columns[i, k]
        A[n, i] = values[i]
    _factor(A, diagonal)
    _invert(A, diagonal, inverse)
    for k in range(n):
        coefficients[k] = _product(inverse[k], A[n, :n], 0)
    spare = m - n
    misfit = _product(A[n], A[n], n)
    return math.sqrt(misfit / spare) * (1.0 + 10.0 / spare) * math.sqrt(_product(inverse[0], inverse[0], 0))


@compiled
def solve(values, degree, ends, tables, coefficients, spread):
    """Fit the values of a window.

    Parameters
    ----------
    values : ndarray, shape (m,)
    degree : int
        Degree of the polynomial; -1 for none.
    ends : ndarray, shape (e, 5)
    tables : ndarray, shape (t, LAW + 1, TERMS)
    coefficients : ndarray, shape (n,)
        Output: the coefficients of the polynomial, then those of each end.
    spread : ndarray, shape (n, n)
        Output: the norm of a row times this matrix is the amplification of the errors of the values in the number that
        the row gives from the coefficients.

    Returns
    -------
    float
        Standard error of a value, a little enlarged if there are few nodes beyond the unknowns.
    """
    return _solve(values, degree, ends, tables, coefficients, spread)


@compiled
def match(degree, ends, tables, coefficients, matches, levers):
    """Find the places of the ends: the first power of the distance from the place is 0.

    Parameters
    ----------
    degree : int
    ends, tables, coefficients : ndarray
        As for :func:`solve`.
    matches : ndarray, shape (e, 3)
        Output for each end: its place, NaN if that is not plausible; the point from which distances count, which is
        the place, or half a node distance outwards; and the least power, 0 or 1. Without a plausible place there is
        the first power, too.
    levers : ndarray, shape (e, n)
        Output: change of each place for a unit of each coefficient.
    """
    _match_all(degree, ends, tables, coefficients, matches, levers)


@compiled
def series(at, degree, ends, tables, matches, rows):
    """Fill `rows` (terms - 1, n), zeros, with the power series at the end number `at` of the coefficients of a fit.

    Row k gives the coefficient of x^(a + k), for the distance x from the place. `matches` is that of :func:`match`.
    """
    first = degree + 1
    for e in range(at):
        first += int(ends[e, SOLUTIONS]) - (0 if math.isnan(ends[e, PLACE]) else 1)
    table, origin = tables[int(ends[at, TABLE])], matches[at, 1]
    for q in range(1, rows.shape[0] + 1):
        if not math.isnan(ends[at, PLACE]):
            rows[q - 1, first + q - 1] = 1.0 / table[GAMMAS, q]
            continue
        factor = 1.0  # the powers of the distance from the origin, in those from the outermost node
        for p in range(q, rows.shape[0] + 1):
            for j in range(p, rows.shape[0] + 1):
                rows[q - 1, first + j] += factor * table[MATCHING + p, j] / table[GAMMAS, q]
            factor *= origin / (p - q + 1)


@compiled
def evaluate(x, last, degree, ends, tables, matches, rows):
    """Fill `rows` (k, n) with the continuous functions of the coefficients at the places `x` (k,).

    `last` is the place of the last node of the window, `matches` the output of :func:`match`.
    """
    for i in range(x.size):
        _row(x[i], last, degree, ends, tables, matches, rows[i])


@compiled
def end_places(values, tries, ends, tables, found):
    """The place of the first end of each of many fits, and its standard error.

    Parameters
    ----------
    values : ndarray, shape (v,)
    tries : ndarray of int, shape (t, 5)
        A row has the first value of a fit, the number of nodes, the degree of the polynomial (none: -1), the first row
        of `ends`, and the row behind its last one.
    ends, tables : ndarray
        As for :func:`solve`, for all fits.
    found : ndarray, shape (t, 2)
        Output: the place, in node distances inwards from its outermost node, NaN if it is not plausible; and its error.
    """
    for t in range(tries.shape[0]):
        first, count, degree, own = tries[t, 0], tries[t, 1], tries[t, 2], ends[tries[t, 3] : tries[t, 4]]
        n = _unknowns(degree, own)
        coefficients, spread, levers = np.empty(n), np.empty((n, n)), np.empty((own.shape[0], n))
        matches = np.empty((own.shape[0], 3))
        scatter = _solve(values[first : first + count], degree, own, tables, coefficients, spread)
        _match_all(degree, own, tables, coefficients, matches, levers)
        found[t, 0], found[t, 1] = matches[0, 0], scatter * _norm_of(levers[0], spread)


@compiled
def value_errors(values, tries, ends, tables, at, found):
    """The standard error of the fitted function of each of many fits.

    Parameters
    ----------
    values, tries, ends, tables : ndarray
        As for :func:`end_places`.
    at : ndarray, shape (t,)
        The place, in node distances from the first node. NaN takes the fitted place of the first end. Then the error
        has another part, from the error of this place and the slope beyond the end.
    found : ndarray, shape (t,)
        Output: the error; NaN if the end has no plausible place.
    """
    for t in range(tries.shape[0]):
        first, count, degree, own = tries[t, 0], tries[t, 1], tries[t, 2], ends[tries[t, 3] : tries[t, 4]]
        n = _unknowns(degree, own)
        coefficients, spread, levers = np.empty(n), np.empty((n, n)), np.empty((own.shape[0], n))
        matches, row, beside = np.empty((own.shape[0], 3)), np.empty(n), np.empty(n)
        scatter = _solve(values[first : first + count], degree, own, tables, coefficients, spread)
        _match_all(degree, own, tables, coefficients, matches, levers)
        x = own[0, NODE] + own[0, INWARDS] * matches[0, 0] if math.isnan(at[t]) else at[t]
        if math.isnan(x):
            found[t] = np.nan
            continue
        _row(x, count - 1.0, degree, own, tables, matches, row)
        found[t] = scatter * _norm_of(row, spread)
        if math.isnan(at[t]):
            step = 0.1  # node distances; the slope is that of the smooth side
            _row(x - own[0, INWARDS] * step, count - 1.0, degree, own, tables, matches, beside)
            for k in range(n):
                beside[k] -= row[k]
            slope = abs(_product(beside, coefficients, 0)) / step
            found[t] += slope * scatter * _norm_of(levers[0], spread)
