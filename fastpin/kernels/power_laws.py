"""Power laws at the ends of zones: their fits to nodes, and their values. See :mod:`fastpin.reading.power_laws`."""

from __future__ import annotations

import math

import numpy as np

from fastpin.kernels.half_line import least_squares
from fastpin.runtime.jit import compiled


@compiled
def fit(x, values, exponent, turns, windows, series):
    """Fit x^a (c0 + c1 x + ...) in each window, and keep the fit with the smallest error. Return it and its last x.

    Parameters
    ----------
    x, values : ndarray, shape (n,)
        Distances from the end in node distances, > 0 in the windows, and the values there.
    exponent : complex
        The power a.
    turns : bool
        Whether a is complex: then the imaginary part of x^a is fitted too.
    windows : ndarray of int, shape (w, 4)
        Nodes that are left out, number of nodes, degree of the polynomial, whether x^(a - 2) is fitted.
    series : ndarray of complex, shape (4,)
        Output: c0, c1, ..., and zeros.

    Returns
    -------
    error, last : float
        Standard error of the real part of c0. The last x is 0 if no window has enough nodes.
    """
    best, last = 0.0, 0.0
    for w in range(windows.shape[0]):
        first, count, degree, decaying = windows[w, 0], windows[w, 1], windows[w, 2], windows[w, 3]
        if first + count > x.size:
            continue
        n = degree + 1 + int(turns) + decaying
        columns, wanted, found = np.empty((count, n)), np.empty(count), np.empty(n)
        for i in range(count):
            place = x[first + i]
            turn = exponent.imag * math.log(place) if turns else 0.0
            for k in range(degree + 1):
                columns[i, k] = place ** (exponent.real + k) * (math.cos(turn) if turns else 1.0)
            if turns:
                columns[i, degree + 1] = place**exponent.real * math.sin(turn)
            if decaying:
                columns[i, n - 1] = place ** (exponent.real - 2.0)
            wanted[i] = values[first + i]
        error = least_squares(columns, wanted, found)
        if last == 0.0 or error < best:
            best, last = error, x[first + count - 1]
            series[:] = 0.0
            for k in range(degree + 1):
                series[k] = found[k]
            if turns:
                series[0] -= 1j * found[degree + 1]
    return best, last


@compiled
def evaluate(x, exponent, series, out):
    """Fill `out` (m,) with the real part of x^a (c0 + c1 x + ...) at distances `x` (m,); 0 at the end and beyond.

    `exponent` is a, complex, and `series` has c0, c1, ..., complex.
    """
    for i in range(x.size):
        out[i] = 0.0
        if x[i] > 0.0:
            log, total = math.log(x[i]), 0j
            for k in range(series.size - 1, -1, -1):
                total = total * x[i] + series[k]
            turn = exponent.imag * log
            power = math.exp(exponent.real * log)
            out[i] = power * (total.real * math.cos(turn) - total.imag * math.sin(turn))
