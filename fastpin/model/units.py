"""Units of every kind of quantity, and SI prefixes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from fastpin.model.loads import LOAD_KIND, LOADS
from fastpin.model.problem import Problem

_SI = {
    "force": "N/m",
    "moment": "N",
    "traction": "Pa",
    "length": "m",
    "displacement": "m",
    "rotation": "rad",
    "stiffness": "N/rad",
    "energy": "J/m",
    "ratio": "",
    "energy density": "J/m^2",
    "stress times strain": "Pa",
    "life": "cycles",
}

_WITH_PREFIX = frozenset({*_SI.values(), "s"} - {"", "cycles"})
"""Units that may get an SI prefix."""

_DIMENSIONLESS = {
    "force": "F",
    "moment": "F R",
    "traction": "F/R",
    "length": "R",
    "displacement": "F beta*",
    "rotation": "F beta*/R",
    "stiffness": "R^2/beta*",
    "energy": "F^2 beta*",
    "ratio": "",
    "energy density": "F^2 beta*/R",
    "stress times strain": "F^2 beta*/R^2",
    "life": "cycles",
}

_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "u", -9: "n", -12: "p"}


def units(problem: Problem) -> dict[str, str]:
    """The unit of every kind of quantity: SI, or the paper's units for a dimensionless problem."""
    return dict(_DIMENSIONLESS if problem.dimensionless else _SI)


def scaled(values: Sequence[float], unit: str) -> tuple[float, str]:
    """A factor for `values`, and `unit` with an SI prefix. In this unit the largest value reads well.

    Ratios, lives, units of a dimensionless problem, degrees and units of the user such as "MPa" keep the factor 1 and
    get no prefix.
    """
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    if unit not in _WITH_PREFIX or largest == 0.0:
        return 1.0, unit
    exponent = 3 * math.floor(math.log10(largest * (1.0 + 1e-12)) / 3.0)
    exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    return 10.0**-exponent, _PREFIXES[exponent] + unit


def acting_loads(loads: Sequence[Mapping[str, float]]) -> list[str]:
    """Names of the loads that are not zero in at least one of `loads`."""
    return [name for name in LOADS if any(load.get(name, 0.0) != 0.0 for load in loads)]


def named_loads(problem: Problem, load: Mapping[str, float]) -> str:
    """The loads that are not zero, as text with their units."""
    unit = units(problem)
    acting = acting_loads([load])
    return ", ".join(f"{name} = {with_unit(load[name], unit[LOAD_KIND[name]], 5)}" for name in acting) or "no load"


def with_unit(value: float, unit: str, digits: int = 6) -> str:
    """A value as text in its unit with an SI prefix, to so many significant `digits`."""
    factor, label = scaled([value], unit)
    return f"{value * factor:.{digits}g} {label}"
