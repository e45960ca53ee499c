"""The section [strength] of a case file: how the strength of a laminate round the hole is assessed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastpin.casefile.toml_text import CaseText, Section
from fastpin.model.strength import LENGTHS, STRENGTH_KEYS, StrengthAssessment


def read_strength(
    source: CaseText, section: Section, default: Mapping[str, Any] | None = None
) -> StrengthAssessment | None:
    """How the strength is assessed; None if a key is wrong (reported).

    `default` holds the values of keys that the section leaves out. A length of the section leaves its lengths out.
    """
    values, faults = dict(default or {}), len(source.placed)
    if any(name in section for name in LENGTHS):
        values = {name: value for name, value in values.items() if name not in LENGTHS}
    values |= {key: section.value(key) for key in STRENGTH_KEYS if key in section}
    harmless: dict[str, Any] = {"criterion": "hashin", "failure": False}
    pair = sum(values.get(name) is not None for name in LENGTHS[1:])
    if pair == 2:
        harmless |= {"distance": None, "tension": 0.0, "compression": 0.0}
    elif not pair:
        harmless["distance"] = 0.0
    found = section.build(StrengthAssessment, values, harmless)
    return found if len(source.placed) == faults else None
