"""The materials of a case file: [pin] and [plate], or [dundurs], and files with materials of the user.

Such a file has a section for each material, by its name.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from fastpin.casefile.profiles import checked_angle
from fastpin.casefile.toml_text import CaseText, Inside, Section, field_defaults, parse_text, read_text, written
from fastpin.errors import CaseFileError, InputError, printable
from fastpin.model.checks import any_text, as_toml, choice, file_path, number, positive, string, true_or_false
from fastpin.model.fatigue import FatigueConstants
from fastpin.model.growth import LAWS, KnownLaw, known_law, law_entries
from fastpin.model.keys import ANY, MATERIAL
from fastpin.model.laminate import ALONG_LOAD, LAMINATE_KEYS, MODULI, Laminate
from fastpin.model.layup import checked_angles
from fastpin.model.materials import (
    MATERIAL_KEYS,
    MATERIALS,
    NUMBERS,
    STRENGTHS,
    Material,
    MaterialPair,
    checked_expansion,
)
from fastpin.model.ply import PLIES, PLY_KEYS, PLY_NUMBERS, STRENGTH_KEYS, Ply, ply_from
from fastpin.model.synonyms import closest
from fastpin.model.unit_systems import SI, is_system
from fastpin.model.units import in_units_of

FILE_KEYS = ("E", "nu", "yield_strength", "ultimate_strength", "expansion", "fatigue", "growth", "source")
"""Keys of a material in a file of materials."""

_FATIGUE_KEYS = tuple(field.name for field in fields(FatigueConstants))

KINDS = {"layup": ("layup", "ply"), "E1": MODULI, "compliance": ("compliance",)}
"""The ways to give a laminate: the key that names the way, and all its keys."""


_ISOTROPIC = ("material", "E", "nu", "rigid", "fatigue", "growth", *NUMBERS)

_REPLACED: dict[str, tuple[str, ...]] = {
    "material": ("E", "nu", "rigid", "fatigue", "growth", *NUMBERS, *LAMINATE_KEYS),
    "E": ("material", "rigid", *LAMINATE_KEYS),
    "nu": ("material", "rigid", *LAMINATE_KEYS),
    "rigid": ("material", "E", "nu", "fatigue", "growth", *NUMBERS, *LAMINATE_KEYS),
    **dict.fromkeys(("layup", "ply"), (*_ISOTROPIC, *MODULI, "compliance")),
    **dict.fromkeys(MODULI, (*_ISOTROPIC, "layup", "ply", "compliance")),
    "compliance": (*_ISOTROPIC, "layup", "ply", *MODULI),
}
"""Keys of a body that each key of its material replaces."""


def read_pair(source: CaseText, materials: Mapping[str, Material]) -> MaterialPair | None:
    """The materials of pin and plate. None if they can't be used. The reason is reported.

    `materials` are those with a name.
    """
    contact = source.section("contact")
    plane = contact.choice("plane", ("strain", "stress")) or "strain"
    if "dundurs" in source.root:
        for name in ("pin", "plate"):
            if name in source.root:
                source.report(f"[{name}]: give either [dundurs] or [pin] and [plate]", name)
        return _dundurs(source.section("dundurs"), contact, plane)
    pin = read_material(source, source.section("pin", required=True), materials)
    section = source.section("plate", required=True)
    is_laminate = any(key in section for key in LAMINATE_KEYS)
    plate = read_laminate(source, section) if is_laminate else read_material(source, section, materials)
    if pin is None or plate is None:
        return None
    return source.root.build(MaterialPair, {"pin": pin, "plate": plate, "plane": plane}, {})


def read_material(
    source: CaseText, section: Section, materials: Mapping[str, Material], may_be_rigid: bool = True
) -> Material | None:
    """The material of a body. Its strengths and constants of fatigue and growth replace those of a named material.

    None if it can't be used. The reason is reported.
    """
    given: dict[str, Any] = {"fatigue": _fatigue(source, section)}
    if section.value("growth") is not None and _has_stresses(source, section, "growth"):
        given["growth"] = read_law(source, section, "growth")
    for strength in STRENGTHS:
        if strength in section and _has_stresses(source, section, strength):
            given[strength] = section.checked(strength, positive)
    if "expansion" in section:
        given["expansion"] = section.checked("expansion", checked_expansion) or 0.0  # a faulty one is not missing
    material = _elastic(section, materials, may_be_rigid)
    if material is None:
        return None
    return replace(material, **{name: value for name, value in given.items() if value is not None})


def _fatigue(source: CaseText, section: Section) -> FatigueConstants | None:
    """The fatigue constants of a body; None if there are none, or they are wrong (reported)."""
    table = section.value("fatigue")
    if table is None or not _has_stresses(source, section, "fatigue"):
        return None
    if not isinstance(table, dict):
        section.report(f"fatigue: must be a table {{ ... }}, not {as_toml(table)}", "fatigue")
        return None
    inner = Section(source, (section.name, "fatigue"), table)
    inner.check_keys(_FATIGUE_KEYS, f" in fatigue of [{section.name}]")
    given = {key: inner.value(key) for key in _FATIGUE_KEYS if inner.value(key) is not None}
    if source.units != SI and "curve_a" in given and "curve_b" not in given:
        section.report("fatigue: curve_a needs curve_b beside it in a file with units", "fatigue")
    return inner.build(FatigueConstants, given, field_defaults(FatigueConstants))


def read_law(source: CaseText, section: Section, key: str) -> KnownLaw | None:
    """The law of crack growth in the table of a key; None if it can't be used (reported)."""
    table = section.value(key)
    if not isinstance(table, dict):
        section.report(f'{key}: must be a table such as {{ law = "walker", ... }}, not {as_toml(table)}', key)
        return None
    inner = Inside(source, section, key, table)
    if "law" not in inner:
        section.report(f"{key}: law is missing; it is one of {', '.join(LAWS)}", key)
    name = inner.checked("law", choice, tuple(LAWS))
    if name is None:
        return None
    make, allowed, needed = LAWS[name]
    constants = f"; the constants of this law are {', '.join(allowed)}"
    inner.check_keys(("law", *allowed), f" in {key} of [{section.name}] with the law {name}", constants)
    for constant in needed:
        if constant not in inner:
            section.report(f"{key}: {constant} is missing; the law {name} needs {', '.join(needed)}", key)
    values = {constant: inner.value(constant) for constant in allowed if constant in table}
    harmless = field_defaults(LAWS[name][0]) | dict.fromkeys(needed, 1.0)
    found = inner.build(make, {**dict.fromkeys(needed), **values}, harmless)
    return None if found is None else known_law(key, found)


def _has_stresses(source: CaseText, section: Section, key: str) -> bool:
    """Whether the stresses in a body have a meaning and a unit; else the `key` is reported."""
    if section.value("rigid") is True:
        section.report(f"[{section.name}]: {key} can't be given together with rigid", key)
    elif "load_parameter" in source.section("contact"):
        section.report(f"{key}: has no meaning with load_parameter, for the stresses have no unit", key)
    else:
        return True
    return False


def _elastic(section: Section, materials: Mapping[str, Material], may_be_rigid: bool) -> Material | None:
    if not section.present:
        return None
    rigid = section.checked("rigid", true_or_false)
    values = {"E": section.checked("E", _modulus if may_be_rigid else number), "nu": section.number("nu")}
    chosen = "material" if "material" in section else "rigid" if rigid else None
    if chosen is not None:
        others = ("E", "nu", "rigid") if rigid and chosen == "material" else ("E", "nu")
        for other in others:
            if other in section:
                section.report(f"[{section.name}]: {other} can't be given together with {chosen}", other)
        if chosen == "rigid":
            return Material.rigid()
        return section.checked("material", _named, materials)
    if "E" not in section and "nu" not in section:
        if rigid is not None or "rigid" not in section:
            section.report(
                f"[{section.name}]: needs material, or E and nu{', or rigid = true' if may_be_rigid else ''}"
            )
        return None
    section.require("E")
    section.require("nu")
    return section.build(Material, values, {"E": 1.0, "nu": 0.3})


def _named(field: str, name: object, materials: Mapping[str, Material]) -> Material:
    """The material of a name."""
    if not isinstance(name, str):
        raise InputError(field, f"must be the name of a material in quotes, not {as_toml(name)}")
    if name not in materials:
        hint = closest(name, materials) or f"; there are {', '.join(materials)}"
        raise InputError(field, f"there is no material {as_toml(name)}{hint}")
    return materials[name]


def _modulus(name: str, value: object) -> float:
    if value == math.inf:
        raise InputError(name, "must be a finite number, not inf; for a rigid body write rigid = true")
    return number(name, value)


def _dundurs(section: Section, contact: Section, plane: str) -> MaterialPair | None:
    if not section.present:
        return None
    convention = section.choice("convention", ("usual", "paper"))
    values = {"alpha": section.checked("alpha", number, -1.0, 1.0), "beta": section.number("beta")}
    values["nu_pin"] = section.checked("nu_pin", number, 0.0, 0.5)
    for key in values:
        section.require(key)
    if "load_parameter" in contact:
        if "beta_star" in section:
            section.report("beta_star: has no meaning with load_parameter, which counts in units of it", "beta_star")
    elif "hole_radius" in contact or "clearance" in contact:
        section.require("beta_star", " (the scale of the moduli; with load_parameter none is needed)")
        values["beta_star"] = section.number("beta_star")
    if convention is None or None in values.values():
        return None
    return section.build(MaterialPair.from_dundurs, {**values, "plane": plane, "convention": convention}, {})


def read_materials(path: str | Path) -> dict[str, Material]:
    """Read the materials of a TOML file.

    Parameters
    ----------
    path : str or Path
        The file. Each section is a material, with the keys `E`, `nu`, and perhaps `yield_strength`,
        `ultimate_strength`, `fatigue`, `growth` and `source`::

            [my-alloy]
            E = 71e9
            nu = 0.33
            yield_strength = 345e6
            source = "certificate 123"

    Returns
    -------
    dict of str to Material
        The materials by name.

    Raises
    ------
    CaseFileError, InputError
        See :func:`fastpin.read_case`.
    """
    path = file_path("path", path)
    return parse_text(read_text(path), str(path), "file of materials", _materials_in)


def known_materials(source: CaseText, folder: Path) -> Mapping[str, Material]:
    """Return all materials that a case knows by name: those of fastpin, and those of the file of its key `materials`.

    A relative path starts in `folder`. Faults of the file are reported on the line of the key.
    """
    name = source.root.checked("materials", any_text)
    if name is None:
        return MATERIALS
    try:
        return MATERIALS | _read(folder / name)
    except CaseFileError as error:
        for line, sentence in error.problems:
            source.report(f"materials: {name}{f', line {line}' if line else ''}: {sentence}", "materials")
        return MATERIALS | dict.fromkeys(_names_in(folder / name), MATERIALS["steel"])  # the rest is checked


def _names_in(path: Path) -> list[str]:
    """Return the names of the materials of a file with faults; none if it can't be read."""
    try:
        return [*CaseText(read_text(path)).root.table]
    except CaseFileError:
        return []


def _read(path: Path) -> dict[str, Material]:
    """Read materials, unless the same file was read before and has not changed since."""
    try:
        status = path.stat()
    except OSError:  # the file can't be read; the reader says why
        return read_materials(path)
    return _remembered(path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=8)  # the points of a sweep share one file
def _remembered(path: Path, changed: int, size: int) -> dict[str, Material]:
    return read_materials(path)


def _materials_in(source: CaseText) -> dict[str, Material]:
    found = {}
    if not source.root.table and not source.faults:
        source.report("no materials: a material is a section, such as [my-alloy], with E and nu")
    source.to_si({ANY: MATERIAL}, False)
    for name, table in source.root.table.items():
        if name == "units":
            continue
        if not isinstance(table, dict):
            source.report(
                f"{name}: must be a section [{name}] with E and nu, not {written(name, table) or as_toml(table)}", name
            )
            continue
        if name in MATERIALS:
            source.report(f"[{name}]: is a material of fastpin; choose another name", name)
        section = Section(source, (name,), table)
        if printable(name) != name:
            section.report(f"[{name}]: the name of a material must be one line of printable characters")
            continue
        section.check_keys(FILE_KEYS, f" in [{name}]")
        section.checked("source", string)
        by_name = "material" in section or "rigid" in section  # such a key is reported already
        material = None if by_name else read_material(source, section, {}, may_be_rigid=False)
        if material is not None:
            found[name] = replace(material, name=name)
    return found


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
        if key in section and key in ("fatigue", "growth", *NUMBERS):
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
    return section.made(lambda: Laminate.from_plies(zip(each, angles, strict=True), axis), "layup")


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


def make_room(body: dict[str, Any], key: str, value: Any, materials: Mapping[str, Material], system: Any) -> None:
    """Remove the keys of a body that its new `key` for the material replaces.

    If one constant of a material with a name changes, its other constants stay. They are written in the units of the
    `system`.
    """
    if key == "rigid" and value is not True:
        return
    material_name = body.get("material")
    if key in ("E", "nu") and isinstance(material_name, str) and material_name in materials:
        material = materials[material_name]
        constants: dict[str, Any] = {"E": material.E, "nu": material.nu, **material.numbers}
        if material.fatigue is not None:
            constants["fatigue"] = material.fatigue.given()
        if material.growth is not None:
            constants["growth"] = law_entries(material.growth)
        constants = in_units_of(constants, MATERIAL, system if is_system(system) else SI, None)
        body |= {name: value for name, value in constants.items() if name in ("E", "nu") or name not in body}
    for replaced in _REPLACED.get(key, ()):
        body.pop(replaced, None)
