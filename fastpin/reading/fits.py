"""Least-squares fits between the nodes: zeros, cusps, corners and power laws of a traction.

Beside a contact edge N = x^a (c0 + c1 x + ...), where x is the distance from the edge. Inside a stick zone, beside its
border, mu N - |T| has the same form. The exponent a is 1/2 for like bodies. For unlike bodies it is a little off 1/2:
(T21), (T26).

The nodal values beside an edge have two errors. One changes sign from node to node and is gone after some four nodes:
these nodes are left out. The other falls like x^(a - 2): it is fitted together with the power series.

The best number of nodes and of terms depends on the neighbourhood: other borders, and kinks that earlier borders left.
So each fit tries a small set of windows and shapes and takes the one with the smallest standard error.
"""

from __future__ import annotations

import bisect
import functools
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fastpin import kernels
from fastpin.reading.ends import end_fit
from fastpin.reading.half_line import HalfLine
from fastpin.reading.old_borders import OldBorder

SPARE = 4
"""Least number of nodes of a window beyond the number of unknowns."""

EDGE_WINDOWS = ((2, 6), (2, 8), (2, 11), (2, 15), (2, 21), (6, 8), (6, 11), (6, 15), (6, 21), (6, 30), (6, 42), (6, 60),
                (6, 84), (6, 120))  # fmt: skip
"""Windows to try beside an edge: the number of nodes left out at the edge, and the number of nodes used."""

EDGE_ENDS = sorted(first + nodes for first, nodes in EDGE_WINDOWS)
"""Numbers of nodes from the edge to the end of each window, increasing."""

EDGE_NEAREST = (2, 6)
"""The window of the nearest nodes. Its fit is a parabola, and the other fits must agree with it."""

EDGE_AGREEMENT = 0.12
"""Largest distance of a fitted edge from the edge of the nearest window, in node distances."""

EDGE_NEAREST_ERROR = 0.3
"""Largest standard error, in node distances, of the edge of the nearest window if no other fit agrees with it."""

EDGE_INSIDE = 0.25
"""Largest distance of an edge inside the outermost closed node, in node distances."""

EDGE_LEAST = 10
"""Number of nodes that a fit may use in a small zone, all but one node at most.

In a zone of more than twice this number of nodes, it is the outer half.
"""

EDGE_DEGREES = (1, 2, 3, 4)
"""Degrees of the polynomial to try."""

EDGE_LONG, EDGE_FAR = 15, 6
"""Limits of the simplest fits.

A window of EDGE_LONG or more nodes is not fitted with a straight line. If EDGE_FAR nodes are left out as well, it is
not fitted without the decaying part.
"""

EDGE_ERROR = 0.1
"""Largest standard error of a fitted edge, in node distances. A fit with a larger one is not taken."""

EDGE_LIMITS = EDGE_INSIDE, EDGE_AGREEMENT, EDGE_NEAREST_ERROR, EDGE_ERROR
"""The limits of the fits of an edge, in the order of the compiled search."""

HALF_WIDTHS = (8, 12, 18, 27, 40, 60)
"""Half-widths of the windows about a border or a corner: the number of nodes on either side."""

CUSP_WINDOWS = ((8, 2), (12, 4), (18, 4), (27, 6), (40, 6), (60, 6), (90, 6))
"""Windows to try about a cusp: the number of nodes on either side, and the number left out beside the cusp."""

CUSP_SHAPES = ((2, 2, False), (3, 2, False), (4, 3, True), (5, 4, True))
"""Shapes to try: degree of the polynomial, terms of the cusp, and whether the part like x^(a - 2) is fitted too."""

CUSP_REACH = 2.0
"""Largest distance of a cusp from the node with the largest value, in node distances."""

CUSP_PLACES = 33
"""Number of equally spaced places, within the reach, at which a cusp is tried first."""

CUSP_REFINED = 8
"""Number of fits that are refined: the windows and shapes with the smallest standard errors."""

CUSP_STEPS = 2
"""Steps of the Gauss-Newton method from the best place of each of these fits."""

CUSP_STEP = 1e-4
"""Shift of the place, in node distances, for the derivative by a difference quotient."""

BORDER_SHAPES = np.array([(3, 2), (4, 3)])
"""Shapes to try at a border: degree of the polynomial, terms of the cusp."""

BORDER_WINDOWS = np.array(list(itertools.product(HALF_WIDTHS, (1, 2, 4))))
"""Windows to try about a border: the number of nodes on either side, and the number left out beside the border."""

BORDER_PLACES = 401
"""Number of places on the slip side at which the fitted bound is compared; they gather at the border."""

BORDER_ERROR = 3e-3
"""Largest standard error of the bound mu N at a border, relative to the largest bound."""

CORNER_DEGREES = np.array([1, 2, 3, 4])
"""Degrees of the polynomials to try at a corner."""

CORNER_WINDOWS = np.array(list(itertools.product(HALF_WIDTHS, (2, 4))))
"""Windows to try about a corner: the number of nodes on either side, and the number left out beside the corner."""

CORNER_BEND = 50.0
"""Least fall from a corner over a node distance, mean of both sides, in standard errors.

Only a corner at the node itself reaches it.
"""

LAW_WINDOWS = ((2, 6, 1, False), (2, 8, 2, False), (2, 8, 1, True), (2, 12, 2, True), (2, 12, 3, True),
               (2, 20, 3, True), (4, 30, 3, True))  # fmt: skip
"""Fits of a power law to try.

Each has the number of nodes left out at the end of the zone, the number of nodes used, the degree of the polynomial,
and whether the part like x^(a - 2) is fitted too.
"""

ROUNDING = 1e-9
"""Relative error of an angle that is rounding."""

LAW_REACH = 9.0
"""Part of a zone that a power law describes, in node distances; at most the fitted window."""

LAW_ERROR = 0.02
"""Largest standard error of the leading coefficient of a power law, in parts of it."""

LAW_EQUAL = 1e-6
"""Largest difference of two places that are the same, in node distances."""

LAW_OFF = np.array([0.25, 0.11, 0.03, 0.03])
"""Largest difference of a power law and the values at the four outermost nodes, in parts of the leading coefficient.

Where an earlier border lies between these nodes, the difference is larger. In good fits it is at most half of this.
"""


@dataclass(frozen=True)
class Peak:
    """A fitted peak.

    Attributes
    ----------
    value : float
        Height of the peak.
    error : float
        Standard error of the value.
    place : float
        Distance of the peak from the point x = 0 of the fit, in node distances.
    cusp : float
        Coefficient of the power of the distance from a cusp, in node distances; 0 unless it was fitted.
    """

    value: float
    error: float
    place: float
    cusp: float = 0.0


def edge(theta: np.ndarray, quantity: np.ndarray, exponent: float, outside: float, alike: int) -> float:
    """Angle at which a quantity falls to zero at the end of a zone, rad.

    The quantity falls like the distance from the edge to the power `exponent`. The edge lies near the outermost node.

    Parameters
    ----------
    theta, quantity : ndarray, shape (n,)
        Angles (rad) of the nodes of a zone, from the outermost node inwards, in either direction; and the values at
        these nodes, >= 0.
    exponent : float
        Power of the distance, about 1/2: (T21), (T26).
    outside : float
        Angle of the next node outwards, where the quantity is zero, rad.
    alike : int
        Number of nodes from the outermost one to the next border inside the zone, where the quantity has a kink.

    Returns
    -------
    float
        An angle, not beyond `outside`. If no fit is good enough, the zero of the line through the two outermost nodes.
        A zone of one node ends halfway to `outside`.
    """
    if theta.size == 1:
        return 0.5 * float(theta[0] + outside)
    spacing = float(theta[1] - theta[0])
    low = (outside - float(theta[0])) / spacing
    place = by_two_nodes(float(quantity[0]), float(quantity[1]), exponent, low)
    most = max(theta.size // 2, min(theta.size - 1, EDGE_LEAST))
    if alike >= sum(EDGE_NEAREST):
        most = min(most, alike)
    if most < sum(EDGE_NEAREST):
        return float(theta[0]) + spacing * place
    used = theta[: EDGE_ENDS[bisect.bisect_right(EDGE_ENDS, most) - 1]]
    x = np.round((used - theta[0]) / spacing + 0.5, 9)  # 0 is halfway to the next node of an equal spacing
    powered = np.abs(quantity[: x.size]) ** (1.0 / exponent)
    designs = _edge_designs(x.tobytes())
    series = (designs.series @ powered).reshape(len(designs.windows), -1)
    found = kernels.least_squares.edge(
        series, designs.windows, designs.amplifications, designs.columns, designs.inverses, powered, low, EDGE_LIMITS
    )
    return float(theta[0]) + spacing * (place if math.isnan(found) else found)


def by_two_nodes(first: float, second: float, exponent: float, low: float) -> float:
    """Zero of the line through two nodes, in node distances from the first one, the outermost node of a zone.

    The line goes through the values to the power 1/`exponent`. If it does not fall outwards, the result is halfway to
    the next node outwards at `low` < 0.
    """
    outer, inner = abs(first) ** (1.0 / exponent), abs(second) ** (1.0 / exponent)
    return max(-outer / (inner - outer), low) if inner > outer else 0.5 * low


@dataclass(frozen=True, eq=False)
class _EdgeDesigns:
    """All fits to try at an edge, as :func:`fastpin.kernels.least_squares.edge` takes them.

    ``series``, shape (fits * terms, nodes), times the nodal values gives the coefficients of all polynomials.
    """

    series: np.ndarray
    windows: np.ndarray
    amplifications: np.ndarray
    columns: np.ndarray
    inverses: np.ndarray


@functools.lru_cache(maxsize=64)
def _edge_designs(places: bytes) -> _EdgeDesigns:
    """The fits to try for nodes at these distances from the edge. The first one uses the nearest window."""
    x = np.frombuffer(places)
    chosen = [(*EDGE_NEAREST, 2, False)]
    for first, count in EDGE_WINDOWS:
        for degree in EDGE_DEGREES:
            for decaying in (False, True):
                too_simple = count >= EDGE_LONG and (degree == 1 or (not decaying and first == EDGE_FAR))
                if first + count <= x.size and not too_simple and count >= degree + 1 + decaying + SPARE:
                    chosen.append((first, count, degree, decaying))
    terms, longest = max(EDGE_DEGREES) + 1, max(count for _, count, _, _ in chosen)
    series = np.zeros((len(chosen), terms, x.size))
    columns, inverses = np.zeros((2, len(chosen), terms + 1, longest))
    for k, (first, count, degree, decaying) in enumerate(chosen):
        window = x[first : first + count]
        scaled, powers = window / window[-1], np.arange(degree + 1)
        of_fit = np.column_stack([scaled[:, None] ** powers, *([1.0 / scaled] * decaying)])
        inverse = np.linalg.pinv(of_fit)
        series[k, : degree + 1, first : first + count] = inverse[: degree + 1] / window[-1] ** powers[:, None]
        columns[k, : of_fit.shape[1], :count], inverses[k, : of_fit.shape[1], :count] = of_fit.T, inverse
    windows = np.array([(first, count, degree + 1 + decaying) for first, count, degree, decaying in chosen])
    return _EdgeDesigns(series.reshape(-1, x.size), windows, np.linalg.norm(series[:, 0], axis=1), columns, inverses)


def border_peak(x: np.ndarray, bound: np.ndarray, exponent: float) -> Peak | None:
    """Largest bound mu N on the slip side of a stick-slip border, at which the bound has a cusp.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Distances of the nodes from the border in node distances, increasing; positive on the slip side.
    bound : ndarray, shape (n,)
        The bound mu N >= 0 at these nodes.
    exponent : float
        Power of the cusp. The bound is p(x) on the stick side and p(x) + x^exponent q(x) on the slip side, where p and
        q are smooth.

    Returns
    -------
    Peak or None
        None if no fit is good enough, or if the bound still rises at the end of the window.
    """
    fitted = np.empty(BORDER_PLACES)
    error, half = kernels.least_squares.border(
        _own(x), _own(bound), exponent, BORDER_WINDOWS, BORDER_SHAPES, SPARE, fitted
    )
    if error > BORDER_ERROR * float(bound.max()):
        return None
    top = int(np.argmax(fitted))
    if top == 0:
        return Peak(float(fitted[0]), error, 0.0)
    if top == fitted.size - 1:
        return None
    shift, value = _vertex(*(float(height) for height in fitted[top - 1 : top + 2]))
    return Peak(value, error, half * ((top + shift) / (fitted.size - 1)) ** 2)


def _own(values: np.ndarray) -> np.ndarray:
    """A copy without gaps that may be written to. Compiled code is compiled anew for any other array."""
    return np.array(values, dtype=float)


def _vertex(before: float, middle: float, after: float) -> tuple[float, float]:
    """Place and value of the extreme of the parabola through three equally spaced values.

    The place counts from the middle value, in spacings.
    """
    bend = before - 2.0 * middle + after
    shift = 0.5 * (before - after) / bend if bend != 0.0 else 0.0
    return shift, middle - 0.25 * (before - after) * shift


def cusp(x: np.ndarray, values: np.ndarray, exponent: float) -> Peak | None:
    """The cusp that an earlier stick-slip border left behind, near the largest value.

    The values are p(x) beyond the cusp and p(x) - |x - place|^exponent q(x) before it, where p and q are smooth.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Distances of the nodes from the node with the largest value, in node distances, increasing.
    values : ndarray, shape (n,)
        Values at these nodes.
    exponent : float
        Power of the cusp.

    Returns
    -------
    Peak or None
        None if no cusp is found within two node distances of the largest value.
    """
    tried: list[tuple[float, int, float, np.ndarray, np.ndarray, tuple[int, int, bool]]] = []
    rounded = np.round(x, 9)
    for half, skipped in CUSP_WINDOWS:
        if x[0] > 0.5 - half or x[-1] < half - 0.5:
            continue
        first, left, right, last = np.searchsorted(x, [-half - 0.5, -skipped - 0.5, skipped + 0.5, half + 0.5])
        window, wanted = (np.concatenate([given[first:left], given[right:last]]) for given in (rounded, values))
        for shape in CUSP_SHAPES:
            if window.size >= shape[0] + 1 + shape[1] + shape[2] + 1 + SPARE:
                smooth, bases, amplification = _cusp_bases(window.tobytes(), shape, exponent)
                error, place = kernels.least_squares.search_cusp(smooth, bases, wanted, amplification, CUSP_REACH)
                tried.append((error, len(tried), place, window, wanted, shape))
    best: Peak | None = None
    for _, _, begin, window, wanted, shape in sorted(tried)[:CUSP_REFINED]:
        coefficients = np.empty(sum(shape) + 1)
        place, error = kernels.least_squares.refine_cusp(
            window, wanted, begin, shape, exponent, CUSP_STEPS, CUSP_STEP, coefficients
        )
        if abs(place) <= CUSP_REACH and (best is None or error < best.error):
            steepness = float(coefficients[shape[0] + 1]) / float(window[-1]) ** exponent
            best = Peak(float(coefficients[0]), error, place, steepness)
    return best


@functools.lru_cache(maxsize=256)
def _cusp_bases(window: bytes, shape: tuple[int, int, bool], exponent: float) -> tuple[np.ndarray, np.ndarray, float]:
    """The columns of a cusp for every place to try, see :func:`fastpin.kernels.least_squares.cusp_bases`.

    They are the orthonormal polynomials, the rest of the columns for each place, and the amplification of errors.
    """
    x = np.frombuffer(window).copy()
    degree, terms, decaying = shape
    smooth, bases = np.empty((degree + 1, x.size)), np.empty((CUSP_PLACES, terms + decaying, x.size))
    places = np.linspace(-CUSP_REACH, CUSP_REACH, CUSP_PLACES)
    return smooth, bases, kernels.least_squares.cusp_bases(x, places, shape, exponent, smooth, bases)


def corner(x: np.ndarray, values: np.ndarray) -> Peak | None:
    """A corner at x = 0, from which two smooth branches fall on both sides.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Distances of the nodes from the corner in node distances, increasing.
    values : ndarray, shape (n,)
        Values at these nodes.

    Returns
    -------
    Peak or None
        None if the values do not fall on both sides with a clear change of slope.
    """
    error, value = kernels.least_squares.corner(
        _own(x), _own(values), CORNER_WINDOWS, CORNER_DEGREES, SPARE, CORNER_BEND
    )
    return Peak(value, error, 0.0) if error < math.inf else None


@dataclass(frozen=True, eq=False)
class Law:
    """A power law at one end of a zone: the real part of x^a (c0 + c1 x + ...), with the distance x from the end.

    Attributes
    ----------
    place : float
        Angle of the end, rad.
    inwards : int
        1 if the zone lies at larger angles, otherwise -1.
    exponent : complex
        The power a.
    coefficients : ndarray of complex, shape (degree + 1,)
        For x in node distances.
    spacing : float
        Node distance, rad.
    reach : float
        Part of the zone that the law describes, rad.
    """

    place: float
    inwards: int
    exponent: complex
    coefficients: np.ndarray
    spacing: float
    reach: float

    def applies(self, theta: np.ndarray) -> np.ndarray:
        """Whether each angle, shape (m,), lies in the part of the zone that the law describes."""
        x = self.inwards * (theta - self.place) / self.reach
        return np.asarray((x >= 0.0) & (x <= 1.0 + ROUNDING))  # the end itself, whatever its rounding

    def values(self, theta: np.ndarray) -> np.ndarray:
        """The law at angles in the zone, shape (m,); 0 at its end and beyond."""
        x = np.maximum(self.inwards * (theta - self.place), 0.0) / self.spacing
        power = np.exp(self.exponent * np.log(np.maximum(x, 1e-300)))
        series = np.polynomial.polynomial.polyval(x, self.coefficients)
        return np.where(x > 0.0, np.real(power * series), 0.0)


def law_of_nodes(
    place: float, line: HalfLine, theta: np.ndarray, values: np.ndarray, cusps: Sequence[OldBorder] = ()
) -> Law | None:
    """The power law at the end of a zone, by the solutions of the half line if they show the end at this place.

    Otherwise it is fitted as in :func:`law`.

    Parameters
    ----------
    place : float
        Angle of the end, rad.
    line : HalfLine
    theta, values : ndarray, shape (n,)
        Angles of the nodes of the zone, from this end on, rad; and the values there.
    cusps : sequence of OldBorder
        Old borders in the zone.

    Returns
    -------
    Law or None
        None if no fit is good enough.
    """
    fit = end_fit(values, line, cusps) if theta.size > 1 else None
    if fit is not None:
        spacing, last = float(theta[1] - theta[0]), int(fit.last)
        equal = abs(float(theta[last] - theta[0]) - last * spacing) <= LAW_EQUAL * abs(spacing)
        if equal and abs(float(theta[0]) + fit.place(0) * spacing - place) <= LAW_EQUAL * abs(spacing):
            series, error = fit.series(0)
            free = min((cusp.at for cusp in cusps if cusp.at > 0), default=last)
            if error <= LAW_ERROR * abs(series[0]):
                reach = abs(spacing) * min(LAW_REACH, last, free)
                return Law(place, int(np.sign(spacing)), line.exponent, series.astype(complex), abs(spacing), reach)
    return law(place, line.exponent, theta, values)


def law(place: float, exponent: complex, theta: np.ndarray, values: np.ndarray) -> Law | None:
    """Fit a power law at the end of a zone.

    Parameters
    ----------
    place : float
        Angle of the end, rad.
    exponent : complex
        With an imaginary part, the law also has the imaginary part of x^a.
    theta, values : ndarray, shape (n,)
        Angles of the nodes of the zone, from this end on, rad; and the values there.

    Returns
    -------
    Law or None
        None if the zone has too few nodes, or if no fit is good enough.
    """
    if theta.size < LAW_OFF.size:
        return None
    inwards, spacing = (1 if theta[-1] > place else -1), abs(float(theta[1] - theta[0]))
    x = inwards * (theta - place) / spacing
    best: tuple[float, np.ndarray, float] | None = None
    for first, count, degree, decaying in LAW_WINDOWS:
        window, wanted = x[first : first + count], values[first : first + count]
        if window.size < count:
            continue
        powers = [window ** (exponent + k) for k in range(degree + 1)]
        parts = [np.imag(powers[0])] * (exponent.imag != 0.0) + [window ** (exponent.real - 2.0)] * decaying
        columns = np.column_stack([*np.real(powers), *parts])
        coefficients = np.empty(columns.shape[1])
        error = kernels.least_squares.fit(columns, _own(wanted), coefficients)
        if best is None or error < best[0]:
            series = coefficients[: degree + 1].astype(complex)
            if exponent.imag != 0.0:
                series[0] -= 1j * coefficients[degree + 1]
            best = error, series, float(window[-1])
    if best is None:
        return None
    error, series, reach = best
    found = Law(place, inwards, exponent, series, spacing, spacing * min(LAW_REACH, reach))
    outermost = slice(LAW_OFF.size)
    size = min(abs(series[0]), float(np.abs(values[outermost]).max()))
    off = np.abs(found.values(theta[outermost]) - values[outermost])
    return found if error <= LAW_ERROR * size and np.all(off <= LAW_OFF * size) else None
