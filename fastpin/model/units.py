"""Units of every kind of quantity, and SI prefixes.

Everything that is printed, drawn or written as text takes its units from :func:`units`. With a thickness these are N,
N m, J and N m/rad, and a factor goes with each. :func:`units_per_thickness` names the units of numbers in Python, HDF5
files and indexes of sweeps. Outputs do not import it, see ``tests/project/test_layout.py``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from fastpin.model.loads import LATER, LOAD_KIND, LOADS
from fastpin.model.problem import Problem


class _Kind(NamedTuple):
    """The units of a kind of quantity: SI, of a dimensionless problem, and of a problem with a thickness.

    The last one is empty unless the SI unit is per thickness.
    """

    si: str
    dimensionless: str
    whole: str = ""


_KINDS = {
    "force": _Kind("N/m", "F", "N"),
    "moment": _Kind("N", "F R", "N m"),
    "traction": _Kind("Pa", "F/R"),
    "length": _Kind("m", "R"),
    "displacement": _Kind("m", "F beta*"),
    "rotation": _Kind("rad", "F beta*/R"),
    "stiffness": _Kind("N/rad", "R^2/beta*", "N m/rad"),
    "rig stiffness": _Kind("N/m^2", "1/beta*", "N per m"),
    "energy": _Kind("J/m", "F^2 beta*", "J"),
    "ratio": _Kind("", ""),
    "temperature": _Kind("K", "K"),
    "energy density": _Kind("J/m^2", "F^2 beta*/R"),
    "stress times strain": _Kind("Pa", "F^2 beta*/R^2"),
    "stress intensity": _Kind("Pa sqrt(m)", "F/sqrt(R)"),
    "crack growth": _Kind("m/cycle", "R/cycle"),
    "life": _Kind("cycles", "cycles"),
    "work per stress": _Kind("m^2", "F R beta*", "m^3"),
    "wear coefficient": _Kind("1/Pa", "R/F"),
}

PER_THICKNESS = {name: kind.whole for name, kind in _KINDS.items() if kind.whole}
"""The kinds that are per thickness in Python, and their units in printed texts of a problem with a thickness."""

_WITH_PREFIX = frozenset(
    {*(kind.si for kind in _KINDS.values()), *PER_THICKNESS.values(), "s"} - {"", "cycles", "1/Pa", "K"}
)
"""Units that may get an SI prefix."""

FIXED_PREFIXES = {"kN, mm": {"N": 3, "N/m": 3, "N m": 0, "J": 0, "J/m": 0, "m": -3, "Pa": 6}}
"""Choices of prefixes that do not depend on the size of a value: a power of ten for each unit, by the choice's name.

1 kN mm is 1 N m and 1 J.
"""

_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "u", -9: "n", -12: "p"}


@dataclass(frozen=True)
class Unit:
    """The unit in which values of a kind are printed.

    Attributes
    ----------
    factor : float
        A value in Python times this factor is in the unit.
    name : str
    """

    factor: float
    name: str

    def __str__(self) -> str:
        raise TypeError("a unit is printed by text or scale, which convert the value, or by its name")

    def scale(self, values: Sequence[float]) -> tuple[float, str]:
        """As :func:`scaled`, for values in Python: the factor converts them to the unit, too."""
        factor, label = scaled([self.factor * value for value in values], self.name)
        return self.factor * factor, label

    def text(self, value: float, digits: int = 6) -> str:
        """A value in Python as text in this unit with an SI prefix, to so many significant `digits`."""
        factor, label = self.scale([value])
        return f"{value * factor:.{digits}g} {label}"


PASCAL = Unit(1.0, "Pa")
"""The unit of moduli and strengths, which are never dimensionless."""

DEGREE = Unit(1.0, "deg")
"""The unit of angles and widths that are in degrees already."""


def units(problem: Problem) -> dict[str, Unit]:
    """The unit of every kind of quantity in printed texts: with the thickness of the problem, if it has one."""
    found = {kind: Unit(1.0, name) for kind, name in units_per_thickness(problem).items()}
    if problem.thickness is not None:
        found |= {kind: Unit(problem.thickness, name) for kind, name in PER_THICKNESS.items()}
    return found


def units_per_thickness(problem: Problem) -> dict[str, str]:
    """The unit of every kind of quantity in Python: SI, or the paper's units for a dimensionless problem."""
    return {name: kind.dimensionless if problem.dimensionless else kind.si for name, kind in _KINDS.items()}


def scaled(values: Sequence[float], unit: str) -> tuple[float, str]:
    """A factor for `values`, and `unit` with an SI prefix. In this unit the largest value reads well.

    Ratios, lives, units of a dimensionless problem, degrees and units of the user such as "MPa" keep the factor 1 and
    get no prefix.
    """
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    if unit not in _WITH_PREFIX or largest == 0.0:
        return 1.0, unit
    # A prefix is raised to the power of a unit, too: 1 mm^2 is 1e-6 m^2. Then the lowest decade of values in it.
    power, lowest = {"m^2": (2, -2), "m^3": (3, -5)}.get(unit, (1, 0))
    exponent = 3 * math.floor((math.log10(largest * (1.0 + 1e-12)) - lowest) / (3.0 * power))
    exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    return 10.0 ** (-exponent * power), _PREFIXES[exponent] + unit


def acting_loads(loads: Sequence[Mapping[str, float]]) -> list[str]:
    """Names of the loads that are not zero in at least one of `loads`."""
    return [name for name in LOADS if any(load.get(name, 0.0) != 0.0 for load in loads)]


def printed_loads(problem: Problem, load: Mapping[str, float]) -> dict[str, float]:
    """Return loads, by name, in printed units. Later loads are left out where they are 0."""
    unit = units(problem)
    return {
        name: unit[LOAD_KIND[name]].factor * value for name, value in load.items() if value != 0.0 or name not in LATER
    }


def named_loads(problem: Problem, load: Mapping[str, float]) -> str:
    """The loads that are not zero, as text with their units."""
    unit = units(problem)
    texts = (f"{name} = {unit[LOAD_KIND[name]].text(load[name], 5)}" for name in acting_loads([load]))
    return ", ".join(text.rstrip() for text in texts) or "no load"
