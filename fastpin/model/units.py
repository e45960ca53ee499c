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

_WITH_THICKNESS = {"force": "N", "moment": "N m", "stiffness": "N m/rad", "energy": "J"}
"""Units of the kinds that are per thickness elsewhere, in printed texts of a problem with a thickness."""

_WITH_PREFIX = frozenset({*_SI.values(), *_WITH_THICKNESS.values(), "s"} - {"", "cycles"})
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


def printed_unit(problem: Problem, kind: str) -> tuple[float, str]:
    """The factor and the unit of a kind of quantity in printed texts: in N, not in N/m, if there is a thickness."""
    if problem.thickness is not None and kind in _WITH_THICKNESS:
        return problem.thickness, _WITH_THICKNESS[kind]
    return 1.0, units(problem)[kind]


def printed_scale(problem: Problem, kind: str, values: Sequence[float]) -> tuple[float, str]:
    """As :func:`scaled`, for values of a kind of quantity in printed texts of a problem."""
    whole, unit = printed_unit(problem, kind)
    factor, label = scaled([whole * value for value in values], unit)
    return whole * factor, label


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
    parts = []
    for name in acting_loads([load]):
        factor, unit = printed_unit(problem, LOAD_KIND[name])
        parts.append(f"{name} = {with_unit(factor * load[name], unit, 5)}")
    return ", ".join(parts) or "no load"


def with_unit(value: float, unit: str, digits: int = 6) -> str:
    """A value as text in its unit with an SI prefix, to so many significant `digits`."""
    factor, label = scaled([value], unit)
    return f"{value * factor:.{digits}g} {label}"
