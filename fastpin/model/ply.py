"""Plies: one unidirectional layer of a laminate, its strengths, and a library of plies from public sources."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import Library, check_fields, instance, number, positive, set_fields, string
from fastpin.model.synonyms import explains_keywords

LEAST_MODULUS, MOST_MODULUS = 1e-60, 1e60
"""Limits of the moduli and strengths of a ply, Pa. A material has the same."""

PlyCriterion = Literal["maximum-stress", "maximum-strain", "tsai-hill", "tsai-wu", "hashin", "yamada-sun"]

CRITERION_NAMES: tuple[str, ...] = get_args(PlyCriterion)
"""The names of the criteria of ply failure, see :mod:`fastpin.damage.laminates`."""


@explains_keywords
@dataclass(frozen=True)
class PlyStrengths:
    """The strengths of a ply in its own axes: the stresses at which it breaks when they act alone.

    Parameters
    ----------
    Xt, Xc : float
        Strength along the fibres in tension and in compression, Pa, both positive.
    Yt, Yc : float
        Strength across the fibres in tension and in compression, Pa, both positive.
    S : float
        Strength in shear in the plane, Pa, positive.

    Raises
    ------
    InputError
        If a strength is not positive.
    """

    Xt: float
    Xc: float
    Yt: float
    Yc: float
    S: float

    def __post_init__(self) -> None:
        check_fields(self, checked_modulus, " ".join(each.name for each in fields(self)))

    def entries(self) -> dict[str, float]:
        """The strengths by name, Pa."""
        return {each.name: getattr(self, each.name) for each in fields(self)}


STRENGTH_KEYS = tuple(each.name for each in fields(PlyStrengths))
"""Names of the strengths of a ply."""


@explains_keywords
@dataclass(frozen=True)
class Ply:
    """A unidirectional layer of a laminate in plane stress. Axis 1 lies along the fibres, axis 2 across.

    Parameters
    ----------
    E1, E2, G12 : float
        Young's moduli along and across the fibres, and the shear modulus, Pa.
    nu12 : float
        Poisson's ratio of a stress along the fibres.
    thickness : float
        Thickness of the layer, m.
    strengths : PlyStrengths, optional
        They change no state, and serve :mod:`fastpin.damage` only.
    name : str, optional
        Name in tables and plots.
    source : str, optional
        Where the values are printed.

    Raises
    ------
    InputError
        If a value is not positive or beyond its limits, or no stable ply has these constants.
    """

    E1: float
    E2: float
    G12: float
    nu12: float
    thickness: float
    strengths: PlyStrengths | None = None
    name: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        check_fields(self, checked_modulus, "E1 E2 G12")
        set_fields(self, nu12=checked_ratio(self.E1, self.E2, self.nu12))
        check_fields(self, positive, "thickness")
        check_fields(self, number, "thickness", 1e-12, 1e6)  # a ply of one atom is thicker
        if self.strengths is not None:
            instance("strengths", self.strengths, PlyStrengths, "a fastpin.model.PlyStrengths")
        check_fields(self, string, "name source")

    @property
    def stiffness(self) -> np.ndarray:
        """The reduced stiffness Q, Pa, shape (3, 3): stresses (s1, s2, t12) per strain (e1, e2, g12)."""
        across = self.nu12 * self.E2
        rest = 1.0 - self.nu12 * across / self.E1
        return np.array([[self.E1, across, 0.0], [across, self.E2, 0.0], [0.0, 0.0, rest * self.G12]]) / rest

    def scaled(self, factor: float) -> Ply:
        """The same ply with all moduli times `factor`. It is another one: its strengths are unknown."""
        times = positive("factor", factor)
        return replace(self, E1=times * self.E1, E2=times * self.E2, G12=times * self.G12, strengths=None)

    def constants(self) -> dict[str, float]:
        """The numbers by name: moduli, ratio and thickness, and the strengths that are given."""
        elastic = {field: getattr(self, field) for field in PLY_NUMBERS}
        return elastic | ({} if self.strengths is None else self.strengths.entries())

    def entries(self) -> dict[str, Any]:
        """The numbers and the texts that are given, by name. :func:`ply_from` reads them back."""
        return self.constants() | {field: text for field in ("name", "source") if (text := getattr(self, field))}


PLY_NUMBERS = ("E1", "E2", "G12", "nu12", "thickness")
"""Names of the numbers that every ply has."""

PLY_KEYS = (*PLY_NUMBERS, *STRENGTH_KEYS, "name", "source")
"""Keys of the table of a ply."""


def ply_from(**given: Any) -> Ply:
    """Return the ply of such entries, see :meth:`Ply.entries`. The strengths are given all or none.

    Raises
    ------
    InputError
        If an entry is missing or out of range.
    """
    for field in PLY_NUMBERS:
        if given.get(field) is None:
            raise InputError(field, f"is missing: a ply needs {', '.join(PLY_NUMBERS)}")
    strengths = {field: given.pop(field) for field in STRENGTH_KEYS if given.get(field) is not None}
    for field in STRENGTH_KEYS:
        if strengths and field not in strengths:
            raise InputError(field, f"is missing: the strengths of a ply are {', '.join(STRENGTH_KEYS)}, all or none")
    return Ply(**given, strengths=PlyStrengths(**strengths) if strengths else None)


def checked_modulus(field: str, value: object) -> float:
    """Check a modulus or a strength, Pa, and return it as a float."""
    return number(field, positive(field, value), LEAST_MODULUS, MOST_MODULUS)


def checked_ratio(first: float, second: float, ratio: object) -> float:
    """Check Poisson's ratio nu12 of a body with the moduli E1 and E2, and return it.

    Raises
    ------
    InputError
        If no stable material has these constants.
    """
    value = number("nu12", ratio)
    if abs(value) >= math.sqrt(first / second) * (1.0 - 0.5e-9):  # a smaller part below 1 is rounding
        raise InputError("nu12", f"must lie within +-sqrt(E1/E2) = {math.sqrt(first / second):g}, not {value:g}")
    return value


_JONES = "Jones, Mechanics of Composite Materials, quoted after public programs"
_WWFE = "Soden, Hinton and Kaddour, Composites Science and Technology 58 (1998), p. 1011, quoted after public programs"

PLIES = Library(
    "ply",
    {
        name: Ply(*elastic, 0.125e-3, PlyStrengths(*strengths), name, source)  # a usual thickness of cured tape
        for name, elastic, strengths, source in (
            ("AS4/3501-6", (126e9, 11e9, 6.6e9, 0.28), (1950e6, 1480e6, 48e6, 200e6, 79e6), _WWFE),
            ("T300/914", (138e9, 11e9, 5.5e9, 0.28), (1500e6, 900e6, 27e6, 200e6, 80e6), _WWFE),
            ("E-glass/LY556", (53.48e9, 17.7e9, 5.83e9, 0.278), (1140e6, 570e6, 35e6, 114e6, 72e6), _WWFE),
            ("E-glass/MY750", (45.6e9, 16.2e9, 5.83e9, 0.278), (1280e6, 800e6, 40e6, 145e6, 73e6), _WWFE),
            ("T300/5208", (181e9, 10.3e9, 7.17e9, 0.28), (1500e6, 1500e6, 40e6, 246e6, 68e6), _JONES),
        )
    },
)
"""Named plies at room temperature, with typical values and no allowables.

* AS4/3501-6, T300/914 (BSL914C), E-glass/LY556 (HT907/DY063) and E-glass/MY750 (HY917/DY063): the plies of the first
  World-Wide Failure Exercise, Soden, Hinton and Kaddour, Composites Science and Technology 58 (1998), p. 1011-1022.
  The paper itself was not at hand: the values were read in public programs that cite it.
* T300/5208: Jones, Mechanics of Composite Materials, 2nd ed., as public programs quote it.

Compare them with the print, and with your own tests, before relying on a strength.
"""
