"""The laminate of a plate in a case file: a layup and its plies, moduli of the whole, or compliances; and its axis."""

from __future__ import annotations

from typing import Any

from fastpin.casefile.profiles import checked_angle
from fastpin.casefile.toml_text import CaseText, Inside, Section
from fastpin.errors import InputError
from fastpin.model.checks import as_toml
from fastpin.model.laminate import ALONG_LOAD, LAMINATE_KEYS, MODULI, Laminate
from fastpin.model.layup import checked_angles
from fastpin.model.materials import MATERIAL_KEYS, STRENGTHS
from fastpin.model.ply import PLIES, PLY_KEYS, PLY_NUMBERS, STRENGTH_KEYS, Ply, ply_from

KINDS = {"layup": ("layup", "ply"), "E1": MODULI, "compliance": ("compliance",)}
"""The ways to give a laminate: the key that names the way, and all its keys."""


def read_laminate(source: CaseText, section: Section) -> Laminate | None:
    """The laminate of [plate]; None if it can't be used (reported)."""
    axis = section.checked("axis", checked_angle)
    way = next((name for name, keys in KINDS.items() if any(key in section for key in keys)), None)
    if way is None:
        section.report(
            "axis: belongs to a laminate: give layup and ply, or E1, E2, G12 and nu12, or compliance", "axis"
        )
        return None
    for key in (*MATERIAL_KEYS, *LAMINATE_KEYS):
        if key in section and key in ("fatigue", "growth", *STRENGTHS):
            section.report(f"{key}: has no meaning for a laminate", key)
        elif key in section and key not in (*KINDS[way], "axis"):
            section.report(f"[plate]: {key} can't be given together with {way}", key)
    for key in KINDS[way]:
        section.require(key, " (a laminate is a layup and its ply, or E1, E2, G12 and nu12, or compliance)")
    if any(key not in section for key in KINDS[way]):
        return None
    turned = {"axis": ALONG_LOAD if axis is None else axis}
    if way == "layup":
        return _of_plies(source, section, turned["axis"])
    if way == "compliance":
        return section.build(Laminate, {"compliance": section.value("compliance"), **turned}, {})
    values = {key: section.number(key) for key in MODULI}
    return section.build(Laminate.from_moduli, {**values, **turned}, {**dict.fromkeys(MODULI, 1.0), "nu12": 0.0})


def _of_plies(source: CaseText, section: Section, axis: float) -> Laminate | None:
    angles = section.checked("layup", checked_angles)
    given = section.value("ply")
    plies = [_ply(source, section, each) for each in (given if isinstance(given, list) else [given])]
    known = [ply for ply in plies if ply is not None]
    if angles is None or len(known) < len(plies):
        return None
    if isinstance(given, list) and len(known) != len(angles):
        section.report(f"ply: must be one ply, or a list of {len(angles)} for the whole stack, not {len(known)}", "ply")
        return None
    each = known if isinstance(given, list) else known * len(angles)
    try:
        return Laminate.from_plies(zip(each, angles, strict=True), axis)
    except InputError as error:
        section.report(f"layup: {error.reason}", "layup")
        return None


def _ply(source: CaseText, section: Section, given: Any) -> Ply | None:
    """The ply of a name or a table; None if it can't be used (reported)."""
    if isinstance(given, str):
        try:
            return PLIES[given]
        except InputError as error:
            section.report(str(error), "ply")
            return None
    if not isinstance(given, dict):
        if given is not None:
            words = f"must be the name of a ply in quotes, or a table with {', '.join(PLY_NUMBERS)}"
            section.report(f"ply: {words}, not {as_toml(given)}", "ply")
        return None
    inner = Inside(source, section, "ply", given)
    inner.check_keys(PLY_KEYS, f" in ply of [{section.name}]")
    for key in given:
        if key in STRENGTH_KEYS and "load_parameter" in source.section("contact"):
            inner.report(f"{key}: has no meaning with load_parameter, for the stresses have no unit", key)
    harmless = {**dict.fromkeys(PLY_KEYS, 1.0), "nu12": 0.0, "name": "", "source": ""}
    return inner.build(ply_from, {key: inner.value(key) for key in PLY_KEYS if key in inner}, harmless)
