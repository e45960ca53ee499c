"""Compiled: Lemke's method for linear complementarity problems.

A linear complementarity problem asks for vectors w and z with

    w = q + M z,    w >= 0,    z >= 0,    w_i z_i = 0 for each i.

Lemke's method adds an artificial variable times a covering vector d > 0, so that w = q + M z + d z_0 >= 0. It then
exchanges variables until z_0 is zero. A lexicographic rule breaks ties, so that no set of basic variables is met twice
and the method ends: with a solution or on a ray (Cottle, Pang and Stone, The Linear Complementarity Problem, section
4.4). On a ray there may be a solution all the same, unless M belongs to certain classes of matrices.
"""

from __future__ import annotations

import numpy as np

from fastpin.runtime.jit import compiled, inner


@inner
def _lexically_smaller(tableau, first, second, enter):
    """Whether row `first` over its pivot comes before row `second` over its pivot, entry by entry."""
    k = tableau.shape[0]
    for j in range(k):
        difference = tableau[first, j] / tableau[first, enter] - tableau[second, j] / tableau[second, enter]
        if difference != 0.0:
            return difference < 0.0
    return False


@inner
def _leaving_row(tableau, basis, enter):
    """The row that leaves when the column `enter` enters; -1 on a ray."""
    k = tableau.shape[0]
    artificial, last = 2 * k, 2 * k + 1
    largest = 0.0
    for i in range(k):
        largest = max(largest, abs(tableau[i, enter]))
    small = 1e-11 * largest  # smaller entries are zero
    least, chosen = np.inf, -1
    for i in range(k):
        if tableau[i, enter] > small:
            least = min(least, tableau[i, last] / tableau[i, enter])
    if least == np.inf:
        return chosen
    for i in range(k):
        if tableau[i, enter] > small:
            ratio = tableau[i, last] / tableau[i, enter]
            if ratio <= least + 1e-11 * max(abs(least), abs(ratio)):  # equal ratios
                if basis[i] == artificial:
                    return i
                if chosen < 0 or _lexically_smaller(tableau, i, chosen, enter):
                    chosen = i
    return chosen


@inner
def _pivot(tableau, basis, row, enter):
    """Let the variable `enter` take the place of the basic variable of `row`."""
    k, width = tableau.shape
    factor = tableau[row, enter]
    for j in range(width):
        tableau[row, j] /= factor
    tableau[row, enter] = 1.0
    for i in range(k):
        factor = tableau[i, enter]
        if i != row and factor != 0.0:
            for j in range(width):
                tableau[i, j] -= factor * tableau[row, j]
            tableau[i, enter] = 0.0
            tableau[i, width - 1] = max(tableau[i, width - 1], 0.0)  # below zero by rounding only
    basis[row] = enter


@compiled
def lemke(matrix, vector, cover, most_pivots, tableau, basis, z):
    """Solve w = vector + matrix z, w >= 0, z >= 0, w z = 0 by Lemke's method.

    Parameters
    ----------
    matrix : ndarray, shape (k, k)
    vector : ndarray, shape (k,)
    cover : ndarray, shape (k,)
        The covering vector, positive.
    most_pivots : int
    tableau : ndarray, shape (k, 2 k + 2), row by row
        Memory. Its columns are w, z, the artificial variable and the right-hand side.
    basis : ndarray of int, shape (k,)
        Memory: the column of the basic variable of each row.
    z : ndarray, shape (k,)
        Output, where the problem is solved.

    Returns
    -------
    bool
        Whether the problem is solved. Otherwise the method has ended on a ray, or needs more pivots than allowed.
    """
    k = vector.size
    artificial, last = 2 * k, 2 * k + 1
    tableau[:, :] = 0.0
    z[:] = 0.0
    lowest, row = 0.0, -1
    for i in range(k):
        tableau[i, i] = 1.0
        for j in range(k):
            tableau[i, k + j] = -matrix[i, j]
        tableau[i, artificial] = -cover[i]
        tableau[i, last] = vector[i]
        basis[i] = i
        if not np.isfinite(vector[i]):
            return False
        if vector[i] / cover[i] <= lowest and vector[i] < 0.0:  # of equal ones the last: lexically smallest
            lowest, row = vector[i] / cover[i], i
    if row < 0:
        return True
    for i in range(k):  # the first exchange makes all right-hand sides positive
        if i != row:
            factor = cover[i] / cover[row]
            for j in range(last + 1):
                tableau[i, j] -= factor * tableau[row, j]
            tableau[i, last] = max(tableau[i, last], 0.0)
    factor = tableau[row, artificial]
    for j in range(last + 1):
        tableau[row, j] /= factor
    basis[row] = artificial
    enter = k + row  # the complement of the variable that left
    for _ in range(most_pivots):
        row = _leaving_row(tableau, basis, enter)
        if row < 0:
            return False
        left = basis[row]
        _pivot(tableau, basis, row, enter)
        if left == artificial:
            for i in range(k):
                if basis[i] >= k:
                    z[basis[i] - k] = tableau[i, last]
            return True
        enter = left + k if left < k else left - k
    return False
