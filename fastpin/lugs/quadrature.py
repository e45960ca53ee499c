"""Kelvin's and Cauchy's kernels between the nodes of edges, and their integrals over panels near a point.

With r = y - x, Kelvin's kernels are 2G U (xx, xy, yy) and T (xx, xy, yx, yy). The first index of T is the direction of
the unit force at x. Cauchy's are tau/r, 1/r and tau conj(r)/r^2, real and imaginary parts, with the unit tangent tau of
the edge at y.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.runtime.jit import compiled, inner

KERNELS = 7
"""Room for the numbers that a kernel gives at a distance."""


@inner
def _kelvin(r, along, kolosov, scale, found):
    """Kelvin's kernels; distances in the logarithm are in units of `scale`."""
    square = r.real * r.real + r.imag * r.imag
    distance = math.sqrt(square)
    x, y = r.real / distance, r.imag / distance
    factor = 1.0 / (math.pi * (1.0 + kolosov))
    log = -0.5 * kolosov * math.log(square / (scale * scale))
    found[0], found[1], found[2] = factor * (log + x * x), factor * (x * y), factor * (log + y * y)
    shear, factor = 0.5 * (kolosov - 1.0), -factor / distance
    outward = x * along.imag - y * along.real  # the normal is -i tau
    across = -shear * (along.real * x + along.imag * y)
    found[3], found[6] = factor * outward * (shear + 2.0 * x * x), factor * outward * (shear + 2.0 * y * y)
    found[4], found[5] = factor * (2.0 * x * y * outward - across), factor * (2.0 * x * y * outward + across)


@inner
def _cauchy(r, along, found):
    """Cauchy's kernels."""
    inverse = 1.0 / r
    one = along * inverse
    other = one * r.conjugate() * inverse
    found[0], found[1], found[2], found[3] = one.real, one.imag, inverse.real, inverse.imag
    found[4], found[5] = other.real, other.imag


@compiled
def between_nodes(rows, z, along, weights, kolosov, scale, columns, displacements, tractions):
    """Fill rows of the matrices of U and T between different nodes; an entry of a node and itself is not touched.

    Parameters
    ----------
    rows : ndarray of int, shape (k,)
    z, along : ndarray of complex, shape (n,)
    weights : ndarray, shape (n,)
    kolosov, scale : float
    columns : ndarray of int, shape (n,)
        The column of each node in U; -1 for none.
    displacements : ndarray, shape (2, n, 2, m)
    tractions : ndarray, shape (2, n, 2, n)
    """
    found = np.empty(KERNELS)
    for i in rows:
        for j in range(z.size):
            if i == j:
                continue
            _kelvin(z[j] - z[i], along[j], kolosov, scale, found)
            w, k = weights[j], columns[j]
            tractions[0, i, 0, j], tractions[0, i, 1, j] = w * found[3], w * found[4]
            tractions[1, i, 0, j], tractions[1, i, 1, j] = w * found[5], w * found[6]
            if k >= 0:
                displacements[0, i, 0, k], displacements[0, i, 1, k] = w * found[0], w * found[1]
                displacements[1, i, 0, k], displacements[1, i, 1, k] = w * found[1], w * found[2]


@inner
def _place(panel, s):
    """Point and unit tangent of a panel at s from -1 to 1."""
    is_straight, origin, span, middle, turn = panel
    if is_straight:
        return origin + span * s, span / abs(span)
    ray = complex(math.cos(middle + turn * s), math.sin(middle + turn * s))
    return origin + span * ray, math.copysign(1.0, turn) * 1j * ray


@compiled
def over_panels(points, pairs, is_straight, origin, span, middle, turn, half, rule, kolosov, scale, sums):
    """Add integrals of kernels times Legendre's polynomials over panels near points.

    A panel is halved until each subinterval is 1.5 of its lengths away from the point. Subintervals at the point are
    left out below 2e-12 of the panel and 1e-13 hole radii: the integrands are integrable there.

    Parameters
    ----------
    points : ndarray of complex, shape (p,)
    pairs : ndarray of int, shape (k, 2)
        Panel and point.
    is_straight, origin, span, middle, turn, half : ndarray, shape (panels,)
        See :class:`fastpin.lugs.panels.Edges`.
    rule : ndarray, shape (2, q)
        Nodes and weights of Gauss on [-1, 1].
    kolosov, scale : float
        Of Kelvin's kernels; Cauchy's are taken if `kolosov` is 0.
    sums : ndarray, shape (k, KERNELS, q)
    """
    nodes, deepest = rule.shape[1], 64  # each halving leaves one subinterval that waits, and there are less than 60
    centres, sizes = np.empty(deepest), np.empty(deepest)
    found, legendre = np.zeros(KERNELS), np.ones(nodes)
    for k in range(pairs.shape[0]):
        p, z = pairs[k, 0], points[pairs[k, 1]]
        panel = is_straight[p], origin[p], span[p], middle[p], turn[p]
        centres[0], sizes[0], waiting = 0.0, 1.0, 1
        while waiting:
            waiting -= 1
            centre, size = centres[waiting], sizes[waiting]
            if abs(_place(panel, centre)[0] - z) < 3.0 * size * half[p]:
                if size > max(2e-12, 1e-13 / half[p]):
                    for side in (-0.5, 0.5):
                        centres[waiting], sizes[waiting] = centre + side * size, 0.5 * size
                        waiting += 1
                continue
            for q in range(nodes):
                s = centre + size * rule[0, q]
                y, along = _place(panel, s)
                if kolosov == 0.0:
                    _cauchy(y - z, along, found)
                else:
                    _kelvin(y - z, along, kolosov, scale, found)
                legendre[1] = s
                for n in range(1, nodes - 1):
                    legendre[n + 1] = ((2 * n + 1) * s * legendre[n] - n * legendre[n - 1]) / (n + 1)
                weight = rule[1, q] * size * half[p]
                for m in range(KERNELS):
                    for n in range(nodes):
                        sums[k, m, n] += weight * found[m] * legendre[n]
