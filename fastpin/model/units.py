"""Units of every kind of quantity, systems of units, and SI prefixes.

Everything that is printed, drawn or written as text takes its units from :func:`units`. With a thickness these are N,
N m, J and N m/rad, and a factor goes with each. A problem may have a system of units of its own, see
:mod:`fastpin.model.unit_systems`. Numbers in Python, HDF5 files and indexes of sweeps are always in SI units, which
:func:`units_per_thickness` names. Outputs do not import it, see ``tests/project/test_layout.py``.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from fastpin.model.growth import Walker
from fastpin.model.keys import KeyKinds, converted
from fastpin.model.loads import LATER, LOAD_KIND, LOADS
from fastpin.model.problem import Problem
from fastpin.model.unit_systems import SI, Measure, measures


class _Kind(NamedTuple):
    """The units of a kind of quantity.

    Attributes
    ----------
    si, dimensionless : str
        In SI, and in a dimensionless problem.
    system : str
        In a system of units: its length, force and stress stand for L, F and S. Empty if `si` is its unit there, too.
    powers : tuple of float
        Powers of length, force and stress.
    whole, whole_system : str
        In SI and in a system for a problem with a thickness, by which the quantity is multiplied; empty if it is not.
    """

    si: str
    dimensionless: str
    system: str = ""
    powers: tuple[float, float, float] = (0, 0, 0)
    whole: str = ""
    whole_system: str = ""


_KINDS = {
    "force": _Kind("N/m", "F", "F/L", (-1, 1, 0), "N", "F"),
    "moment": _Kind("N", "F R", "F L/L", (0, 1, 0), "N m", "F L"),
    "traction": _Kind("Pa", "F/R", "S", (0, 0, 1)),
    "modulus": _Kind("Pa", "1/beta*", "S", (0, 0, 1)),
    "compliance": _Kind("1/Pa", "beta*", "1/S", (0, 0, -1)),
    "length": _Kind("m", "R", "L", (1, 0, 0)),
    "displacement": _Kind("m", "F beta*", "L", (1, 0, 0)),
    "rotation": _Kind("rad", "F beta*/R"),
    "stiffness": _Kind("N/rad", "R^2/beta*", "F/rad", (0, 1, 0), "N m/rad", "F L/rad"),
    "rig stiffness": _Kind("N/m^2", "1/beta*", "F/L^2", (-2, 1, 0), "N per m", "F per L"),
    "energy": _Kind("J/m", "F^2 beta*", "F L/L", (0, 1, 0), "J", "F L"),
    "ratio": _Kind("", ""),
    "temperature": _Kind("K", "K"),
    "energy density": _Kind("J/m^2", "F^2 beta*/R", "F L/L^2", (-1, 1, 0)),
    "stress times strain": _Kind("Pa", "F^2 beta*/R^2", "S", (0, 0, 1)),
    "stress intensity": _Kind("Pa sqrt(m)", "F/sqrt(R)", "S sqrt(L)", (0.5, 0, 1)),
    "crack growth": _Kind("m/cycle", "R/cycle", "L/cycle", (1, 0, 0)),
    "life": _Kind("cycles", "cycles"),
    "work per stress": _Kind("m^2", "F R beta*", "L^2", (2, 0, 0), "m^3", "L^3"),
    "wear coefficient": _Kind("1/Pa", "R/F", "1/S", (0, 0, -1)),
    "flexibility": _Kind("m/N", "beta*", "L/F", (1, -1, 0)),
}

PER_THICKNESS = {name: kind.whole for name, kind in _KINDS.items() if kind.whole}
"""The kinds that are per thickness in Python, and their units in printed texts of a problem with a thickness."""

_WITH_PREFIX = frozenset(
    {*(kind.si for kind in _KINDS.values()), *PER_THICKNESS.values(), "s"} - {"", "cycles", "1/Pa", "K"}
)
"""Units that may get an SI prefix."""

_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "u", -9: "n", -12: "p"}


@dataclass(frozen=True)
class Unit:
    """The unit in which values of a kind are printed.

    Attributes
    ----------
    factor : float
        A value in Python times this factor is in the unit.
    name : str
    is_chosen : bool
        Whether the user chose it. Then it gets no prefix.
    """

    factor: float
    name: str
    is_chosen: bool = False

    def __str__(self) -> str:
        raise TypeError("a unit is printed by text or scale, which convert the value, or by its name")

    def scale(self, values: Sequence[float]) -> tuple[float, str]:
        """As :func:`scaled`, for values in Python: the factor converts them to the unit, too."""
        if self.is_chosen:
            return self.factor, self.name
        factor, label = scaled([self.factor * value for value in values], self.name)
        return self.factor * factor, label

    @property
    def printed(self) -> Unit:
        """This unit for values that are in it already."""
        return Unit(1.0, self.name, self.is_chosen)

    def column(self, words: str, values: np.ndarray) -> dict[str, np.ndarray]:
        """Values in Python as a column of a table by its heading: its words and this unit."""
        return {f"{words} [{self.name}]": self.factor * values}

    def text(self, value: float, digits: int = 6) -> str:
        """A value in Python as text in this unit with an SI prefix, to so many significant `digits`."""
        factor, label = self.scale([value])
        return f"{self.number(value * factor, digits)} {label}"

    def number(self, value: float, digits: int) -> str:
        """A value in this unit to so many significant `digits`; in a unit that is chosen, 25000 has no exponent."""
        text = f"{value:.{digits}g}"
        return f"{float(text):.0f}" if self.is_chosen and "e+" in text and abs(value) < 1e7 else text


PLAIN = Unit(1.0, "")
"""The unit of plain numbers."""

DEGREE = Unit(1.0, "deg")
"""The unit of angles and widths that are in degrees already."""


def units(problem: Problem) -> dict[str, Unit]:
    """The unit of every kind of quantity in printed texts: with the thickness of the problem, if it has one."""
    if problem.dimensionless:
        return {kind: Unit(1.0, name) for kind, name in units_per_thickness(problem).items()}
    thickness, found = problem.thickness, dict(units_of(problem.unit_system, problem.thickness is not None))
    if thickness is not None:
        found |= {kind: replace(found[kind], factor=thickness * found[kind].factor) for kind in PER_THICKNESS}
    return found


@functools.cache
def units_of(system: str, whole: bool) -> Mapping[str, Unit]:
    """The unit of every kind of quantity in a system of units, for values in SI units.

    Kinds of :data:`PER_THICKNESS` count for the `whole` thickness, or per thickness.
    """
    ways = measures_of(system, whole)
    return {kind: Unit(way.per_si, way.name, system != SI and bool(_KINDS[kind].system)) for kind, way in ways.items()}


@functools.cache
def measures_of(system: str, whole: bool) -> Mapping[str, Measure]:
    """The way of numbers of every kind from a system of units to SI units, see :func:`units_of`."""
    found, basic = {}, measures(system)
    symbols = {letter: each.name for letter, each in zip("LFS", basic, strict=True)}
    for kind, each in _KINDS.items():
        is_whole = whole and bool(each.whole)
        if system == SI or not each.system:
            found[kind] = Measure(each.whole if is_whole else each.si)
            continue
        name = "".join(symbols.get(letter, letter) for letter in (each.whole_system if is_whole else each.system))
        powers = (each.powers[0] + is_whole, *each.powers[1:])
        decade = sum(power * one.power for power, one in zip(powers, basic, strict=True))
        factor = math.prod(one.factor**power for power, one in zip(powers, basic, strict=True))
        found[kind] = Measure(name, math.floor(decade), factor * 10.0 ** (decade - math.floor(decade)))
    return found


def units_per_thickness(problem: Problem) -> dict[str, str]:
    """The unit of every kind of quantity in Python: SI, or the paper's units for a dimensionless problem."""
    return {name: kind.dimensionless if problem.dimensionless else kind.si for name, kind in _KINDS.items()}


def system_words(problem: Problem) -> str:
    """The system of units of printed texts in words, such as "SI units" or "units of in, lbf, ksi"."""
    return "SI units" if problem.unit_system == SI else f"units of {problem.unit_system}"


def from_units(value: Any, kinds: KeyKinds, system: str, whole: bool = False) -> Any:
    """A value whose numbers are in a system of units, such as a file or an option, in SI units; see `measures_of`."""
    ways, unit = measures_of(system, whole), None if system == SI else 1.0
    return converted(value, kinds, lambda kind, number: ways[kind].in_si(number), unit)


def in_units(problem: Problem, value: Any, kinds: KeyKinds) -> Any:
    """See :func:`in_units_of`, with the units and the thickness of a problem."""
    return in_units_of(value, kinds, problem.unit_system, problem.thickness)


def in_units_of(value: Any, kinds: KeyKinds, system: str, thickness: float | None) -> Any:
    """A value in SI units and per thickness, such as a table of a case file, as it stands in a file with units.

    Parameters
    ----------
    value : dict or other value
    kinds : str or mapping
        The kinds of its numbers, see :mod:`fastpin.model.keys`.
    system : str
        See :func:`fastpin.model.unit_systems.checked_system`.
    thickness : float or None
        Thickness of the file, m. None if it has none.
    """
    if system == SI and thickness is None:
        return value
    ways, each = measures_of(system, thickness is not None), thickness or 1.0

    def given(kind: str, number: float) -> float:
        return ways[kind].given(number, each if kind in PER_THICKNESS else 1.0)

    return converted(value, kinds, functools.cache(given), None if system == SI else Walker.unit)


def in_other_units(tables: Mapping[str, Any], kinds: KeyKinds, old: str, new: str, whole: bool) -> dict[str, Any]:
    """Tables of a file in an `old` system of units as they stand in a `new` one; see :func:`measures_of`."""
    read, written = measures_of(old, whole), measures_of(new, whole)
    unit = Walker.unit if old == SI else 1.0
    found: dict[str, Any] = converted(
        tables, kinds, lambda kind, number: written[kind].given(read[kind].in_si(number)), unit
    )
    return found | {"units": new}


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
