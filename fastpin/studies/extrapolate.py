"""What a sequence of values on finer and finer grids says of its limit: observed order, extrapolated value, error bar.

f = f0 + C h^p is fitted to all values by least squares, with weights 1/h, as in L. Eca and M. Hoekstra, *A procedure
for the estimation of the numerical uncertainty of CFD calculations based on grid refinement studies*, J. Comput. Phys.
262 (2014) 104-130. With three values the fit is exact: Richardson's extrapolation with the order that P. J. Roache's
grid convergence index takes (J. Fluids Eng. 116 (1994) 405-413; ASME V&V 20-2009), for any refinement ratios.

The error bar is theirs, too. Where an order is observed: a safety factor times the distance to the limit, and the
deviation from the fit. The factor is :data:`SAFETY`, with three values, whose fit proves nothing, :data:`SAFETY_NOISE`.
Where none is: the latter times the range of the last values (of all of them, with Eca and Hoekstra; here coarse grids
that have been left behind do not count). A bar is never less than the index for an order of one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
import scipy

from fastpin.states.error_bars import SAFETY, pair_bar

SAFETY_NOISE = 3.0

LATEST = 3
"""Values whose range is the error bar where no order is observed."""

LEAST_ORDER, MOST_ORDER = 0.5, 4.0
"""Orders outside are not believed."""

MISFIT = 0.1
"""Standard deviation of a fit that shows no order any more, in parts of the range of the values."""

TRUSTED_ORDER = 2.0
"""The order of piecewise linear tractions: a larger one is reported, but limit and bar come from a fit of this one."""

Verdict = Literal["observed", "not observed", "to rounding", "not comparable"]


class Estimate(NamedTuple):
    """What is known of a limit.

    Attributes
    ----------
    verdict : str
        "observed": an order is. "not observed": the values follow no power of the spacing.
        "to rounding": all values are the same but for rounding. "not comparable": one of them is missing (NaN).
    order : float
        p of C h^p; NaN unless observed.
    limit : float
        f0; NaN unless observed. To rounding: the last value.
    bar : float
        The limit lies within the last value +- so much, in some 95 of 100 cases; NaN if not comparable.
    """

    verdict: Verdict
    order: float
    limit: float
    bar: float


def estimate(spacings: Sequence[float], values: Sequence[float], rounding: float = 0.0) -> Estimate:
    """Observed order, limit and error bar of the last of a sequence of values.

    Parameters
    ----------
    spacings : sequence of float, shape (grids,)
        Decreasing; ratios may differ. At least three.
    values : sequence of float, shape (grids,)
    rounding : float
        Values that differ by no more than this are the same.
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
    """Order, limit and standard deviation of the best fit; the order is at an end of its range where there is none."""
    orders = np.linspace(0.5 * LEAST_ORDER, 1.25 * MOST_ORDER, 60)
    best = int(np.argmin([_fit_of_order(h, f, order)[1] for order in orders]))
    near = orders[max(best - 1, 0)], orders[min(best + 1, len(orders) - 1)]
    order = float(
        scipy.optimize.minimize_scalar(lambda p: _fit_of_order(h, f, p)[1], bounds=near, options={"xatol": 1e-6}).x
    )
    return order, *_fit_of_order(h, f, order)


def _fit_of_order(h: np.ndarray, f: np.ndarray, order: float) -> tuple[float, float]:
    """Limit and standard deviation of the best fit of a given order."""
    weights = (1.0 / h) / np.sum(1.0 / h)
    powers = h**order
    power, value = weights @ powers, weights @ f
    factor = (weights * (powers - power)) @ (f - value) / (weights @ (powers - power) ** 2)
    limit = float(value - factor * power)
    square = len(f) * float(weights @ (f - limit - factor * powers) ** 2)
    return limit, math.sqrt(square / max(len(f) - 3, 1))
