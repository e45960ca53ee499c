"""The section [fatigue] of a case file, and the keys of an outcome of fatigue."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastpin.casefile.toml_text import CaseText, Section
from fastpin.model.assessment import ASSESSMENT_KEYS, MINER_RULES, FatigueAssessment


def read_assessment(
    source: CaseText, section: Section, default: Mapping[str, Any] | None = None
) -> FatigueAssessment | None:
    """How the fatigue of a history is assessed; None if a key can't be replaced by a harmless one (reported).

    `default` holds the values of keys that the section leaves out. A length goes with its method, and a knee with its
    rule: another method or rule in the section leaves the default ones out.
    """
    values = dict(default or {})
    for chooser, partner in (("method", "length"), ("small_cycles", "knee")):
        if chooser in section:
            values.pop(partner, None)
    values |= {key: section.value(key) for key in ASSESSMENT_KEYS if section.value(key) is not None}
    usual = FatigueAssessment()
    harmless = {key: getattr(usual, key) for key in ASSESSMENT_KEYS}
    if values.get("length") is not None:
        harmless["method"] = "line"  # a wrong method leaves its length unreported, as a wrong rule its knee
    if values.get("reliability") is not None:
        harmless["criterion"] = "stress-life"
    if values.get("knee") is not None:
        harmless["small_cycles"] = "original"
    if values.get("small_cycles", "elementary") != "elementary":
        harmless["knee"] = 1e6 if values.get("knee") is not None or values["small_cycles"] in MINER_RULES else None
    return section.build(FatigueAssessment, values, harmless)
