"""The sections of a case beside its problem: what is asked of its result. Outcomes of plans use the readers, too."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from fastpin.casefile.materials import read_law
from fastpin.casefile.toml_text import CaseText, Section, field_defaults
from fastpin.model.assessment import MINER_RULES, FatigueAssessment
from fastpin.model.case import BESIDE
from fastpin.model.crack import CrackGrowth, crack_from
from fastpin.model.growth import Walker
from fastpin.model.strength import LENGTHS, StrengthAssessment
from fastpin.model.units import measures_of


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
    values |= {key: value for key in BESIDE["fatigue"].keys if (value := section.value(key)) is not None}
    harmless = field_defaults(FatigueAssessment)
    if values.get("length") is not None:
        harmless["method"] = "line"  # a wrong method leaves its length unreported, as a wrong rule its knee
    if values.get("reliability") is not None:
        harmless["criterion"] = "stress-life"
    if values.get("knee") is not None:
        harmless["small_cycles"] = "original"
    if values.get("small_cycles", "elementary") != "elementary":
        harmless["knee"] = 1e6 if values.get("knee") is not None or values["small_cycles"] in MINER_RULES else None
    return section.build(FatigueAssessment, values, harmless)


def read_crack(source: CaseText, section: Section, default: Mapping[str, Any] | None = None) -> CrackGrowth | None:
    """How a crack grows; None if a key is wrong (reported). `default`: values of keys that the section leaves out."""
    values = {**(default or {}), **{key: section.value(key) for key in BESIDE["crack"].keys if key in section}}
    faults = len(source.placed)
    if section.value("law") is not None:
        values["law"] = read_law(source, section, "law") or Walker(1.0, 1.0)
    length = measures_of(section.units, False)["length"].name
    for key in ("first", "last"):
        if key not in values:
            section.report(f"{key} is missing: give the {key} length of the crack, {length}")
    values = {"first": 1e-300, "last": 1e300, **values}
    crack = section.build(crack_from, values, field_defaults(CrackGrowth) | {"first": 1e-300, "last": 1e300})
    return crack if len(source.placed) == faults else None


def read_strength(
    source: CaseText, section: Section, default: Mapping[str, Any] | None = None
) -> StrengthAssessment | None:
    """How the strength is assessed; None if a key is wrong (reported).

    `default` holds the values of keys that the section leaves out. A length of the section leaves its lengths out.
    """
    values, faults = dict(default or {}), len(source.placed)
    if any(name in section for name in LENGTHS):
        values = {name: value for name, value in values.items() if name not in LENGTHS}
    values |= {key: section.value(key) for key in BESIDE["strength"].keys if key in section}
    pair = sum(values.get(name) is not None for name in LENGTHS[1:])
    harmless: dict[str, Any] = {"criterion": "hashin", "failure": False}
    if pair == 2:
        harmless |= {"distance": None, "tension": 0.0, "compression": 0.0}
    elif not pair:
        harmless["distance"] = 0.0
    found = section.build(StrengthAssessment, values, harmless)
    return found if len(source.placed) == faults else None


READERS: dict[str, Callable[..., Any]] = {
    "fatigue": read_assessment, "crack": read_crack, "strength": read_strength
}  # fmt: skip
"""Functions of a text, a section and the values of keys that it leaves out. None: a key is wrong (reported)."""
