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
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

TERMS = 6
"""Most terms of a fit at one end."""

MOST_NODES = 64
"""Nodes for which the solutions are tabulated. The widest window is smaller."""

SAMPLES = 4096
"""Samples of the symbol. The coefficients of its logarithm fall with the fourth power: the last ones are 1e-15."""

NEWTON_STEPS = 5
"""Steps of Newton's method for the place of an end. It starts within half a node distance."""

LEAST_PLACE, MOST_PLACE = -1.3, 0.5
"""Least and largest distance of an end from its outermost node, in node distances inwards.

The next node outwards is at -1, and the solution of the nodes has an end up to 0.3 of a node distance beyond.
"""

AT_END = 1e-12
"""Distance from an end that is rounding, in node distances. Its root, 1e-6, would be none."""

SUMMED = 16
"""Terms of Hurwitz's zeta function that are summed. The rest, by Euler and Maclaurin, then has an error of 1e-15."""

_FACTORIALS = np.array([float(math.factorial(k)) for k in range(TERMS)])


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
    coupled : bool
        Whether it is the border of a stick zone of unlike bodies.
    """

    exponent: float
    nodal: np.ndarray
    matching: np.ndarray
    coupled: bool

    def powers(self, x: float, terms: int) -> np.ndarray:
        """The powers x^(a - 1 + m) / Gamma(a + m) for x > 0, shape (terms,)."""
        order = self.exponent - 1.0 + np.arange(terms)
        return np.asarray(x**order / [math.gamma(value + 1.0) for value in order.tolist()])


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
    p = 2.0 * math.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
    part = p / (2.0 * math.pi)
    here, there = (4.0 * np.sin(0.5 * p) ** 2 / (2.0 * math.pi) ** 3 * zeta_3(t) for t in (part, 1.0 - part))
    even, odd = here + there, here - there
    turn = 1j * math.tan(math.pi * (exponent - 0.5)) * odd
    symbol = even + turn if coupling is None else (even**2 - (coupling * odd) ** 2) / (even - turn)
    # Without its singular factors (1 - z)^(a - 1) (1 - 1/z)^-a, the symbol has a smooth logarithm.
    z = np.exp(-1j * p)
    logarithm = np.log(symbol) + (1.0 - exponent) * np.log(1.0 - z) + exponent * np.log(1.0 - 1.0 / z)
    order = np.arange(SAMPLES // 2)
    halves = np.fft.ifft(logarithm)[: order.size] * np.exp(1j * math.pi * order / SAMPLES)
    smooth = -np.real(halves)
    smooth[0] *= 0.5
    series = smooth[:MOST_NODES].copy()
    series[1:] -= (1.0 - exponent) / order[1:MOST_NODES]
    first = np.zeros(MOST_NODES)  # coefficients of the inverse of one factor of the symbol: exp(series)
    first[0] = math.exp(series[0])
    for k in range(1, MOST_NODES):
        first[k] = (order[1 : k + 1] * series[1 : k + 1]) @ first[k - 1 :: -1][:k] / k
    nodal = np.empty((MOST_NODES, TERMS))
    for m in range(TERMS):
        nodal[:, m] = first = np.cumsum(first)
    moments = np.array([smooth.sum(), -(order @ smooth), 0.5 * (order**2 @ smooth)])
    matching = np.zeros((TERMS, TERMS))
    for m in range(TERMS):
        far = _far_field(moments, -exponent - m, m + 1)
        matching[: m + 1, m] = far[::-1]
    return HalfLine(exponent, nodal, matching, bool(coupling))


def zeta_3(t: np.ndarray) -> np.ndarray:
    """Hurwitz's zeta function zeta(3, t) for t > 0, shape (k,). SciPy has it too, but takes long to import."""
    far = t + SUMMED
    rest = 0.5 / far**2 + 0.5 / far**3 + 0.25 / far**4 - 1.0 / (12.0 * far**6) + 1.0 / (12.0 * far**8) - 0.15 / far**10
    return np.asarray(((t + np.arange(SUMMED)[:, None]) ** -3.0).sum(axis=0) + rest)


def _far_field(moments: np.ndarray, power: float, terms: int) -> np.ndarray:
    """Coefficients of exp(moments) ((1 - exp(-s))/s)^power in powers of s, shape (terms,)."""
    logarithm = np.zeros(max(terms, 5))
    logarithm[:5] = power * np.array([0.0, -0.5, 1.0 / 24.0, 0.0, -1.0 / 2880.0])
    logarithm[:3] += moments
    far = np.zeros(terms)
    far[0] = math.exp(logarithm[0])
    for k in range(1, terms):
        far[k] = sum(j * logarithm[j] * far[k - j] for j in range(1, k + 1)) / k
    return far


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
    """

    half_line: HalfLine
    node: int
    inwards: int
    terms: int
    place: float | None = None

    @property
    def unknowns(self) -> int:
        """Number of unknowns of the fit."""
        return self.terms - (self.place is not None)

    def columns(self, nodes: int) -> np.ndarray:
        """The solutions at the nodes of a window, shape (nodes, terms); 0 outside the zone."""
        columns = np.zeros((nodes, self.terms))
        if self.inwards > 0:
            columns[self.node :] = self.half_line.nodal[: nodes - self.node, : self.terms]
        else:
            columns[: self.node + 1] = self.half_line.nodal[self.node :: -1, : self.terms]
        return columns if self.place is None else columns @ self.solutions()

    def solutions(self) -> np.ndarray:
        """The solutions whose far fields are powers 1, 2, ... of the distance from the known place, a column each."""
        assert self.place is not None
        moved = _shift(-self.place, self.terms)[:, 1:]
        return np.asarray(np.linalg.solve(self.half_line.matching[: self.terms, : self.terms], moved))


@dataclass(frozen=True, eq=False)
class _Design:
    """The columns of a fit, and their pseudo-inverse."""

    columns: np.ndarray
    inverse: np.ndarray


@functools.lru_cache(maxsize=1024)
def _design(nodes: int, degree: int, ends: tuple[End, ...]) -> _Design:
    """The design of a window: powers of the place up to `degree` (none: -1), and the solutions of all ends."""
    places = np.arange(nodes) / (nodes - 1.0)
    columns = np.column_stack([places[:, None] ** np.arange(degree + 1), *(end.columns(nodes) for end in ends)])
    sizes = np.abs(columns).max(axis=0)
    return _Design(columns, np.linalg.pinv(columns / sizes) / sizes[:, None])


class Fit:
    """A fit of the values at the nodes 0, 1, ... of a window, by a polynomial and the solutions at some ends.

    Parameters
    ----------
    values : ndarray, shape (nodes,)
    ends : tuple of End
    degree : int
        Degree of the polynomial; -1 for none.

    Attributes
    ----------
    places : list of float
        Places of the ends, in node distances from the node 0. NaN where there is none.
    place_errors : list of float
        Their standard errors.
    """

    def __init__(self, values: np.ndarray, ends: tuple[End, ...], degree: int = -1) -> None:
        design = _design(values.size, degree, ends)
        self._ends, self._degree, self._last = ends, degree, values.size - 1.0
        self._coefficients = design.inverse @ values
        left = design.columns @ self._coefficients - values
        spare = values.size - self._coefficients.size
        self._inverse = design.inverse
        self._scatter = math.sqrt(float(left @ left) / spare) * (1.0 + 10.0 / spare)
        self.places: list[float] = []
        self.place_errors: list[float] = []
        self._parts: list[tuple[slice, _Match]] = []
        first = degree + 1
        for end in ends:
            rows = slice(first, first + end.unknowns)
            first += end.unknowns
            match = _matched(end, self._coefficients[rows])
            self.places.append(end.node + end.inwards * match.place)
            self.place_errors.append(self._scatter * float(np.linalg.norm(match.lever @ self._inverse[rows])))
            self._parts.append((rows, match))

    def value(self, x: float) -> float:
        """The fitted function at a place x, in node distances from the node 0."""
        return float(self._row(x) @ self._coefficients)

    def value_error(self, x: float) -> float:
        """Standard error of the fitted function at a place x, without the part from the places of the ends."""
        return self._scatter * float(np.linalg.norm(self._row(x) @ self._inverse))

    def _row(self, x: float) -> np.ndarray:
        """The continuous functions of the coefficients at a place x, with the present places of the ends."""
        row = np.zeros(self._coefficients.size)
        row[: self._degree + 1] = (x / self._last) ** np.arange(self._degree + 1)
        for end, (rows, match) in zip(self._ends, self._parts, strict=True):
            inside = end.inwards * (x - end.node) - match.origin
            if inside > AT_END:
                row[rows] = end.half_line.powers(inside, end.terms)[match.least :] @ match.matching[match.least :]
        return row


class _Match(NamedTuple):
    """The continuous function with the far field of some solutions.

    Attributes
    ----------
    place : float
        Its end, in node distances inwards from the outermost node.
    lever : ndarray, shape (terms,)
        Change of the place for a unit of each coefficient.
    origin : float
        Point from which distances count: the place, or half a node distance outwards if the place is not plausible.
    least : int
        The least power, 0 or 1: without a plausible place there is also the first power.
    matching : ndarray, shape (terms, terms)
        Times the coefficients of the solutions, the coefficients of the powers of the distance from the origin.
    """

    place: float
    lever: np.ndarray
    origin: float
    least: int
    matching: np.ndarray


def _matched(end: End, coefficients: np.ndarray) -> _Match:
    """Match the far field of some solutions: the first power of the distance from the place is 0."""
    if end.place is not None:
        powers = np.eye(end.terms)[:, 1:]
        return _Match(end.place, np.zeros(end.unknowns), end.place, 1, powers)
    orders = np.arange(end.terms)
    matching = end.half_line.matching[: end.terms, : end.terms]
    factorials = _FACTORIALS[: end.terms]
    series = matching @ coefficients / factorials
    place, slope = -series[0] / (series[1] or math.nan), float(series[1])
    for _ in range(NEWTON_STEPS):
        slope = float(orders[1:] * series[1:] @ place ** orders[:-1]) or math.nan
        place -= float(series @ place**orders) / slope
    plausible = bool(LEAST_PLACE <= place <= MOST_PLACE)
    origin = place if plausible else -0.5
    lever = place**orders / factorials @ matching / slope
    shift = _shift(origin, end.terms)
    return _Match(float(place) if plausible else math.nan, lever, origin, int(plausible), shift @ matching)


def _shift(origin: float, terms: int) -> np.ndarray:
    """Times the coefficients of the powers of a distance, the coefficients for distances from an origin inwards."""
    orders = np.arange(terms)
    shifted = origin**orders / _FACTORIALS[:terms]
    return np.asarray(shifted[np.maximum(orders - orders[:, None], 0)] * (orders >= orders[:, None]))
