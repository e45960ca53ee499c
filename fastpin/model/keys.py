"""The kind of quantity of every number in a case file, by section and key.

Case files with a system of units, the units of varied fields, and the bodies of a summary follow from it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from typing import Any

from fastpin.bodies.kinds import PINS, PLATES
from fastpin.model.fields import FIELDS
from fastpin.model.loads import LOAD_KIND

ITSELF, ANY, ROW = "", "*", "row"
"""Entries of the kinds of a value: of the value itself where it is a number, of all other keys, and of the numbers of a
row where it is a list of rows.
"""

KeyKinds = str | Mapping[str, Any]
"""The kind of a number and of all numbers in a list, or the kinds of the keys of a table."""


def of(kind: str, *keys: str) -> dict[str, str]:
    """Return the kinds of keys of one kind."""
    return dict.fromkeys(keys, kind)


LAW = of("stress intensity", "threshold_range", "toughness", "unit") | {
    "C": "crack growth", "intrinsic_length": "length"
}  # fmt: skip
"""Constants of a law of crack growth."""

FATIGUE = of(
    "traction", "fatigue_strength", "shear_fatigue_strength", "yield_strength", "bending_limit", "torsion_limit",
    "limit_range", "curve_c",
) | {"threshold_range": "stress intensity", "wear_coefficient": "wear coefficient"}  # fmt: skip
"""Fatigue constants. The constant curve_a counts with the unit of stress, see :func:`converted`."""

PLY = of("modulus", "E1", "E2", "G12") | of("traction", "Xt", "Xc", "Yt", "Yc", "S") | {"thickness": "length"}
"""Numbers of a ply."""

MATERIAL = (
    of("modulus", "E", "E1", "E2", "G12")
    | of("traction", "yield_strength", "ultimate_strength")
    | {"compliance": "compliance", "fatigue": FATIGUE, "growth": LAW, "ply": PLY}
)
"""Numbers of a material or a laminate."""


RESIDUAL = {ITSELF: "traction", ROW: ("length", "traction")}
"""A residual stress, or its values at some depths."""


def profile(kind: str) -> dict[str, str]:
    """Return the kinds of a profile along the rim: of its numbers, and of the keys of its terms."""
    return of(
        kind, ITSELF, "constant", "ellipse", "size", "cosine", "sine", "flat", "crown", "zone", "values"
    )  # fmt: skip


CASE: dict[str, Any] = {
    "pin": MATERIAL,
    "plate": MATERIAL,
    "dundurs": {"beta_star": "compliance"},
    "contact": {name: field.kind for name, field in FIELDS.items() if field.place == "[contact]" and field.kind},
    "gap": {"hole": profile("displacement"), "pin": profile("displacement")},
    "pin_body": {key: kind for made in PINS.values() for key, kind in made.keys.items()},
    "plate_body": {key: kind for made in PLATES.values() for key, kind in made.keys.items()} | MATERIAL,
    "load": LOAD_KIND | {"mean": LOAD_KIND, "amplitude": LOAD_KIND},
    "wear": {key: profile("wear coefficient") for key in ("coefficient", "pin", "plate")},
    "fatigue": {"length": "length", "residual_stress": RESIDUAL},
    "crack": of("length", "first", "last", "place") | {"law": LAW, "residual_stress": RESIDUAL},
    "strength": of("length", "distance", "tension", "compression"),
}  # fmt: skip
"""The kinds of a case file by section and key. A key that is not here has no unit."""


def kind_of(field: str, kinds: Any = CASE) -> str:
    """Return the kind of a field of a case, such as "pin.E" or "load.2.P"; empty if it has no unit."""
    for part in field.split("."):
        if not part.isdigit():
            kinds = kinds.get(part, "") if isinstance(kinds, Mapping) else ""
    return str(kinds.get(ITSELF, "") if isinstance(kinds, Mapping) else kinds)


def converted(value: Any, kinds: KeyKinds, way: Callable[[str, float], float], unit: float | None = None) -> Any:
    """Return a value of a file with all its numbers changed.

    Parameters
    ----------
    value : dict, list, number or other value
        Values of other types stay, as do keys that have no kind.
    kinds : str or mapping
        The kinds of the value.
    way : callable
        ``way(kind, number)``: the number in other units.
    unit : float, optional
        The range that C of a law of crack growth belongs to where a table does not say it, before the change.
    """
    kinds = {ITSELF: kinds} if isinstance(kinds, str) else kinds
    if isinstance(value, Mapping):
        given = {"unit": unit, **value} if "unit" in kinds and unit is not None else value
        found = {key: converted(item, kinds.get(key, kinds.get(ANY, {})), way, unit) for key, item in given.items()}
        if "curve_c" in kinds and all(isinstance(found.get(name), (int, float)) for name in ("curve_a", "curve_b")):
            found["curve_a"] += found["curve_b"] * math.log10(way("traction", 1.0))
        return found
    if isinstance(value, (list, tuple)):
        is_row = [ROW in kinds and isinstance(item, (list, tuple)) and len(item) == len(kinds[ROW]) for item in value]
        return [
            list(map(converted, item, kinds[ROW], itertools.repeat(way))) if row else converted(item, kinds, way, unit)
            for item, row in zip(value, is_row, strict=True)
        ]
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return way(kinds[ITSELF], value) if is_number and kinds.get(ITSELF) else value
