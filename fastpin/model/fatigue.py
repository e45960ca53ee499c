"""Fatigue constants of a material, and stress-life curves of alloys with scatter, as such constants by name."""

from __future__ import annotations

import csv
import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

from fastpin.errors import InputError
from fastpin.model.checks import (
    LONGEST_TEXT,
    as_toml,
    check_fields,
    choice,
    given_fields,
    items,
    negative,
    not_negative,
    number,
    positive,
    set_fields,
    string,
    whole_number,
)
from fastpin.model.synonyms import closest, explains_keywords

LIFE_CONSTANTS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "smith-watson-topper": (
        (),
        ("fatigue_strength", "strength_exponent", "fatigue_ductility", "ductility_exponent"),
    ),
    "fatemi-socie": (
        ("normal_stress_factor", "yield_strength"),
        ("shear_fatigue_strength", "shear_strength_exponent", "shear_fatigue_ductility", "shear_ductility_exponent"),
    ),
    "stress-life": (("curve_m",), ("curve_a", "curve_b", "curve_c", "curve_kt")),
}
"""The criteria with lives: the constants of the parameter, and the constants of the life."""

LEAST_SAMPLES = 6
"""Least number of specimens: more than the constants of a curve."""

CHECKS: dict[str, Callable[..., Any]] = {
    "curve_a": number,
    "curve_c": not_negative,
    "curve_m": partial(number, least=0.01, most=0.99),
    "curve_samples": partial(whole_number, least=LEAST_SAMPLES),
}
"""Checks of constants that need not be positive, or are limited."""


@explains_keywords
@dataclass(frozen=True, repr=False)
class FatigueConstants:
    """Fatigue constants of a material, each of them optional. A criterion says which ones it needs.

    2N counts reversals: two in a cycle.

    Parameters
    ----------
    fatigue_strength, strength_exponent : float, optional
        Coefficient sf' of the fatigue strength, Pa, and its exponent b < 0: the elastic strain amplitude is
        sf'/E (2N)^b (Basquin 1910).
    fatigue_ductility, ductility_exponent : float, optional
        Coefficient ef' of the fatigue ductility and its exponent c < 0: the plastic strain amplitude is ef' (2N)^c
        (Coffin 1954, Manson 1953).
    shear_fatigue_strength, shear_strength_exponent, shear_fatigue_ductility, shear_ductility_exponent : float, optional
        The same for torsion: tf', Pa, b0 < 0, gf' and c0 < 0.
    yield_strength : float, optional
        Pa.
    bending_limit, torsion_limit : float, optional
        Amplitudes of the fatigue limits under fully reversed bending, f, and torsion, t, Pa.
    threshold_range : float, optional
        Range dK_th of the stress intensity below which long cracks do not grow, Pa sqrt(m).
    limit_range : float, optional
        Range ds_0 of the stress at the fatigue limit of a smooth specimen, Pa. `threshold_range` belongs to the same
        stress ratio.
    normal_stress_factor : float, optional
        Weight k of the normal stress in the criterion of Fatemi and Socie.
    wear_coefficient : float, optional
        Archard's coefficient k_w: volume worn off per force and sliding distance, 1/Pa.
    source : str
        Where the constants come from.
    curve : str
        Name of a stress-life curve of :func:`fastpin.model.stress_life_curves`. It gives all constants below that are
        not given themselves.
    curve_a, curve_b, curve_c, curve_m : float, optional
        log10 N = A - B log10(S - C) with the equivalent stress S = S_max (1 - R)^m of Walker, Pa. With stresses in ksi,
        A is smaller by 6.83852 B.
    curve_kt : float, optional
        Stress concentration of the specimens, to whose nominal stress S belongs; 1 for smooth ones.
    curve_scatter : float, optional
        Standard error of log10 N about the curve of lives.
    curve_samples : int, optional
        Number of specimens behind it.

    Raises
    ------
    InputError
        If a constant is not positive and finite, or an exponent not negative and finite. The constant C may be 0, and m
        is below 1. Also if the curve is unknown.
    """

    fatigue_strength: float | None = None
    strength_exponent: float | None = None
    fatigue_ductility: float | None = None
    ductility_exponent: float | None = None
    shear_fatigue_strength: float | None = None
    shear_strength_exponent: float | None = None
    shear_fatigue_ductility: float | None = None
    shear_ductility_exponent: float | None = None
    yield_strength: float | None = None
    bending_limit: float | None = None
    torsion_limit: float | None = None
    threshold_range: float | None = None
    limit_range: float | None = None
    normal_stress_factor: float | None = None
    wear_coefficient: float | None = None
    source: str = ""
    curve: str = ""
    curve_a: float | None = None
    curve_b: float | None = None
    curve_c: float | None = None
    curve_m: float | None = None
    curve_kt: float | None = None
    curve_scatter: float | None = None
    curve_samples: int | None = None

    def __post_init__(self) -> None:
        check_fields(self, string, "source curve")
        known: dict[str, Any] = {} if self.curve_a is None else {"curve_c": 0.0, "curve_kt": 1.0}
        if self.curve:
            curves = stress_life_curves()
            if self.curve not in curves:
                words = (
                    f"there is no stress-life curve {as_toml(self.curve)}{closest(self.curve[:LONGEST_TEXT], curves)}"
                )
                raise InputError("curve", words)
            known = curves[self.curve]
        set_fields(self, **{name: value for name, value in known.items() if getattr(self, name) in (None, "")})
        for name in self.given():
            if name not in ("source", "curve"):
                check_fields(self, negative if name.endswith("_exponent") else CHECKS.get(name, positive), name)

    def __repr__(self) -> str:
        return f"FatigueConstants({', '.join(f'{name}={value!r}' for name, value in self.given().items())})"

    def given(self) -> dict[str, Any]:
        """The constants that are given, by name, and the source unless it is empty."""
        return {name: value for name, value in given_fields(self).items() if not isinstance(value, str) or value}

    def required(self, names: Sequence[str], purpose: str, body: str) -> tuple[float, ...]:
        """The constants of these names.

        Raises
        ------
        InputError
            If some of them are missing. The message names the constants, the `purpose` and the `body`.
        """
        known = [field.name for field in fields(self)]
        names = [choice("names", name, known) for name in items("names", names, "a list of constants")]
        missing = [name for name in names if getattr(self, name) is None]
        if missing:
            raise InputError("fatigue", f"{purpose} needs {', '.join(missing)} of the {body}'s material")
        return tuple(getattr(self, name) for name in names)


KSI = 6.894757293168361e6
"""Pa in a ksi."""


@functools.cache
def stress_life_curves() -> dict[str, dict[str, Any]]:
    """Return fields of :class:`fastpin.model.FatigueConstants` by the names of curves, such as "2024-T3 sheet, Kt 1".

    They come from figures of MIL-HDBK-5J, read from a public transcription: compare a curve with the print before
    relying on a life. Curves of specimens whose number is not printed have no ``curve_samples``.
    """
    with Path(__file__).with_name("stress_life.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {
        row["name"]: {
            "curve_a": float(row["A"]) + float(row["B"]) * math.log10(KSI),
            "curve_b": float(row["B"]),
            "curve_c": float(row["C"]) * KSI,
            "curve_m": float(row["m"]),
            "curve_kt": float(row["Kt"]),
            "curve_scatter": float(row["scatter"]),
            "source": row["source"],
        }
        | ({"curve_samples": int(row["samples"])} if row["samples"] else {})
        for row in rows
    }
