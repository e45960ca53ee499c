"""Compiled: closed-form influence integrals of hat functions.

Notation of the paper, with x = theta - xi:

    C = cos x,  S = sin x,  L = ln(2 - 2 cos x),  A = x/2 - (pi/2) sign x  (2 pi-periodic).

Two combinations carry the displacements (30), (31), and one the integral equations (46), (47):

    direct(x) = ratio S A - C L   (even),      ratio = alpha*/beta*
    cross(x)  = ratio C A + S L   (odd)
    cot(x/2)                      (odd, principal value)

A hat is two half hats, and a half hat that falls from 1 at u = theta - node to 0 over a length h gives

    int_0^h k(u - t) (1 - t/h) dt = K1(u) - [K2(u) - K2(u - h)]/h,      K2'' = K1' = k.

K1 and K2 vanish at 0 (but for K1 = L of the cotangent), so that their difference near a node keeps its
digits. Further away than 8 lengths of the half hat it would lose them; there 4-point Gauss quadrature is
right to 1e-12.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import zeta

from fastpin.jit import compiled

TWO_PI = 2.0 * math.pi
TWO_PI_LOW = 2.4492935982947064e-16
NEAR = 8.0  # lengths of a half hat within which the exact difference is used

# Cl2(x) = x - x ln|x| + sum a_k x^(2k+1) and Cl2(pi - y) = y ln 2 - sum b_k y^(2k+1); the Bernoulli numbers
# are written as |B_2k| / (2k)! = 2 zeta(2k) / (2 pi)^(2k).
_ORDERS = 2.0 * np.arange(1, 19)
AROUND_ZERO = 2.0 * zeta(_ORDERS) / (TWO_PI**_ORDERS * _ORDERS * (_ORDERS + 1.0))
AROUND_PI = AROUND_ZERO * (2.0**_ORDERS - 1.0)
AROUND_ZERO_TERMS = 14
AROUND_PI_TERMS = 18

GAUSS_POINT, GAUSS_WEIGHT = np.polynomial.legendre.leggauss(4)


@compiled
def clausen(x):
    """Clausen's function Cl2(x) = -int_0^x ln|2 sin(t/2)| dt for any real x, to 1e-15."""
    if abs(x) > math.pi:  # fmod is exact; TWO_PI_LOW is what the double TWO_PI lacks of 2 pi
        rest = np.fmod(x, TWO_PI)
        turns = math.floor((x - rest) / TWO_PI + 0.5)
        if abs(rest) > math.pi:
            turns += 1.0 if rest > 0.0 else -1.0
            rest -= math.copysign(TWO_PI, rest)
        x = rest - turns * TWO_PI_LOW
    size = abs(x)
    if size == 0.0:
        return 0.0
    total = 0.0
    if size < 2.0:
        square = size * size
        for k in range(AROUND_ZERO_TERMS - 1, -1, -1):
            total = (total + AROUND_ZERO[k]) * square
        value = size * (1.0 - math.log(size) + total)
    else:
        y = math.pi - size
        square = y * y
        for k in range(AROUND_PI_TERMS - 1, -1, -1):
            total = (total + AROUND_PI[k]) * square
        value = y * (math.log(2.0) - total)
    return math.copysign(value, x)


@compiled
def log_kernels(x, ratio):
    """The kernels (direct, cross) at x, x not a multiple of 2 pi, |x| < 4 pi."""
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
    """First and second antiderivatives of (direct, cross) at x, |x| < 4 pi.

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
    if abs(x) > TWO_PI:  # past the next jump of A; only hats wider than half a turn come here
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
        theta minus the hat's node, rad, any turn.
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

    At u = 0, where the integral diverges, its finite part without the logarithm: the two halves of a hat have
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
    """Principal value of the integral of cot(x/2) over a hat; arguments as in :func:`hat_log`.

    A half hat at its own node has no principal value: NaN.
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
def _fill_toeplitz(values, parity, closed, out):
    """out[i, j] = values[i - j], with values[-k] = parity values[k]; mirrored entries have the same bits.

    On a circle only the first half of `values` is given; the rest follows by symmetry.
    """
    n = values.size
    if closed:
        for k in range(n // 2 + 1, n):
            values[k] = parity * values[n - k]
        if parity < 0.0 and n % 2 == 0:
            values[n // 2] = 0.0  # odd about the opposite node
    for i in range(n):
        for j in range(n):
            out[i, j] = values[i - j] if i >= j else parity * values[j - i]


@compiled
def fill_log(theta, left, right, uniform, closed, ratio, direct, cross):
    """Integrals of direct and cross over every hat, seen from every node.

    Parameters
    ----------
    theta, left, right : ndarray, shape (n,)
        Nodes and the outer knots of their hats, rad; a half hat has its outer knot at the node.
    uniform : bool
        Nodes are equally spaced: n kernel values fill the matrices, and mirrored entries have the same bits.
    closed : bool
        The nodes go round the whole circle.
    ratio : float
        alpha*/beta*.
    direct, cross : ndarray, shape (n, n), output
        direct[i, j] = int hat_j(xi) (ratio S A - C L)(theta_i - xi) dxi, cross likewise with ratio C A + S L.
    """
    n = theta.size
    if not uniform:
        for j in range(n):
            h_left = theta[j] - left[j]
            h_right = right[j] - theta[j]
            for i in range(n):
                d, c = hat_log(theta[i] - theta[j], h_left, h_right, ratio)
                direct[i, j] = d
                cross[i, j] = c
        return
    h = TWO_PI / n if closed else (theta[n - 1] - theta[0]) / (n - 1)
    row_d = np.empty(n)
    row_c = np.empty(n)
    for k in range(n // 2 + 1 if closed else n):
        row_d[k], row_c[k] = hat_log(k * h, h, h, ratio)
    _fill_toeplitz(row_d, 1.0, closed, direct)
    _fill_toeplitz(row_c, -1.0, closed, cross)
    if not closed:
        for i in range(n):
            d, c = hat_log(i * h, 0.0, h, ratio)
            direct[i, 0] = d
            cross[i, 0] = c
            direct[n - 1 - i, n - 1] = d
            cross[n - 1 - i, n - 1] = -c


@compiled
def fill_cauchy(theta, left, right, uniform, closed, out):
    """Principal values out[i, j] = PV int hat_j(xi) cot((theta_i - xi)/2) dxi.

    Parameters as in :func:`fill_log`. The half hats of an arc have no principal value at their own nodes:
    out[0, 0] and out[n-1, n-1] are NaN (tractions vanish at the ends of an arc: leave those columns out).
    """
    n = theta.size
    if not uniform:
        for j in range(n):
            h_left = theta[j] - left[j]
            h_right = right[j] - theta[j]
            for i in range(n):
                out[i, j] = hat_cauchy(theta[i] - theta[j], h_left, h_right)
        return
    h = TWO_PI / n if closed else (theta[n - 1] - theta[0]) / (n - 1)
    row = np.empty(n)
    for k in range(n // 2 + 1 if closed else n):
        row[k] = hat_cauchy(k * h, h, h)
    _fill_toeplitz(row, -1.0, closed, out)
    if not closed:
        for i in range(n):
            value = hat_cauchy(i * h, 0.0, h)
            out[i, 0] = value
            out[n - 1 - i, n - 1] = -value
