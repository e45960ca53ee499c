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
transform of |T| is -g/(g - i t h) times that of the reserve, and that of mu N is -i t h/(g - i t h) times it.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fastpin.kernels import least_squares

TERMS = 6
"""Most terms of a fit at one end."""

SHEAR_TERMS = 3
"""Most terms of a fit of the shear of unlike bodies. Sums for more terms converge badly."""

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

DEPENDENT = 1e-10
"""Ratio of pivots below which columns of a fit depend on each other. In other fits it is above 1e-7."""

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
    coupling : float
        Dundurs' parameter beta_D for the border of a stick zone of unlike bodies, otherwise 0.
    """

    exponent: float
    nodal: np.ndarray
    matching: np.ndarray
    coupling: float

    @functools.cached_property
    def _gammas(self) -> np.ndarray:
        return np.array([math.gamma(self.exponent + m) for m in range(TERMS)])

    def powers(self, x: np.ndarray, terms: int) -> np.ndarray:
        """The powers x^(a - 1 + m) / Gamma(a + m) for x > 0, shape (k,), as an array (k, terms)."""
        return np.asarray(x[:, None] ** (self.exponent - 1.0 + np.arange(terms)) / self._gammas[:terms])


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
    return HalfLine(exponent, nodal, matching, coupling or 0.0)


class _Samples(NamedTuple):
    """What all symbols have in common, at the samples; each has the shape (SAMPLES,).

    Attributes
    ----------
    even, odd : ndarray
        g and h.
    inner, outer : ndarray
        log(1 - z) and log(1 - 1/z) of z = exp(-i p).
    """

    even: np.ndarray
    odd: np.ndarray
    inner: np.ndarray
    outer: np.ndarray


@functools.cache
def _samples() -> _Samples:
    p = 2.0 * math.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
    part = p / (2.0 * math.pi)
    here, there = (4.0 * np.sin(0.5 * p) ** 2 / (2.0 * math.pi) ** 3 * zeta_3(t) for t in (part, 1.0 - part))
    z = np.exp(-1j * p)
    return _Samples(here + there, here - there, np.log(1.0 - z), np.log(1.0 - 1.0 / z))


@functools.lru_cache(maxsize=64)
def _log_factor(exponent: float, coupling: float | None) -> np.ndarray:
    """Coefficients of the logarithm of the inverse factor in powers of z, without its singular part.

    The array has the shape (SAMPLES // 2,).
    """
    even, odd, inner, outer = _samples()
    turn = 1j * math.tan(math.pi * (exponent - 0.5)) * odd
    symbol = even + turn if coupling is None else (even**2 - (coupling * odd) ** 2) / (even - turn)
    # Without its singular factors (1 - z)^(a - 1) (1 - 1/z)^-a, the symbol has a smooth logarithm.
    logarithm = np.log(symbol) + (1.0 - exponent) * inner + exponent * outer
    order = np.arange(SAMPLES // 2)
    halves = np.fft.ifft(logarithm)[: order.size] * np.exp(1j * math.pi * order / SAMPLES)
    smooth = -np.real(halves)
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
    smooth, (even, odd, inner, outer) = _log_factor(exponent, coupling), _samples()
    tilt = exponent - 0.5
    order = np.arange(SAMPLES // 2)
    factor = np.exp(np.fft.fft(np.r_[smooth * np.exp(-1j * math.pi * order / SAMPLES), np.zeros(order.size)]))
    ratio = even / (even - 1j * math.tan(math.pi * tilt) * odd)
    # Without its singular factors (1 - z)^tilt (1 - 1/z)^-tilt, the ratio is smooth.
    ratio *= np.exp(tilt * (outer - inner))
    twist = np.exp(1j * math.pi * np.fft.fftfreq(SAMPLES, 1.0 / SAMPLES) / SAMPLES)
    weights = np.fft.fftshift(np.real(np.fft.ifft(factor * ratio) * twist))
    reach = SAMPLES // 2 + MOST_NODES - 1
    columns = [np.convolve(_two_sided(-0.5 - m, -tilt, reach)[1:], weights, "valid") for m in range(SHEAR_TERMS)]
    return np.column_stack(columns)


def _two_sided(inner: float, outer: float, reach: int) -> np.ndarray:
    """Coefficients of (1 - z)^inner (1 - 1/z)^outer in the powers of z from -reach to reach."""
    n = np.arange(reach)
    middle = math.gamma(1.0 + inner + outer) / (math.gamma(1.0 + inner) * math.gamma(1.0 + outer))
    after = np.cumprod((n - inner) / (n + 1.0 + outer))
    before = np.cumprod((n - outer) / (n + 1.0 + inner))
    return middle * np.r_[before[::-1], 1.0, after]


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
    parts : (float, float)
        The fitted quantity has these parts of the reserve and of its shear, see :func:`shear_columns`.
    """

    half_line: HalfLine
    node: int
    inwards: int
    terms: int
    place: float | None = None
    parts: tuple[float, float] = (1.0, 0.0)

    @property
    def unknowns(self) -> int:
        """Number of unknowns of the fit."""
        return self.terms - (self.place is not None)

    def columns(self, nodes: int) -> np.ndarray:
        """The solutions at the nodes of a window, shape (nodes, terms). The reserve is 0 outside the zone."""
        columns, line = np.zeros((nodes, self.terms)), self.half_line
        offsets = self.inwards * (np.arange(nodes) - self.node)
        inside = offsets >= 0
        columns[inside] = self.parts[0] * line.nodal[offsets[inside], : self.terms]
        if self.parts[1] != 0.0:
            sheared = shear_columns(line.exponent, line.coupling)
            columns += self.parts[1] * sheared[MOST_NODES - 1 + offsets, : self.terms]
        return columns if self.place is None else columns @ self.solutions()

    def powers(self, inside: np.ndarray) -> np.ndarray:
        """The powers of the quantity at some distances from the end, inwards, shape (k,), as an array (k, terms)."""
        powers = np.zeros((inside.size, self.terms))
        zone = inside > AT_END
        powers[zone] = sum(self.parts) * self.half_line.powers(inside[zone], self.terms)
        if self.parts[1] != 0.0:
            beyond = inside < -AT_END
            height = self.parts[1] * math.cos(math.pi * self.half_line.exponent)
            signs = height * (-1.0) ** (np.arange(self.terms) - 1)
            powers[beyond] = signs * self.half_line.powers(-inside[beyond], self.terms)
        return powers

    def solutions(self) -> np.ndarray:
        """The solutions whose far fields are powers 1, 2, ... of the distance from the known place, a column each."""
        assert self.place is not None
        moved = _shift(-self.place, self.terms)[:, 1:]
        return np.asarray(np.linalg.solve(self.half_line.matching[: self.terms, : self.terms], moved))


@functools.lru_cache(maxsize=256)
def _columns(end: End, nodes: int) -> np.ndarray:
    """The columns of an end, kept for the fits of one window with several degrees."""
    return end.columns(nodes)


@dataclass(frozen=True, eq=False)
class _Design:
    """The columns of a fit, and their pseudo-inverse."""

    columns: np.ndarray
    inverse: np.ndarray


@functools.lru_cache(maxsize=1024)
def _design(nodes: int, degree: int, ends: tuple[End, ...]) -> _Design:
    """The design of a window: powers of the place up to `degree` (none: -1), and the solutions of all ends."""
    places = np.arange(nodes) / (nodes - 1.0)
    columns = np.column_stack([places[:, None] ** np.arange(degree + 1), *(_columns(end, nodes) for end in ends)])
    inverse = np.empty(columns.shape[::-1])
    if not least_squares.pseudo_inverse(columns, inverse) > DEPENDENT:
        # Solutions of two ends some nodes apart depend on each other: take the least coefficients.
        sizes = np.abs(columns).max(axis=0)
        inverse = np.linalg.pinv(columns / sizes) / sizes[:, None]
    return _Design(columns, inverse)


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
    last : float
        Place of the last node.
    """

    def __init__(self, values: np.ndarray, ends: tuple[End, ...], degree: int = -1) -> None:
        design = _design(values.size, degree, ends)
        self._ends, self._degree, self.last = ends, degree, values.size - 1.0
        self._coefficients = design.inverse @ values
        left = design.columns @ self._coefficients - values
        spare = values.size - self._coefficients.size
        self._inverse = design.inverse
        self._scatter = math.sqrt(float(left @ left) / spare) * (1.0 + 10.0 / spare)
        self._matches: dict[int, _Match] = {}
        self._matchings: dict[int, np.ndarray] = {}

    def place(self, at: int) -> float:
        """Place of the end number `at`, in node distances from the node 0. NaN where there is none."""
        end = self._ends[at]
        return end.node + end.inwards * self._match(at).place

    def place_error(self, at: int) -> float:
        """Standard error of this place."""
        return self._scatter * float(np.linalg.norm(self._match(at).lever @ self._inverse[self._rows(at)]))

    def _rows(self, at: int) -> slice:
        """The coefficients of an end."""
        first = self._degree + 1 + sum(end.unknowns for end in self._ends[:at])
        return slice(first, first + self._ends[at].unknowns)

    def _match(self, at: int) -> _Match:
        if at not in self._matches:
            self._matches[at] = _matched(self._ends[at], self._coefficients[self._rows(at)])
        return self._matches[at]

    def values(self, x: np.ndarray) -> np.ndarray:
        """The fitted function at some places, shape (k,), in node distances from the node 0."""
        return np.asarray(self._rows_at(x) @ self._coefficients)

    def value(self, x: float) -> float:
        """The fitted function at one place."""
        return float(self.values(np.array([x]))[0])

    def value_error(self, x: float) -> float:
        """Standard error of the fitted function at a place x, without the part from the places of the ends."""
        return self._scatter * float(np.linalg.norm(self._rows_at(np.array([x])) @ self._inverse))

    def series(self, at: int) -> tuple[np.ndarray, float]:
        """The power series at the end number `at`, which has a place.

        Returns
        -------
        coefficients : ndarray, shape (terms - 1,)
            Of the powers x^a, x^(a + 1), ... of the distance x from the place, in node distances.
        error : float
            Standard error of the first one.
        """
        rows, end = self._rows(at), self._ends[at]
        matching, exponent = self._matching(at), end.half_line.exponent
        series = matching[1:] / [[math.gamma(exponent + 1.0 + m)] for m in range(len(matching) - 1)]
        error = self._scatter * float(np.linalg.norm(series[0] @ self._inverse[rows]))
        return np.asarray(series @ self._coefficients[rows]), error

    def _rows_at(self, x: np.ndarray) -> np.ndarray:
        """The continuous functions of the coefficients at some places, with the present places of the ends."""
        rows = np.zeros((x.size, self._coefficients.size))
        rows[:, : self._degree + 1] = (x[:, None] / self.last) ** np.arange(self._degree + 1)
        for at, end in enumerate(self._ends):
            match = self._match(at)
            powers = end.powers(end.inwards * (x - end.node) - match.origin)
            rows[:, self._rows(at)] = powers[:, match.least :] @ self._matching(at)[match.least :]
        return rows

    def _matching(self, at: int) -> np.ndarray:
        if at not in self._matchings:
            self._matchings[at] = self._match(at).matching(self._ends[at])
        return self._matchings[at]


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
    """

    place: float
    lever: np.ndarray
    origin: float
    least: int

    def matching(self, end: End) -> np.ndarray:
        """Times the coefficients of the solutions, those of the powers of the distance from the origin."""
        if end.place is not None:
            return np.eye(end.terms)[:, 1:]
        return np.asarray(_shift(self.origin, end.terms) @ end.half_line.matching[: end.terms, : end.terms])


def _matched(end: End, coefficients: np.ndarray) -> _Match:
    """Match the far field of some solutions: the first power of the distance from the place is 0."""
    if end.place is not None:
        return _Match(end.place, np.zeros(end.unknowns), end.place, 1)
    scaled = end.half_line.matching[: end.terms, : end.terms] / _FACTORIALS[: end.terms, None]
    series: list[float] = (scaled @ coefficients).tolist()
    place, slope = -series[0] / (series[1] or math.nan), series[1]
    for _ in range(NEWTON_STEPS):
        value = slope = 0.0
        for coefficient in reversed(series):
            slope = slope * place + value
            value = value * place + coefficient
        place -= value / (slope or math.nan)
    plausible = LEAST_PLACE <= place <= MOST_PLACE
    lever = place ** np.arange(end.terms) @ scaled / (slope or math.nan)
    return _Match(place if plausible else math.nan, lever, place if plausible else -0.5, int(plausible))


def _shift(origin: float, terms: int) -> np.ndarray:
    """Times the coefficients of the powers of a distance, the coefficients for distances from an origin inwards."""
    orders = np.arange(terms)
    shifted = origin**orders / _FACTORIALS[:terms]
    return np.asarray(shifted[np.maximum(orders - orders[:, None], 0)] * (orders >= orders[:, None]))
