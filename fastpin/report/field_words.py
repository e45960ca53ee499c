"""Words for the fields of a case, on axes and in legends of sweeps."""

from __future__ import annotations

from fastpin.model.loads import LOADS

_OWNERS = {"pin": "pin", "plate": "plate", "pin_body": "pin", "plate_body": "plate"}
"""Sections of a case whose keys belong to a body."""

_KEYS = {
    "E": "modulus",
    "nu": "Poisson's ratio",
    "friction": "friction coefficient",
    "pin_load": "load of the pin",
    "reaction": "distance of the reaction",
    "interference": "interference of the bush",
    "nodes": "number of nodes",
}
"""Words for keys whose names are no words."""

_LOADS = {"P": "force P", "Q": "force Q", "M": "moment M", "ux": "displacement ux", "uy": "displacement uy"}
"""Words for loads; the others are remote stresses."""


def field_words(field: str) -> str:
    """Return words for a field of a case: "modulus of the pin" for "pin.E", "moment M in load 2" for "load.2.M"."""
    section, *between, key = field.split(".")
    if section == "load":
        load = _LOADS.get(key, f"remote stress {key}") if key in LOADS else key.replace("_", " ")
        number, *part = between or [""]  # the part is mean, amplitude or phase of a harmonic block
        words = f"{part[0]} of the {load}" if part else load
        return f"{words} in load {number}" if number else words
    words = _KEYS.get(key, key.replace("_", " "))
    return f"{words} of the {_OWNERS[section]}" if section in _OWNERS else words
