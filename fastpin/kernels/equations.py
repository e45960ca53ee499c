"""Compiled solution of the equations of given statuses, for few unknowns.

LAPACK solves them as fast. But NumPy takes some forty calls to gather the equations of ten nodes, ten times as long.
"""

from __future__ import annotations

import numpy as np

from fastpin.kernels.status import OPEN, STICK
from fastpin.runtime.jit import compiled, inner

MOST_UNKNOWNS = 48
"""Unknown tractions, at most, for which this takes less time than LAPACK."""


@inner
def _norm(matrix, first, size):
    """The largest sum of sizes in a column, of `size` columns of a matrix from the column `first` on."""
    largest = 0.0
    for column in range(first, first + size):
        total = 0.0
        for row in range(size):
            total += abs(matrix[row, column])
        if total > largest or total != total:  # NaN stays
            largest = total
    return largest


@inner
def _eliminate(matrix):
    """Solve the equations A X = B in place, by elimination with row pivots.

    `matrix` (k, l) holds A in its first k columns, and B in the others. B becomes X, which is not finite where A is
    singular.
    """
    size, columns = matrix.shape
    for k in range(size):
        pivot = k
        for row in range(k + 1, size):
            if abs(matrix[row, k]) > abs(matrix[pivot, k]):
                pivot = row
        if pivot != k:
            for column in range(columns):
                matrix[k, column], matrix[pivot, column] = matrix[pivot, column], matrix[k, column]
        for row in range(k + 1, size):
            factor = matrix[row, k] / matrix[k, k]
            for column in range(k + 1, columns):
                matrix[row, column] -= factor * matrix[k, column]
    for k in range(size - 1, -1, -1):
        for row in range(k + 1, size):
            factor = matrix[k, row]
            for column in range(size, columns):
                matrix[k, column] -= factor * matrix[row, column]
        for column in range(size, columns):
            matrix[k, column] /= matrix[k, k]


@compiled
def solve_few(operator, equations, loaded, forces, rest_gap, stuck_slip, width, solution):
    """Solve for tractions and motion under given statuses.

    The unknowns are N at closed nodes, T at sticking nodes, and the motion. T = -status mu N where a node slips.

    Parameters
    ----------
    operator : ndarray, shape (2n, 2n), column by column
    equations : Equations
    loaded : ndarray, shape (2n,)
        Gap and slip of the load.
    forces : ndarray, shape (m,)
        Right sides of the conditions of equilibrium.
    rest_gap, stuck_slip : ndarray, shape (n,)
        The rest gap, and the slip that sticking nodes hold.
    width : float
        Typical weight of a node. Unknowns are forces: entries are then of order one, and the condition has a meaning.
    solution : ContactValues
        With the statuses. All other arrays are set.

    Returns
    -------
    float
        Reciprocal condition number, in the norm of column sums. It is not above 0 where nothing holds the pin.
    """
    status, n, motions = solution.status, solution.status.size, solution.motion.size
    variables, count = np.empty(2 * n, np.int64), 0
    for variable in range(2 * n):
        if status[variable % n] == STICK or (variable < n and status[variable] != OPEN):
            variables[count] = variable
            count += 1
    size = count + motions
    matrix = np.zeros((size, 2 * size + 1))  # the equations, the right side, and a unit matrix for the condition
    for j in range(count):
        variable = variables[j]
        slides = variable < n and status[variable] != STICK
        coupling = -equations.friction[variable] * status[variable] if slides else 0.0
        for i in range(count):
            matrix[i, j] = operator[variables[i], variable] / width
            if slides:
                matrix[i, j] += coupling * operator[variables[i], n + variable] / width
        for k in range(motions):
            matrix[j, count + k] = equations.motion[variable, k]
            matrix[count + k, j] = equations.equilibrium[k, variable] / width
            if slides:
                matrix[count + k, j] += coupling * equations.equilibrium[k, n + variable] / width
        held = -stuck_slip[variable - n] if variable >= n else rest_gap[variable]
        matrix[j, size] = -(loaded[variable] + held)
    for k in range(motions):
        matrix[count + k, size] = forces[k]
        for j in range(motions):
            matrix[count + k, count + j] = equations.motion_rows[k, j]
    for k in range(size):
        matrix[k, size + 1 + k] = 1.0
    norm = _norm(matrix, 0, size)
    _eliminate(matrix)

    pressure, shear, gap, slip, motion = solution.pressure, solution.shear, solution.gap, solution.slip, solution.motion
    for k in range(motions):
        motion[k] = matrix[count + k, size]
    for i in range(n):
        pressure[i], shear[i], gap[i], slip[i] = 0.0, 0.0, loaded[i] + rest_gap[i], loaded[n + i]
        for k in range(motions):
            gap[i] += equations.motion[i, k] * motion[k]
            slip[i] += equations.motion[n + i, k] * motion[k]
    for j in range(count):
        variable, traction = variables[j], matrix[j, size] / width
        if variable >= n:
            shear[variable - n] = traction
        else:
            pressure[variable] = traction
            if status[variable] != STICK:
                shear[variable] = -equations.friction[variable] * status[variable] * traction
    for i in range(n):
        if status[i] != OPEN:
            for row in range(n):
                gap[row] += operator[row, i] * pressure[i] + operator[row, n + i] * shear[i]
                slip[row] += operator[n + row, i] * pressure[i] + operator[n + row, n + i] * shear[i]
    return 1.0 / (norm * _norm(matrix, size + 1, size))
