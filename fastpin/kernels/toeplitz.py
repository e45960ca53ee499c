"""Compiled inverse of symmetric block Toeplitz matrices with 2 x 2 blocks, in O(n^2).

The operator of m sticking neighbours on equally spaced nodes is such a matrix T: its entries depend on the distance of
two nodes only. Whittle's recursion, the block form of Levinson's recursion, gives the first and last block columns of
the inverse. A recurrence along the diagonals then gives the whole inverse (Gohberg, Semencul and Heinig). A
factorisation takes O(m^3). The responses of the other nodes have recurrences of the same kind
(:class:`NeighbourResponses`).

From the other end the nodes look the same with the shear turned round, D = diag(1, -1). So blocks at opposite distances
are B(-k) = D B(k) D. The last block column of the inverse is the first block column in reverse, D F D.

A column of 2 x 2 blocks is held as an array (4, m). Its rows are the entries 00, 01, 10 and 11 of the blocks.
"""

from __future__ import annotations

import numpy as np

from fastpin.runtime.jit import compiled, inner

TURNED = np.array([1.0, -1.0, -1.0, 1.0])
"""Signs of the entries of a block B in D B D."""


@inner
def _predictor(first, second, cross, F, error):
    """Compute the block column F with T F = (E, 0, ..., 0), by Whittle's recursion. F begins with the unit matrix.

    `first`, `second` (even) and `cross` (odd), shape (m,), are the entries [[first, cross], [-cross, second]] of T at
    the distances 0 to m - 1. Output are `F` (4, m) and the block E in `error` (4,).
    """
    F[:, :] = 0.0
    F[0, 0] = F[3, 0] = 1.0
    e00, e01, e10, e11 = first[0], cross[0], -cross[0], second[0]
    for k in range(1, first.size):
        # The block g is T times the column, extended by a zero block, in the new block row.
        g00 = g01 = g10 = g11 = 0.0
        for j in range(k):
            a, b, c = first[k - j], cross[k - j], second[k - j]
            g00 += a * F[0, j] + b * F[2, j]
            g01 += a * F[1, j] + b * F[3, j]
            g10 += c * F[2, j] - b * F[0, j]
            g11 += c * F[3, j] - b * F[1, j]
        # With D p = E^-1 D g, the column F_j - D F_{k-j} D p makes g zero; two blocks at a time.
        d = e00 * e11 - e01 * e10
        p00, p01 = (e11 * g00 + e01 * g10) / d, (e11 * g01 + e01 * g11) / d
        p10, p11 = (e00 * g10 + e10 * g00) / d, (e00 * g11 + e10 * g01) / d
        for j in range(k // 2 + 1):
            i = k - j
            s, t, u, v = F[0, j], F[1, j], F[2, j], F[3, j]
            w, x, y, z = F[0, i], F[1, i], F[2, i], F[3, i]
            F[0, j], F[1, j] = s - w * p00 + x * p10, t - w * p01 + x * p11
            F[2, j], F[3, j] = u + y * p00 - z * p10, v + y * p01 - z * p11
            F[0, i], F[1, i] = w - s * p00 + t * p10, x - s * p01 + t * p11
            F[2, i], F[3, i] = y + u * p00 - v * p10, z + u * p01 - v * p11
        # the new E is E - D g D p
        e00, e01 = e00 - g00 * p00 + g01 * p10, e01 - g00 * p01 + g01 * p11
        e10, e11 = e10 + g10 * p00 - g11 * p10, e11 + g10 * p01 - g11 * p11
    error[0], error[1], error[2], error[3] = e00, e01, e10, e11


@compiled
def _fill(before, on, top, left, out):
    """Fill a block of `out` by out[i, j] = out[i - 1, j - 1] + before[:, i - 1] @ on[:, j - 1].

    The block begins in the row `top` and the column `left` of `out`. Its first row and its first column are given.
    `before` is (4, rows - 1), `on` (4, columns - 1).
    """
    stop = left + 1 + on.shape[1]
    for i in range(before.shape[1]):
        a, b, c, d = before[0, i], before[1, i], before[2, i], before[3, i]
        above, here = out[top + i, left:stop], out[top + i + 1, left:stop]  # in rows of C, the next loop is vector code
        for j in range(on.shape[1]):
            here[j + 1] = above[j] + ((a * on[0, j] + b * on[1, j]) + (c * on[2, j] + d * on[3, j]))


@compiled
def fill_column(first, second, cross, half_hat, closed, rows, column, out):
    """Fill `out` (r,) with the entries of one `column` of the operator of equally spaced nodes, at `rows` (r,).

    Rows belong to (gap, slip), columns to (N, T). By the distance of two nodes, `first`, `second` and `cross` (n,) are
    the entries (gap, N), (slip, T) and (gap, T). On an arc, `half_hat` (4, n) has the column of the first half hat, in
    the order (gap, N), (gap, T), (slip, N), (slip, T). On a circle (`closed`) it is not used.
    """
    n = first.size
    of_shear = column >= n
    node = column - n if of_shear else column
    whole = closed or (node != 0 and node != n - 1)
    for i in range(rows.size):
        of_slip = rows[i] >= n
        away = (rows[i] - n if of_slip else rows[i]) - node
        distance = abs(away)
        if whole:
            if of_slip == of_shear:
                out[i] = second[distance] if of_slip else first[distance]
            else:  # odd in the distance; the slip of N is the opposite of the gap of T
                out[i] = cross[distance] if (away >= 0) == of_shear else -cross[distance]
        else:  # the last half hat mirrors the first one
            value = half_hat[2 * int(of_slip) + int(of_shear), distance]
            out[i] = -value if node != 0 and of_slip != of_shear else value


@compiled
def add_turned_column(by_distance, turn, factor, rows, column, out):
    """Add one `column` of the term of a laminate, (T51), at `rows` (r,) to `out` (r,).

    Rows belong to (gap, slip), columns to (N, T). The term of two nodes is k `factor` turn_i turn_j, with the number k
    of their distance in `by_distance` (n,), and `turn` (n,) complex.
    """
    n = turn.size
    of_shear = column >= n
    node = column - n if of_shear else column
    weight = factor * turn[node]
    real, imag = (-weight.imag, weight.real) if of_shear else (weight.real, weight.imag)
    for i in range(rows.size):
        of_slip = rows[i] >= n
        row = rows[i] - n if of_slip else rows[i]
        u, v = turn[row].real, turn[row].imag
        moved = -(real * v + imag * u) if of_slip else real * u - imag * v
        out[i] += by_distance[abs(row - node)] * moved


@compiled
def invert(first, second, cross, out):
    """Fill `out` (2m, 2m) with the inverse; see :func:`inverse`."""
    m = first.size
    forward, column, error = np.empty((4, m)), np.empty((4, m)), np.empty(4)
    _predictor(first, second, cross, forward, error)
    size = error[0] * error[3] - error[1] * error[2]
    for j in range(m):  # the first block column of the inverse is the block column F E^-1
        for r in range(0, 4, 2):
            column[r, j] = (forward[r, j] * error[3] - forward[r + 1, j] * error[2]) / size
            column[r + 1, j] = (forward[r + 1, j] * error[0] - forward[r, j] * error[1]) / size
    before, after = np.empty((4, m - 1)), np.empty((4, m - 1))
    for r in range(2):
        for s in range(2):
            for j in range(m):  # T is symmetric: the first block row is the first block column transposed
                out[r * m, s * m + j], out[r * m + j, s * m] = column[2 * s + r, j], column[2 * r + s, j]
            for j in range(m - 1):
                for k in range(2):
                    row, place = 2 * r + k, 2 * s + k
                    before[k, j], before[2 + k, j] = column[row, j + 1], TURNED[row] * column[row, m - 1 - j]
                    after[k, j], after[2 + k, j] = forward[place, j + 1], -TURNED[place] * forward[place, m - 1 - j]
            _fill(before, after, r * m, s * m, out)


def inverse(first: np.ndarray, second: np.ndarray, cross: np.ndarray) -> np.ndarray:
    """Inverse of the symmetric matrix [[first, cross], [-cross, second]] of three Toeplitz matrices, shape (2m, 2m).

    The arguments, shape (m,) each, are the first columns of the three matrices. `first` and `second` are symmetric,
    `cross` is antisymmetric. The inverse is not finite if a leading block is singular.
    """
    out = np.empty((2 * first.size, 2 * first.size))
    invert(first, second, cross, out)
    return out


class NeighbourResponses:
    """Responses of a run of neighbours to tractions at the other nodes, without a product of large matrices.

    The nodes of the run are 0 to m-1. All other nodes j are free. T_ij is the block of T of two nodes, and b_j is the
    block column of T of node j in the rows of the run. The responses are, for all other nodes,

        x_j = T^-1 b_j,        Y_ij = T_ij - b_i^T x_j.

    The column b_j+1 is b_j moved on by one node. With A and Z the first and the last block column of the inverse,

        x_j+1[i] = x_j[i-1] + x_m[i] x_j[m-1] + A[i] Y_-1,j,
        Y_i+1,j+1 = Y_ij + Y_i+1,m x_j[m-1] - x_i+1[0]^T Y_-1,j,

    and likewise from the other end. Products with few columns give the right-hand sides for all j:
    x_j[0] = A^T b_j, x_j[m-1] = Z^T b_j, Y_-1,j and Y_mj.

    Parameters
    ----------
    entries : ndarray, shape (3, n)
        First, second and cross as for :func:`inverse`, for all n nodes.
    core : ndarray, shape (2m, 2m)
        The inverse of T in the run.
    low : int
        Number of nodes before the run.
    """

    def __init__(self, entries: np.ndarray, core: np.ndarray, low: int) -> None:
        n, m = entries.shape[1], core.shape[0] // 2
        self._entries = np.zeros((3, n + 1))  # the last entry, farther than any two nodes, is not used
        self._entries[:, :n] = entries
        self._m, self._low, self._others = m, low, np.r_[:low, low + m : n] - low
        self._back = slice(low - 1, None, -1) if low else slice(0, 0)  # the nodes before the run, from the run outwards
        corners = core[:, [0, m]], core[:, [m - 1, 2 * m - 1]]
        columns = np.hstack([self._block_column(np.arange(m), node) for node in (-1, m, -low)])
        neighbours = np.split(core @ columns, 3, axis=1)
        seeds = np.hstack([*corners, *neighbours])
        at_others = self._products(seeds).reshape(2, n - m, 5, 2)
        # Blocks stand as [kind of the node, node, kind of the column].
        self._corner = [corner.reshape(2, m, 2) for corner in corners]
        self._neighbour = [x.reshape(2, m, 2) for x in neighbours[:2]]
        self._end = [at_others[:, :, k] for k in (0, 1)]  # x_j[0], x_j[m-1]
        self._across = [
            self._block_column(self._others, node).reshape(2, n - m, 2) - at_others[:, :, k]
            for k, node in ((2, -1), (3, m), (4, -low))
        ]  # Y_j,-1, Y_jm and Y_j,-low

    def responses(self) -> np.ndarray:
        """The x_j of all other nodes, shape (2m, 2(n-m)). Rows and columns of the first kind come first."""
        (before, after, _), low, w = self._across, self._low, self._others.size
        out, back = np.empty((2, self._m, 2, w)), self._back
        for r in range(2):
            for s in range(2):
                x, corner = self._neighbour[1][r], self._corner[0][r]
                _extend(
                    out[r, :, s, low:], self._end[0][s, low:, r], x[:, s],
                    np.hstack([x, corner]), np.hstack([self._end[1][s, low:], before[s, low:]]),
                )  # fmt: skip
                x, corner = self._neighbour[0][r, ::-1], self._corner[1][r, ::-1]
                _extend(
                    out[r, ::-1, s, back], self._end[1][s, back, r], x[:, s],
                    np.hstack([x, corner]), np.hstack([self._end[0][s, back], after[s, back]]),
                )  # fmt: skip
        return out.reshape(2 * self._m, 2 * w)

    def complement(self) -> np.ndarray:
        """The matrix Y of all other nodes, shape (2(n-m), 2(n-m)). Rows and columns of the first kind come first."""
        (before, after, far), low, w = self._across, self._low, self._others.size
        first, last = self._end
        out, back = np.empty((2, w, 2, w)), self._back
        for r in range(2):
            for s in range(2):
                on = np.hstack([last[s, low:], before[s, low:]])
                down = np.hstack([after[r], -first[r]])
                _extend(out[r, low:, s, low:], after[s, low:, r], after[r, low:, s], down[low:], on)
                _extend(out[r, :low, s, low:], far[s, low:, r], after[r, :low, s], down[:low], on)
                out[s, low:, r, :low] = out[r, :low, s, low:].T
                on, down = np.hstack([first[s, back], after[s, back]]), np.hstack([before[r, back], -last[r, back]])
                _extend(out[r, back, s, back], before[s, back, r], before[r, back, s], down, on)
        return out.reshape(2 * w, 2 * w)

    def _block_column(self, nodes: np.ndarray, column: int) -> np.ndarray:
        """The blocks of T in the rows of `nodes` and the columns of node `column`, shape (2 nodes, 2)."""
        first, second, cross = self._entries[:, np.abs(nodes - column)]
        cross = np.sign(nodes - column) * cross
        return np.column_stack([np.r_[first, -cross], np.r_[cross, second]])

    def _products(self, vectors: np.ndarray) -> np.ndarray:
        """The products of b_j^T and vectors (2m, k) on the run, for all other nodes, shape (2(n-m), k)."""
        n, m, low = self._entries.shape[1] - 1, self._m, self._low
        one, two = np.zeros((2, n, vectors.shape[1]))
        one[low : low + m], two[low : low + m] = vectors[:m], vectors[m:]
        first, second, cross = self._entries[:, :n]
        upper = _toeplitz_product(first, first, one) + _toeplitz_product(cross, -cross, two)
        lower = _toeplitz_product(second, second, two) - _toeplitz_product(cross, -cross, one)
        return np.concatenate([upper[self._others + low], lower[self._others + low]])


def _toeplitz_product(column: np.ndarray, row: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """The product of a Toeplitz matrix and vectors (n, k), from its first column and its first row, by Fourier sums.

    ``scipy.linalg.matmul_toeplitz`` gives the same, but importing ``scipy.linalg`` takes longer than importing NumPy.
    """
    around = np.concatenate([column, row[:0:-1]])
    waves = np.fft.rfft(around)[:, np.newaxis] * np.fft.rfft(vectors, around.size, axis=0)
    return np.fft.irfft(waves, around.size, axis=0)[: column.size]


def _extend(out: np.ndarray, row: np.ndarray, column: np.ndarray, down: np.ndarray, on: np.ndarray) -> None:
    """Fill `out` (p, q) from its first row and column by out[i, j] = out[i-1, j-1] + down[i] @ on[j-1].

    `down` is (p, 4), `on` (q, 4).
    """
    if out.size:
        out[0], out[:, 0] = row, column
        _fill(np.ascontiguousarray(down[1:].T), np.ascontiguousarray(on[:-1].T), 0, 0, out)  # one type: compiled once
