"""Compiled: the inverse of a symmetric block Toeplitz matrix with blocks of two, in O(m^2).

On equally spaced nodes the operator of m neighbours that all stick is such a matrix: entries depend on the distance of
two nodes only. Its inverse follows from its first and last block columns (Whittle's recursion, the block form of
Levinson's) by a recurrence along the diagonals (Gohberg, Semencul and Heinig). A factorisation takes O(m^3).

Seen from the other end the nodes are the same with the shear turned round, D = diag(1, -1): blocks at opposite
distances are B(-k) = D B(k) D, and the last block column of the inverse is the first one in reverse, D F D.

Blocks of two are kept as four rows, 00, 01, 10 and 11, of arrays (4, m).
"""

from __future__ import annotations

import numpy as np

from fastpin.jit import compiled

TURNED = np.array([1.0, -1.0, -1.0, 1.0])
"""D B D of a block B."""


@compiled
def _predictor(first, second, cross, F, error):
    """The block column F with T F = (E, 0, ..., 0) that begins with the unit matrix, by Whittle's recursion.

    `first`, `second` (even) and `cross` (odd), shape (m,), are the entries [[first, cross], [-cross, second]] of T at
    the distances 0 to m - 1. `F` (4, m) and `error` (4,), which is E, are output.
    """
    F[:, :] = 0.0
    F[0, 0] = F[3, 0] = 1.0
    e00, e01, e10, e11 = first[0], cross[0], -cross[0], second[0]
    for k in range(1, first.size):
        # What the column, extended by a zero, leaves in the new block row.
        g00 = g01 = g10 = g11 = 0.0
        for j in range(k):
            a, b, c = first[k - j], cross[k - j], second[k - j]
            g00 += a * F[0, j] + b * F[2, j]
            g01 += a * F[1, j] + b * F[3, j]
            g10 += c * F[2, j] - b * F[0, j]
            g11 += c * F[3, j] - b * F[1, j]
        # D p = E^-1 D g takes it away: F_j - D F_{k-j} D p, two blocks at a time.
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
        # E - D g D p
        e00, e01 = e00 - g00 * p00 + g01 * p10, e01 - g00 * p01 + g01 * p11
        e10, e11 = e10 + g10 * p00 - g11 * p10, e11 + g10 * p01 - g11 * p11
    error[0], error[1], error[2], error[3] = e00, e01, e10, e11


@compiled
def _fill(before, after, out):
    """out[i, j] = out[i - 1, j - 1] + before[:, i - 1] @ after[:, j - 1]; its first row and column are given.

    `before` and `after` are (4, m - 1).
    """
    m = out.shape[0]
    for i in range(1, m):
        a, b, c, d = before[0, i - 1], before[1, i - 1], before[2, i - 1], before[3, i - 1]
        for j in range(1, m):
            step = (a * after[0, j - 1] + b * after[1, j - 1]) + (c * after[2, j - 1] + d * after[3, j - 1])
            out[i, j] = out[i - 1, j - 1] + step


@compiled
def _responses(first, second, cross, core, low, out):
    """The products of the inverse `core` and the columns of the nodes beside the set, one after the other.

    b_j, the column of the node j (from 0 to m-1 inside), has the entries of b_j-1, moved on by one. So, with x_j for
    core b_j, the move Z, the block row r of the node before the first and the first block column C of `core`,

        x_j+1 = Z x_j + x_m (last block of x_j) - C (r x_j - T_-1,j),

    and likewise on the other side. `out` (2m, 2w) has two columns for each of the w nodes outside, `low` of them to the
    left, first all of the first kind. Those of the nodes next to the set are given.
    """
    m, w = core.shape[0] // 2, out.shape[1] // 2
    for side in range(2):
        begin, end, sense = (low, w, 1) if side == 0 else (low - 1, -1, -1)
        edge, corner = (m - 1, 0) if side == 0 else (0, m - 1)
        for now in range(begin, end - sense, sense):
            away = abs(now - begin) + m + 1  # from the node on the other side
            for kind in range(2):
                x, new = out[:, kind * w + now], out[:, kind * w + now + sense]
                a, b = x[edge], x[m + edge]
                c = -first[away] if kind == 0 else sense * cross[away]
                d = -second[away] if kind == 1 else -sense * cross[away]
                for k in range(m):
                    far = k + 1 if side == 0 else m - k
                    c += first[far] * x[k] - sense * cross[far] * x[m + k]
                    d += second[far] * x[m + k] + sense * cross[far] * x[k]
                for row in range(2 * m):
                    new[row] = (
                        a * out[row, begin]
                        + b * out[row, w + begin]
                        - c * core[row, corner]
                        - d * core[row, m + corner]
                    )
                for k in range(1, m):
                    to, source = (k, k - 1) if side == 0 else (k - 1, k)
                    new[to] += x[source]
                    new[m + to] += x[m + source]


def responses(
    first: np.ndarray, second: np.ndarray, cross: np.ndarray, core: np.ndarray, low: int, nodes: int
) -> np.ndarray:
    """The inverse `core` (2m, 2m) of m neighbours out of n `nodes` times the columns of all other nodes.

    `first`, `second` and `cross` are the entries at the distances from 0 to that of the furthest of them; `low` nodes
    are to the left. Returns (2m, 2(n-m)), first the columns of the first kind. O(m) operations a column.
    """
    m = core.shape[0] // 2
    w = nodes - m
    out = np.empty((2 * m, 2 * w), order="F")
    near = np.arange(1, m + 1)
    for node, distance, sense in ((low, near[::-1], -1.0), (low - 1, near, 1.0)):
        if 0 <= node < w:
            out[:, node] = core @ np.r_[first[distance], -sense * cross[distance]]
            out[:, w + node] = core @ np.r_[sense * cross[distance], second[distance]]
    _responses(first, second, cross, core, low, out)
    return out


def inverse(first: np.ndarray, second: np.ndarray, cross: np.ndarray) -> np.ndarray:
    """Inverse of [[first, cross], [-cross, second]], shape (2m, 2m), three Toeplitz matrices given by first columns.

    `first` and `second` are symmetric, `cross` is antisymmetric, shape (m,) each; the whole is symmetric. Not finite
    if a leading block is singular.
    """
    m = first.size
    forward, error = np.empty((4, m)), np.empty(4)
    _predictor(first, second, cross, forward, error)
    with np.errstate(divide="ignore", invalid="ignore"):
        column = _divided(forward, error)
    backward, last = (TURNED[:, np.newaxis] * blocks[:, ::-1] for blocks in (forward, column))
    out = np.empty((2 * m, 2 * m))
    for r in range(2):
        for s in range(2):
            block = out[r * m : (r + 1) * m, s * m : (s + 1) * m]
            block[0] = column[2 * s + r]  # the first block column transposed: T is symmetric
            block[:, 0] = column[2 * r + s]
            before = np.concatenate([column[2 * r : 2 * r + 2, 1:], last[2 * r : 2 * r + 2, :-1]])
            after = np.concatenate([forward[2 * s : 2 * s + 2, 1:], -backward[2 * s : 2 * s + 2, :-1]])
            _fill(before, after, block)
    return out


def _divided(column: np.ndarray, error: np.ndarray) -> np.ndarray:
    """column error^-1, block by block."""
    a, b, c, d = error
    one, two, three, four = column
    return np.array([one * d - two * c, two * a - one * b, three * d - four * c, four * a - three * b]) / (
        a * d - b * c
    )
