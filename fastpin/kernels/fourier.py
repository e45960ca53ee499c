"""Fourier series of smooth kernels, integrated over hat functions.

The compliance of a finite body differs from that of a solid pin in an infinite plate by smooth kernels of the distance
of two angles, sum c_n cos n(theta - xi) or sum c_n sin n(theta - xi). A hat is two half hats of the lengths h_left and
h_right. About its node

    int_0^h exp(-i n t) (1 - t/h) dt = h [exp(-z) - 1 + z]/z^2,      z = i n h.
"""

from __future__ import annotations

import math

import numpy as np

BLOCK = 256
"""Harmonics that are summed together. It bounds the memory of thin walls, which need thousands of them."""


def hat_moments(order: np.ndarray, h_left: np.ndarray, h_right: np.ndarray) -> np.ndarray:
    """Integrals of exp(-i n t) over hats, t from the node, for the harmonics `order` (m,); shape (k, m).

    `h_left` and `h_right`, shape (k,), are the distances to the outer knots, rad; 0 for a half hat.
    """
    right = _half_moments(order, h_right)
    left = right if h_left is h_right else _half_moments(order, h_left)
    return right + np.conj(left)


def _half_moments(order: np.ndarray, length: np.ndarray) -> np.ndarray:
    z = np.multiply.outer(1j * length, order)
    small, terms = np.abs(z) < 0.5, 12  # there the quotient is summed by its series
    minus, quotient = -np.where(small, z, 0.0), np.full_like(z, 1.0 / math.factorial(terms + 2))
    for k in range(terms + 1, 1, -1):
        quotient *= minus
        quotient += 1.0 / math.factorial(k)
    if not small.all():
        large = z[~small]
        quotient[~small] = (np.expm1(-large) + large) / (large * large)
    found: np.ndarray = length[:, None] * quotient
    return found


def hat_columns(
    seen: np.ndarray, nodes: np.ndarray, h_left: np.ndarray, h_right: np.ndarray, coefficients: np.ndarray
) -> np.ndarray:
    """Integrals of three kernels over hats, shape (3, m, k): two sums of cosines, and one sum of sines.

    Parameters
    ----------
    seen : ndarray, shape (m,)
        Angles theta, rad.
    nodes, h_left, h_right : ndarray, shape (k,)
        Nodes of the hats and distances to their outer knots, rad.
    coefficients : ndarray, shape (3, N + 1)
        c_n of the three kernels, for n = 0 to N.
    """
    found = np.zeros((3, seen.size, nodes.size))
    for begin in range(0, coefficients.shape[1], BLOCK):
        part = coefficients[:, begin : begin + BLOCK]
        seen_waves = waves(seen, begin, part.shape[1])
        hats = _hats(begin, part.shape[1], nodes, h_left, h_right)
        if nodes.size <= 4:  # equally spaced nodes need one or two columns: sum in complex numbers
            sums = seen_waves @ (part[:, :, None] * hats.T).transpose(1, 0, 2).reshape(part.shape[1], -1)
            sums = sums.reshape(seen.size, 3, nodes.size)
            found[:2] += sums[:, :2].real.transpose(1, 0, 2)
            found[2] += sums[:, 2].imag
            continue
        cosines = np.hstack([seen_waves.real, -seen_waves.imag])
        both = np.hstack([hats.real, hats.imag]).T
        found[0] += (cosines * np.tile(part[0], 2)) @ both
        found[1] += (cosines * np.tile(part[1], 2)) @ both
        sines = np.hstack([seen_waves.imag, seen_waves.real])
        found[2] += (sines * np.tile(part[2], 2)) @ both
    return found


def waves(angles: np.ndarray, begin: int, count: int) -> np.ndarray:
    """exp(i n theta) at `angles` (m,) for n = begin to begin + count - 1, shape (m, count).

    All are products of the waves n = 1, 2, 4 and so on, whose phases are free of rounding.
    """
    found = np.empty((count, angles.size), dtype=complex)
    found[0] = 1.0
    for power in range(abs(begin).bit_length()):
        if abs(begin) >> power & 1:
            found[0] *= np.exp(math.copysign(2.0**power, begin) * 1j * angles)
    size = 1
    while size < count:
        more = min(size, count - size)
        np.multiply(found[:more], np.exp(1j * size * angles), out=found[size : size + more])
        size *= 2
    return found.T


def _hats(begin: int, count: int, nodes: np.ndarray, h_left: np.ndarray, h_right: np.ndarray) -> np.ndarray:
    """Integrals of exp(-i n xi) over hats, shape (k, count)."""
    order = np.arange(begin, begin + count, dtype=float)
    return hat_moments(order, h_left, h_right) * np.conj(waves(nodes, begin, count))


def hat_coefficients(
    order: np.ndarray, nodes: np.ndarray, h_left: np.ndarray, h_right: np.ndarray, values: np.ndarray
) -> np.ndarray:
    """int f exp(-i n xi) dxi of piecewise linear functions f, shape (m, ...), from their nodal `values` (k, ...)."""
    hats = hat_moments(order, h_left, h_right) * np.exp(-1j * np.multiply.outer(nodes, order))
    return np.tensordot(hats, values, axes=(0, 0))


def product(
    seen: np.ndarray,
    nodes: np.ndarray,
    h_left: np.ndarray,
    h_right: np.ndarray,
    coefficients: np.ndarray,
    tractions: np.ndarray,
) -> np.ndarray:
    """Gap and slip, shape (2, m), of nodal tractions (N, T), shape (2, k); the other arguments as for hat_columns.

    Gap is c_0 and c_2 of :func:`hat_columns` times N and T, slip is -c_2 and c_1.
    """
    found = np.zeros((2, seen.size))
    for begin in range(0, coefficients.shape[1], BLOCK):
        first, second, cross = coefficients[:, begin : begin + BLOCK]
        pressure, shear = tractions @ _hats(begin, first.size, nodes, h_left, h_right)
        sums = np.column_stack([first * pressure - 1j * cross * shear, second * shear + 1j * cross * pressure])
        found += (waves(seen, begin, first.size) @ sums).real.T
    return found
