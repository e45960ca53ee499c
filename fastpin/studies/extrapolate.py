"""The limit of a sequence of values on ever finer grids: observed order, extrapolated value, error bar.

f = f0 + C h^p is fitted to all values by least squares, with weights 1/h, as in L. Eca and M. Hoekstra, *A procedure
for the estimation of the numerical uncertainty of CFD calculations based on grid refinement studies*, J. Comput. Phys.
262 (2014) 104-130. With three values the fit is exact. It is then Richardson's extrapolation, for any refinement
ratios, with the order of P. J. Roache's grid convergence index (J. Fluids Eng. 116 (1994) 405-413; ASME V&V 20-2009).

The error bar, too, follows Eca and Hoekstra. With an observed order it is a safety factor times the distance to the
limit, plus the deviation from the fit. The factor is :data:`~fastpin.states.error_bars.SAFETY`. With three values it is
:data:`SAFETY_NOISE`, because an exact fit proves nothing. Without an observed order the bar is :data:`SAFETY_NOISE`
times the range of the last values. Eca and Hoekstra take the range of all values; here the coarsest grids do not count.
A bar is never below the grid convergence index for order one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
import scipy

from fastpin.states.error_bars import SAFETY, pair_bar

SAFETY_NOISE = 3.0
"""Safety factor of an error bar with three values, or without an observed order."""

LATEST = 3
"""Number of last values. Without an observed order their range gives the error bar."""

LEAST_ORDER, MOST_ORDER = 0.5, 4.0
"""Smallest and largest credible order. A fit with another order observes none."""

MISFIT = 0.1
"""Standard deviation, in parts of the range of the values, from which on a fit observes no order."""

TRUSTED_ORDER = 2.0
"""The order of piecewise linear tractions. A larger order is reported, but a fit of this order gives limit and bar."""

Verdict = Literal["observed", "not observed", "to rounding", "not comparable"]
"""See :class:`Estimate`."""


class Estimate(NamedTuple):
    """The estimated limit of a sequence of values.

    Attributes
    ----------
    verdict : str
        "observed": the values show an order. "not observed": the values follow no power of the spacing.
        "to rounding": all values are equal up to rounding. "not comparable": a value is missing (NaN).
    order : float
        The order p of C h^p. NaN unless observed.
    limit : float
        The limit f0. The last value if all values are equal up to rounding. NaN if no order is observed, or the values
        are not comparable.
    bar : float
        Error bar: in some 95 of 100 cases the limit lies within the last value +- bar. NaN if not comparable.
    """

    verdict: Verdict
    order: float
    limit: float
    bar: float


def estimate(spacings: Sequence[float], values: Sequence[float], rounding: float = 0.0) -> Estimate:
    """Estimate the observed order and the limit of a sequence of values, and the error bar of the last value.

    Parameters
    ----------
    spacings : sequence of float, shape (grids,)
        At least three node distances or step sizes, decreasing. Their ratios may differ, and their unit is free.
    values : sequence of float, shape (grids,)
    rounding : float
        Largest difference of values that are equal up to rounding, in the unit of the values.
    """
    h, f = np.asarray(spacings, dtype=float) / spacings[-1], np.asarray(values, dtype=float)
    last = float(f[-1])
    if not np.all(np.isfinite(f)):
        return Estimate("not comparable", math.nan, math.nan, math.nan)
    if np.ptp(f) <= rounding:
        return Estimate("to rounding", math.nan, last, float(np.ptp(f)))
    order, limit, deviation = _fit(h, f)
    if not LEAST_ORDER <= order <= MOST_ORDER or deviation >= MISFIT * np.ptp(f):
        return Estimate("not observed", math.nan, math.nan, SAFETY_NOISE * float(np.ptp(f[-LATEST:])))
    if order > TRUSTED_ORDER:
        limit, deviation = _fit_of_order(h, f, TRUSTED_ORDER)
    safety = SAFETY if len(f) > LATEST else SAFETY_NOISE
    least = pair_bar(last, float(f[-2]), 1.0, float(h[-2]))
    return Estimate("observed", order, limit, max(safety * abs(last - limit) + deviation, least))


def _fit(h: np.ndarray, f: np.ndarray) -> tuple[float, float, float]:
    """Return order, limit and standard deviation of the best fit.

    Without a best order inside the range of the search, the order is at an end of this range.
    """
    orders = np.linspace(0.5 * LEAST_ORDER, 1.25 * MOST_ORDER, 60)
    best = int(np.argmin([_fit_of_order(h, f, order)[1] for order in orders]))
    bounds = orders[max(best - 1, 0)], orders[min(best + 1, len(orders) - 1)]
    order = float(
        scipy.optimize.minimize_scalar(lambda p: _fit_of_order(h, f, p)[1], bounds=bounds, options={"xatol": 1e-6}).x
    )
    return order, *_fit_of_order(h, f, order)


def _fit_of_order(h: np.ndarray, f: np.ndarray, order: float) -> tuple[float, float]:
    """Return limit and standard deviation of the best fit of a given order."""
    weights = (1.0 / h) / np.sum(1.0 / h)
    powers = h**order
    power, value = weights @ powers, weights @ f
    factor = (weights * (powers - power)) @ (f - value) / (weights @ (powers - power) ** 2)
    limit = float(value - factor * power)
    square = len(f) * float(weights @ (f - limit - factor * powers) ** 2)
    return limit, math.sqrt(square / max(len(f) - 3, 1))
