"""Cauchy integrals of piecewise linear tractions at points of pin and plate, exact and fast.

With p = N - iT, zeta = z/R and t = exp(i xi), the integrals at a point are

    C[g] = (1/2 pi) int g t/(t - zeta) dxi,       Z = zeta dC[p]/dzeta.

A stretch of linear pieces has a closed form: one logarithm and one dilogarithm a node. Far pieces are summed by their
moments: a tree of blocks, each with the expansion of its integral about its centre. No digit is lost near the edge:
the distance from the edge enters as l = |ln(r/R)|, not as a difference of radii.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.runtime.jit import compiled, inner

TERMS = 28
"""Terms of the expansion of a block."""

# B_2k/(2k + 1)! for k = 1 to 10, with the Bernoulli numbers B
_SERIES = np.array(
    [
        1 / 6 / math.factorial(3), -1 / 30 / math.factorial(5), 1 / 42 / math.factorial(7),
        -1 / 30 / math.factorial(9), 5 / 66 / math.factorial(11), -691 / 2730 / math.factorial(13),
        7 / 6 / math.factorial(15), -3617 / 510 / math.factorial(17), 43867 / 798 / math.factorial(19),
        -174611 / 330 / math.factorial(21),
    ]
)  # fmt: skip


@inner
def _log_one_minus(x, away):
    """log(1 - w) for w = exp(-away + i x), away >= 0; -inf at w = 1."""
    half, size = math.sin(0.5 * x), math.exp(-away)
    real, imag = 2.0 * size * half * half - math.expm1(-away), -size * math.sin(x)
    return complex(0.5 * math.log(real * real + imag * imag), math.atan2(imag, real))


@inner
def _dilogarithm(x, away, log):
    """Li2(w) for w = exp(-away + i x), |x| <= pi, from log(1 - w)."""
    beyond = math.exp(-away) * math.cos(x) > 0.5
    u = complex(away, -x) if beyond else -log
    square = u * u
    total = _SERIES[9] + 0j
    for k in range(8, -1, -1):
        total = total * square + _SERIES[k]
    total = u - 0.25 * square + u * square * total
    if not beyond:
        return total
    crossed = 0j if u == 0j else u * log  # -log w log(1 - w)
    return math.pi * math.pi / 6.0 + crossed - total


@inner
def _reduced(angle):
    """An angle moved by whole turns into [-pi, pi]."""
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


@inner
def _stretch(first, last, theta, away, outside, nodes):
    """2 pi C[N], 2 pi C[T] and 2 pi Z of the linear pieces from node `first` to node `last`.

    `nodes`, shape (k, 3), holds angle, N and T. In the plate w = t/zeta, in the pin w = zeta/t. The tractions may jump
    at the ends of the stretch, but not at a point on the edge.
    """
    pressure, shear, slope = 0j, 0j, 0j
    sense = -1.0 if outside else 1.0
    slope_pressure, slope_shear = 0.0, 0.0
    for j in range(first, last + 1):
        x = _reduced(sense * (theta - nodes[j, 0]))
        at_node = x == 0.0 and away == 0.0
        log = 0j if at_node else _log_one_minus(x, away)
        integral = _dilogarithm(x, away, log)
        jump_pressure, jump_shear = -slope_pressure, -slope_shear
        if j < last:
            step = nodes[j + 1, 0] - nodes[j, 0]
            slope_pressure = (nodes[j + 1, 1] - nodes[j, 1]) / step
            slope_shear = (nodes[j + 1, 2] - nodes[j, 2]) / step
            jump_pressure, jump_shear = jump_pressure + slope_pressure, jump_shear + slope_shear
            if not outside:
                pressure += 0.5 * step * (nodes[j + 1, 1] + nodes[j, 1])
                shear += 0.5 * step * (nodes[j + 1, 2] + nodes[j, 2])
        pressure -= sense * jump_pressure * integral
        shear -= sense * jump_shear * integral
        slope += complex(jump_pressure, -jump_shear) * log
        if j in (first, last) and (nodes[j, 1] != 0.0 or nodes[j, 2] != 0.0):
            sign = 1.0 if j == first else -1.0  # -i [g log] and its derivative
            pressure += sign * 1j * nodes[j, 1] * log
            shear += sign * 1j * nodes[j, 2] * log
            half = math.sin(0.5 * x)
            w = math.exp(-away) * complex(math.cos(x), math.sin(x))
            gap = complex(2.0 * math.exp(-away) * half * half - math.expm1(-away), -w.imag)  # 1 - w
            slope += -sense * sign * 1j * complex(nodes[j, 1], -nodes[j, 2]) * w / gap
    return pressure, shear, slope


@inner
def _expansion(zeta, centre, moments):
    """2 pi C[p], 2 pi C[T] and 2 pi Z of a block, from its moments, shape (2, TERMS), about its centre."""
    inverse = 1.0 / (zeta - centre)
    whole, shear, slope = 0j, 0j, 0j
    for m in range(TERMS - 1, -1, -1):
        whole = whole * inverse + moments[0, m]
        shear = shear * inverse + moments[1, m]
        slope = slope * inverse + (m + 1) * moments[0, m]
    return -whole * inverse, -shear * inverse, slope * inverse * inverse * zeta


@inner
def _opposite(theta, nodes, turn):
    """The node of a patch all round that is about opposite to the angle `theta`."""
    low, high = 0, turn
    away = (theta + math.pi - nodes[0, 0]) % (2.0 * math.pi)
    while high - low > 1:
        middle = (low + high) // 2
        if nodes[middle, 0] - nodes[0, 0] <= away:
            low = middle
        else:
            high = middle
    return low


@inner
def _add_moments(nodes, first, last, centre, points, weights, out):
    """Add the moments int g (t - centre)^m t dxi of the pieces from node `first` to node `last` to `out` (2, TERMS).

    The rows are for g = p and g = T. `points` and `weights` (q,) are those of Gauss on (0, 1).
    """
    for j in range(first, last):
        step = nodes[j + 1, 0] - nodes[j, 0]
        for q in range(points.size):
            part = points[q]
            xi = nodes[j, 0] + part * step
            pressure = nodes[j, 1] + part * (nodes[j + 1, 1] - nodes[j, 1])
            shear = nodes[j, 2] + part * (nodes[j + 1, 2] - nodes[j, 2])
            t = complex(math.cos(xi), math.sin(xi))
            power, away = weights[q] * step * t, t - centre
            for m in range(TERMS):
                out[0, m] += complex(pressure, -shear) * power
                out[1, m] += shear * power
                power = power * away


@inner
def _shift_moments(child, offset, binomials, out):
    """Add moments `child` (2, TERMS) to `out` (2, TERMS) about another centre; `offset` is child's centre less it."""
    powers = np.empty(TERMS, dtype=np.complex128)
    powers[0] = 1.0
    for m in range(1, TERMS):
        powers[m] = powers[m - 1] * offset
    for g in range(2):
        for m in range(TERMS):
            for k in range(m + 1):
                out[g, m] += binomials[m, k] * powers[m - k] * child[g, k]


@compiled
def grow(nodes, leaves, points, weights, binomials, tree, centres, radii, moments):
    """Build a tree of blocks from its leaves: pairs of neighbours become blocks, up to one root.

    Parameters
    ----------
    nodes : ndarray, shape (k, 3)
        Angle, N and T of the nodes.
    leaves : int
        Number l of leaves, the first blocks of the tree.
    points, weights : ndarray, shape (q,)
        Gauss points and weights on (0, 1).
    binomials : ndarray, shape (TERMS, TERMS)
    tree : ndarray of int, shape (2l-1, 4)
        First and last node of each leaf, and -1 elsewhere. The other blocks and all children are set; see
        :func:`cauchy`.
    centres, radii : ndarray, shape (2l-1,)
        Are set.
    moments : ndarray of complex, shape (2l-1, 2, TERMS)
        Zeros. The moments of each block about its centre are added.
    """
    level, size, count = np.arange(leaves), leaves, leaves
    for b in range(leaves):
        first, last = tree[b, 0], tree[b, 1]
        one = complex(math.cos(nodes[first, 0]), math.sin(nodes[first, 0]))
        two = complex(math.cos(nodes[last, 0]), math.sin(nodes[last, 0]))
        centres[b], radii[b] = 0.5 * (one + two), 0.0
        for j in range(first, last + 1):
            place = complex(math.cos(nodes[j, 0]), math.sin(nodes[j, 0]))
            radii[b] = max(radii[b], abs(place - centres[b]))
        _add_moments(nodes, first, last, centres[b], points, weights, moments[b])
    while size > 1:
        for k in range(0, size - 1, 2):
            children = level[k], level[k + 1]
            centres[count] = 0.5 * (centres[children[0]] + centres[children[1]])
            tree[count, 0], tree[count, 1] = tree[children[0], 0], tree[children[1], 1]
            tree[count, 2], tree[count, 3] = children
            radii[count] = 0.0
            for child in children:
                away = centres[child] - centres[count]
                radii[count] = max(radii[count], abs(away) + radii[child])
                _shift_moments(moments[child], away, binomials, moments[count])
            level[k // 2] = count
            count += 1
        if size % 2:
            level[size // 2] = level[size - 1]
        size = (size + 1) // 2


@compiled
def cauchy(theta, away, outside, nodes, turn, tree, centres, radii, block_moments, out):
    """C[p], C[T] and Z at points.

    Parameters
    ----------
    theta, away : ndarray, shape (m,)
        Angles of the points, and |ln(r/R)|.
    outside : bool
        Whether the points lie in the plate.
    nodes : ndarray, shape (k, 3)
        Angle, N and T of the nodes, patch after patch. A patch all round is there twice.
    turn : int
        Number of pieces of a patch all round; 0 without one.
    tree : ndarray of int, shape (b, 4)
        First and last node, and the two children of each block; -1 in leaves. The last block is the root.
    centres, radii : ndarray, shape (b,)
    block_moments : ndarray of complex, shape (b, 2, TERMS)
    out : ndarray of complex, shape (m, 3)
        At a point on the edge Z lacks its infinite terms: they are zero in the stresses.
    """
    deepest = 64  # levels of the tree, at most
    stack, runs = np.empty(2 * deepest, dtype=np.int64), np.empty((2 * deepest + tree.shape[0], 2), dtype=np.int64)
    scale = 1.0 / (2.0 * math.pi)
    for i in range(theta.size):
        size = math.exp(away[i] if outside else -away[i])
        zeta = size * complex(math.cos(theta[i]), math.sin(theta[i]))
        whole, shear, slope = 0j, 0j, 0j
        top, count = 0, 0
        if tree.shape[0]:
            stack[0], top = tree.shape[0] - 1, 1
        while top:
            top -= 1
            b = stack[top]
            if radii[b] <= 0.35 * abs(zeta - centres[b]):  # far enough for its expansion
                one, two, three = _expansion(zeta, centres[b], block_moments[b])
                whole, shear, slope = whole + one, shear + two, slope + three
            elif tree[b, 2] < 0:
                if count and runs[count - 1, 1] == tree[b, 0]:
                    runs[count - 1, 1] = tree[b, 1]
                else:
                    runs[count, 0], runs[count, 1] = tree[b, 0], tree[b, 1]
                    count += 1
            else:
                stack[top], stack[top + 1] = tree[b, 3], tree[b, 2]
                top += 2
        first = 0
        if turn and count > 1 and runs[0, 0] == 0 and runs[count - 1, 1] == turn:
            runs[count - 1, 1] += runs[0, 1]  # two ends of one stretch round the circle
            first = 1
        elif turn and count == 1 and runs[0, 0] == 0 and runs[0, 1] == turn:
            cut = _opposite(theta[i], nodes, turn)  # the whole circle: cut it away from the point
            runs[0, 0], runs[0, 1] = cut, cut + turn
        for k in range(first, count):
            one, two, three = _stretch(runs[k, 0], runs[k, 1], theta[i], away[i], outside, nodes)
            whole, shear, slope = whole + one - 1j * two, shear + two, slope + three
        out[i, 0], out[i, 1], out[i, 2] = scale * whole, scale * shear, scale * slope
