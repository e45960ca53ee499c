"""Systems of units: the length, the force and the stress in which a user gives numbers and reads them.

Numbers in Python are always in SI units. A system is named by its three units, such as "in, lbf, ksi".
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

from fastpin.errors import InputError
from fastpin.model.checks import as_toml
from fastpin.model.synonyms import closest

SI = "SI"
"""The usual system: SI units, with a prefix that suits the size of a value."""

NO_UNITS = "has no meaning in a dimensionless problem, whose numbers have no units"
"""Why a dimensionless problem refuses a system of units."""

POUND, INCH = 4.4482216152605, 0.0254
"""A pound of force, N, and an inch, m. Both are exact."""


class Measure(NamedTuple):
    """A unit, and the way of a number in it to SI units: times 10 to the `power`, times the `factor`.

    A power of ten is multiplied, or divided by its inverse: so 15.5 mm are 0.0155 m to the last bit.
    """

    name: str
    power: int = 0
    factor: float = 1.0

    def in_si(self, number: float) -> float:
        """A number in this unit as one in SI units."""
        return (number * 10.0**self.power if self.power >= 0 else number / 10.0**-self.power) * self.factor

    def given(self, number: float, divisor: float = 1.0) -> float:
        """The number in this unit that gives a `number` in SI units, after it was divided; the shortest one of several.

        Rounding leaves it within two floats of the product. If no float gives the number, it is the product.
        """
        if self.per_si == divisor == 1.0:
            return number
        guess = number * divisor * self.per_si
        near = [guess, *(float(f"{guess:.{digits}g}") for digits in (15, 16))]
        for end in (-math.inf, math.inf):
            one = math.nextafter(guess, end)
            near += [one, math.nextafter(one, end)]
        same = (each for each in near if self.in_si(each) / divisor == number)
        return min(same, key=lambda each: len(repr(each)), default=guess)

    @property
    def per_si(self) -> float:
        """The number in this unit of one SI unit."""
        return float(10.0**-self.power / self.factor)


_METRIC = (
    {"m": Measure("m"), "cm": Measure("cm", -2), "mm": Measure("mm", -3), "um": Measure("um", -6)},
    {"N": Measure("N"), "kN": Measure("kN", 3), "MN": Measure("MN", 6)},
    {"Pa": Measure("Pa"), "kPa": Measure("kPa", 3), "MPa": Measure("MPa", 6), "GPa": Measure("GPa", 9)},
)
_CUSTOMARY = (
    {"in": Measure("in", 0, INCH)},
    {"lbf": Measure("lbf", 0, POUND), "kip": Measure("kip", 3, POUND)},
    {"psi": Measure("psi", 0, POUND / INCH**2), "ksi": Measure("ksi", 3, POUND / INCH**2)},
)


def checked_system(field: str, value: object) -> str:
    """Check a system of units, and return its name: "SI", or its length, force and stress, joined by commas.

    Raises
    ------
    InputError
        If it is no text of three known units, one of each kind, or mixes metric and US customary units.
    """
    if isinstance(value, str) and value == SI:
        return SI
    words = [word.strip() for word in value.split(",")] if isinstance(value, str) else []
    known = [name for table in (*_METRIC, *_CUSTOMARY) for name in table]
    for word in words:
        if word and word not in (*known, SI):
            hint = closest(word, known) or f"; there are {', '.join(known)}"
            raise InputError(field, f"there is no unit {as_toml(word)}{hint}")
    chosen = _chosen(words, _METRIC) or _chosen(words, _CUSTOMARY)
    if chosen:
        return ", ".join(measure.name for measure in chosen)
    if _chosen(words, tuple({**a, **b} for a, b in zip(_METRIC, _CUSTOMARY, strict=True))):
        raise InputError(field, f"must not mix metric and US customary units, as {as_toml(value)} does")
    examples = '"SI", or a length, a force and a stress, such as "mm, N, MPa" or "in, lbf, ksi"'
    raise InputError(field, f"must be {examples}, not {as_toml(value)}")


def is_system(value: object) -> bool:
    """Whether a value is a system of units as :func:`checked_system` returns it."""
    try:
        return checked_system("", value) == value
    except InputError:
        return False


def _chosen(words: list[str], tables: tuple[dict[str, Measure], ...]) -> tuple[Measure, ...]:
    """The measures of length, force and stress that the words name in any order; empty if they name others."""
    found = [[table[word] for word in words if word in table] for table in tables]
    is_one_each = len(words) == len(tables) and all(len(each) == 1 for each in found)
    return tuple(each[0] for each in found) if is_one_each else ()


@functools.cache
def measures(system: str) -> tuple[Measure, Measure, Measure]:
    """The length, the force and the stress of a checked system of units."""
    words = ["m", "N", "Pa"] if system == SI else system.split(", ")
    length, force, stress = _chosen(words, _METRIC) or _chosen(words, _CUSTOMARY)
    return length, force, stress
