"""Formulas for a spreadsheet, fitted to the charts, with the largest error of each."""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from fastpin.charts.groups import STORED, load_parameter_at, width_coordinate
from fastpin.charts.lookups import lookup
from fastpin.model.checks import in_one_shape, numbers

MOST_LOAD_PARAMETER, MOST_FRICTION = 10.0, 0.6
"""Largest load parameter and coefficient of friction of the formulas."""

DEGREE = 3
"""Largest sum of powers of the polynomials."""

SAMPLES = 61
"""Values of load parameter and friction at which a formula is fitted, and twice as many for its error."""

ROUNDS = 15
"""Rounds of the fit. They lower its largest error."""

DIGITS = 4
"""Decimal places of the coefficients."""

HEAD = ("x     =1/SQRT(0.4563+PI()*Lp)", "z     =mu/SQRT(mu^2+0.2*x^2)")
"""Cells that all formulas use."""


FACTORS = {"peak_pressure": "*SQRT(1.438+16*Lp/PI())", "contact_angle": "*x", "kt_bearing": ""}
"""The quantities with a formula, and the factor of :data:`fastpin.charts.groups.STORED` as a spreadsheet has it."""


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
        Bound of its error in parts of the value: the largest distance from the chart, with the bound of the chart.
    coefficients : dict
        By the powers of x and z.
    """

    quantity: str
    pin_load: str
    cell: str
    error: float
    coefficients: dict[tuple[int, int], float]

    def at(self, load_parameter: ArrayLike, friction: ArrayLike) -> np.ndarray:
        """The value of the formula; the arguments broadcast.

        Raises
        ------
        InputError
            If an argument is beyond the range of the formula.
        """
        parameter = numbers("load_parameter", load_parameter, 0.0, MOST_LOAD_PARAMETER)
        parameter, mu = in_one_shape("load_parameter", parameter, numbers("friction", friction, 0.0, MOST_FRICTION))
        x, z = _cells(parameter, mu)
        total = sum(value * x**a * z**b for (a, b), value in self.coefficients.items())
        return np.asarray(STORED[self.quantity].value(total, parameter))


@functools.cache
def chart_formulas() -> tuple[ChartFormula, ...]:
    """The formulas of like bodies with nu = 0.3 in plane strain, for load parameters and friction up to the limits."""
    return tuple(_fitted(*pair) for pair in itertools.product(FACTORS, ("body", "centre")))


def _fitted(quantity: str, pin_load: str) -> ChartFormula:
    """Fit a polynomial in x and z to a chart. The largest relative distances get more and more weight."""
    powers = [(a, b) for a in range(DEGREE + 1) for b in range(DEGREE + 1 - a)]
    at, friction = _samples(SAMPLES)
    value = lookup(quantity, load_parameter=at, friction=friction, pin_load=pin_load).value
    x, z = _cells(at, friction)
    goal = STORED[quantity].stored(value, at)
    columns = np.stack([x**a * z**b for a, b in powers], axis=-1) / goal[:, None]
    weights = np.ones(len(goal))
    for _ in range(ROUNDS):
        found = np.linalg.lstsq(columns * weights[:, None], weights, rcond=None)[0]
        away = np.abs(columns @ found - 1.0)
        weights *= np.sqrt(away / away.max() + 0.05)
    coefficients = {pair: round(float(value), DIGITS) for pair, value in zip(powers, found, strict=True)}
    terms = "".join(f"{c:+.{DIGITS}f}{_power('x', a)}{_power('z', b)}" for (a, b), c in coefficients.items() if c)
    cell = f"=({terms.lstrip('+')}){FACTORS[quantity]}"
    formula = ChartFormula(quantity, pin_load, cell, 0.0, coefficients)
    at, friction = _samples(2 * SAMPLES)
    chart = lookup(quantity, load_parameter=at, friction=friction, pin_load=pin_load)
    error = float(np.max((np.abs(formula.at(at, friction) - chart.value) + chart.error) / chart.value))
    return ChartFormula(quantity, pin_load, cell, error, coefficients)


def _cells(load_parameter: np.ndarray, friction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cells x and z of :data:`HEAD`. The smaller z, the more slips."""
    x = np.asarray(width_coordinate(load_parameter))
    return x, friction / np.sqrt(friction**2 + 0.2 * x**2)


def _samples(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Load parameters and frictions of a grid, each shape (count**2,), equally spaced in x and sqrt(mu)."""
    x = np.linspace(width_coordinate(MOST_LOAD_PARAMETER), width_coordinate(0.0), count)
    at = np.clip(load_parameter_at(x), 0.0, MOST_LOAD_PARAMETER)
    friction = np.minimum(np.linspace(0.0, MOST_FRICTION**0.5, count) ** 2, MOST_FRICTION)
    grid = np.meshgrid(at, friction, indexing="ij")
    return grid[0].ravel(), grid[1].ravel()


def _power(cell: str, power: int) -> str:
    return "" if power == 0 else f"*{cell}" if power == 1 else f"*{cell}^{power}"
