"""The reader of joint files: plates, pins and loads of a joint, in one TOML file.

All faults of a file are reported at once, each with its line. :data:`JOINT_EXAMPLE` is a commented joint file.
``fastpin joint --example`` prints it.
"""

from __future__ import annotations

import itertools
import re
from pathlib import Path
from typing import Any, Literal, NamedTuple

from fastpin.bodies import Bushing
from fastpin.bodies.body import THINNEST
from fastpin.casefile.beside import read_assessment, read_crack
from fastpin.casefile.bodies import BodySection
from fastpin.casefile.lug import limits_of, point_of
from fastpin.casefile.materials import read_material
from fastpin.casefile.profiles import GAP_KEYS, read_gap, read_wear
from fastpin.casefile.toml_text import CaseText, Inside, Section, parse_text, read_text
from fastpin.errors import InputError
from fastpin.joints.parts import Joint, JointPlate, kind_of_load
from fastpin.joints.pins import Clamp, JointPin, tate_rosenfeld
from fastpin.joints.result import SectionCrack, check_crack, check_fatigue, check_wear
from fastpin.joints.solving import LEAST_NODES, MOST_HARMONICS, MOST_NODES, load_values, reaction_words
from fastpin.lugs.outline import Part, rectangle
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.case import BESIDE
from fastpin.model.checks import (
    any_text,
    as_toml,
    choice,
    file_path,
    instance,
    number,
    positive,
    string,
    unknown_key,
    whole_number,
)
from fastpin.model.keys import ANY, CASE, ITSELF, MATERIAL, of
from fastpin.model.materials import MATERIAL_KEYS, MATERIALS, PLANES
from fastpin.model.profile import InitialGap
from fastpin.model.wear import WEAR_KEYS, Wear

JOINT_EXAMPLE = Path(__file__).with_name("joint.toml").read_text(encoding="utf-8")
"""A commented joint file: a single lap of three bolts."""

JOINT_KEYS: dict[str, tuple[str, ...]] = {
    "joint": ("plane", "nodes", "harmonics", "repeat"),
    "plate": ("name", *MATERIAL_KEYS, "thickness", "x", "y", "start", "parts", "supports", "moves", "drive", "slices"),
    "pin": (
        "name",
        "at",
        *MATERIAL_KEYS,
        "diameter",
        "bore_radius",
        "plates",
        "clearance",
        "friction",
        "flexibility",
        "heads",
        "bush",
        "gap",
        "drive",
        "clamp",
    ),
    "load": (),
    "fatigue": BESIDE["fatigue"].keys,
    "wear": WEAR_KEYS,
    "crack": ("pin", "plate", *(key for key in BESIDE["crack"].keys if key not in ("body", "place"))),
}
"""Sections of a joint file and their keys. The keys of [[load]] are the loads of the joint."""

BUSH_KEYS = (*MATERIAL_KEYS, "outer_radius", "interference", "bonded", "friction")
"""Keys of a bush in [[pin]]."""

_KINDS: dict[str, Any] = {
    "plate": MATERIAL | of("length", "thickness", "x", "y", "start") | {"parts": of("length", "to", "through")},
    "pin": MATERIAL
    | of("length", "at", "diameter", "bore_radius")
    | {"clearance": {ITSELF: "length", ANY: "length"}, "flexibility": "flexibility", "heads": "moment"}
    | {"clamp": {"force": "force", "flexibility": "flexibility"}}
    | {"bush": CASE["plate_body"] | {ANY: CASE["plate_body"]}, "gap": CASE["gap"] | {ANY: CASE["gap"]}},
    "fatigue": CASE["fatigue"],
    "wear": CASE["wear"],
    "crack": CASE["crack"],
}
"""The kinds of the keys, apart from those of the loads."""

MOST_CORNERS = 1_000_000
"""Most corners of a load history."""


class JointFile(NamedTuple):
    """The content of a joint file: a joint, its load history, and what is asked of it.

    Attributes
    ----------
    joint : Joint
    corners : list of dict
        Loads at the corners, for :func:`fastpin.joints.solve_joint`.
    title : str
    nodes : int
    harmonics : int or None
    fatigue : FatigueAssessment or None
        How the fatigue at all pins is assessed, for :meth:`fastpin.joints.JointResult.assessed_fatigue`.
    crack : SectionCrack or None
        A crack at the hole of a pin, for :meth:`fastpin.joints.JointResult.crack_growth`.
    wear : Wear or None
        How pins, bushes and plates wear, for :func:`fastpin.wear_lives.wear_joint`.
    """

    joint: Joint
    corners: list[dict[str, float]]
    title: str = ""
    nodes: int = 96
    harmonics: int | None = None
    fatigue: FatigueAssessment | None = None
    crack: SectionCrack | None = None
    wear: Wear | None = None


def is_joint_file(text: str) -> bool:
    """Whether a TOML text has a section that only a joint file has."""
    return re.search(r"^\s*\[(joint|\[(pin|plate)\])\]", instance("text", text, str, "text"), re.MULTILINE) is not None


def read_joint(path: str | Path) -> JointFile:
    """Read a joint file.

    Raises
    ------
    CaseFileError, InputError
        See :func:`fastpin.read_case`.
    """
    path = file_path("path", path)
    return parse_joint(read_text(path), str(path), path.parent)


def parse_joint(text: str, name: str = "joint file", folder: str | Path = ".") -> JointFile:
    """Read a joint from a TOML text.

    Parameters
    ----------
    text : str
    name : str
        The name of the file in error messages.
    folder : str or Path
        Relative paths of CSV files of profiles start here.

    Raises
    ------
    CaseFileError, InputError
        See :func:`fastpin.read_case`.
    """
    place = file_path("folder", folder)
    return parse_text(text, name, "joint file", lambda source: joint_file_in(source, place))


def kinds_in(source: CaseText) -> dict[str, Any]:
    """The kinds of the keys of a joint file, see :mod:`fastpin.model.keys`."""
    names = [name for block in source.blocks("load") for name in block.table]
    return _KINDS | {"load": {name: kind_of_load(name) for name in names}}


def joint_file_in(source: CaseText, folder: Path) -> JointFile | None:
    """Read the tables of a text, with files of a folder. What is returned has no meaning if the text has faults."""
    source.to_si(kinds_in(source), True)
    source.check_sections(JOINT_KEYS, ("plate", "pin", "load"))
    title, settings = source.root.checked("title", string) or "", source.section("joint")
    plane = settings.choice("plane", ("stress", *(word for word in PLANES if word != "stress")))
    nodes = settings.checked("nodes", whole_number, LEAST_NODES, MOST_NODES) or 96
    harmonics = settings.checked("harmonics", whole_number, 2, MOST_HARMONICS)
    times = settings.checked("repeat", whole_number, 1, MOST_CORNERS) or 1
    plates = [_plate(source, block) for block in _required(source, "plate")]
    pins = [each for block in _required(source, "pin") for each in _pins(source, block, plates, folder)]
    loads = _required(source, "load")
    how = read_assessment(source, source.section("fatigue")) if "fatigue" in source.root else None
    crack = _crack(source) if "crack" in source.root else None
    wear = read_wear(source.section("wear"), folder, {}) if "wear" in source.root else None
    if source.faults or plane is None or None in plates or None in pins:
        return None
    try:
        joint = Joint(tuple(plates), tuple(pins), plane, source.units)  # type: ignore[arg-type]
    except InputError as error:
        section, name, key = (*error.field.split(".", 2), "", "")[:3]
        named = [block for block in source.blocks(section) if name in _names("name", block.value("name"))]
        if named:
            named[0].report(str(error), *filter(None, key.split(".")))
        else:
            source.report(str(error), "pin")
        return None
    corners = []
    for block in loads:
        for name in (name for name in joint.reactions if name in block):
            block.report(f"{name} {reaction_words(joint, name)}", name)
        block.check_keys(joint.load_names, " in [[load]]", f"; the loads are {', '.join(joint.given_names)}")
        given = {name: block.number(name) for name in joint.given_names if name in block}
        corners.append({name: value for name, value in given.items() if value is not None})
    if len(corners) * times > MOST_CORNERS:
        source.report(f"the history has {len(corners) * times:,} corners, more than {MOST_CORNERS:,}", "load")
    if source.faults:
        return None
    values = load_values(joint, corners * times)
    if how is not None:
        source.section("fatigue").made(lambda: check_fatigue(joint, how, values))
    if crack is not None:
        source.section("crack").made(lambda: check_crack(joint, crack, len(values)))
    if wear is not None:
        source.section("wear").made(lambda: check_wear(wear, values))
    return None if source.faults else JointFile(joint, corners * times, title, nodes, harmonics, how, crack, wear)


def _crack(source: CaseText) -> SectionCrack | None:
    """The crack of a file; None if a key is missing or wrong (reported)."""
    section = source.section("crack")
    for key in ("pin", "plate"):
        section.require(key)
    pin, plate, how = section.checked("pin", any_text), section.checked("plate", any_text), read_crack(source, section)
    return None if pin is None or plate is None or how is None else SectionCrack(pin, plate, how)


def _required(source: CaseText, name: str) -> list[Section]:
    """The blocks of a name, of which there must be one."""
    blocks = source.blocks(name)
    if not blocks and name not in source.root:
        source.report(f"[[{name}]] blocks are missing", name)
    return blocks


def _plate(source: CaseText, block: Section) -> JointPlate | None:
    """A plate; None if it is wrong (reported)."""
    for key in ("name", "thickness"):
        block.require(key)
    material = read_material(source, block, MATERIALS, may_be_rigid=False)
    supports = block.value("supports") or {}
    if not isinstance(supports, dict):
        block.report(f'supports: must be a table {{ part = "both" }}, not {as_toml(supports)}', "supports")
        return None
    outline = _outline(block)
    values = {"name": block.value("name"), "thickness": block.value("thickness"), "moves": block.value("moves") or ""}
    values |= {key: block.value(key) for key in ("slices", "drive") if key in block}
    if material is None or outline is None or values["name"] is None or values["thickness"] is None:
        return None
    return _made(block, JointPlate, **values, material=material, outline=outline, supports=supports)


def _made(block: Section, make: Any, **values: Any) -> Any:
    """An object of a block; None if a value is wrong (reported)."""
    try:
        return make(**values)
    except InputError as error:
        block.report(str(error), error.field)
        return None


def _outline(block: Section) -> tuple[Part, ...] | None:
    """The outline of a plate; empty for an infinite one, None if it is wrong (reported)."""
    if "start" in block or "parts" in block:
        start, parts = block.checked("start", point_of), block.value("parts")
        if start is None or not isinstance(parts, list) or not all(isinstance(part, dict) for part in parts):
            block.report("parts: start and a list of parts { name, to, through } make an outline", "parts")
            return None
        found = []
        try:
            for part in parts:
                known = [key for key in part if key not in ("name", "to", "through")]
                if known or "to" not in part:
                    raise InputError("parts", "a part has a name, its end to, and through if it is a circular arc")
                end = point_of("to", part["to"])
                through = point_of("through", part["through"]) if "through" in part else None
                found.append(Part(string("name", part.get("name", "edge")), start, end, through))
                start = end
        except InputError as error:
            block.report(str(error), "parts")
            return None
        return tuple(found)
    if "x" not in block and "y" not in block:
        return ()
    for key in ("x", "y"):
        block.require(key)
    x, y = block.checked("x", limits_of), block.checked("y", limits_of)
    return None if x is None or y is None else rectangle(x, y)


def _pins(source: CaseText, block: Section, plates: list[JointPlate | None], folder: Path) -> list[JointPin | None]:
    """The pins of a block; None for each that is wrong (reported)."""
    for key in ("name", "at", "diameter", "plates"):
        block.require(key)
    material = read_material(source, block, MATERIALS, may_be_rigid=False)
    names, places = block.checked("name", _names), block.checked("at", _points)
    diameter, through = block.checked("diameter", positive), block.checked("plates", _names)
    if material is None or names is None or places is None or diameter is None or through is None:
        return [None]
    if len(names) != len(places):
        block.report(f"name: must name {len(places)} pins, as many as at has points, not {len(names)}", "name")
        return [None]
    most = 0.5 * (1.0 - THINNEST) * diameter
    bore = block.checked("bore_radius", number, 0.0, most) if "bore_radius" in block else 0.0
    if bore is None:
        return [None]
    flexibility = _flexibility(block, material, (diameter, bore), through, plates)
    if flexibility is None:
        return [None]
    clamp = block.checked("clamp", _clamp)
    if clamp is None and "clamp" in block:
        return [None]
    common = {"material": material, "radius": 0.5 * diameter, "plates": through, "flexibility": flexibility}
    common |= {"clamp": clamp, "bore_radius": bore}
    if "bush" in block:
        common["bush"] = _bushes(source, block, through)
        if common["bush"] is None:
            return [None]
    if "gap" in block:
        common["gap"] = _gaps(source, block, through, 0.5 * diameter, folder)
    for key in (key for key in ("clearance", "friction", "heads", "drive") if key in block):
        common[key] = block.value(key)
    return [_made(block, JointPin, name=name, at=at, **common) for name, at in zip(names, places, strict=True)]


def _bushes(source: CaseText, block: Section, through: list[str]) -> Bushing | dict[str, Bushing] | None:
    """The bush of all plates, or of each plate that is named; None if one is wrong (reported)."""
    table = block.value("bush")
    if not isinstance(table, dict):
        block.report(f"bush: must be a table {{ material, outer_radius, ... }}, not {as_toml(table)}", "bush")
        return None
    inner = Inside(source, block, "bush", table)
    if not any(isinstance(one, dict) for name, one in table.items() if name not in BUSH_KEYS):
        return _bush(source, inner, " in bush")
    inner.check_keys(through, " in bush", f"; the plates of the pin are {', '.join(through)}")
    each = {name: inner.value(name) for name in through if name in table}
    for name in (name for name, one in each.items() if not isinstance(one, dict)):
        block.report(f"bush.{name}: must be a table {{ material, outer_radius, ... }}", "bush", name)
        return None
    found = {name: _bush(source, Inside(source, inner, name, one), f" in bush.{name}") for name, one in each.items()}
    return None if None in found.values() else found  # type: ignore[return-value]


def _gaps(
    source: CaseText, block: Section, through: list[str], radius: float, folder: Path
) -> InitialGap | dict[str, InitialGap] | None:
    """The initial gap in all plates, or in each plate that is named; without one where it is wrong (reported)."""
    table = block.value("gap")
    if not isinstance(table, dict):
        block.report(f"gap: must be a table {{ hole, pin }}, not {as_toml(table)}", "gap")
        return None
    inner = Inside(source, block, "gap", table)
    if not any(isinstance(one, dict) for name, one in table.items() if name in through and name not in GAP_KEYS):
        inner.check_keys(GAP_KEYS, " in gap")
        return read_gap(inner, folder, radius, False)
    inner.check_keys(through, " in gap", f"; the plates of the pin are {', '.join(through)}")
    found = {}
    for name in (name for name in through if name in table):
        if not isinstance(table[name], dict):
            inner.report(f"gap.{name}: must be a table {{ hole, pin }}, not {as_toml(table[name])}", name)
            continue
        own = Inside(source, inner, name, table[name])
        own.check_keys(GAP_KEYS, f" in gap.{name}")
        found[name] = read_gap(own, folder, radius, False)
    return found


def _bush(source: CaseText, table: Section, where: str) -> Bushing | None:
    """A bush, with the keys of a bush in a case file; None if it is wrong (reported)."""
    table.check_keys(BUSH_KEYS, where)
    if "outer_radius" not in table:
        table.report(f"outer_radius is missing{where}")
        return None
    return Bushing.read(BodySection(source, table, Path(), MATERIALS))


def _flexibility(
    block: Section, material: Any, size: tuple[float, float], through: list[str], plates: list[JointPlate | None]
) -> float | Literal["beam"] | None:
    """The flexibility of a pin, m/N, or that it is a beam; None if it is wrong (reported).

    `size` is the diameter and the radius of the bore, m.
    """
    given = block.value("flexibility")
    if not isinstance(given, str):
        return block.checked("flexibility", number, 0.0) if given is not None else 0.0
    if block.checked("flexibility", choice, ("rigid", "tate-rosenfeld", "beam")) is None:
        return None
    if given == "beam":
        return "beam"
    by_name = {plate.name: plate for plate in plates if plate is not None}
    of = [by_name[name] for name in through if name in by_name]
    if given == "rigid" or len(of) < 2:
        return 0.0
    values = {
        tate_rosenfeld(size[0], material, (a.material, a.thickness), (b.material, b.thickness), size[1])
        for a, b in itertools.pairwise(of)
    }
    if len(values) > 1:
        block.report("flexibility: the formula gives several values for plates of unlike thickness; give a number, m/N")
        return None
    return values.pop()


def _clamp(field: str, value: object) -> Clamp:
    """A clamp-up { force, friction, flexibility }."""
    keys = "force", "friction", "flexibility"
    if not isinstance(value, dict):
        raise InputError(field, f"must be a table {{ {', '.join(keys)} }}, not {as_toml(value)}")
    for key in (key for key in value if key not in keys):
        raise InputError(field, unknown_key(key, keys))
    for key in (key for key in keys[:2] if key not in value):
        raise InputError(field, f"{key} is missing")
    try:
        return Clamp(**value)
    except InputError as error:
        raise InputError(f"{field}.{error.field}", error.reason) from None


def _names(field: str, value: object) -> list[str]:
    names = value if isinstance(value, list) else [value]
    return [any_text(field, name) for name in names]


def _points(field: str, value: object) -> list[complex]:
    """One point [x, y] or a list of points, m."""
    if isinstance(value, list) and value and all(isinstance(each, list) for each in value):
        return [point_of(field, each) for each in value]
    return [point_of(field, value)]
