"""Where a traction falls to zero, and how high its cusps and corners are, fitted between the nodes.

Beside a contact edge N = x^a (c0 + c1 x + ...), with the distance x from the edge; beside a stick-slip border the same
holds inside the stick zone for mu N - |T|. The exponent a is 1/2, or a little off it where bodies are unlike: (T21),
(T26). What nodes have there is off by two parts: one that changes sign from node to node and is gone after some four of
them, and one that falls like x^(a - 2). The first is left out, the second is fitted with the rest.

How many nodes can be taken, and how many terms, depends on what else is near: other borders, and kinks that earlier
ones have left. So a small set of windows and shapes is tried, and the fit with the smallest standard error is taken.
"""

from __future__ import annotations

import bisect
import functools
import itertools
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

SPARE = 4
"""Nodes of a window beyond the unknowns, at least."""

EDGE_WINDOWS = ((2, 6), (2, 8), (2, 11), (2, 15), (2, 21), (6, 8), (6, 11), (6, 15), (6, 21), (6, 30), (6, 42), (6, 60),
                (6, 84), (6, 120))  # fmt: skip
"""Nodes beside an edge that are left out, and nodes of a window to try."""

EDGE_ENDS = sorted(first + nodes for first, nodes in EDGE_WINDOWS)
EDGE_NEAREST = (2, 6)  # the window that has to agree with the others, on a parabola
EDGE_AGREEMENT = 0.12
"""Largest difference from the place that the nearest nodes give, in node distances."""

EDGE_NEAREST_ERROR = 0.3
"""Largest standard error with which that place is taken where no other fit agrees with it."""

EDGE_INSIDE = 0.25
"""How far inside the outermost node an edge may be found, in node distances."""

EDGE_LEAST = 10
"""Nodes that may be used of a zone with so many or a little more; of a larger one the outer half."""

EDGE_DEGREES = (1, 2, 3, 4)
EDGE_LONG, EDGE_FAR = 15, 6
"""Nodes from which on a straight line is not tried, nor, behind so many nodes left out, a fit without decaying part."""

EDGE_ERROR = 0.1
"""Largest standard error of an edge, in node distances; with a larger one the two outermost nodes tell it."""

HALF_WIDTHS = (8, 12, 18, 27, 40, 60)
"""Nodes on either side of a border or a corner, in the windows to try."""

CUSP_WINDOWS = ((8, 2), (12, 4), (18, 4), (27, 6), (40, 6), (60, 6), (90, 6))
"""The same of a cusp, and the nodes beside it that are left out."""

CUSP_SHAPES = ((2, 2, False), (3, 2, False), (4, 3, True), (5, 4, True))
"""Degree of the polynomial, terms of the cusp, and whether the part that falls like x^(a - 2) is fitted too."""

CUSP_REACH = 2.0  # node distances from the largest nodal value
CUSP_PLACES = 33
CUSP_REFINED = 8  # of all windows and shapes, those with the smallest standard errors
CUSP_STEPS = 2  # of the Gauss-Newton method, from the best of these places
CUSP_STEP = 1e-4
BORDER_SHAPES = ((3, 2), (4, 3))  # degree of the polynomial, terms of the cusp
BORDER_SKIPPED = (1, 2, 4)
BORDER_ERROR = 3e-3
"""Largest standard error of the bound at a border, relative to its largest value."""

CORNER_DEGREES = (1, 2, 3, 4)
CORNER_SKIPPED = (2, 4)
CORNER_BEND = 50.0
"""Least slope on either side over a node distance, in standard errors: only a corner that is at the node has it."""


@dataclass(frozen=True)
class Peak:
    """A fitted peak: its value, the standard error of that, and its place in node distances from a given point."""

    value: float
    error: float
    place: float


def _standard_error(residual: np.ndarray, unknowns: int, amplification: float) -> float:
    """Standard error of a fitted number, a little enlarged where few nodes are left over."""
    spare = residual.size - unknowns
    return math.sqrt(float(residual @ residual) / spare) * amplification * (1.0 + 10.0 / spare)


# --- edges ----------------------------------------------------------------------------------------------------


def edge(theta: np.ndarray, quantity: np.ndarray, exponent: float, outside: float, alike: int) -> float:
    """Where `quantity` falls to zero like a distance to the power `exponent`, near the outermost node theta[0].

    Parameters
    ----------
    theta, quantity : ndarray, shape (n,)
        The nodes of a zone from the outermost one inwards, in either direction, and values there, >= 0.
    exponent : float
    outside : float
        Angle of the next node outwards, where the quantity is zero.
    alike : int
        How many nodes there are to the next border inside the zone, where the quantity has a kink.

    Returns
    -------
    float
        An angle not beyond `outside`. Where no shape can be made out, that to which the two outermost nodes point.
    """
    if theta.size == 1:
        return 0.5 * float(theta[0] + outside)
    spacing = float(theta[1] - theta[0])
    low = (outside - float(theta[0])) / spacing
    place = _by_two_nodes(float(quantity[0]), float(quantity[1]), exponent, low)
    most = max(theta.size // 2, min(theta.size - 1, EDGE_LEAST))
    if alike >= sum(EDGE_NEAREST):
        most = min(most, alike)
    if most < sum(EDGE_NEAREST):
        return float(theta[0]) + spacing * place
    used = theta[: EDGE_ENDS[bisect.bisect_right(EDGE_ENDS, most) - 1]]
    x = np.round((used - theta[0]) / spacing + 0.5, 9)  # 0 is halfway to the next node of an equal spacing
    powered = np.abs(quantity[: x.size]) ** (1.0 / exponent)
    designs = _edge_designs(x.tobytes())
    roots, slopes = _roots((designs.series @ powered).reshape(len(designs.fits), -1))
    offsets = roots - 0.5
    possible = (offsets >= 1.25 * low) & (offsets <= EDGE_INSIDE)
    if not possible[0]:
        return float(theta[0]) + spacing * place
    if designs.fits[0].error(powered, slopes[0]) <= EDGE_NEAREST_ERROR:
        place = max(offsets[0], low)
    least = EDGE_ERROR
    agreeing = possible & (np.abs(offsets - offsets[0]) <= EDGE_AGREEMENT)
    for k in np.flatnonzero(agreeing[1:]) + 1:
        error = designs.fits[k].error(powered, slopes[k])
        if error < least:
            least, place = error, max(offsets[k], low)
    return float(theta[0] + spacing * place)


def _by_two_nodes(first: float, second: float, exponent: float, low: float) -> float:
    """Where the line through two nodes points, from the first one in node distances; halfway to `low` if inwards."""
    outer, inner = abs(first) ** (1.0 / exponent), abs(second) ** (1.0 / exponent)
    return max(-outer / (inner - outer), low) if inner > outer else 0.5 * low


@dataclass(frozen=True, eq=False)
class _EdgeFit:
    """Least squares on one window: a polynomial of the distance, and perhaps a part that falls like its inverse."""

    nodes: slice
    columns: np.ndarray
    inverse: np.ndarray
    series: np.ndarray  # of the nodal values: the coefficients of the polynomial's powers
    amplification: float

    @classmethod
    def of(cls, x: np.ndarray, first: int, count: int, degree: int, decaying: bool) -> _EdgeFit:
        window = x[first : first + count]
        scaled, powers = window / window[-1], np.arange(degree + 1)
        columns = np.column_stack([scaled[:, None] ** powers, *([1.0 / scaled] * decaying)])
        inverse = np.linalg.pinv(columns)
        series = inverse[: degree + 1] / window[-1] ** powers[:, None]
        return cls(slice(first, first + count), columns, inverse, series, float(np.linalg.norm(series[0])))

    def error(self, values: np.ndarray, slope: float) -> float:
        """Standard error of the root, where the polynomial has this slope."""
        wanted = values[self.nodes]
        residual = self.columns @ (self.inverse @ wanted) - wanted
        return _standard_error(residual, self.columns.shape[1], self.amplification) / abs(slope)


@dataclass(frozen=True, eq=False)
class _EdgeDesigns:
    """All fits that are tried; ``series`` (fits * terms, nodes) gives the coefficients of all their polynomials."""

    fits: list[_EdgeFit]
    series: np.ndarray


@functools.lru_cache(maxsize=64)
def _edge_designs(places: bytes) -> _EdgeDesigns:
    """The fits with the nodes at these distances from the edge; the first is that of the nearest nodes."""
    x = np.frombuffer(places)
    fits = [_EdgeFit.of(x, *EDGE_NEAREST, 2, False)]
    for first, count in EDGE_WINDOWS:
        for degree in EDGE_DEGREES:
            for decaying in (False, True):
                too_simple = count >= EDGE_LONG and (degree == 1 or (not decaying and first == EDGE_FAR))
                if first + count <= x.size and not too_simple and count >= degree + 1 + decaying + SPARE:
                    fits.append(_EdgeFit.of(x, first, count, degree, decaying))
    series = np.zeros((len(fits), max(EDGE_DEGREES) + 1, x.size))
    for fit, rows in zip(fits, series, strict=True):
        rows[: fit.series.shape[0], fit.nodes] = fit.series
    return _EdgeDesigns(fits, series.reshape(-1, x.size))


def _roots(series: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Roots near 0 of power series, shape (fits, terms), by Newton's method, and the slopes there; NaN without any."""
    places = np.zeros(series.shape[0])
    slopes = places
    with np.errstate(all="ignore"):
        for _ in range(4):
            values, slopes = np.zeros_like(places), np.zeros_like(places)
            for k in range(series.shape[1] - 1, -1, -1):
                slopes = slopes * places + values
                values = values * places + series[:, k]
            places = places - values / slopes
    return np.where(np.isfinite(places) & (slopes != 0.0), places, np.nan), slopes


# --- peaks ----------------------------------------------------------------------------------------------------


def border_peak(x: np.ndarray, bound: np.ndarray, exponent: float) -> Peak | None:
    """Largest value on the slip side of a border, beside which the bound mu N has a cusp.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Distances of the nodes from the border in node distances, increasing; positive where they slip.
    bound : ndarray, shape (n,)
        mu N at these nodes.
    exponent : float
        Of the cusp: bound = p(x) on the stick side and p(x) + x^exponent q(x) on the slip side, p and q smooth.
    """
    best, shape = None, (np.zeros(0), 0, 0)
    for half, taken in _windows(x, itertools.product(HALF_WIDTHS, BORDER_SKIPPED)):
        for degree, terms in BORDER_SHAPES:
            if np.count_nonzero(taken) < degree + 1 + terms + SPARE:
                continue
            columns = _cusp_columns(-x[taken] / half, exponent, degree, terms)
            coefficients, error = _fit_windows(columns, bound[taken])
            if best is None or error < best.error:
                best, shape = Peak(0.0, error, float(half)), (coefficients, degree, terms)
    if best is None or best.error > BORDER_ERROR * float(bound.max()):
        return None
    t = np.linspace(0.0, 1.0, 401)  # the square roots of the distances: most of them are at the border
    coefficients, degree, terms = shape
    fitted = _cusp_columns(-(t**2), exponent, degree, terms) @ coefficients
    top = int(np.argmax(fitted))
    if top == 0:
        return Peak(float(fitted[0]), best.error, 0.0)
    if top == t.size - 1:
        return None
    shift, value = _vertex(*(float(each) for each in fitted[top - 1 : top + 2]))
    return Peak(value, best.error, best.place * float(t[top] + shift * t[1]) ** 2)


def _windows(x: np.ndarray, sizes: Iterable[tuple[int, int]]) -> Iterator[tuple[int, np.ndarray]]:
    """Half-width and nodes of the windows about x = 0 that fit in; `sizes`: half-width, and nodes left out beside 0."""
    for half, skipped in sizes:
        if x[0] <= 0.5 - half and x[-1] >= half - 0.5:
            yield half, (np.abs(x) > skipped + 0.5) & (np.abs(x) < half + 0.5)


def _fit_windows(columns: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, float]:
    """Coefficients of a least-squares fit, and the standard error of the first one."""
    inverse = np.linalg.pinv(columns)
    coefficients = inverse @ values
    residual = columns @ coefficients - values
    return coefficients, _standard_error(residual, columns.shape[1], float(np.linalg.norm(inverse[0])))


def _cusp_columns(y: np.ndarray, exponent: float, degree: int, terms: int) -> np.ndarray:
    """Columns y^k, and |y|^(exponent + k) where y is negative."""
    cusp_side = np.maximum(-y, 0.0)
    return np.column_stack([y**k for k in range(degree + 1)] + [cusp_side ** (exponent + k) for k in range(terms)])


def _vertex(before: float, middle: float, after: float) -> tuple[float, float]:
    """Place and value of the extreme of a parabola through equally spaced values, from the middle one."""
    bend = before - 2.0 * middle + after
    shift = 0.5 * (before - after) / bend if bend != 0.0 else 0.0
    return shift, middle - 0.25 * (before - after) * shift


def cusp(x: np.ndarray, values: np.ndarray, exponent: float) -> Peak | None:
    """A cusp that a border has left behind: values = p(x) beyond it and p(x) - |x - place|^exponent q(x) before it.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Distances of the nodes from the one with the largest value, in node distances, increasing.
    values : ndarray, shape (n,)
    exponent : float

    Returns
    -------
    Peak or None
        None if no cusp is found within two nodes of the largest value.
    """
    tried: list[tuple[float, int, float, np.ndarray, np.ndarray, tuple[int, int, bool]]] = []
    for _, taken in _windows(x, CUSP_WINDOWS):
        window, wanted = np.round(x[taken], 9), values[taken]
        for shape in CUSP_SHAPES:
            if window.size >= shape[0] + 1 + shape[1] + shape[2] + 1 + SPARE:
                error, place = _cusp_place(window, wanted, shape, exponent)
                tried.append((error, len(tried), place, window, wanted, shape))
    best: Peak | None = None
    for _, _, place, window, wanted, shape in sorted(tried)[:CUSP_REFINED]:
        for _ in range(CUSP_STEPS):
            columns = _left_cusp(window, place, shape, exponent)
            coefficients = np.linalg.pinv(columns) @ wanted
            moved = _left_cusp(window, place + CUSP_STEP, shape, exponent) - columns
            inverse = np.linalg.pinv(np.column_stack([columns, moved @ coefficients / CUSP_STEP]))
            residual = columns @ coefficients - wanted
            place -= float(inverse[-1] @ residual)
        error = _standard_error(residual, inverse.shape[0], float(np.linalg.norm(inverse[0])))
        if abs(place) <= CUSP_REACH and (best is None or error < best.error):
            best = Peak(float(coefficients[0]), error, place)
    return best


def _left_cusp(x: np.ndarray, place: float, shape: tuple[int, int, bool], exponent: float) -> np.ndarray:
    degree, terms, decaying = shape
    y = (x - place) / x[-1]
    columns = _cusp_columns(y, exponent, degree, terms)
    if decaying:
        before = y < 0.0
        falling = np.where(before, np.maximum(np.abs(x - place), 1.0) ** (exponent - 2.0), 0.0)
        columns = np.column_stack([columns, falling])
    return columns


def _cusp_place(
    window: np.ndarray, values: np.ndarray, shape: tuple[int, int, bool], exponent: float
) -> tuple[float, float]:
    """The place that leaves the smallest misfit and about its standard error; infinite at an end of what is tried."""
    orthogonal, amplification = _cusp_bases(window.tobytes(), shape, exponent)
    left = values - np.einsum("pmk,pk->pm", orthogonal, np.einsum("pmk,m->pk", orthogonal, values))
    misfit = np.einsum("pm,pm->p", left, left)
    lowest = int(np.argmin(misfit))
    if lowest in (0, CUSP_PLACES - 1):
        return math.inf, 0.0
    shift, _ = _vertex(*misfit[lowest - 1 : lowest + 2])
    place = CUSP_REACH * (2.0 * (lowest + shift) / (CUSP_PLACES - 1) - 1.0)
    return _standard_error(left[lowest], orthogonal.shape[2] + 1, amplification), place


@functools.lru_cache(maxsize=256)
def _cusp_bases(window: bytes, shape: tuple[int, int, bool], exponent: float) -> tuple[np.ndarray, float]:
    """Orthonormal columns for every place to try (places, nodes, unknowns), and how a residual tells on the value."""
    x = np.frombuffer(window)
    places = np.linspace(-CUSP_REACH, CUSP_REACH, CUSP_PLACES)
    columns = np.array([_left_cusp(x, place, shape, exponent) for place in places])
    middle = np.linalg.pinv(columns[CUSP_PLACES // 2])
    return np.linalg.qr(columns)[0], float(np.linalg.norm(middle[0]))


def corner(x: np.ndarray, values: np.ndarray) -> Peak | None:
    """A corner at x = 0, between two smooth branches that fall on both sides.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Distances of the nodes from the corner in node distances, increasing.
    values : ndarray, shape (n,)
    """
    best: Peak | None = None
    for half, taken in _windows(x, itertools.product(HALF_WIDTHS, CORNER_SKIPPED)):
        y, wanted = x[taken] / half, values[taken]
        for degree in CORNER_DEGREES:
            if y.size < 2 * degree + 1 + SPARE:
                continue
            columns = np.column_stack([y**k for k in range(degree + 1)] + [np.abs(y) * y**k for k in range(degree)])
            coefficients, error = _fit_windows(columns, wanted)
            bend = -coefficients[degree + 1] / half
            falling = bend > max(abs(coefficients[1]) / half, CORNER_BEND * error)
            if falling and (best is None or error < best.error):
                best = Peak(float(coefficients[0]), error, 0.0)
    return best
