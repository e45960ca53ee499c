"""The bodies of a case file: [pin_body] and [plate_body].

A body whose keys are wrong is reported and replaced by a solid pin or an infinite plate, so that the rest is still
checked.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from fastpin.casefile.materials import MATERIAL_KEYS, read_material
from fastpin.casefile.toml_text import CaseText, Section
from fastpin.errors import InputError
from fastpin.model.bodies import (
    SUPPORTS,
    TUBE_LOADS,
    Bushing,
    Disk,
    PinBody,
    Plate,
    PlateBody,
    Ring,
    Tube,
    check_pin_body,
    check_plate_body,
)
from fastpin.model.checks import any_text, choice, not_negative, positive
from fastpin.model.compliance import Compliance
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import check_bush

Kinds = dict[str, tuple[str, ...]]
"""The keys of each kind of body."""

PIN_KINDS: Kinds = {"disk": (), "tube": ("bore_radius", "load")}
PLATE_KINDS: Kinds = {
    "plate": ("reaction",),
    "ring": ("outer_radius", "support"),
    "bushing": (
        *MATERIAL_KEYS,
        "outer_radius",
        "interference",
        "friction",
        "ring_outer_radius",
        "support",
        "reaction",
    ),
    "compliance": ("file",),
}
BODY_KINDS = {"pin_body": PIN_KINDS, "plate_body": PLATE_KINDS}
"""The kinds of body of each section."""

KEPT_FILES = 8
"""Compliances that stay in memory. The points of a sweep often share one."""


def keys_of(kinds: Kinds) -> tuple[str, ...]:
    """All keys of a section with these kinds of body."""
    return tuple(dict.fromkeys(["kind", *(key for keys in kinds.values() for key in keys)]))


def implied_kind(kinds: Kinds, table: Mapping[str, Any]) -> str:
    """The kind of body that the keys of a table tell: the first kind that has all of them."""
    known = {key for key in table if any(key in keys for keys in kinds.values())}
    return next((kind for kind, keys in kinds.items() if known <= set(keys)), list(kinds)[-1])


def read_bodies(
    source: CaseText,
    folder: Path,
    radius: float | None,
    pair: MaterialPair | None,
    materials: Mapping[str, Material],
) -> dict[str, PinBody | PlateBody]:
    """Read the bodies of a case.

    Parameters
    ----------
    source : CaseText
        The text of the case file. All faults of the bodies are reported to it.
    folder : Path
        Folder in which the relative path of a compliance starts.
    radius : float or None
        Radius of the hole. None if it is unknown; the bodies are then a solid pin and an infinite plate.
    pair : MaterialPair or None
        Materials of pin and plate. None if they are unknown; a compliance is then an infinite plate.
    materials : mapping of str to Material
        The materials with a name, for a bush.

    Returns
    -------
    dict
        The arguments ``pin_body`` and ``plate_body`` of a :class:`Problem`.
    """
    if not source.root.table.keys() & BODY_KINDS:
        return {"pin_body": Disk(), "plate_body": Plate()}
    pin = _pin_body(source.section("pin_body"))
    plate = _plate_body(source, folder, materials)
    if radius is None or (pair is None and isinstance(plate, Compliance)):
        plate = Plate()
    if radius is None or not _fits(source.section("pin_body"), functools.partial(check_pin_body, pin, radius)):
        pin = Disk()
    if radius is not None:
        plate = _fitting(source, plate, radius, pair)
    return {"pin_body": pin, "plate_body": plate}


def _kind(section: Section) -> str | None:
    """The kind of the body of a section. None if it is wrong. Keys of other kinds are reported."""
    kinds = BODY_KINDS[section.name]
    kind = section.checked("kind", choice, tuple(kinds)) if "kind" in section else implied_kind(kinds, section.table)
    if kind is None:
        return None
    for key in section.table:
        owners = [f'"{name}"' for name, keys in kinds.items() if key in keys]
        if owners and f'"{kind}"' not in owners:
            more = "; a bush sits in an infinite plate or a ring" if (key, kind) == ("file", "bushing") else ""
            section.report(f'{key}: belongs to kind = {" or ".join(owners)}, not to kind = "{kind}"{more}', key)
    return kind


def _pin_body(section: Section) -> PinBody:
    if _kind(section) != "tube":
        return Disk()
    section.require("bore_radius")
    bore, load = section.checked("bore_radius", positive), section.choice("load", TUBE_LOADS)
    return Disk() if bore is None or load is None else Tube(bore, load)  # type: ignore[arg-type]


def _plate_body(source: CaseText, folder: Path, materials: Mapping[str, Material]) -> PlateBody:
    section = source.section("plate_body")
    kind = _kind(section)
    if kind == "compliance":
        return _compliance(section, folder)
    if kind == "bushing":
        return _bushing(source, section, materials)
    if kind == "ring":
        return _ring(section, "outer_radius")
    return _plate(section)


def _plate(section: Section) -> Plate:
    given = section.value("reaction")
    return section.build(Plate, {"reaction": given}, {"reaction": None}) or Plate()


def _ring(section: Section, key: str) -> Plate | Ring:
    """The ring whose outer radius stands under `key`; an infinite plate if it is wrong."""
    section.require(key)
    outer, support = section.checked(key, positive), section.choice("support", SUPPORTS)
    return Plate() if outer is None or support is None else Ring(outer, support)  # type: ignore[arg-type]


def _bushing(source: CaseText, section: Section, materials: Mapping[str, Material]) -> PlateBody:
    material = _bush_material(source, section, materials)
    section.require("outer_radius")
    outer = section.checked("outer_radius", positive)
    interference, friction = (section.checked(key, not_negative) for key in ("interference", "friction"))
    inside: Plate | Ring
    if "ring_outer_radius" in section:
        if "reaction" in section:
            section.report("reaction: can't be given together with ring_outer_radius", "reaction")
        inside = _ring(section, "ring_outer_radius")
    else:
        if "support" in section:
            section.report("support: needs ring_outer_radius, the outer radius of the ring round the bush", "support")
        inside = _plate(section)
    if material is None or outer is None:
        return Plate()
    values = {"material": material, "outer_radius": outer, "inside": inside, "friction": friction}
    key = next(key for key in ("rigid", "material", "E", "nu") if key in section)
    found = section.build(Bushing, {**values, "interference": interference or 0.0}, {}, {"material": (section, key)})
    return found or Plate()


def _bush_material(source: CaseText, section: Section, materials: Mapping[str, Material]) -> Material | None:
    """The material of a bush. None if it can't be used. The reason is reported."""
    material = read_material(source, section, materials, may_be_rigid=False)
    if "material" in section and "dundurs" in source.root and "load_parameter" in source.section("contact"):
        section.report(
            "material: with [dundurs] and load_parameter the moduli count in units of 1/beta* of pin and plate; "
            "give E and nu of the bush",
            "material",
        )
        return None
    return material


def _compliance(section: Section, folder: Path) -> PlateBody:
    section.require("file")
    name = section.checked("file", any_text)
    if name is None:
        return Plate()
    try:
        return _read_compliance(folder / name)
    except InputError as error:
        section.report(str(error), "file")
        return Plate()


def _read_compliance(path: Path) -> Compliance:
    """Read a compliance, unless the same file was read before and has not changed since."""
    try:
        status = path.stat()
    except OSError:  # the file can't be read; the reader says why
        return Compliance.from_file(path)
    return _remembered(path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=KEPT_FILES)
def _remembered(path: Path, changed: int, size: int) -> Compliance:
    return Compliance.from_file(path)


def _fitting(source: CaseText, body: PlateBody, radius: float, pair: MaterialPair | None) -> PlateBody:
    """Return the part of a plate's body that fits round the hole. Every part that does not fit is reported."""
    section = source.section("plate_body")
    whole = "load_parameter" in source.section("contact")

    def fits(part: PlateBody, names: Mapping[str, str] | None = None) -> bool:
        return _fits(section, functools.partial(check_plate_body, part, radius, whole), names)

    if not isinstance(body, Bushing):
        return body if fits(body) else Plate()
    bush = Bushing(body.material, body.outer_radius, friction=body.friction)
    if not fits(bush) or (pair is not None and not _touches(section, pair, bush)):
        return Plate()
    if fits(replace(bush, inside=body.inside), {"outer_radius": "ring_outer_radius"}):
        bush = replace(bush, inside=body.inside)
    pressed = replace(bush, interference=body.interference)
    return pressed if fits(pressed) else bush


def _touches(section: Section, pair: MaterialPair, bush: Bushing) -> bool:
    """Whether pin and bush can be in contact; else the fault is reported."""
    key = "material" if "material" in section else "E"
    return _fits(section, functools.partial(check_bush, pair, bush), {"material": key})


def _fits(section: Section, check: functools.partial[None], names: Mapping[str, str] | None = None) -> bool:
    """Whether a check passes; else its fault is reported. `names` are the keys of fields with other names."""
    try:
        check()
    except InputError as error:
        key = (names or {}).get(error.field, error.field)
        section.report(f"{key}: {error.reason}", key)
        return False
    return True
