"""Formulas for a spreadsheet, fitted to the charts, with the largest error of each."""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass

import numpy as np

from fastpin.charts.groups import width_coordinate
from fastpin.charts.lookups import CHARTS, lookup

MOST_LOAD_PARAMETER, MOST_FRICTION = 10.0, 0.6
"""Largest load parameter and coefficient of friction of the formulas."""

DEGREE = 4
"""Largest sum of powers of the polynomials."""

SAMPLES = 61
"""Values of load parameter and friction at which a formula is fitted, and twice as many for its error."""

DIGITS = 4
"""Decimal places of the coefficients."""

HEAD = ("x     =1/SQRT(0.4563+PI()*Lp)", "t     =SQRT(mu)")
"""Cells that all formulas use."""


@dataclass(frozen=True)
class ChartFormula:
    """A formula for a spreadsheet.

    Attributes
    ----------
    quantity : str
        A name of :data:`fastpin.charts.CHARTS`.
    pin_load : str
    cell : str
        The formula, with the cells Lp, mu and those of :data:`HEAD`.
    error : float
        Bound of its error: the largest distance from the chart, and the bound of the chart there. In parts of the value
        for ratios, rad for angles.
    coefficients : dict
        By the powers of x and t.
    """

    quantity: str
    pin_load: str
    cell: str
    error: float
    coefficients: dict[tuple[int, int], float]

    def at(self, load_parameter: np.ndarray, friction: np.ndarray) -> np.ndarray:
        """The value of the formula; the arguments broadcast."""
        x, t = width_coordinate(load_parameter), friction**0.5
        total = sum(value * x**a * t**b for (a, b), value in self.coefficients.items())
        return np.asarray(total / x if self.quantity == "peak_pressure" else total)


@functools.cache
def chart_formulas() -> tuple[ChartFormula, ...]:
    """The formulas of like bodies with nu = 0.3 in plane strain, for load parameters and friction up to the limits."""
    quantities = ("peak_pressure", "contact_angle", "kt_bearing")
    return tuple(_fitted(*pair) for pair in itertools.product(quantities, ("body", "centre")))


def _fitted(quantity: str, pin_load: str) -> ChartFormula:
    """Fit a polynomial in x and t to a chart, by least squares of the relative distance."""
    powers = [(a, b) for a in range(DEGREE + 1) for b in range(DEGREE + 1 - a)]
    at, friction = _samples(SAMPLES)
    value = lookup(quantity, load_parameter=at, friction=friction, pin_load=pin_load).value
    x, t = width_coordinate(at), friction**0.5
    goal = value * x if quantity == "peak_pressure" else value  # Hertz's pressure goes like 1/x
    columns = np.stack([x**a * t**b for a, b in powers], axis=-1) / goal[:, None]
    found = np.round(np.linalg.lstsq(columns, np.ones(len(goal)), rcond=None)[0], DIGITS).tolist()
    coefficients = dict(zip(powers, found, strict=True))
    terms = "".join(f"{c:+.{DIGITS}f}{_power('x', a)}{_power('t', b)}" for (a, b), c in coefficients.items() if c)
    cell = f"=({terms.lstrip('+')})/x" if quantity == "peak_pressure" else f"={terms.lstrip('+')}"
    formula = ChartFormula(quantity, pin_load, cell, 0.0, coefficients)
    at, friction = _samples(2 * SAMPLES)
    chart = lookup(quantity, load_parameter=at, friction=friction, pin_load=pin_load)
    away = np.abs(formula.at(at, friction) - chart.value) + chart.error
    error = float(np.max(away if CHARTS[quantity].unit else away / chart.value))
    return ChartFormula(quantity, pin_load, cell, error, coefficients)


def _samples(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Load parameters and frictions of a grid, each shape (count**2,), equally spaced in x and t."""
    x = np.linspace(width_coordinate(MOST_LOAD_PARAMETER), width_coordinate(0.0), count)
    at = np.maximum((x**-2.0 - x[-1] ** -2.0) / np.pi, 0.0)
    t = np.linspace(0.0, MOST_FRICTION**0.5, count)
    grid = np.meshgrid(at, t**2, indexing="ij")
    return grid[0].ravel(), grid[1].ravel()


def _power(cell: str, power: int) -> str:
    return "" if power == 0 else f"*{cell}" if power == 1 else f"*{cell}^{power}"
