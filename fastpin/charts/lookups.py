"""Values of the charts at given parameters, with their error bounds."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fastpin.bodies.kinds import INFINITE_PLATE, SOLID_PIN
from fastpin.charts import groups
from fastpin.charts.groups import STORED, load_parameter_at, tables, width_coordinate
from fastpin.errors import InputError
from fastpin.model.checks import choice, in_one_shape, instance, known_name, number, numbers, positive
from fastpin.model.problem import Problem
from fastpin.model.synonyms import closest

CYCLE_PARAMETERS = ("load_parameter", "friction", "load_ratio", "alpha", "beta", "kolosov", "pin_load", "rotation")
"""Parameters of a chart of a load cycle: those of the first load, and two more."""

DEFAULTS: dict[str, Any] = {"alpha": 0.0, "beta": 0.0, "kolosov": 1.8, "pin_load": "centre", "rotation": "free"}
"""Parameters that may be left out: like bodies with nu = 0.3 in plane strain, load at the centre, free rotation."""

_CHOICES = {"pin_load": ("centre", "body"), "rotation": ("free", "fixed")}

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
class ChartQuantity:
    """A quantity of the charts.

    Attributes
    ----------
    name : str
    words : str
        Its meaning.
    unit : str
        Its unit in terms of the force P, the radius R and the compliance beta*; empty for a ratio.
    is_cycle : bool
        Whether it belongs to a load cycle; else to the first load.
    """

    name: str
    words: str
    unit: str

    @property
    def is_cycle(self) -> bool:
        """Whether it belongs to a load cycle; else to the first load."""
        return self.name in groups.CYCLE

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of its parameters."""
        of_cycles = () if self.is_cycle else ("load_ratio", "rotation")
        return tuple(name for name in CYCLE_PARAMETERS if name not in of_cycles)


@dataclass(frozen=True)
class ChartValue:
    """A value of a chart.

    Attributes
    ----------
    value : float or ndarray
    error : float or ndarray
        Bound of its error, in the same unit. Solver and discretisation are in it.
    unit : str
    """

    value: Any
    error: Any
    unit: str

    def __float__(self) -> float:
        return float(self.value)


CHARTS = {
    chart.name: chart
    for chart in (
        ChartQuantity("peak_pressure", "largest pressure over the bearing stress P/(2 R), first load", ""),
        ChartQuantity("peak_pressure_angle", "place of the largest pressure from the bottom, first load", "rad"),
        ChartQuantity("contact_angle", "half-angle of the contact, first load", "rad"),
        ChartQuantity("stick_angle", "half of all angles that stick, first load", "rad"),
        ChartQuantity("kt_bearing", "largest hoop stress round the hole over P/(2 R), first load", ""),
        ChartQuantity("peak_hoop_angle", "place of the largest hoop stress from the bottom, first load", "rad"),
        ChartQuantity("cycle_energy", "friction energy of a cycle of Q", "P^2 beta*"),
        ChartQuantity("cycle_slip_range", "largest slip range of a place in a cycle of Q", "P beta*"),
        ChartQuantity("cycle_stick_angle", "half of all angles that stick at the end of a cycle of Q", "rad"),
        ChartQuantity("cycle_peak_pressure", "largest pressure over P/(2 R) at the end of a cycle of Q", ""),
        ChartQuantity("cycle_kt_bearing", "largest hoop stress round the hole over P/(2 R), end of a cycle of Q", ""),
    )
}
"""The charts by name."""


def lookup(quantity: str, **parameters: Any) -> ChartValue:
    """Look up the value of a chart. It takes microseconds for numbers; arrays broadcast.

    Parameters
    ----------
    quantity : str
        A name of :data:`CHARTS`.
    load_parameter : float or array_like
        L_p = (R - R_D)/(P beta*), see :meth:`fastpin.Problem.load_parameter`.
    friction : float or array_like
    load_ratio : float or array_like
        Q/P, the amplitude of the cycle; of the charts of a cycle only.
    alpha, beta : float or array_like
        Dundurs' parameters in the usual sign, 0 unless given.
    kolosov : float or array_like
        Kolosov's constant of the pin: 3 - 4 nu in plane strain, (3 - nu)/(1 + nu) in plane stress; 1.8 unless given.
    pin_load : {"centre", "body"}
    rotation : {"free", "fixed"}
        Of the charts of a cycle only. The circle of the paper is held, see :class:`fastpin.Problem`.

    Returns
    -------
    ChartValue
        The value and the bound of its error.

    Raises
    ------
    InputError
        If there is no such chart or parameter, a parameter is missing, or lies beyond the range of the chart. There is
        no extrapolation.
    """
    chart = chart_of(quantity)
    given = _checked(chart, parameters)
    group = _group(given)
    units = [_unit(axis, given) for axis in group.axes]
    value, error = tables()[group.name].value_at(quantity, units, given["load_parameter"])
    return ChartValue(value, error, chart.unit)


def _group(given: Mapping[str, Any]) -> groups.ChartGroup:
    """The group of charts of some parameters; a load cycle has a rotation."""
    is_like = not any(value if isinstance(value := given[name], float) else value.any() for name in ("alpha", "beta"))
    if "rotation" not in given:
        return groups.GROUPS[f"{'like' if is_like else 'unlike'}_{given['pin_load']}"]
    name = "held" if given["rotation"] == "fixed" else f"free_{given['pin_load']}"
    return groups.GROUPS[name if is_like else f"unlike_{name}"]


def chart_of(quantity: object) -> ChartQuantity:
    """The chart of a name.

    Raises
    ------
    UnknownNameError
        If there is no such chart. The message says which name is meant.
    """
    if not isinstance(quantity, str) or quantity not in CHARTS:
        known_name("chart", quantity, CHARTS)
    return CHARTS[str(quantity)]


def _checked(chart: ChartQuantity, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters of a chart, checked for themselves, with those that were left out."""
    for name in parameters:
        if name in chart.parameters:
            continue
        if name in CYCLE_PARAMETERS:
            raise InputError(name, f"has no meaning in the chart {chart.name}: it belongs to the charts of a cycle")
        known = f"{', '.join(chart.parameters)}{closest(name, chart.parameters)}"
        raise InputError(name, f"is no parameter of the chart {chart.name}, which has {known}")
    given: dict[str, Any] = {}
    for name in chart.parameters:
        if name not in parameters and name not in DEFAULTS:
            raise InputError(name, f"is needed by the chart {chart.name}")
        value = parameters.get(name, DEFAULTS.get(name))
        if name in _CHOICES:
            given[name] = choice(name, value, _CHOICES[name])
        elif isinstance(value, (list, tuple, np.ndarray)):
            given[name] = numbers(name, value)
        else:
            given[name] = number(name, value)
    if given.get("rotation") == "fixed" and given["pin_load"] == "body":
        raise InputError("rotation", 'must be "free" for a body load: uniform body forces bear no moment')
    numeric = [name for name in chart.parameters if name not in _CHOICES]
    if any(not isinstance(given[name], float) for name in numeric):
        try:
            given |= zip(numeric, np.broadcast_arrays(*(given[name] for name in numeric)), strict=True)
        except ValueError:
            raise InputError("load_parameter", "and the other parameters have shapes that do not fit") from None
    return given


def _unit(axis: groups.TableAxis, given: Mapping[str, Any]) -> Any:
    """The place along an axis, 0 to 1: a float or an array. Raises :class:`InputError` if it is out of range."""
    field, low, high, words = _limits(axis, given)
    value, slack = given[field], groups.ROUNDING if words else 0.0
    if isinstance(value, float):
        if not low - slack <= value <= high + slack:
            raise InputError(field, f"must lie between {low:.6g} and {high:.6g}{words}, not {value:.6g}")
    else:
        value, low, high = np.broadcast_arrays(value, low, high)
        outside = (value < low - slack) | (value > high + slack)
        if outside.any():
            k = np.flatnonzero(outside)[0]
            least, most, first = (float(each.flat[k]) for each in (low, high, value))
            raise InputError(field, f"must lie between {least:.6g} and {most:.6g}{words}, not {first:.6g}")
    unit = (groups.COORDINATES[axis.name](given) - axis.least) / (axis.most - axis.least)
    return min(max(unit, 0.0), 1.0) if isinstance(unit, float) else np.clip(unit, 0.0, 1.0)


def _limits(axis: groups.TableAxis, given: Mapping[str, Any]) -> tuple[str, Any, Any, str]:
    """The parameter of an axis, its least and largest value, and words on the limits."""
    if axis.name == "plate term":
        low, high = (
            groups.plate_beta(given["alpha"], groups.pin_term(given), plate) for plate in (axis.most, axis.least)
        )
        return "beta", low, high, " for this alpha and kolosov"
    field, low, high = groups.parameter_range(axis)
    if field == "load_ratio":
        return field, low * given["friction"], high * given["friction"], f", {low:g} and {high:g} times the friction"
    return field, low, high, ""


def joint_values(problem: Problem, P: float, Q: float | None = None) -> dict[str, ChartValue]:
    """The values of all charts for a joint, in SI units: Pa, rad, J/m and m.

    Parameters
    ----------
    problem : Problem
        A solid pin in a round hole of an infinite isotropic plate, with clearance or a neat fit and one friction.
    P : float
        The force on the pin, N/m, positive.
    Q : float, optional
        The amplitude of the force across, N/m: the charts of a load cycle then follow. Without it the charts of the
        first load follow.

    Returns
    -------
    dict of str to ChartValue
        By the names of :data:`CHARTS`. "kt_bearing" and "cycle_kt_bearing" are ratios.

    Raises
    ------
    InputError
        If the charts do not cover the joint, or a parameter lies beyond their range.
    """
    _check_joint(instance("problem", problem, Problem, "a Problem"))
    force, pair = positive("P", P), problem.pair
    given: dict[str, Any] = {"load_parameter": problem.load_parameter(force), "friction": problem.uniform_friction}
    given |= {"kolosov": pair.pin_kolosov, "pin_load": problem.pin_load}
    alpha, beta = (value if abs(value) > groups.ROUNDING else 0.0 for value in pair.dundurs())
    given |= {"alpha": alpha, "beta": beta}
    if Q is not None:
        given |= {"rotation": problem.rotation, "load_ratio": abs(number("Q", Q)) / force}
    bearing, squeeze = 0.5 * force / problem.hole_radius, force * pair.beta_star
    units = {"cycle_energy": ("J/m", force * squeeze), "cycle_slip_range": ("m", squeeze)}
    units |= dict.fromkeys(("peak_pressure", "cycle_peak_pressure"), ("Pa", bearing))
    found = {}
    for name in _group(given).quantities:
        here = lookup(name, **given)
        unit, scale = units.get(name, (here.unit, 1.0))
        found[name] = ChartValue(scale * here.value, scale * here.error, unit)
    return found


def _check_joint(problem: Problem) -> None:
    """Raise :class:`InputError` if the charts do not cover a joint."""
    refused = {"pin_body": problem.pin_body != SOLID_PIN, "plate_body": problem.plate_body != INFINITE_PLATE}
    refused |= {"gap": bool(problem.gap), "drive": problem.drive != "force"}
    refused["hub_radius"] = problem.hub_radius is not None
    for field, is_refused in refused.items():
        if is_refused:
            raise InputError(field, "is not in the charts: solve this joint")
    if problem.rotation == "spring":
        raise InputError("rotation", 'must be "free" or "fixed" in the charts')
    if not problem.pair.plate.is_isotropic:
        raise InputError("plate", "must be isotropic in the charts: solve this joint")


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
