"""The conjugate of a piecewise linear shear traction on the edge of the hole, exact and fast.

On the edge the tractions are two of the three stresses. The hoop stress needs one integral more,

    H(theta) = (1/4 pi) int T(xi) cot((theta - xi)/2) dxi = Im C[T],

a principal value. Near pieces have a closed form: one Clausen function a node. Far pieces are summed by blocks. With
the angle c of the middle of a block, b = cot((theta - c)/2) and u = tan((xi - c)/2), the cotangent is

    (b + u)/(1 - b u) = b + (1 + b^2) (u + b u^2 + b^2 u^3 + ...).
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.kernels.influence import clausen
from fastpin.runtime.jit import compiled, inner

TERMS = 28
"""Moments of a block, of the powers 0 to 27 of u."""


@inner
def _reduced(angle):
    """An angle moved by whole turns into [-pi, pi]."""
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


@compiled
def gather(nodes, blocks, longest, points, weights, centres, moments):
    """Fill the moments of blocks of linear pieces.

    Parameters
    ----------
    nodes : ndarray, shape (k, 3)
        Angle, N and T of the nodes, patch after patch.
    blocks : ndarray of int, shape (b, 2)
        First and last node of each block.
    longest : ndarray, shape (r,)
        Longest piece, in parts of the half width of its block, for which each rule of Gauss is exact; increasing.
    points, weights : ndarray, shape (r, q)
        The rules on (0, 1). The weights behind the last point of a rule are 0.
    centres : ndarray, shape (b, 4)
        Output: the angle c of each block, cos(c/2), sin(c/2), and its largest u; infinite without moments.
    moments : ndarray, shape (b, TERMS)
        Zeros. The integrals of T u^m are added.
    """
    for b in range(blocks.shape[0]):
        first, last = blocks[b, 0], blocks[b, 1]
        centre, half = 0.5 * (nodes[first, 0] + nodes[last, 0]), 0.5 * (nodes[last, 0] - nodes[first, 0])
        centres[b, 0], centres[b, 1], centres[b, 2] = centre, math.cos(0.5 * centre), math.sin(0.5 * centre)
        has_moments = half <= 1.2  # rad
        centres[b, 3] = math.tan(0.5 * half) if has_moments else np.inf
        for j in range(first, last if has_moments else first):
            step, before, after, rule = nodes[j + 1, 0] - nodes[j, 0], nodes[j, 2], nodes[j + 1, 2], 0
            while rule < longest.size - 1 and step > longest[rule] * half:
                rule += 1
            for q in range(points.shape[1]):
                if weights[rule, q] == 0.0:
                    break
                u = math.tan(0.5 * (nodes[j, 0] + points[rule, q] * step - centre))
                power = weights[rule, q] * step * (before + points[rule, q] * (after - before))
                for m in range(TERMS):
                    moments[b, m] += power
                    power *= u


@compiled
def edge(theta, field, nodes, joined, blocks, centres, moments, out):
    """The stresses srr, stt and srt at points on the edge.

    Parameters
    ----------
    theta : ndarray, shape (m,)
    field : ndarray, shape (7,)
        The parts of 1, N, H, cos(theta), sin(theta), cos(2 theta) and sin(2 theta) in the hoop stress.
    nodes, blocks, centres, moments : ndarray
        Those of :func:`gather`.
    joined : int
        Last node of a patch all round, which is its first node once more; -1 without one.
    out : ndarray, shape (3, m)
    """
    rounding = 4e-15  # rad
    for i in range(theta.size):
        total, cos, sin = 0.0, math.cos(0.5 * theta[i]), math.sin(0.5 * theta[i])  # total: 4 pi H
        pressure, shear = 0.0, 0.0
        for b in range(blocks.shape[0]):
            reach, first, last = centres[b, 3], blocks[b, 0], blocks[b, 1]
            across, along = sin * centres[b, 1] - cos * centres[b, 2], cos * centres[b, 1] + sin * centres[b, 2]
            if abs(across) < 0.02:  # the difference above has lost two digits
                across, along = math.sin(0.5 * (theta[i] - centres[b, 0])), math.cos(0.5 * (theta[i] - centres[b, 0]))
            if reach * abs(along) <= 0.3 * abs(across):  # the power 28 of 0.3 is 2e-15
                inverse = along / across
                terms = TERMS if reach * abs(inverse) > 0.08 else TERMS // 2  # the power 14 of 0.08 is 4e-16
                square, odd, even = inverse * inverse, moments[b, terms - 1], 0.0
                for m in range(terms - 2, 0, -2):  # two sums side by side
                    odd, even = odd * square + moments[b, m - 1], even * square + moments[b, m]
                total += inverse * moments[b, 0] + (1.0 + square) * (odd + even * inverse)
                continue
            slope = 0.0
            for j in range(first, last + 1):
                x = _reduced(theta[i] - nodes[0 if j == joined else j, 0])
                jump = -slope
                if j < last:
                    step = nodes[j + 1, 0] - nodes[j, 0]
                    slope = (nodes[j + 1, 2] - nodes[j, 2]) / step if step > 0.0 else 0.0
                    jump += slope
                    if -rounding < x < step + rounding:
                        part = min(max(x / step, 0.0), 1.0) if step > 0.0 else 0.0
                        pressure = nodes[j, 1] + part * (nodes[j + 1, 1] - nodes[j, 1])
                        shear = nodes[j, 2] + part * (nodes[j + 1, 2] - nodes[j, 2])
                total -= 2.0 * jump * clausen(x)
                if j in (first, last) and nodes[j, 2] != 0.0 and x != 0.0:
                    log = 2.0 * nodes[j, 2] * math.log(abs(2.0 * math.sin(0.5 * x)))
                    total += log if j == first else -log
        cos_theta, sin_theta = cos * cos - sin * sin, 2.0 * cos * sin
        hoop = field[0] + field[1] * pressure + field[2] * total / (4.0 * math.pi)
        hoop += field[3] * cos_theta + field[4] * sin_theta
        hoop += field[5] * (cos_theta**2 - sin_theta**2) + field[6] * (2.0 * cos_theta * sin_theta)
        out[0, i], out[1, i], out[2, i] = -pressure, hoop, shear
