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

CONVERGED = 1e-3
"""Largest scatter of values that have converged without an order: three digits agree."""

ALIKE = 1e-5
"""Scatter up to which a drift is no sign of divergence: five digits agree.

In 1 of 36 sequences four random values grow in steps that grow. So a drift as small as this is scatter.
"""

Verdict = Literal["observed", "converged", "not converged", "to rounding", "not comparable"]
"""See :class:`Estimate`."""


class Estimate(NamedTuple):
    """The estimated limit of a sequence of values.

    Attributes
    ----------
    verdict : str
        "observed": the values show an order. "converged": the values follow no power of the spacing, and the last
        values scatter by at most :data:`CONVERGED`. "not converged": they scatter by more, or they drift away in steps
        that grow. "to rounding": all values are equal up to rounding. "not comparable": a value is missing (NaN).
    order : float
        The order p of C h^p. NaN unless observed.
    limit : float
        The limit f0. The last value if all values are equal up to rounding. NaN if no order is observed, or the values
        are not comparable.
    bar : float
        Error bar: in some 95 of 100 cases the limit lies within the last value +- bar. NaN if not comparable.
    scatter : float
        Range of the last three values in parts of their reference, see :func:`estimate`. NaN if not comparable.
    """

    verdict: Verdict
    order: float
    limit: float
    bar: float
    scatter: float


def estimate(
    spacings: Sequence[float], values: Sequence[float], rounding: float = 0.0, reference: float | None = None
) -> Estimate:
    """Estimate the observed order and the limit of a sequence of values, and the error bar of the last value.

    Parameters
    ----------
    spacings : sequence of float, shape (grids,)
        At least three node distances or step sizes, decreasing. Their ratios may differ, and their unit is free.
    values : sequence of float, shape (grids,)
    rounding : float
        Largest difference of values that are equal up to rounding, in the unit of the values.
    reference : float, optional
        The size to which the scatter is relative, positive; the magnitude of the last value unless given.
    """
    h, f = np.asarray(spacings, dtype=float) / spacings[-1], np.asarray(values, dtype=float)
    last = float(f[-1])
    if not np.all(np.isfinite(f)):
        return Estimate("not comparable", math.nan, math.nan, math.nan, math.nan)
    scattered = float(np.ptp(f[-LATEST:]))
    size = abs(last) if reference is None else reference
    scatter = scattered / size if size > 0.0 else math.inf if scattered else 0.0
    if np.ptp(f) <= rounding:
        return Estimate("to rounding", math.nan, last, float(np.ptp(f)), scatter)
    order, limit, deviation = _fit(h, f)
    if not LEAST_ORDER <= order <= MOST_ORDER or deviation >= MISFIT * np.ptp(f):
        steps = np.diff(f)
        is_drift = (np.all(steps > 0.0) or np.all(steps < 0.0)) and abs(steps[-1]) >= np.abs(steps).max()
        settled = scatter <= CONVERGED and not (scatter > ALIKE and is_drift)
        verdict: Verdict = "converged" if settled else "not converged"
        return Estimate(verdict, math.nan, math.nan, SAFETY_NOISE * scattered, scatter)
    if order > TRUSTED_ORDER:
        limit, deviation = _fit_of_order(h, f, TRUSTED_ORDER)
    safety = SAFETY if len(f) > LATEST else SAFETY_NOISE
    least = pair_bar(last, float(f[-2]), 1.0, float(h[-2]))
    return Estimate("observed", order, limit, max(safety * abs(last - limit) + deviation, least), scatter)


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
