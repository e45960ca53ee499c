"""Compiled: the inverse of a symmetric block Toeplitz matrix with blocks of two, in O(m^2).

On equally spaced nodes the operator of m neighbours that all stick is such a matrix: entries depend on the distance of
two nodes only. Its inverse follows from its first and last block columns (Whittle's recursion, the block form of
Levinson's) by a recurrence along the diagonals (Gohberg, Semencul and Heinig). A factorisation takes O(m^3).

Blocks of two are kept as four rows, 00, 01, 10 and 11, of arrays (4, m).
"""

from __future__ import annotations

import numpy as np

from fastpin.jit import compiled


@compiled
def _predictors(first, second, cross, forward, backward, errors):
    """Block columns F, G with T F = (E, 0, ..., 0) and T G = (0, ..., 0, E'); F begins and G ends with the unit matrix.

    `first`, `second` (even) and `cross` (odd), shape (m,), are the entries [[first, cross], [-cross, second]] of T at
    the distances 0 to m - 1. F and G come in `forward` and `backward`, shape (2, 4, m), at the first index that is
    returned, E and E' in `errors`, shape (2, 4).
    """
    m = first.size
    now = 0
    forward[0, 0, 0] = forward[0, 3, 0] = backward[0, 0, 0] = backward[0, 3, 0] = 1.0
    forward[0, 1, 0] = forward[0, 2, 0] = backward[0, 1, 0] = backward[0, 2, 0] = 0.0
    e00, e01, e10, e11 = first[0], cross[0], -cross[0], second[0]
    b00, b01, b10, b11 = e00, e01, e10, e11
    for k in range(1, m):
        F, G = forward[now], backward[now]
        # What the extended columns leave in the new block row: g below F, h above G.
        g00 = g01 = g10 = g11 = h00 = h01 = h10 = h11 = 0.0
        for j in range(k):
            a, b, c = first[k - j], cross[k - j], second[k - j]
            g00 += a * F[0, j] + b * F[2, j]
            g01 += a * F[1, j] + b * F[3, j]
            g10 += c * F[2, j] - b * F[0, j]
            g11 += c * F[3, j] - b * F[1, j]
            a, b, c = first[j + 1], cross[j + 1], second[j + 1]
            h00 += a * G[0, j] - b * G[2, j]
            h01 += a * G[1, j] - b * G[3, j]
            h10 += c * G[2, j] + b * G[0, j]
            h11 += c * G[3, j] + b * G[1, j]
        # p = E'^-1 g, q = E^-1 h
        d = b00 * b11 - b01 * b10
        p00, p01 = (b11 * g00 - b01 * g10) / d, (b11 * g01 - b01 * g11) / d
        p10, p11 = (b00 * g10 - b10 * g00) / d, (b00 * g11 - b10 * g01) / d
        d = e00 * e11 - e01 * e10
        q00, q01 = (e11 * h00 - e01 * h10) / d, (e11 * h01 - e01 * h11) / d
        q10, q11 = (e00 * h10 - e10 * h00) / d, (e00 * h11 - e10 * h01) / d
        for r in range(4):
            F[r, k] = 0.0
        X, Y = forward[1 - now], backward[1 - now]
        for j in range(k + 1):
            s, t, u, v = (G[0, j - 1], G[1, j - 1], G[2, j - 1], G[3, j - 1]) if j > 0 else (0.0, 0.0, 0.0, 0.0)
            X[0, j], X[1, j] = F[0, j] - s * p00 - t * p10, F[1, j] - s * p01 - t * p11
            X[2, j], X[3, j] = F[2, j] - u * p00 - v * p10, F[3, j] - u * p01 - v * p11
            Y[0, j], Y[1, j] = s - F[0, j] * q00 - F[1, j] * q10, t - F[0, j] * q01 - F[1, j] * q11
            Y[2, j], Y[3, j] = u - F[2, j] * q00 - F[3, j] * q10, v - F[2, j] * q01 - F[3, j] * q11
        e00, e01 = e00 - h00 * p00 - h01 * p10, e01 - h00 * p01 - h01 * p11
        e10, e11 = e10 - h10 * p00 - h11 * p10, e11 - h10 * p01 - h11 * p11
        b00, b01 = b00 - g00 * q00 - g01 * q10, b01 - g00 * q01 - g01 * q11
        b10, b11 = b10 - g10 * q00 - g11 * q10, b11 - g10 * q01 - g11 * q11
        now = 1 - now
    errors[0, 0], errors[0, 1], errors[0, 2], errors[0, 3] = e00, e01, e10, e11
    errors[1, 0], errors[1, 1], errors[1, 2], errors[1, 3] = b00, b01, b10, b11
    return now


@compiled
def _fill(F, G, left, left_back, out):
    """The inverse (2m, 2m) from F, G and left = F E^-1, left_back = G E'^-1, all (4, m)."""
    m = F.shape[1]
    for r in range(2):
        for s in range(2):
            for j in range(m):
                # the first block row is the first block column transposed: T is symmetric
                out[r * m, s * m + j] = left[2 * s + r, j]
    for i in range(m - 1):
        for r in range(2):
            a, b = left[2 * r, i + 1], left[2 * r + 1, i + 1]
            c, d = left_back[2 * r, i], left_back[2 * r + 1, i]
            for s in range(2):
                row, above = r * m + i + 1, r * m + i
                out[row, s * m] = left[2 * r + s, i + 1]
                for j in range(m - 1):
                    out[row, s * m + j + 1] = (
                        out[above, s * m + j]
                        + (a * F[2 * s, j + 1] + b * F[2 * s + 1, j + 1])
                        - (c * G[2 * s, j] + d * G[2 * s + 1, j])
                    )


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
    forward, backward, errors = np.empty((2, 4, m)), np.empty((2, 4, m)), np.empty((2, 4))
    now = _predictors(first, second, cross, forward, backward, errors)
    F, G = forward[now], backward[now]
    with np.errstate(divide="ignore", invalid="ignore"):
        left, left_back = (_divided(column, error) for column, error in zip((F, G), errors, strict=True))
    out = np.empty((2 * m, 2 * m))
    _fill(F, G, left, left_back, out)
    return out


def _divided(column: np.ndarray, error: np.ndarray) -> np.ndarray:
    """column error^-1, block by block."""
    a, b, c, d = error
    one, two, three, four = column
    return np.array([one * d - two * c, two * a - one * b, three * d - four * c, four * a - three * b]) / (
        a * d - b * c
    )
