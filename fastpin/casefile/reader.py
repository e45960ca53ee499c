"""The reader of case files: a problem, its load history and the options of the solver in one TOML file.

All faults of a file are reported at once, each with its line. A missing or wrong value is reported and replaced by a
harmless one, so that the rest is still checked.

:data:`EXAMPLE` is a commented case file. ``fastpin example`` prints it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from datetime import date
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from fastpin.bodies.kinds import INFINITE_PLATE, SOLID_PIN
from fastpin.casefile.beside import READERS
from fastpin.casefile.bodies import BODY_KINDS, keys_of, read_bodies
from fastpin.casefile.loads import HARMONIC, read_history, report_loads
from fastpin.casefile.materials import known_materials, read_pair
from fastpin.casefile.profiles import GAP_KEYS, read_friction, read_gap, read_wear
from fastpin.casefile.toml_text import KINDS, CaseText, Section, field_defaults, parse_text, read_text, written
from fastpin.errors import InputError
from fastpin.model import LOADS, SolveOptions, checks, synonyms
from fastpin.model.acting import check_arc, check_keep
from fastpin.model.assessment import check_assessment
from fastpin.model.case import BESIDE, About, Case, check_wear
from fastpin.model.fields import FIELDS
from fastpin.model.keys import CASE
from fastpin.model.laminate import LAMINATE_KEYS
from fastpin.model.materials import MATERIAL_KEYS, MATERIALS, Material, MaterialPair
from fastpin.model.problem import LEAST_RADIUS, MOST_RADIUS, NO_THICKNESS, Problem, checked_thickness
from fastpin.model.unit_systems import NO_UNITS, SI
from fastpin.model.units import PER_THICKNESS
from fastpin.model.wear import WEAR_KEYS

EXAMPLE = Path(__file__).with_name("example.toml").read_text(encoding="utf-8")
"""A commented case file: the built-in case."""

KEYS: dict[str, tuple[str, ...]] = {
    "about": tuple(field.name for field in fields(About)),
    "pin": MATERIAL_KEYS,
    "plate": (*MATERIAL_KEYS, *LAMINATE_KEYS),
    "dundurs": ("alpha", "beta", "nu_pin", "convention", "beta_star"),
    "contact": (
        *("plane", "hole_radius", "clearance", "load_parameter"),
        *(
            name
            for name, each in FIELDS.items()
            if name not in ("hole_radius", "clearance") and each.place == "[contact]"
        ),
    ),
    "gap": GAP_KEYS,
    **{section: keys_of(kinds) for section, kinds in BODY_KINDS.items()},
    "load": (*LOADS, *HARMONIC, "csv", "skip", "count", "turning_points", "repeat"),
    "history": ("csv", "turning_points", "repeat"),
    "wear": WEAR_KEYS,
    **{name: each.keys for name, each in BESIDE.items()},
    "solve": tuple(field.name for field in fields(SolveOptions)),
}
"""Sections of a case file and their keys."""

ROOT_KEYS = ("title", "units", "materials")
"""Keys before the first section."""

T = TypeVar("T")


_SIZES: dict[str, Any] = {
    each.name: each.default
    for each in fields(Problem)
    if each.name in FIELDS and isinstance(each.default, (float, type(None)))
}
del _SIZES["thickness"]  # it converts the others


def builtin_case() -> Case:
    """The case of :data:`EXAMPLE`: a titanium pin in an aluminium plate, one fretting cycle."""
    return parse_case(EXAMPLE, "built-in case")


def read_case(path: str | Path) -> Case:
    """Read a case from a TOML file.

    Parameters
    ----------
    path : str or Path
        The case file. Relative paths of CSV files and compliances start in its folder.

    Raises
    ------
    CaseFileError
        If the file can't be read or has faults. It lists all faults with their lines.
    InputError
        If `path` is no path.
    """
    path = checks.file_path("path", path)
    return parse_case(read_text(path), str(path), path.parent)


def parse_case(text: str, name: str = "case file", folder: str | Path = ".") -> Case:
    """Read a case from a TOML text.

    Parameters
    ----------
    text : str
        The text of a case file.
    name : str
        Name of the file in error messages.
    folder : str or Path
        Folder in which relative paths of files start.

    Raises
    ------
    CaseFileError, InputError
        See :func:`fastpin.read_case`.
    """
    place = checks.file_path("folder", folder)
    return parse_text(text, name, "case file", lambda source: case_from(source, place))


class SharedParts:
    """Parts of the last case that had no fault. The next case of a plan shares them if their input is equal."""

    def __init__(self) -> None:
        self._parts: dict[str, tuple[object, Any]] = {}

    def part(self, name: str, source: CaseText, given: object, make: Callable[[], T]) -> T:
        """The part `name` of a case, made by `make` unless the last case had the same `given` input of it."""
        last, made = self._parts.get(name, (None, None))
        if last is not None and last == given:
            return made
        faults = len(source.placed)
        made = make()
        if len(source.placed) == faults:
            self._parts[name] = given, made
        return made


def case_from(source: CaseText, folder: Path, shared: SharedParts | None = None) -> Case | None:
    """Build the case from the tables of a text, and report all faults to the text.

    Parameters
    ----------
    source : CaseText
        The text. If it has faults afterwards, the returned case has no meaning.
    folder : Path
        Folder in which relative paths of files start.
    shared : Shared, optional
        Parts of the case before.

    Returns
    -------
    Case or None
        None if the problem or the history is unusable.
    """
    contact = source.root.value("contact")
    is_dimensionless = isinstance(contact, dict) and "load_parameter" in contact
    if is_dimensionless and source.root.value("units") not in (None, SI):
        source.report(f"units: {NO_UNITS}", "units")
    elif not is_dimensionless:
        source.to_si(CASE, isinstance(contact, dict) and "thickness" in contact)
    shared, tables = shared or SharedParts(), source.root.table
    shared.part("keys", source, _keys_of(tables), lambda: _check_keys(source))
    title = source.root.checked("title", checks.string) or ""
    about = _about(source.section("about"))
    materials = known_materials(source, folder)
    pair = shared.part("pair", source, _given_of_pair(tables, materials), lambda: read_pair(source, materials))
    problem = _problem(source, folder, pair, materials)
    given_units = [*contact] if isinstance(contact, dict) else None, source.units
    loads = repr([tables.get("load"), tables.get("history"), given_units])
    history = shared.part("loads", source, loads, lambda: read_history(source, folder))
    if problem is not None and history is not None and problem.thickness is not None:
        whole, thickness = history, problem.thickness
        given = whole, thickness
        history = shared.part("loads per thickness", source, given, lambda: whole.per_thickness(thickness))
    options = shared.part("options", source, repr(tables.get("solve")), lambda: _options(source.section("solve")))
    if problem is not None and history is not None:
        report_loads(source, problem, history)
    if problem is not None:
        _check_together(source, lambda: check_arc(problem, options))
    if history is not None:
        _check_together(source, lambda: check_keep(history, options))
    how = source.section("wear")
    count = {} if history is None else {"cycles": history.blocks[-1].count}
    wear = read_wear(how, folder, count) if how.present else None
    if problem is not None and wear is not None:
        _check_together(source, lambda: check_wear(problem), "plate_body")
    beside = {}
    for name in (name for name in READERS if name in source.root):
        beside[name] = value = READERS[name](source, source.section(name))
        check = BESIDE[name].check
        if problem is None or value is None:
            continue
        if check is None and not source.placed:  # a fatigue is checked with everything else
            _check_together(source, partial(check_assessment, problem, value, history, options), name)
        elif check is not None and pair is not None:
            _check_together(source, partial(check, problem, value), name)
    if problem is None or history is None:
        return None
    return Case(problem, history, options, title, about, wear, **beside)


def _keys_of(tables: Mapping[str, Any]) -> object:
    """All keys of the sections of a case."""
    found: list[object] = [*tables]
    for value in tables.values():
        if isinstance(value, dict):
            found.append([*value])
        elif isinstance(value, list):
            found.append([[*block] for block in value if isinstance(block, dict)])
        else:
            found.append(None)
    return found


def _given_of_pair(tables: Mapping[str, Any], materials: Mapping[str, Material]) -> object:
    """Everything that the materials of a case depend on."""
    contact = tables.get("contact")
    contact = contact if isinstance(contact, dict) else {}
    bodies = [tables.get(name) for name in ("pin", "plate", "dundurs")]
    names = [body.get("material") for body in bodies if isinstance(body, dict)]
    named = [materials.get(name) for name in names if isinstance(name, str)]
    return repr([bodies, contact.get("plane"), [*contact]]), named


def _check_together(source: CaseText, check: Callable[[], None], section: str = "solve") -> None:
    """Report a key of a section that contradicts another part of the case."""
    try:
        check()
    except InputError as error:
        source.report(str(error), section, error.field)


def _check_keys(source: CaseText) -> None:
    """Report unknown sections and keys."""
    for name, value in source.root.table.items():
        if name in ROOT_KEYS:
            continue
        if name in KEYS:
            for section in source.blocks(name):
                section.check_keys(KEYS[name], f" in {_in_brackets(name)}", hint=partial(key_hint, name))
        elif written(name, value):
            source.report_unknown(name, _section_hint(name))
        else:
            source.report_unknown(name, _owners(name) or synonyms.closest(name, ROOT_KEYS) or _elsewhere(name))


def _section_hint(name: str) -> str:
    """A hint at what is meant by an unknown section."""
    owners = sections_with(name)
    if owners:
        return f"; {name} is a key in {_in_words(owners)}"
    if name in ROOT_KEYS:
        return f"; {name} is a key before the first section"
    for kind, (sections, command) in KINDS.items():
        if name in sections:
            return f"; a file with [{name}] is a {kind}, see fastpin {command}"
    return synonyms.closest(name, tuple(KEYS)) or f"; the sections are {', '.join(map(_in_brackets, KEYS))}"


def key_hint(section: str, key: str) -> str:
    """A hint at the key that is meant by an unknown `key` of a section, or at all keys of the section."""
    known = KEYS[section]
    elsewhere = synonyms.closest(key, known, spelling=False) or _owners(key) or _elsewhere(key)
    return elsewhere or synonyms.closest(key, known) or f"; the keys are {', '.join(known)}"


def _owners(key: str) -> str:
    """A hint at the sections that have a key of this name; empty if there are none."""
    if key == "load":
        return "; loads are [[load]] blocks, with double brackets"
    owners = sections_with(key)
    return f"; it belongs in {_in_words(owners)}" if owners else ""


def sections_with(key: str) -> list[str]:
    """Return the sections that have a key of this name, without brackets."""
    return [section for section, keys in KEYS.items() if key in keys]


def _in_words(sections: list[str]) -> str:
    return " or ".join(map(_in_brackets, sections))


def _elsewhere(word: str) -> str:
    """A hint at a key of some section that is meant by `word`; empty if there is none."""
    for name in synonyms.meant(word):
        owners = sections_with(name)
        if owners:
            hint = synonyms.closest(word, [name])
            return f"{hint.removesuffix('?')} in {_in_words(owners)}{'?' * hint.endswith('?')}"
    return ""


def _in_brackets(section: str) -> str:
    return "[[load]]" if section == "load" else f"[{section}]"


def _problem(
    source: CaseText, folder: Path, given: MaterialPair | None, materials: Mapping[str, Material]
) -> Problem | None:
    """The problem. None if [contact] is missing, or pin_load, rotation or drive is wrong: the loads depend on them."""
    contact = source.section("contact", required=True)
    steel = replace(MATERIALS["steel"], expansion=0.0)
    pair = given or MaterialPair(steel, steel)  # replaces a wrong pair: the rest is checked
    if not contact.present:
        read_bodies(source, folder, None, given, materials)
        return None
    make: Callable[..., Problem] = Problem
    needed = ["hole_radius", "clearance", "friction"]
    if "load_parameter" in contact:
        for key in ("hole_radius", "clearance"):
            if key in contact:
                contact.report(f"{key}: can't be given together with load_parameter", key)
        make = Problem.from_load_parameter
        needed = ["load_parameter", "friction"]
    for key in needed:
        contact.require(key, " (or give load_parameter)" if key in ("hole_radius", "clearance") else "")
    values: dict[str, Any] = {"pair": pair, **{key: contact.number(key) for key in needed if key != "friction"}}
    chosen = {name: contact.choice(name, field.choices) for name, field in FIELDS.items() if field.choices}
    sizes, shown = _sizes_and_units(contact)
    if chosen["rotation"] == "spring" and "hub_stiffness" not in contact:
        contact.report('hub_stiffness: a pin with rotation = "spring" needs the stiffness of the spring', "rotation")
    radius = values.get("hole_radius", 1.0)
    if radius is None or not LEAST_RADIUS <= radius <= MOST_RADIUS:
        radius, sizes = None, dict(_SIZES)  # without the radius of the hole no size can be checked
    values |= read_bodies(source, folder, radius, given, materials)
    given_radius, radius = radius, radius or MOST_RADIUS
    unit = radius**2 / (1.0 if make is not Problem else pair.beta_star)
    dimensionless = make is not Problem
    values["friction"] = read_friction(contact, folder)
    values["gap"] = read_gap(source.section("gap"), folder, given_radius, dimensionless)
    is_complete = None not in chosen.values()
    if is_complete:
        values |= {**chosen, **sizes, **shown}
    harmless = {
        "hole_radius": MOST_RADIUS,
        **dict.fromkeys(("clearance", "load_parameter", "friction"), 0.0),
        **_SIZES,
        "hub_stiffness": unit if chosen["rotation"] == "spring" else None,
        "plate_body": INFINITE_PLATE,
    }
    if values["pin_body"] != SOLID_PIN:
        harmless["pin_load"] = "centre"
    problem = contact.build(make, values, harmless, {"plate_body": (source.section("plate_body"), "file")})
    return problem if is_complete else None


def _sizes_and_units(contact: Section) -> tuple[dict[str, Any], dict[str, Any]]:
    """The numbers with a default; the system of units and the thickness if they are given.

    With a thickness, a stiffness is that of the whole pin.
    """
    shown: dict[str, Any] = {} if contact.units == SI else {"unit_system": contact.units}
    sizes = _SIZES | {name: contact.number(name) for name in _SIZES if name in contact}
    thickness = None if "thickness" not in contact else contact.checked("thickness", checked_thickness)
    if thickness is None:
        return sizes, shown
    if "load_parameter" in contact:
        contact.report(f"thickness: {NO_THICKNESS}", "thickness")
        return sizes, shown
    for name, value in sizes.items():
        if value is not None and FIELDS[name].kind in PER_THICKNESS:
            sizes[name] = value / thickness
    return sizes, shown | {"thickness": thickness}


def _about(section: Section) -> About:
    """Project, author, revision and date. TOML has a type of its own for dates."""
    given = {key: section.value(key) for key in KEYS["about"] if key in section}
    if type(given.get("date")) is date:
        given["date"] = given["date"].isoformat()
    return section.build(About, given, field_defaults(About)) or About()


def _options(section: Section) -> SolveOptions:
    given = {key: section.value(key) for key in KEYS["solve"] if key in section}
    harmless = field_defaults(SolveOptions)
    if "increments" in given:
        harmless["method"] = "increment"  # replaces a wrong method, so that its increments are not reported as well
    return section.build(SolveOptions, given, harmless) or SolveOptions()
