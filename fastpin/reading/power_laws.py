"""Power laws at the ends of zones: a traction between the nodes beside an edge or a border.

Beside a contact edge N = x^a (c0 + c1 x + ...), where x is the distance from the edge. Inside a stick zone, beside its
border, mu N - |T| has the same form. The exponent a is 1/2 for like bodies. For unlike bodies it is a little off 1/2:
(T21), (T26). The solutions of the half line give these laws. Where they do not apply, powers are fitted: T beside an
edge that sticks has a complex exponent.

The nodal values beside an edge have two errors. One changes sign from node to node and is gone after some four nodes:
these nodes are left out. The other falls like x^(a - 2): it is fitted together with the power series. The best number
of nodes and of terms depends on the neighbourhood. So some windows are tried, and the smallest standard error counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fastpin.kernels import power_laws as kernel
from fastpin.reading.half_line import HalfLine
from fastpin.reading.old_borders import OldBorder
from fastpin.reading.zones import end_fit

WINDOWS = np.array([(2, 6, 1, False), (2, 8, 2, False), (2, 8, 1, True), (2, 12, 2, True), (2, 12, 3, True),
                    (2, 20, 3, True), (4, 30, 3, True)])  # fmt: skip
"""Fits of a power law to try.

Each has the number of nodes left out at the end of the zone, the number of nodes used, the degree of the polynomial,
and whether the part like x^(a - 2) is fitted too.
"""

ROUNDING = 1e-9
"""Relative error of an angle that is rounding, and imaginary part of an exponent that is none."""

REACH = 9.0
"""Part of a zone that a power law describes, in node distances; at most the fitted window."""

LARGEST_ERROR = 0.02
"""Largest standard error of the leading coefficient of a power law, in parts of it."""

OFF = np.array([0.25, 0.11, 0.03, 0.03])
"""Largest difference of a power law and the values at the four outermost nodes, in parts of the leading coefficient.

Where an earlier border lies between these nodes, the difference is larger. In good fits it is at most half of this.
"""


class Law(NamedTuple):
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
        values = np.empty(theta.size)
        x = self.inwards * (theta - self.place) / self.spacing
        kernel.evaluate(x, complex(self.exponent), self.coefficients, values)
        return values


def law_of_nodes(
    place: float, line: HalfLine, theta: np.ndarray, values: np.ndarray, cusps: Sequence[OldBorder] = ()
) -> Law | None:
    """The power law at the end of a zone, by the solutions of the half line if they show the end at this place.

    Otherwise it is fitted as in :func:`fit_law`.

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
        rounding = 1e-6 * abs(spacing)
        equal = abs(float(theta[last] - theta[0]) - last * spacing) <= rounding
        if equal and abs(float(theta[0]) + fit.place(0) * spacing - place) <= rounding:
            series, error = fit.series(0)
            free = min((cusp.at for cusp in cusps if cusp.at > 0), default=last)
            if error <= LARGEST_ERROR * abs(series[0]):
                reach = abs(spacing) * min(REACH, last, free)
                law = Law(place, int(np.sign(spacing)), line.exponent, series.astype(complex), abs(spacing), reach)
                off = np.abs(law.values(theta) - values)[law.applies(theta)]
                if np.all(off <= OFF[0] * abs(series[0])):  # no old border lies between the end and these nodes
                    return law
    return fit_law(place, line.exponent, theta, values)


def fit_law(place: float, exponent: complex, theta: np.ndarray, values: np.ndarray) -> Law | None:
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
    if theta.size < OFF.size:
        return None
    inwards, spacing = (1 if theta[-1] > place else -1), abs(float(theta[1] - theta[0]))
    x = inwards * (theta - place) / spacing
    series, turns = np.empty(4, dtype=complex), abs(exponent.imag) > ROUNDING
    error, reach = kernel.fit(x, np.array(values, dtype=float), complex(exponent), turns, WINDOWS, series)
    if reach == 0.0:
        return None
    found = Law(place, inwards, exponent, series, spacing, spacing * min(REACH, reach))
    outermost = slice(OFF.size)
    size = min(abs(series[0]), float(np.abs(values[outermost]).max()))
    off = np.abs(found.values(theta[outermost]) - values[outermost])
    return found if error <= LARGEST_ERROR * size and np.all(off <= OFF * size) else None
