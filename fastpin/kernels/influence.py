"""Compiled closed-form integrals of the influence functions over hat functions.

The notation is the paper's, with x = theta - xi:

    C = cos x,  S = sin x,  L = ln(2 - 2 cos x),  A = x/2 - (pi/2) sign x  (2 pi-periodic).

Two kernels give the displacements (30), (31). The third gives the integral equations (46), (47):

    direct(x) = ratio S A - C L   (even),      ratio = alpha*/beta*
    cross(x)  = ratio C A + S L   (odd)
    cot(x/2)                      (odd, principal value)

A hat is two half hats. A half hat falls from 1 at its node to 0 over a length h. With u = theta - node it gives

    int_0^h k(u - t) (1 - t/h) dt = K1(u) - [K2(u) - K2(u - h)]/h,      K2'' = K1' = k.

K1 and K2 vanish at 0, so that their difference keeps its digits near a node. The only exception is K1 = L of the
cotangent. Farther away than 8 lengths of the half hat, the difference would lose digits. There 4-point Gauss quadrature
is right to 1e-12. This is the way for single hats. In matrices nearly all hats are far away. They are replaced by their
moments (:func:`log_columns`), which is right to 1e-14.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.kernels import fourier
from fastpin.runtime.jit import compiled

TWO_PI = 2.0 * math.pi
NEAR = 8.0  # lengths of a half hat within which the exact difference is used

# Cl2(x) = x - x ln|x| + sum a_k x^(2k+1) and Cl2(pi - y) = y ln 2 - sum b_k y^(2k+1). The Bernoulli numbers
# are |B_2k| / (2k)! = 2 zeta(2k) / (2 pi)^(2k). The table of zeta(2k) spares the import of scipy.special.
_ORDERS = 2.0 * np.arange(1, 19)
ZETA = np.array([
    1.6449340668482264, 1.0823232337111381, 1.0173430619844492, 1.0040773561979444, 1.000994575127818,
    1.000246086553308, 1.0000612481350588, 1.0000152822594086, 1.000003817293265, 1.0000009539620338,
    1.0000002384505027, 1.000000059608189, 1.0000000149015549, 1.000000003725334, 1.0000000009313275,
    1.000000000232831, 1.0000000000582077, 1.000000000014552,
])  # fmt: skip
AROUND_ZERO = 2.0 * ZETA / (TWO_PI**_ORDERS * _ORDERS * (_ORDERS + 1.0))
AROUND_PI = AROUND_ZERO * (2.0**_ORDERS - 1.0)

GAUSS_POINT, GAUSS_WEIGHT = np.polynomial.legendre.leggauss(4)

BLOCK_PARITY = np.array([[1.0, -1.0], [-1.0, 1.0]])
"""Parity in the distance of two nodes of the blocks [[(gap, N), (gap, T)], [(slip, N), (slip, T)]]."""

TERMS = 15  # terms of the series in the moments of a hat
HAT_POINT, HAT_WEIGHT = np.polynomial.legendre.leggauss(8)  # for the moments of a half hat, on (0, 1)
HAT_POINT = 0.5 * (1.0 + HAT_POINT)
HAT_WEIGHT = 0.5 * HAT_WEIGHT * (1.0 - HAT_POINT)


@compiled
def clausen(x):
    """Clausen's function Cl2(x) = -int_0^x ln|2 sin(t/2)| dt for any real x, to 1e-15."""
    if abs(x) > math.pi:  # fmod is exact
        rest = np.fmod(x, TWO_PI)
        turns = math.floor((x - rest) / TWO_PI + 0.5)
        if abs(rest) > math.pi:
            turns += 1.0 if rest > 0.0 else -1.0
            rest -= math.copysign(TWO_PI, rest)
        x = rest - turns * 2.4492935982947064e-16  # 2 pi less the double TWO_PI
    size = abs(x)
    if size == 0.0:
        return 0.0
    total = 0.0
    if size < 2.0:
        square = size * size
        for k in range(13, -1, -1):  # 14 terms are enough below 2
            total = (total + AROUND_ZERO[k]) * square
        value = size * (1.0 - math.log(size) + total)
    else:
        y = math.pi - size
        square = y * y
        for k in range(AROUND_PI.size - 1, -1, -1):
            total = (total + AROUND_PI[k]) * square
        value = y * (math.log(2.0) - total)
    return math.copysign(value, x)


@compiled
def log_kernels(x, ratio):
    """The kernels (direct, cross) at x, rad. |x| < 4 pi, and x is no multiple of 2 pi."""
    s = math.sin(x)
    c = math.cos(x)
    half = math.sin(0.5 * x)
    log = math.log(4.0 * half * half)
    a = 0.5 * x - math.copysign(0.5 * math.pi, x)
    if abs(x) > TWO_PI:
        a -= math.copysign(math.pi, x)
    return ratio * s * a - c * log, ratio * c * a + s * log


@compiled
def log_antiderivatives(x, ratio):
    """First and second antiderivatives of (direct, cross) at x, rad, |x| < 4 pi.

    Returns
    -------
    direct_1, direct_2, cross_1, cross_2 : float
        All vanish at 0 and are continuous.
    """
    if x == 0.0:
        return 0.0, 0.0, 0.0, 0.0
    s = math.sin(x)
    half = math.sin(0.5 * x)
    versed = 2.0 * half * half  # 1 - cos x, without cancellation
    log = math.log(2.0 * versed) if versed > 0.0 else 0.0
    cl_1 = s * (log - 1.0) - x
    cl_2 = versed * (log - 2.0) - 0.5 * x * x
    sl_1 = versed * (log - 1.0)
    sl_2 = -2.0 * clausen(x) - s * (log - 2.0)
    jump = math.copysign(0.5 * math.pi, x)
    sa_1 = 0.5 * (s - x) + 0.5 * x * versed - jump * versed
    sa_2 = versed - 0.5 * x * s + jump * (s - x)
    ca_1 = 0.5 * x * s - jump * s - 0.5 * versed
    ca_2 = (s - x) + 0.5 * x * versed - jump * versed
    if abs(x) > TWO_PI:  # beyond the next jump of A: only for hats wider than half a turn
        jump *= 2.0
        sa_1 -= jump * versed
        sa_2 += jump * (s - x) + TWO_PI * math.pi
        ca_1 -= jump * s
        ca_2 -= jump * versed
    return ratio * sa_1 - cl_1, ratio * sa_2 - cl_2, ratio * ca_1 + sl_1, ratio * ca_2 + sl_2


@compiled
def half_hat_log(u, h, ratio):
    """int_0^h (direct, cross)(u - t) (1 - t/h) dt for u in [-pi, pi]."""
    if max(u - h, -u) > NEAR * h:
        direct = 0.0
        cross = 0.0
        for k in range(GAUSS_POINT.size):
            t = 0.5 * (1.0 + GAUSS_POINT[k])
            weight = GAUSS_WEIGHT[k] * (1.0 - t)
            kernel_d, kernel_c = log_kernels(u - t * h, ratio)
            direct += weight * kernel_d
            cross += weight * kernel_c
        return 0.5 * h * direct, 0.5 * h * cross
    d1, d2, c1, c2 = log_antiderivatives(u, ratio)
    _, d2_end, _, c2_end = log_antiderivatives(u - h, ratio)
    return d1 - (d2 - d2_end) / h, c1 - (c2 - c2_end) / h


@compiled
def hat_log(u, h_left, h_right, ratio):
    """Integrals of (direct, cross) over a hat.

    Parameters
    ----------
    u : float
        Angle theta minus the node of the hat, rad, in any turn.
    h_left, h_right : float
        Distances to the outer knots, rad; 0 for a half hat at the end of an arc.
    ratio : float
        alpha*/beta*.
    """
    u = u - TWO_PI * math.floor(u / TWO_PI + 0.5)
    direct = 0.0
    cross = 0.0
    if h_right > 0.0:
        d, c = half_hat_log(u, h_right, ratio)
        direct += d
        cross += c
    if h_left > 0.0:  # the left half is the mirror image: direct is even, cross is odd
        d, c = half_hat_log(-u, h_left, ratio)
        direct += d
        cross -= c
    return direct, cross


@compiled
def half_hat_cauchy(u, h):
    """int_0^h cot((u - t)/2) (1 - t/h) dt for u in [-pi, pi].

    At u = 0 the integral diverges. Then this is its finite part without the logarithm: the two halves of a hat have
    opposite logarithms there.
    """
    if max(u - h, -u) > NEAR * h:
        total = 0.0
        for k in range(GAUSS_POINT.size):
            t = 0.5 * (1.0 + GAUSS_POINT[k])
            total += GAUSS_WEIGHT[k] * (1.0 - t) / math.tan(0.5 * (u - t * h))
        return 0.5 * h * total
    if u == 0.0:
        return -2.0 * clausen(-h) / h
    half = math.sin(0.5 * u)
    return math.log(4.0 * half * half) + 2.0 * (clausen(u) - clausen(u - h)) / h


@compiled
def hat_cauchy(u, h_left, h_right):
    """Principal value of the integral of cot(x/2) over a hat. Arguments are as in :func:`hat_log`.

    A half hat has no principal value at its own node: the result is NaN.
    """
    u = u - TWO_PI * math.floor(u / TWO_PI + 0.5)
    if u == 0.0 and (h_left == 0.0 or h_right == 0.0):
        return math.nan
    value = 0.0
    if h_right > 0.0:
        value += half_hat_cauchy(u, h_right)
    if h_left > 0.0:
        value -= half_hat_cauchy(-u, h_left)
    return value


@compiled
def _columns(seen, nodes, h_left, h_right, ratio, scale, series, direct, cross):
    """Run the loops of :func:`log_columns`. The `series` come from :func:`_hat_series`."""
    m = seen.size
    sin_seen, cos_seen = np.empty(m), np.empty(m)
    for i in range(m):
        sin_seen[i] = math.sin(0.5 * seen[i])
        cos_seen[i] = math.cos(0.5 * seen[i])
    sine, cosine, cot, log = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    column_d, column_c = np.empty(m), np.empty(m)
    for j in range(nodes.size):
        node = nodes[j]
        sin_node, cos_node = math.sin(0.5 * node), math.cos(0.5 * node)
        real, imag = series[j, 0], series[j, 1]
        longer = max(h_left[j], h_right[j])
        near = math.sin(min(0.5 * 6.0 * longer, 0.5 * math.pi))  # beyond 6 lengths the series is used
        for i in range(m):  # sine and cosine of half the distance
            sine[i] = sin_seen[i] * cos_node - cos_seen[i] * sin_node
            cosine[i] = cos_seen[i] * cos_node + sin_seen[i] * sin_node
        for i in range(m):
            far = abs(sine[i]) > near
            cot[i] = cosine[i] / sine[i] if far else 0.0
            log[i] = math.log(4.0 * sine[i] * sine[i]) if far else 0.0
        for i in range(m):
            a = 0.0
            b = 0.0
            for p in range(TERMS - 1, -1, -1):
                a = a * cot[i] + real[p]
                b = b * cot[i] + imag[p]
            x = seen[i] - node
            saw = ratio * (0.5 * x - math.copysign(0.5 * math.pi, x))
            a += saw * real[TERMS] + log[i] * imag[TERMS]
            b += saw * imag[TERMS] - log[i] * real[TERMS]
            s, c = sine[i], cosine[i]
            sin_x, cos_x = 2.0 * s * c, c * c - s * s
            column_c[i] = a * cos_x - b * sin_x
            column_d[i] = a * sin_x + b * cos_x
        for i in range(m):
            if abs(sine[i]) <= near:
                column_d[i], column_c[i] = hat_log(seen[i] - node, h_left[j], h_right[j], ratio)
        for i in range(m):
            direct[i, j] = scale * column_d[i]
            cross[i, j] = scale * column_c[i]


def _hat_series(h_left, h_right, ratio):
    """Coefficients of the powers of cot(x/2) in :func:`log_columns`, for each hat.

    They come from Gauss quadrature over the two halves of the hat.

    Returns
    -------
    series : ndarray, shape (k, 2, TERMS + 1)
        Real and imaginary parts. The last coefficient is the factor of ratio A(x) - i L(x).
    """
    t = np.hstack([np.multiply.outer(h_right, HAT_POINT), np.multiply.outer(-h_left, HAT_POINT)])
    weight = np.hstack([np.multiply.outer(h_right, HAT_WEIGHT), np.multiply.outer(h_left, HAT_WEIGHT)])
    tangent = np.tan(0.5 * t)
    moment = weight * np.exp(-1j * t)
    moments = np.empty((TERMS, *t.shape), dtype=complex)  # times the powers of the tangent
    moments[0], moments[1:] = moment, tangent
    np.multiply.accumulate(moments, axis=0, out=moments)
    series = np.empty((h_left.size, TERMS + 1), dtype=complex)
    series[:, TERMS] = moment.sum(axis=1)
    series[:, 0] = (moment * (1j * np.log1p(tangent * tangent) - 0.5 * ratio * t)).sum(axis=1)  # ln cos(t/2)
    series[:, 1:TERMS] = 2j / np.arange(1, TERMS) * moments[1:].sum(axis=2).T
    return np.stack([series.real, series.imag], axis=1)


def log_columns(
    seen: np.ndarray,
    nodes: np.ndarray,
    h_left: np.ndarray,
    h_right: np.ndarray,
    ratio: float,
    scale: float,
    direct: np.ndarray,
    cross: np.ndarray,
) -> None:
    """Compute `scale` times the integrals of direct and cross over hats, one column for each hat.

    Far from a hat's node, at x = seen - node, the kernels at x - t are

        cross + i direct = exp(i (x - t)) [ratio A(x - t) - i L(x - t)],
        A(x - t) = A(x) - t/2,   L(x - t) = L(x) + 2 ln cos(t/2) - 2 sum_p (cot(x/2) tan(t/2))^p / p,

    so the moments of a hat are enough. Each point costs one logarithm and a polynomial in cot(x/2).

    Parameters
    ----------
    seen : ndarray, shape (m,)
        Angles at which the integrals are taken, rad.
    nodes, h_left, h_right : ndarray, shape (k,)
        Nodes of the hats and distances to their outer knots, rad. `seen` and `nodes` lie within one turn.
    ratio, scale : float
        The ratio alpha*/beta*, and a factor of all integrals.
    direct, cross : ndarray, shape (m, k), output
    """
    series = _hat_series(h_left, h_right, ratio)
    _columns(seen, nodes, h_left, h_right, ratio, scale, series, direct, cross)


@compiled
def cauchy_columns(seen, nodes, h_left, h_right, out):
    """Compute the principal values of the integrals of cot(x/2) over hats, one column for each hat.

    Arguments are as in :func:`log_columns`. Output is `out`, shape (m, k).
    """
    for j in range(nodes.size):
        for i in range(seen.size):
            out[i, j] = hat_cauchy(seen[i] - nodes[j], h_left[j], h_right[j])


def fill_operator(
    theta: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
    uniform: bool,
    closed: bool,
    ratio: float,
    uniform_part: float,
    operator: np.ndarray,
    smooth: np.ndarray | None = None,
) -> None:
    """Fill the symmetric part of the displacements (30), (31). It maps tractions (N, T) to (gap, slip).

    The motion of the pin is not part of it.

    Parameters
    ----------
    theta, left, right : ndarray, shape (n,)
        Nodes and the outer knots of their hats, rad. A half hat has its outer knot at the node.
    uniform : bool
        Whether the nodes are equally spaced. Then at most two columns are integrated, the other columns are copies, and
        mirrored entries have the same bits.
    closed : bool
        Whether the nodes go round the whole circle.
    ratio : float
        alpha*/beta*.
    uniform_part : float
        Expansion of the pin. It is subtracted from `direct` in the gap of a pressure.
    operator : ndarray, shape (2n, 2n), Fortran order, output
        The matrix [[direct - uniform_part, cross], [-cross, direct]] / (4 pi). Here direct[i, j] is the integral of
        ratio S A - C L at theta_i - xi over hat j, and cross[i, j] is the integral of ratio C A + S L.
    smooth : ndarray, shape (3, N + 1), optional
        Coefficients of smooth kernels that are added to the gap of N, the slip of T, and the gap of T, see
        :func:`fastpin.kernels.fourier.hat_columns`. The slip of N gets the opposite of the third.
    """
    n = theta.size
    blocks = operator.reshape((n, 2, n, 2), order="F").transpose(1, 3, 0, 2)
    hats = _hats(theta, left, right, uniform, closed)
    _fill_blocks(hats, ratio, uniform_part, smooth, blocks[..., : hats[1].size])
    if uniform:
        _copy_columns(blocks, BLOCK_PARITY, closed)


def uniform_columns(
    theta: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
    uniform: bool,
    closed: bool,
    ratio: float,
    uniform_part: float,
    smooth: np.ndarray | None = None,
) -> np.ndarray:
    """The columns from which all columns of the operator of equally spaced nodes follow, shape (2, 2, n, k).

    The first two indices choose the block of :func:`fill_operator`, which has the parameters. On an arc the columns are
    the first half hat and the first whole hat. On a circle there is one.
    """
    hats = _hats(theta, left, right, uniform, closed)
    blocks = np.empty((2, 2, hats[1].size, theta.size)).swapaxes(2, 3)
    _fill_blocks(hats, ratio, uniform_part, smooth, blocks)
    return blocks


def by_distance(blocks: np.ndarray, closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Entries (gap, N), (slip, T) and (gap, T) of whole hats by the distance of two nodes, shape (n,) each.

    `blocks` (2, 2, n, k) come from :func:`uniform_columns`. No two nodes of an arc have a whole hat between them at the
    largest distance: this entry is 0.
    """
    values = _values_by_distance(blocks, BLOCK_PARITY, closed)
    if not closed:
        values = np.concatenate([values, np.zeros((2, 2, 1))], axis=-1)
    return values[0, 0], values[1, 1], values[0, 1]


def _fill_blocks(hats, ratio, uniform_part, smooth, blocks):
    """Fill `blocks` (2, 2, n, k) with the columns of some `hats`, as :func:`_hats` gives them."""
    seen, nodes, h_left, h_right = hats
    scale = 1.0 / (4.0 * math.pi)
    (expanded, cross), (mirrored, direct) = blocks
    log_columns(seen, nodes, h_left, h_right, ratio, scale, direct, cross)
    np.subtract(direct, 0.5 * scale * uniform_part * (h_left + h_right), out=expanded)
    np.negative(cross, out=mirrored)
    if smooth is not None:
        first, second, odd = fourier.hat_columns(seen, nodes, h_left, h_right, smooth)
        expanded += first
        direct += second
        cross += odd
        mirrored -= odd


def fill_cauchy(
    theta: np.ndarray, left: np.ndarray, right: np.ndarray, uniform: bool, closed: bool, out: np.ndarray
) -> None:
    """Fill `out`, shape (n, n), with the principal values out[i, j] = PV int hat_j(xi) cot((theta_i - xi)/2) dxi.

    The other parameters are as in :func:`fill_operator`. The half hats of an arc have no principal value at their own
    nodes: out[0, 0] and out[n-1, n-1] are NaN. Tractions vanish at the ends of an arc, so leave these columns out.
    """
    seen, nodes, h_left, h_right = _hats(theta, left, right, uniform, closed)
    cauchy_columns(seen, nodes, h_left, h_right, out[:, : nodes.size])
    if uniform:
        _copy_columns(out[np.newaxis, np.newaxis], np.array([[-1.0]]), closed)


def _hats(theta, left, right, uniform, closed):
    """The hats to be integrated. For equally spaced nodes these are the hats from which all columns follow.

    Returns the angles at which the integrals are taken, shape (n,), then the nodes of the hats and the distances to
    their two outer knots, shape (k,) each. Angles of equally spaced nodes count from the first node. The first half hat
    and the first whole hat are enough for an arc, and one hat for a circle.
    """
    if not uniform:
        return theta, theta, theta - left, right - theta
    n = theta.size
    h = TWO_PI / n if closed else (theta[-1] - theta[0]) / (n - 1)
    seen = h * np.arange(n)
    if closed:
        return seen, seen[:1], np.array([h]), np.array([h])
    return seen, seen[:2], np.array([0.0, h]), np.array([h, h])


def _copy_columns(out, parity, closed):
    """Fill the columns of equally spaced nodes from the columns of the hats of :func:`_hats`.

    `out` (a, b, n, n) holds matrices with given first columns. `parity` (a, b) is 1 or -1 for each matrix.
    """
    values = _values_by_distance(out, parity, closed)
    if not closed:
        out[..., -1] = parity[..., np.newaxis] * out[..., ::-1, 0]
    spread(values, parity, 0 if closed else 1, out)


@compiled
def spread(values, parity, ends, out):
    """Fill matrices whose entries depend on i - j, with a parity.

    Parameters
    ----------
    values : ndarray, shape (a, b, l)
        Entries by the distance of two nodes. l is n on a circle, n-1 on an arc.
    parity : ndarray, shape (a, b)
        1 or -1 for each matrix.
    ends : int
        Number of columns at either end that are left as they are: half hats.
    out : ndarray, shape (a, b, n, n), output
    """
    rows, columns, n, _ = out.shape
    for a in range(rows):
        for b in range(columns):
            for j in range(ends, n - ends):
                for i in range(j):
                    out[a, b, i, j] = parity[a, b] * values[a, b, j - i]
                for i in range(j, n):
                    out[a, b, i, j] = values[a, b, i - j]


def _values_by_distance(out, parity, closed):
    """The entries of whole hats by the distance of two nodes, (..., n) on a circle, (..., n-1) on an arc.

    Arguments are as in :func:`_copy_columns`.
    """
    if not closed:
        return out[..., 1:, 1].copy()
    n = out.shape[-2]
    values = out[..., 0].copy()
    values[..., n // 2 + 1 :] = parity[..., np.newaxis] * values[..., (n - 1) // 2 : 0 : -1]
    if n % 2 == 0:
        values[parity < 0.0, n // 2] = 0.0  # odd about the opposite node, so exactly zero
    return values
