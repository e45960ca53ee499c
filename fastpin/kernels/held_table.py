"""The compiled table of a held contact of neighbouring, equally spaced nodes, in O(n^2) operations.

The closed nodes are a run 0 to m-1 that sticks. T_ij is the block of the operator of two nodes, and b_j the block
column of T of node j in the rows of the run. The other nodes j, before and after the run, have the responses

    x_j = T^-1 b_j,        Y_ij = T_ij - b_i^T x_j.

Blocks depend on the distance of two nodes, so one response gives the next. A is the first block column of the inverse:

    x_j+1[i] = x_j[i-1] + x_m[i] x_j[m-1] + A[i] Y_-1,j,
    Y_i+1,j+1 = Y_ij + Y_i+1,m x_j[m-1] - x_i+1[0]^T Y_-1,j.

From the other end the nodes look the same with the shear turned round, D = diag(1, -1). So nodes before the run are
mirror images of nodes after it: x_-1-q[i] = D x_m+q[m-1-i] D, and likewise for Y. Then the pin moves, by the
Schur complement of the equations of equilibrium.

A block [[00, 01], [10, 11]] is held as four numbers. :mod:`fastpin.kernels.toeplitz` has the inverse, and the same
recurrences for runs of thousands of nodes.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.kernels.toeplitz import TURNED, invert
from fastpin.runtime.jit import compiled, inner


@inner
def _before(entries, first, away, x):
    """The block Y of node j and a node before the run, `first` nodes before its first one and `away` before node j.

    `x` (4, m) is the response of node j. Returns the four numbers of the block.
    """
    direct, other, cross = entries[0], entries[1], entries[2]
    y00, y01, y10, y11 = direct[away], -cross[away], cross[away], other[away]
    for k in range(x.shape[1]):
        f, s, c = direct[first + k], other[first + k], cross[first + k]
        y00 -= f * x[0, k] - c * x[2, k]
        y01 -= f * x[1, k] - c * x[3, k]
        y10 -= c * x[0, k] + s * x[2, k]
        y11 -= c * x[1, k] + s * x[3, k]
    return y00, y01, y10, y11


@inner
def _after(entries, away, x):
    """The block Y of node m and a node j, `away` nodes beyond it, from the response x (4, m) of node j."""
    direct, other, cross, m = entries[0], entries[1], entries[2], x.shape[1]
    y00, y01, y10, y11 = direct[away], -cross[away], cross[away], other[away]
    for k in range(m):
        f, s, c = direct[m - k], other[m - k], cross[m - k]
        y00 -= f * x[0, k] + c * x[2, k]
        y01 -= f * x[1, k] + c * x[3, k]
        y10 -= s * x[2, k] - c * x[0, k]
        y11 -= s * x[3, k] - c * x[1, k]
    return y00, y01, y10, y11


@inner
def _respond(entries, core, x, before, after):
    """Set the responses x (q, 4, m) of the nodes m to m+q-1, and the blocks Y_-1,j and Y_mj, both (4, q)."""
    m, kinds = x.shape[2], x.shape[1] // 2
    for r in range(kinds):
        for i in range(m):
            x[0, 2 * r, i] = x[0, 2 * r + 1, i] = 0.0
        for k in range(m):
            f, s, c = entries[0, m - k], entries[1, m - k], entries[2, m - k]
            for i in range(m):  # the core is symmetric
                x[0, 2 * r, i] += core[k, r * m + i] * f + core[m + k, r * m + i] * c
                x[0, 2 * r + 1, i] += core[m + k, r * m + i] * s - core[k, r * m + i] * c
    for q in range(x.shape[0]):
        y00, y01, y10, y11 = _before(entries, 1, m + 1 + q, x[q])
        before[0, q], before[1, q], before[2, q], before[3, q] = y00, y01, y10, y11
        after[0, q], after[1, q], after[2, q], after[3, q] = _after(entries, q, x[q])
        if q + 1 == x.shape[0]:
            break
        p00, p01, p10, p11 = x[q, 0, m - 1], x[q, 1, m - 1], x[q, 2, m - 1], x[q, 3, m - 1]
        for r in range(kinds):
            u, v = 2 * r, 2 * r + 1
            for i in range(m):
                a, b = core[0, r * m + i], core[m, r * m + i]
                x[q + 1, u, i] = (x[0, u, i] * p00 + x[0, v, i] * p10) + (a * y00 + b * y10)
                x[q + 1, v, i] = (x[0, u, i] * p01 + x[0, v, i] * p11) + (a * y01 + b * y11)
            for i in range(1, m):
                x[q + 1, u, i] += x[q, u, i - 1]
                x[q + 1, v, i] += x[q, v, i - 1]


@inner
def _extend(row, column, down, on, out):
    """Fill `out` (rows, columns) by out[i, j] = out[i-1, j-1] + down[:, i] @ on[:, j-1], from first row and column."""
    for j in range(out.shape[1]):
        out[0, j] = row[j]
    for i in range(1, out.shape[0]):
        above, here = out[i - 1], out[i]  # two arrays: the loop over them is vector code
        a, b, c, d = down[0, i], down[1, i], down[2, i], down[3, i]
        here[0] = column[i]
        for j in range(1, here.size):
            here[j] = above[j - 1] + ((a * on[0, j - 1] + b * on[1, j - 1]) + (c * on[2, j - 1] + d * on[3, j - 1]))


@inner
def _fill_responses(x, low, matrix):
    """Write minus the responses, and their transpose, into the columns and the rows of the other nodes."""
    m, kinds = x.shape[2], x.shape[1] // 2
    beside = (matrix.shape[0] - 3) // 2 - m
    for s in range(kinds):
        for q in range(beside):
            column = 2 * m + s * beside + q
            for r in range(kinds):
                k, row = 2 * r + s, r * m
                if q >= low:
                    for i in range(m):
                        matrix[row + i, column] = -x[q - low, k, i]
                else:
                    for i in range(m):
                        matrix[row + i, column] = -TURNED[k] * x[low - 1 - q, k, m - 1 - i]
    for column in range(2 * m):
        for row in range(2 * m, 2 * m + 2 * beside):
            matrix[row, column] = -matrix[column, row]


@inner
def _fill_complement(entries, x, before, after, low, matrix):
    """Write the blocks Y of the other nodes: after the run, before it in the mirror, and across it."""
    most, kinds, m = x.shape[0], x.shape[1] // 2, x.shape[2]
    beside = (matrix.shape[0] - 3) // 2 - m
    beyond, far = beside - low, np.empty((4, beside - low))
    for q in range(beyond if low else 0):
        far[0, q], far[1, q], far[2, q], far[3, q] = _before(entries, low, m + q + low, x[q])
    down, on, same, over = np.empty((4, most)), np.empty((4, most)), np.empty((most, most)), np.empty((low, beyond))
    for r in range(kinds):
        for s in range(kinds):
            top, left = 2 * m + s * beside, 2 * m + r * beside  # rows of s, columns of r: the complement is symmetric
            for q in range(most):
                down[0, q], down[1, q] = after[r, q], after[2 + r, q]
                down[2, q], down[3, q] = -x[q, r, 0], -x[q, 2 + r, 0]
                on[0, q], on[1, q] = x[q, s, m - 1], x[q, 2 + s, m - 1]
                on[2, q], on[3, q] = before[s, q], before[2 + s, q]
            _extend(after[2 * r + s], after[2 * s + r], down, on, same)
            for i in range(beyond):
                for j in range(beyond):
                    matrix[top + low + j, left + low + i] = same[i, j]
            for i in range(low):
                for j in range(low):
                    matrix[top + low - 1 - j, left + low - 1 - i] = TURNED[2 * r + s] * same[i, j]
            for p in range(low):
                q = low - 1 - p
                down[0, p], down[1, p] = TURNED[2 * r] * before[r, q], TURNED[2 * r + 1] * before[2 + r, q]
                down[2, p], down[3, p] = -TURNED[r] * x[q, r, m - 1], -TURNED[2 + r] * x[q, 2 + r, m - 1]
            if low and beyond:
                _extend(far[2 * r + s], down[s], down, on, over)
            for i in range(low):
                for j in range(beyond):
                    matrix[top + low + j, left + i] = matrix[left + i, top + low + j] = over[i, j]


@inner
def _invert_small(matrix, inverse):
    """Set `inverse` (3, 3) by cofactors, and return the condition number by the Frobenius norm."""
    square, of_inverse = 0.0, 0.0
    for i in range(3):
        for j in range(3):
            p, q, r, s = (j + 1) % 3, (j + 2) % 3, (i + 1) % 3, (i + 2) % 3
            inverse[i, j] = matrix[p, r] * matrix[q, s] - matrix[p, s] * matrix[q, r]
    determinant = matrix[0, 0] * inverse[0, 0] + matrix[0, 1] * inverse[1, 0] + matrix[0, 2] * inverse[2, 0]
    for i in range(3):
        for j in range(3):
            inverse[i, j] /= determinant
            square += matrix[i, j] ** 2
            of_inverse += inverse[i, j] ** 2
    return math.sqrt(square * of_inverse)


@inner
def _add_motion(low, m, motion, equilibrium, motion_rows, matrix):
    """Let the pin move: add the products with the Schur complement to the table. Returns its condition number."""
    size = matrix.shape[0]
    n, count = motion.shape[0] // 2, 2 * m
    end, beside = size - 3, n - m
    turned, moving, small, complement = np.zeros((3, size)), np.zeros((3, size)), np.empty((3, 3)), motion_rows.copy()
    moves, carries = np.empty((3, count)), np.empty((3, count))
    for k in range(3):
        for i in range(count):
            row = (i // m) * n + low + i % m
            moves[k, i], carries[k, i] = motion[row, k], equilibrium[k, row]
    for i in range(count):
        a, b, c, d, e, f = moves[0, i], moves[1, i], moves[2, i], carries[0, i], carries[1, i], carries[2, i]
        for row in range(end):  # responses of the others have the opposite sign in rows and columns
            value = matrix[row, i]
            turned[0, row] -= value * a
            turned[1, row] -= value * b
            turned[2, row] -= value * c
            moving[0, row] += value * d
            moving[1, row] += value * e
            moving[2, row] += value * f
    for column in range(count, end):
        node = (column - count) % beside
        row = (column - count) // beside * n + (node if node < low else node + m)
        for k in range(3):
            turned[k, column] += motion[row, k]
            moving[k, column] = equilibrium[k, row] - moving[k, column]
    for k in range(3):
        for j in range(3):
            for i in range(count):
                complement[k, j] += carries[k, i] * turned[j, i]
    condition = _invert_small(complement, small)
    for column in range(end):
        g0, g1, g2 = moving[0, column], moving[1, column], moving[2, column]
        for k in range(3):
            moving[k, column] = -(small[k, 0] * g0 + small[k, 1] * g1 + small[k, 2] * g2)
    for k in range(3):
        turned[k, end + k] = 1.0
        for j in range(3):
            moving[k, end + j] = small[k, j]
        for i in range(size):
            matrix[end + k, i] = matrix[i, end + k] = 0.0
    for column in range(size):
        g0, g1, g2 = moving[0, column], moving[1, column], moving[2, column]
        for row in range(size):
            matrix[row, column] += turned[0, row] * g0 + turned[1, row] * g1 + turned[2, row] * g2
    return condition


@inner
def _larger(largest, value):
    """The larger one of a number and the size of a value; NaN if one of them is NaN."""
    size = abs(value)
    return size if size > largest or size != size else largest


@inner
def _error(entries, low, m, motion, equilibrium, motion_rows, matrix):
    """The largest error in the equations of the closed nodes and of equilibrium, for one load of order one."""
    size, n = matrix.shape[0], motion.shape[0] // 2
    count, end, error = 2 * m, size - 3, 0.0
    given, answer, left = np.cos(np.arange(1.0 * size)), np.zeros(size), np.zeros(count)
    for column in range(size):
        if column < count or column >= end:
            for row in range(size):
                answer[row] += matrix[row, column] * given[column]
    for away in range(m):
        first, second, cross = entries[0, away], entries[1, away], entries[2, away]
        for i in range(m - away):
            left[i + away] += first * answer[i] + cross * answer[m + i]
            left[m + i + away] += second * answer[m + i] - cross * answer[i]
        for i in range(m - away if away else 0):
            left[i] += first * answer[i + away] - cross * answer[m + i + away]
            left[m + i] += second * answer[m + i + away] + cross * answer[i + away]
    for i in range(count):
        row = (i // m) * n + low + i % m
        for k in range(3):
            left[i] += motion[row, k] * answer[end + k]
            given[end + k] -= equilibrium[k, row] * answer[i]
        error = _larger(error, left[i] - given[i])
    for k in range(3):
        for j in range(3):
            given[end + k] -= motion_rows[k, j] * answer[end + j]
        error = _larger(error, given[end + k])
    return error


@compiled
def fill(entries, low, count, motion, equilibrium, motion_rows, matrix):
    """Fill the table of a run of `count` nodes that stick, from the node `low` on.

    Parameters
    ----------
    entries : ndarray, shape (3, n+1)
        The operator by the distance of two nodes: gap of N, slip of T, and gap of T. The last column is not used.
    low, count : int
    motion : ndarray, shape (2n, 3)
        Maps the motion of the pin to gap and slip.
    equilibrium : ndarray, shape (3, 2n)
    motion_rows : ndarray, shape (3, 3)
        Map the tractions, and the motion, to the conditions of equilibrium.
    matrix : ndarray, shape (2n+3, 2n+3), column by column
        The sequence of rows and columns is that of closed nodes (N, T), of open nodes (N, T), and of the motion. See
        ``HeldTable``.

    Returns
    -------
    (float, float)
        The condition number of the equations of the motion, which is large or NaN where the nodes hardly hold the pin;
        and the largest error in the equations of the closed nodes and of equilibrium, for one load of order one.
    """
    n, m = motion.shape[0] // 2, count
    core, most = np.empty((2 * m, 2 * m)), max(low, n - m - low)
    invert(entries[0, :m], entries[1, :m], entries[2, :m], core)
    x, before, after = np.empty((most, 4, m)), np.empty((4, most)), np.empty((4, most))
    _respond(entries, core, x, before, after)
    for column in range(2 * m):
        for row in range(2 * m):
            matrix[row, column] = core[column, row]
    _fill_responses(x, low, matrix)
    _fill_complement(entries, x, before, after, low, matrix)
    condition = _add_motion(low, m, motion, equilibrium, motion_rows, matrix)
    return condition, _error(entries, low, m, motion, equilibrium, motion_rows, matrix)
