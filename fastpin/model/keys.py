"""The kind of quantity of every number in a case file, by section and key.

Case files with a system of units, the units of varied fields, and the bodies of a summary follow from it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from typing import Any

from fastpin.model.fields import FIELDS
from fastpin.model.loads import LOAD_KIND

ITSELF, ANY, ROW = "", "*", "row"
"""Entries of the kinds of a value: of the value itself where it is a number, of all other keys, and of the numbers of a
row where it is a list of rows.
"""

KeyKinds = str | Mapping[str, Any]
"""The kind of a number and of all numbers in a list, or the kinds of the keys of a table."""


def _of(kind: str, *keys: str) -> dict[str, str]:
    return dict.fromkeys(keys, kind)


LAW = _of("stress intensity", "threshold_range", "toughness", "unit") | {
    "C": "crack growth", "intrinsic_length": "length"
}  # fmt: skip
"""Constants of a law of crack growth."""

FATIGUE = _of(
    "traction", "fatigue_strength", "shear_fatigue_strength", "yield_strength", "bending_limit", "torsion_limit",
    "limit_range", "curve_c",
) | {"threshold_range": "stress intensity", "wear_coefficient": "wear coefficient"}  # fmt: skip
"""Fatigue constants. The constant curve_a counts with the unit of stress, see :func:`converted`."""

PLY = _of("modulus", "E1", "E2", "G12") | _of("traction", "Xt", "Xc", "Yt", "Yc", "S") | {"thickness": "length"}
"""Numbers of a ply."""

MATERIAL = (
    _of("modulus", "E", "E1", "E2", "G12")
    | _of("traction", "yield_strength", "ultimate_strength")
    | {"compliance": "compliance", "fatigue": FATIGUE, "growth": LAW, "ply": PLY}
)
"""Numbers of a material or a laminate."""


RESIDUAL = {ITSELF: "traction", ROW: ("length", "traction")}
"""A residual stress, or its values at some depths."""


def profile(kind: str) -> dict[str, str]:
    """Return the kinds of a profile along the rim: of its numbers, and of the keys of its terms."""
    return _of(
        kind, ITSELF, "constant", "ellipse", "size", "cosine", "sine", "flat", "crown", "zone", "values"
    )  # fmt: skip


CASE: dict[str, Any] = {
    "pin": MATERIAL,
    "plate": MATERIAL,
    "dundurs": {"beta_star": "compliance"},
    "contact": {name: field.kind for name, field in FIELDS.items() if field.place == "[contact]" and field.kind},
    "gap": {"hole": profile("displacement"), "pin": profile("displacement")},
    "pin_body": {"bore_radius": "length"},
    "plate_body": MATERIAL
    | _of("length", "outer_radius", "ring_outer_radius", "reaction")
    | {"interference": "displacement"},
    "load": LOAD_KIND | {"mean": LOAD_KIND, "amplitude": LOAD_KIND},
    "wear": {key: profile("wear coefficient") for key in ("coefficient", "pin", "plate")},
    "fatigue": {"length": "length", "residual_stress": RESIDUAL},
    "crack": _of("length", "first", "last", "place") | {"law": LAW, "residual_stress": RESIDUAL},
    "strength": _of("length", "distance", "tension", "compression"),
}  # fmt: skip
"""The kinds of a case file by section and key. A key that is not here has no unit."""

OUTCOMES = {ANY: CASE["wear"] | CASE["fatigue"] | CASE["crack"] | CASE["strength"]}
"""The kinds of the outcomes of a plan, which may have keys of these sections."""

LUG: dict[str, Any] = {
    "plate": _of("length", "hole_radius", "net_section"),
    "outline": _of("length", "x", "y", "start", "origin", "tolerance"),
    "part": _of("length", "to", "through", "at"),
    "hole": _of("length", "centre", "radius"),
}
"""The kinds of a lug file. Its loads are parts of the stress of a case."""

JOINT: dict[str, Any] = {
    "plate": MATERIAL | _of("length", "thickness", "x", "y", "start") | {"parts": _of("length", "to", "through")},
    "pin": MATERIAL
    | _of("length", "at", "diameter")
    | {"clearance": {ITSELF: "length", ANY: "length"}, "flexibility": "flexibility"},
    "fatigue": CASE["fatigue"],
}
"""The kinds of a joint file, apart from its loads."""


def kind_of(field: str) -> str:
    """Return the kind of a field of a case, such as "pin.E" or "load.2.P"; empty if it has no unit."""
    kinds: Any = CASE
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
