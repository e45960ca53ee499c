"""The section [crack] of a case file: a crack at the edge of the hole, and how it grows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastpin.casefile.materials import read_law
from fastpin.casefile.toml_text import CaseText, Section
from fastpin.model.crack import CRACK_KEYS, CrackGrowth, crack_from
from fastpin.model.growth import Walker


def read_crack(source: CaseText, section: Section, default: Mapping[str, Any] | None = None) -> CrackGrowth | None:
    """How a crack grows; None if a key is wrong (reported). `default`: values of keys that the section leaves out."""
    values = {**(default or {}), **{key: section.value(key) for key in CRACK_KEYS if key in section}}
    faults = len(source.placed)
    if section.value("law") is not None:
        values["law"] = read_law(source, section, "law") or Walker(1.0, 1.0)
    for key in ("first", "last"):
        if key not in values:
            section.report(f"{key} is missing: give the {key} length of the crack, m")
    values = {"first": 1e-300, "last": 1e300, **values}
    harmless = {"first": 1e-300, "last": 1e300, "theta": None, "angle": 0.0, "body": "plate", "residual_stress": None}
    crack = section.build(crack_from, values, harmless)
    return crack if len(source.placed) == faults else None
