"""Fits with the solutions of a half line in NumPy, as they are written down: the reference of the compiled ones."""

import math
from itertools import pairwise

import numpy as np

from fastpin.kernels.half_line import AT_END, LEAST_PLACE, MOST_NODES, MOST_PLACE, TERMS
from fastpin.reading.half_line import End, HalfLine, shear_columns

FACTORIALS = np.array([math.factorial(k) for k in range(TERMS)])


def powers(line: HalfLine, x: np.ndarray, terms: int) -> np.ndarray:
    """The powers x^(a - 1 + m) / Gamma(a + m) for x > 0, shape (k,), as an array (k, terms)."""
    gammas = np.array([math.gamma(line.exponent + m) for m in range(terms)])
    return x[:, None] ** (line.exponent - 1.0 + np.arange(terms)) / gammas


def columns(end: End, nodes: int) -> np.ndarray:
    """The columns of an end in a fit of a window, shape (nodes, unknowns)."""
    found, line = np.zeros((nodes, end.terms)), end.half_line
    offsets = end.inwards * (np.arange(nodes) - end.node)
    inside = offsets >= 0
    found[inside] = end.parts[0] * line.nodal[offsets[inside], : end.terms]
    if end.parts[1] != 0.0:
        sheared = shear_columns(line.exponent, line.coupling)
        found += end.parts[1] * sheared[MOST_NODES - 1 + offsets, : end.terms]
    if end.place is None:
        return found
    return found @ np.linalg.solve(line.matching[: end.terms, : end.terms], shift(-end.place, end.terms)[:, 1:])


def shift(origin: float, terms: int) -> np.ndarray:
    """Times the coefficients of the powers of a distance, the coefficients for distances from an origin inwards."""
    orders = np.arange(terms)
    shifted = origin**orders / FACTORIALS[:terms]
    return shifted[np.maximum(orders - orders[:, None], 0)] * (orders >= orders[:, None])


class NaiveFit:
    """A fit of the values (m,) at the nodes of a window, by the pseudo-inverse of its columns."""

    def __init__(self, values: np.ndarray, ends: tuple[End, ...], degree: int = -1) -> None:
        places = np.arange(values.size) / (values.size - 1.0)
        parts = [places[:, None] ** np.arange(degree + 1), *(columns(end, values.size) for end in ends)]
        design = np.column_stack(parts)
        sizes = np.abs(design).max(axis=0)
        self.inverse = np.linalg.pinv(design / sizes) / sizes[:, None]
        self.ends, self.degree, self.last = ends, degree, values.size - 1.0
        self.coefficients = self.inverse @ values
        left, spare = design @ self.coefficients - values, values.size - design.shape[1]
        self.scatter = float(np.linalg.norm(left)) / math.sqrt(spare) * (1.0 + 10.0 / spare)
        stops = degree + 1 + np.cumsum([0, *(end.terms - (end.place is not None) for end in ends)])
        self.rows = [slice(start, stop) for start, stop in pairwise(stops.tolist())]

    def match(self, at: int) -> tuple[float, np.ndarray]:
        """The place of an end inwards from its outermost node, and its change for a unit of each coefficient (n,)."""
        end, lever = self.ends[at], np.zeros(self.coefficients.size)
        if end.place is not None:
            return end.place, lever
        scaled = end.half_line.matching[: end.terms, : end.terms] / FACTORIALS[: end.terms, None]
        series = np.polynomial.Polynomial(scaled @ self.coefficients[self.rows[at]])
        place = -series.coef[0] / series.coef[1]
        for _ in range(50):
            place -= series(place) / series.deriv()(place)
        lever[self.rows[at]] = place ** np.arange(end.terms) @ scaled / series.deriv()(place)
        return place if LEAST_PLACE <= place <= MOST_PLACE else math.nan, lever

    def series(self, at: int) -> np.ndarray:
        """The coefficients of the powers of the distance from the place of an end, or from half a node outwards."""
        end, found = self.ends[at], self.coefficients[self.rows[at]]
        gammas = [math.gamma(end.half_line.exponent + m) for m in range(1, end.terms)]
        if end.place is not None:
            return found / gammas
        place = self.match(at)[0]
        far = np.polynomial.Polynomial(
            end.half_line.matching[: end.terms, : end.terms] @ found / FACTORIALS[: end.terms]
        )
        origin = -0.5 if math.isnan(place) else place
        return np.array([far.deriv(k)(origin) for k in range(1, end.terms)]) / gammas

    def place_error(self, at: int) -> float:
        return self.scatter * float(np.linalg.norm(self.match(at)[1] @ self.inverse))

    def row(self, x: float) -> np.ndarray:
        """The functions of all coefficients at a place x, in node distances from the node 0."""
        row = np.zeros(self.coefficients.size)
        row[: self.degree + 1] = (x / self.last) ** np.arange(self.degree + 1)
        for at, (end, rows) in enumerate(zip(self.ends, self.rows, strict=True)):
            place, line = self.match(at)[0], end.half_line
            origin, least = (-0.5, 0) if math.isnan(place) else (place, 1)
            inside, of_end = end.inwards * (x - end.node) - origin, np.zeros(end.terms)
            if inside > AT_END:
                of_end = sum(end.parts) * powers(line, np.array([inside]), end.terms)[0]
            elif inside < -AT_END:
                signs = end.parts[1] * math.cos(math.pi * line.exponent) * (-1.0) ** (np.arange(end.terms) - 1)
                of_end = signs * powers(line, np.array([-inside]), end.terms)[0]
            matching = shift(origin, end.terms) @ line.matching[: end.terms, : end.terms]
            row[rows] = of_end[1:] if end.place is not None else of_end[least:] @ matching[least:]
        return row

    def value(self, x: float) -> float:
        return float(self.row(x) @ self.coefficients)

    def value_error(self, x: float) -> float:
        return self.scatter * float(np.linalg.norm(self.row(x) @ self.inverse))
