"""Nodal values at the end of a zone, and their fits: the solutions of the discrete problem of a half line.

Beside the end of a zone a traction is not the power law x^a (c0 + c1 x + ...) at the nodes. It is the solution of the
collocation equations of a zone that is infinitely long on one side. This solution is known from the symbol of the
equations, by the method of Wiener and Hopf. Far from the end it is a sum of powers of the distance. So a fit of these
solutions to a few nodes, the outermost one included, gives the end of the zone and the traction between the nodes.

With the Fourier variable p of the node index, the symbol of the pressure under its own displacement is

    g(p) = 4 sin(p/2)^2 sum over all m of |p + 2 pi m|^-3,

and the symbol of the coupling of unlike bodies is -i beta_D h(p), where h has the terms sign(p) |p + 2 pi m|^-3.
A slip zone at a contact edge has the symbol g + i t h, where t = tan(pi (a - 1/2)) and a is the exponent (T21).
The reserve mu N - |T| in a stick zone has (g^2 - beta_D^2 h^2)/(g - i t h), with the exponent (T26).

Unlike bodies have a cusp in N too, so that T has one on both sides of a border. From the equation of the pressure the
transform of |T| is -g/(g - i t h) times the transform of the reserve. For mu N the factor is -i t h/(g - i t h).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fastpin.kernels import half_line as kernel
from fastpin.kernels.half_line import MOST_NODES, TERMS

SHEAR_TERMS = 3
"""Most terms of a fit of the shear of unlike bodies. Sums for more terms converge badly."""

SAMPLES = 4096
"""Samples of the symbol. The coefficients of its logarithm fall with the fourth power: the last ones are 1e-15."""


@dataclass(frozen=True, eq=False)
class HalfLine:
    """Solutions of a half line whose nodes are 0, 1, 2, ...; the node -1 lies outside.

    Attributes
    ----------
    exponent : float
        The power a of the distance x from the end.
    nodal : ndarray, shape (MOST_NODES, TERMS)
        The solutions at the nodes. The solution m grows like the power a - 1 + m, m = 0, 1, ...
    matching : ndarray, shape (TERMS, TERMS)
        Times the coefficients of the solutions, the coefficients of the powers x^(a - 1 + m) / Gamma(a + m) far away.
    coupling : float
        Dundurs' parameter beta_D for the border of a stick zone of unlike bodies, otherwise 0.
    """

    exponent: float
    nodal: np.ndarray
    matching: np.ndarray
    coupling: float


@functools.lru_cache(maxsize=64)
def half_line(exponent: float, coupling: float | None = None) -> HalfLine:
    """The half line of an exponent a.

    Parameters
    ----------
    exponent : float
        The power a of the distance at the end.
    coupling : float, optional
        Dundurs' parameter beta_D, for the reserve of a stick zone; None for the pressure in a slip zone.
    """
    smooth, order = _log_factor(exponent, coupling), np.arange(SAMPLES // 2)
    series, first = smooth[:MOST_NODES].copy(), np.empty(MOST_NODES)
    series[1:] -= (1.0 - exponent) / order[1:MOST_NODES]
    kernel.exponential(series, first)  # coefficients of the inverse of one factor of the symbol
    nodal = np.empty((MOST_NODES, TERMS))
    for m in range(TERMS):
        nodal[:, m] = first = np.cumsum(first)
    moments = np.array([smooth.sum(), -(order @ smooth), 0.5 * (order**2 @ smooth)])
    matching = np.zeros((TERMS, TERMS))
    step = np.array([0.0, -0.5, 1.0 / 24.0, 0.0, -1.0 / 2880.0, 0.0])  # log((1 - exp(-s))/s) in powers of s
    for m in range(TERMS):
        # Coefficients of exp(moments) ((1 - exp(-s))/s)^(-exponent - m) in powers of s.
        logarithm, far = (-exponent - m) * step, np.empty(TERMS)
        logarithm[: moments.size] += moments
        kernel.exponential(logarithm, far)
        matching[: m + 1, m] = far[m::-1]
    return HalfLine(exponent, nodal, matching, coupling or 0.0)


@functools.cache
def _samples() -> tuple[np.ndarray, ...]:
    """All that symbols have in common at the samples: g, h, log(1 - z) and log(1 - 1/z) of z = exp(-i p), and turns.

    The samples lie half a step off the places of the discrete Fourier transform. The turns are the factors of its
    coefficients, in its order. Each array has the shape (SAMPLES,).
    """
    p = 2.0 * math.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
    part = p / (2.0 * math.pi)
    here, there = (4.0 * np.sin(0.5 * p) ** 2 / (2.0 * math.pi) ** 3 * zeta_3(t) for t in (part, 1.0 - part))
    z = np.exp(-1j * p)
    turns = np.exp(1j * math.pi * np.fft.fftfreq(SAMPLES, 1.0 / SAMPLES) / SAMPLES)
    return here + there, here - there, np.log(1.0 - z), np.log(1.0 - 1.0 / z), turns


@functools.lru_cache(maxsize=64)
def _log_factor(exponent: float, coupling: float | None) -> np.ndarray:
    """Coefficients of the logarithm of the inverse factor in powers of z, without its singular part.

    The array has the shape (SAMPLES // 2,).
    """
    even, odd, inner, outer, turns = _samples()
    turn = 1j * math.tan(math.pi * (exponent - 0.5)) * odd
    symbol = even + turn if coupling is None else (even**2 - (coupling * odd) ** 2) / (even - turn)
    # Without its singular factors (1 - z)^(a - 1) (1 - 1/z)^-a, the symbol has a smooth logarithm.
    logarithm = np.log(symbol) + (1.0 - exponent) * inner + exponent * outer
    smooth = -np.real((np.fft.ifft(logarithm) * turns)[: SAMPLES // 2])
    smooth[0] *= 0.5
    return smooth


@functools.lru_cache(maxsize=64)
def shear_columns(exponent: float, coupling: float) -> np.ndarray:
    """The shear of unlike bodies on both sides of a border, with the solutions of the half line for the reserve.

    Far from the border they go like the same powers as the solutions on the stick side. On the slip side the solution m
    has the factor cos(pi a) (-1)^(m - 1). The sign makes them positive on the stick side.

    Returns
    -------
    ndarray, shape (2 MOST_NODES - 1, SHEAR_TERMS)
        At the nodes from -MOST_NODES + 1 to MOST_NODES - 1; the stick zone begins at the node 0.
    """
    half = SAMPLES // 2
    even, odd, inner, outer, turns = (values[:half] for values in _samples())
    tilt, smooth = exponent - 0.5, _log_factor(exponent, coupling)
    factor = np.fft.fft(smooth * turns.conj(), SAMPLES)[:half]
    ratio = even / (even - 1j * math.tan(math.pi * tilt) * odd)
    # Without its singular factors (1 - z)^tilt (1 - 1/z)^-tilt, the ratio is smooth.
    product = np.exp(factor + tilt * (outer - inner)) * ratio
    whole = np.concatenate([product, product[::-1].conj()])  # at 2 pi - p it is the complex conjugate
    weights = np.fft.fftshift(np.real(np.fft.ifft(whole) * _samples()[-1]))
    reach = half + MOST_NODES - 1
    columns = np.empty((2 * MOST_NODES - 1, SHEAR_TERMS))
    columns[:, 0] = np.convolve(_two_sided(-0.5, -tilt, reach)[1:], weights, "valid")
    for m in range(1, SHEAR_TERMS):  # a solution is the sum of the one before
        columns[0, m] = _two_sided(-0.5 - m, -tilt, reach)[1 : SAMPLES + 1] @ weights[::-1]
        columns[1:, m] = columns[0, m] + np.cumsum(columns[1:, m - 1])
    return columns


def _two_sided(inner: float, outer: float, reach: int) -> np.ndarray:
    """Coefficients of (1 - z)^inner (1 - 1/z)^outer in the powers of z from -reach to reach."""
    n = np.arange(reach)
    middle = math.gamma(1.0 + inner + outer) / (math.gamma(1.0 + inner) * math.gamma(1.0 + outer))
    after = np.cumprod((n - inner) / (n + 1.0 + outer))
    before = np.cumprod((n - outer) / (n + 1.0 + inner))
    return middle * np.r_[before[::-1], 1.0, after]


def zeta_3(t: np.ndarray) -> np.ndarray:
    """Hurwitz's zeta function zeta(3, t) for t > 0, shape (k,). SciPy has it too, but takes long to import."""
    summed = 16  # the rest, by Euler and Maclaurin, then has an error of 1e-15
    far = t + summed
    rest = 0.5 / far**2 + 0.5 / far**3 + 0.25 / far**4 - 1.0 / (12.0 * far**6) + 1.0 / (12.0 * far**8) - 0.15 / far**10
    return np.asarray(((t + np.arange(summed)[:, None]) ** -3.0).sum(axis=0) + rest)


class End(NamedTuple):
    """An end of a zone, or an old border inside a zone, as a part of a fit.

    Attributes
    ----------
    half_line : HalfLine
    node : int
        Its outermost node, counted in the window.
    inwards : int
        1 if its zone lies at larger indices, otherwise -1.
    terms : int
        Number of solutions to fit.
    place : float, optional
        The place, in node distances inwards from the outermost node, if it is known. There is one unknown less then.
    parts : (float, float)
        The fitted quantity has these parts of the reserve and of its shear, see :func:`shear_columns`.
    """

    half_line: HalfLine
    node: int
    inwards: int
    terms: int
    place: float | None = None
    parts: tuple[float, float] = (1.0, 0.0)


class Try(NamedTuple):
    """A fit to try.

    Attributes
    ----------
    first, nodes : int
        The first of its values, and their number.
    degree : int
        Degree of the polynomial; -1 for none.
    ends : tuple of End
    """

    first: int
    nodes: int
    degree: int
    ends: tuple[End, ...]

    @property
    def spare(self) -> int:
        """Number of nodes beyond the number of unknowns."""
        unknown = sum([end.terms if end.place is None else end.terms - 1 for end in self.ends])
        return self.nodes - self.degree - 1 - unknown


class Tries:
    """Fits to try, as compiled code takes them.

    Attributes
    ----------
    rows : ndarray of int, shape (t, 5)
        Values, degree and ends of each fit, see :func:`fastpin.kernels.half_line.end_places`.
    ends : ndarray, shape (e, 5)
        The ends of all fits, see :data:`fastpin.kernels.half_line.TABLE`.
    tables : ndarray
        The tables of their half lines, see :func:`table`.
    """

    def __init__(self, tries: Sequence[Try]) -> None:
        tables: dict[tuple[HalfLine, tuple[float, float]], int] = {}
        ends: list[tuple[float, ...]] = []
        rows = []
        for first, nodes, degree, own in tries:
            rows.append((first, nodes, degree, len(ends), len(ends) + len(own)))
            for line, node, inwards, terms, place, parts in own:
                number = tables.setdefault((line, parts), len(tables))
                ends.append((number, node, inwards, terms, math.nan if place is None else place))
        self.rows, self.tables = np.array(rows), _tables(tuple(tables))
        self.ends = np.array(ends, dtype=float).reshape(-1, kernel.PLACE + 1)

    def end_places(self, values: np.ndarray) -> np.ndarray:
        """The place of the first end of each fit of `values`, and its standard error, shape (t, 2).

        The place is in node distances inwards from the outermost node of the zone. It is NaN if it is not plausible.
        """
        found = np.empty((len(self.rows), 2))
        kernel.end_places(np.array(values), self.rows, self.ends, self.tables, found)
        return found

    def value_errors(self, values: np.ndarray, at: np.ndarray) -> np.ndarray:
        """The standard error of each fit of `values` at the place `at`, shape (t,); NaN takes the first end's place.

        See :func:`fastpin.kernels.half_line.value_errors`.
        """
        found = np.empty(len(self.rows))
        kernel.value_errors(np.array(values), self.rows, self.ends, self.tables, at, found)
        return found


@functools.lru_cache(maxsize=256)
def _tables(keys: tuple[tuple[HalfLine, tuple[float, float]], ...]) -> np.ndarray:
    """The tables of some half lines and parts, shape (t, LAW + 1, TERMS)."""
    return np.array([table(line, parts) for line, parts in keys]).reshape(-1, kernel.LAW + 1, TERMS)


@functools.lru_cache(maxsize=64)
def table(line: HalfLine, parts: tuple[float, float]) -> np.ndarray:
    """The table of a half line for compiled code, shape (LAW + 1, TERMS), see :mod:`fastpin.kernels.half_line`.

    The fitted quantity has the `parts` of the reserve and of its shear, see :class:`End`.
    """
    rows = np.zeros((kernel.LAW + 1, TERMS))
    rows[kernel.MIDDLE : kernel.MATCHING] = parts[0] * line.nodal
    beyond = 0.0
    if parts[1] != 0.0:
        rows[: kernel.MATCHING, :SHEAR_TERMS] += parts[1] * shear_columns(line.exponent, line.coupling)
        beyond = parts[1] * math.cos(math.pi * line.exponent)
    rows[kernel.MATCHING : kernel.GAMMAS] = line.matching
    rows[kernel.GAMMAS] = [math.gamma(line.exponent + m) for m in range(TERMS)]
    rows[kernel.LAW, :3] = line.exponent, sum(parts), beyond
    return rows


class Fit:
    """A fit of the values at the nodes 0, 1, ... of a window, by a polynomial and the solutions at some ends.

    Parameters
    ----------
    values : ndarray, shape (nodes,)
        At most MOST_NODES values.
    ends : tuple of End
    degree : int
        Degree of the polynomial; -1 for none.

    Attributes
    ----------
    last : float
        Place of the last node.
    """

    def __init__(self, values: np.ndarray, ends: tuple[End, ...], degree: int = -1) -> None:
        packed = Tries([Try(0, values.size, degree, ends)])
        self._ends, self.last = ends, values.size - 1.0
        self._packed = degree, packed.ends, packed.tables
        unknowns = values.size - Try(0, values.size, degree, ends).spare
        self._coefficients, self._spread = np.empty(unknowns), np.empty((unknowns, unknowns))
        self._matches, levers = np.empty((len(ends), 3)), np.empty((len(ends), unknowns))
        self._scatter = kernel.solve(np.array(values), *self._packed, self._coefficients, self._spread)
        kernel.match(*self._packed, self._coefficients, self._matches, levers)

    def place(self, at: int) -> float:
        """Place of the end number `at`, in node distances from the node 0. NaN where there is none."""
        end = self._ends[at]
        return end.node + end.inwards * float(self._matches[at, 0])

    def values(self, x: np.ndarray) -> np.ndarray:
        """The fitted function at some places, shape (k,), in node distances from the node 0."""
        rows = np.empty((x.size, self._coefficients.size))
        kernel.evaluate(np.array(x, dtype=float), self.last, *self._packed, self._matches, rows)
        return np.asarray(rows @ self._coefficients)

    def series(self, at: int) -> tuple[np.ndarray, float]:
        """The power series at the end number `at`.

        Returns
        -------
        coefficients : ndarray, shape (terms - 1,)
            Of the powers x^a, x^(a + 1), ... of the distance x from the place, in node distances.
        error : float
            Standard error of the first one.
        """
        rows = np.zeros((self._ends[at].terms - 1, self._coefficients.size))
        kernel.series(at, *self._packed, self._matches, rows)
        return np.asarray(rows @ self._coefficients), self._scatter * float(np.linalg.norm(rows[0] @ self._spread))
