"""Words and kinds of quantities for the fields of a case that sweeps vary."""

from __future__ import annotations

from fastpin.model.fields import FIELDS
from fastpin.model.loads import LOAD, LOAD_KIND
from fastpin.studies.variation import FACTORS

_OWNERS = {"pin": "pin", "plate": "plate", "pin_body": "pin", "plate_body": "plate"}
"""Sections of a case whose keys belong to a body."""

_KEYS = {
    "E": "modulus",
    "nu": "Poisson's ratio",
    **{name: field.words for name, field in FIELDS.items() if field.words},
    "reaction": "distance of the reaction",
    "nodes": "number of nodes",
    "axis": "axis (deg)",
    **{name: f"modulus {name}" for name in ("E1", "E2", "G12")},
    "nu12": "Poisson's ratio nu12",
}
"""Words for keys whose names are no words."""


_OF_BUSHES = {
    "plate_body.friction": "friction coefficient of the seat",
    "plate_body.interference": "interference of the bush",
    "plate_body.E": "modulus of the bush",
    "plate_body.nu": "Poisson's ratio of the bush",
    "plate_body.ring_outer_radius": "outer radius of the lug",
}
"""Words for fields that only a plate with a bush has."""

_KIND = {
    **{f"contact.{name}": field.kind for name, field in FIELDS.items()},
    "pin.E": "traction",
    **dict.fromkeys(("plate.E", "plate.E1", "plate.E2", "plate.G12"), "traction"),
    "pin_body.bore_radius": "length",
    "plate_body.E": "traction",
    "plate_body.outer_radius": "length",
    "plate_body.ring_outer_radius": "length",
    "plate_body.reaction": "length",
    "plate_body.interference": "displacement",
}
"""The kind of every field of a case that has a unit, apart from the loads."""


_PROFILE_WORDS = {
    "ellipse": "oval",
    "lobes": "number of lobes",
    "size": "size of the lobes",
    "axis": "direction (deg)",
    "centre": "place (deg)",
    "half_width": "half width (deg)",
    "start": "start (deg)",
    "stop": "stop (deg)",
}
"""Words for keys of profiles whose names are no words, or that are in degrees."""


def field_words(field: str) -> str:
    """Return words for a field of a case: "modulus of the pin" for "pin.E", "moment M in load 2" for "load.2.M"."""
    if field in FACTORS:
        _, _, load = field.partition(".")
        return f"factor of the {LOAD[load].short}" if load else "factor of all loads"
    if field in _OF_BUSHES:
        return _OF_BUSHES[field]
    section, *between, key = field.split(".")
    if between and section in ("gap", "contact"):
        owner = "friction" if section == "contact" else between[0]
        term = f", term {between[1]}" if len(between) > 1 else ""
        return f"{_PROFILE_WORDS.get(key, key)} of the {owner}{term}"
    if section == "load":
        load = LOAD[key].short if key in LOAD else key.replace("_", " ")
        number, *part = between or [""]  # the part is mean, amplitude or phase of a harmonic block
        words = f"{part[0]} of the {load}" if part else load
        return f"{words} in load {number}" if number else words
    words = _KEYS.get(key, key.replace("_", " "))
    return f"{words} of the {_OWNERS[section]}" if section in _OWNERS else words


def field_kind(field: str) -> str:
    """Return the kind of a varied field; empty if it has no unit."""
    section, key = field.split(".")[0], field.rsplit(".", 1)[-1]
    if section == "gap":
        lengths = ("hole", "pin", "ellipse", "size", "flat", "crown", "constant", "cosine", "sine")
        return "displacement" if key in lengths else ""
    return LOAD_KIND.get(key, "") if section == "load" else _KIND.get(field, "")
