"""The reader of case files: a problem, its load history and the options of the solver in one TOML file.

All faults of a file are reported at once, each with its line. A missing or wrong value is reported and replaced by a
harmless one, so that the rest is still checked.

:data:`EXAMPLE` is a commented case file. ``fastpin example`` prints it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, TypeVar

from fastpin.casefile.loads import HARMONIC, read_history, report_loads
from fastpin.casefile.toml_text import CaseText, Section
from fastpin.errors import CaseFileError, InputError
from fastpin.model.case import Case, check_arc, check_keep
from fastpin.model.checks import as_toml, choice, closest, file_path, number, string, true_or_false
from fastpin.model.fatigue import FatigueConstants
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.options import SolveOptions
from fastpin.model.problem import LEAST_RADIUS, MOST_RADIUS, Problem

EXAMPLE = Path(__file__).with_name("example.toml").read_text(encoding="utf-8")
"""A commented case file: the built-in case."""

MOST_BYTES = 100_000_000
"""Most bytes of a case file or a plan."""

_MATERIAL_KEYS = ("material", "E", "nu", "rigid", "fatigue")
_FATIGUE_KEYS = tuple(field.name for field in fields(FatigueConstants))
KEYS: dict[str, tuple[str, ...]] = {
    "pin": _MATERIAL_KEYS,
    "plate": _MATERIAL_KEYS,
    "dundurs": ("alpha", "beta", "nu_pin", "convention", "beta_star"),
    "contact": (
        "plane",
        "hole_radius",
        "clearance",
        "load_parameter",
        "friction",
        "pin_load",
        "rotation",
        "hub_radius",
        "hub_stiffness",
        "drive",
        "gauge_radius",
    ),
    "load": (*LOADS, *HARMONIC, "csv", "repeat"),
    "history": ("csv", "repeat"),
    "solve": tuple(field.name for field in fields(SolveOptions)),
}
"""Sections of a case file and their keys."""

_STEEL = MaterialPair(MATERIALS["steel"], MATERIALS["steel"])  # replaces a wrong pair, so that the rest is checked

T = TypeVar("T")


def builtin_case() -> Case:
    """The case of :data:`EXAMPLE`: a titanium pin in an aluminium plate, one fretting cycle."""
    return parse_case(EXAMPLE, "built-in case")


def read_case(path: str | Path) -> Case:
    """Read a case from a TOML file.

    Parameters
    ----------
    path : str or Path
        The case file. Relative paths of CSV files start in its folder.

    Raises
    ------
    CaseFileError
        If the file can't be read or has faults. It lists all faults with their lines.
    InputError
        If `path` is no path.
    """
    path = file_path("path", path)
    return parse_case(read_text(path), str(path), path.parent)


def read_text(path: Path) -> str:
    """Read the text of a case file (UTF-8).

    Raises
    ------
    CaseFileError
        If the file can't be read, is larger than :data:`MOST_BYTES`, or is not UTF-8 text.
    """
    try:
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise CaseFileError(str(path), [(0, f"can't be read: {reason}")]) from None
    if len(raw) > MOST_BYTES:
        raise CaseFileError(str(path), [(0, f"is larger than {MOST_BYTES:,} bytes")])
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise CaseFileError(str(path), [(line, "is not UTF-8 text")]) from None


def parse_case(text: str, name: str = "case file", folder: str | Path = ".") -> Case:
    """Read a case from a TOML text.

    Parameters
    ----------
    text : str
        The text of a case file.
    name : str
        Name of the file in error messages.
    folder : str or Path
        Folder in which relative paths of CSV files start.

    Raises
    ------
    CaseFileError
        If the text has faults. It lists all faults with their lines.
    InputError
        If an argument is of the wrong kind.
    """
    source = CaseText(text)
    place, title = file_path("folder", folder), string("name", name)
    case = case_from(source, place) if source.readable else None
    if source.faults:
        raise CaseFileError(title, source.faults)
    assert case is not None
    return case


def case_from(
    source: CaseText, folder: Path, read: Callable[[CaseText, Path], LoadHistory | None] = read_history
) -> Case | None:
    """Build the case from the tables of a text, and report all faults to the text.

    Parameters
    ----------
    source : CaseText
        The text. If it has faults afterwards, the returned case has no meaning.
    folder : Path
        Folder in which relative paths of CSV files start.
    read : callable
        Reads the load history.

    Returns
    -------
    Case or None
        None if the problem or the history is unusable.
    """
    _check_keys(source)
    title = source.root.checked("title", string) or ""
    pair = _pair(source, source.section("contact"))
    problem = _problem(source.section("contact", required=True), pair or _STEEL)
    history = read(source, folder)
    options = _options(source.section("solve"))
    if problem is not None and history is not None:
        report_loads(source, problem, history)
    if problem is not None:
        _check_together(source, lambda: check_arc(problem, options))
    if history is not None:
        _check_together(source, lambda: check_keep(history, options))
    return Case(problem, history, options, title) if problem is not None and history is not None else None


def _check_together(source: CaseText, check: Callable[[], None]) -> None:
    """Report an option of the solver that contradicts the problem or the history."""
    try:
        check()
    except InputError as error:
        source.report(str(error), "solve", error.field)


def _built(
    section: Section, make: Callable[..., T], values: Mapping[str, Any], harmless: Mapping[str, Any]
) -> T | None:
    """Call ``make(**values)`` and report every wrong value.

    Missing and wrong values are replaced by the `harmless` ones. None if a wrong value has no harmless replacement.
    """
    values = {key: harmless.get(key) if value is None else value for key, value in values.items()}
    left = dict(harmless)
    while True:
        try:
            return make(**values)
        except InputError as error:
            section.report(str(error), error.field)
            if error.field not in left:
                return None
            values[error.field] = left.pop(error.field)


def _check_keys(source: CaseText) -> None:
    """Report unknown sections and keys."""
    for name, value in source.root.table.items():
        if name == "title":
            continue
        if name in KEYS:
            for section in source.blocks(name):
                for key in section.table:
                    if key not in KEYS[name]:
                        hint = closest(key, KEYS[name]) or _owners(key) or f"; the keys are {', '.join(KEYS[name])}"
                        section.report(f'unknown key "{key}" in {_in_brackets(name)}{hint}', key)
        elif isinstance(value, (dict, list)) and not _owners(name):
            hint = closest(name, tuple(KEYS)) or f"; the sections are {', '.join(map(_in_brackets, KEYS))}"
            source.report(f"unknown section [{name}]{hint}", name)
        else:
            hint = _owners(name) or closest(name, ("title",))
            source.report(f'unknown key "{name}" before the first section{hint}', name)


def _owners(key: str) -> str:
    """A hint at the sections that have a key of this name; empty if there are none."""
    owners = [_in_brackets(section) for section, keys in KEYS.items() if key in keys]
    return f"; it belongs in {' or '.join(owners)}" if owners else ""


def _in_brackets(section: str) -> str:
    return "[[load]]" if section == "load" else f"[{section}]"


def _pair(source: CaseText, contact: Section) -> MaterialPair | None:
    plane = contact.choice("plane", ("strain", "stress")) or "strain"
    if "dundurs" in source.root:
        for name in ("pin", "plate"):
            if name in source.root:
                source.report(f"[{name}]: give either [dundurs] or [pin] and [plate]", name)
        return _dundurs(source.section("dundurs"), contact, plane)
    pin, plate = (_material(source, name) for name in ("pin", "plate"))
    if pin is None or plate is None:
        return None
    return _built(source.root, MaterialPair, {"pin": pin, "plate": plate, "plane": plane}, {})


def _material(source: CaseText, name: str) -> Material | None:
    """The material of a body, with its fatigue constants. They replace the constants of a named material."""
    section = source.section(name, required=True)
    material, fatigue = _elastic(section), _fatigue(source, section)
    if material is None or fatigue is None:
        return material
    return replace(material, fatigue=fatigue)


def _fatigue(source: CaseText, section: Section) -> FatigueConstants | None:
    """The fatigue constants of a body; None if there are none, or they are wrong (reported)."""
    table = section.value("fatigue")
    if table is None:
        return None
    if section.value("rigid") is True:
        section.report(f"[{section.name}]: fatigue can't be given together with rigid", "fatigue")
        return None
    if "load_parameter" in source.section("contact"):
        section.report("fatigue: has no meaning with load_parameter, for the stresses have no unit", "fatigue")
        return None
    if not isinstance(table, dict):
        section.report(f"fatigue: must be a table {{ ... }}, not {as_toml(table)}", "fatigue")
        return None
    inner = Section(source, (section.name, "fatigue"), table)
    for key in table:
        if key not in _FATIGUE_KEYS:
            hint = closest(key, _FATIGUE_KEYS) or f"; the keys are {', '.join(_FATIGUE_KEYS)}"
            inner.report(f'unknown key "{key}" in fatigue of [{section.name}]{hint}', key)
    given = {key: inner.value(key) for key in _FATIGUE_KEYS if inner.value(key) is not None}
    return _built(inner, FatigueConstants, given, {**dict.fromkeys(_FATIGUE_KEYS), "source": ""})


def _elastic(section: Section) -> Material | None:
    if not section.present:
        return None
    rigid = section.checked("rigid", true_or_false)
    values = {"E": section.checked("E", _modulus), "nu": section.number("nu")}
    chosen = "material" if "material" in section else "rigid" if rigid else None
    if chosen is not None:
        others = ("E", "nu", "rigid") if rigid and chosen == "material" else ("E", "nu")
        for other in others:
            if other in section:
                section.report(f"[{section.name}]: {other} can't be given together with {chosen}", other)
        if chosen == "rigid":
            return Material.rigid()
        return MATERIALS.get(section.checked("material", choice, tuple(MATERIALS)) or "")
    if "E" not in section and "nu" not in section:
        if rigid is not None or "rigid" not in section:
            section.report(f"[{section.name}]: needs material, or E and nu, or rigid = true")
        return None
    section.require("E")
    section.require("nu")
    return _built(section, Material, values, {"E": 1.0, "nu": 0.3})


def _modulus(name: str, value: object) -> float:
    if value == math.inf:
        raise InputError(name, "must be a finite number, not inf; for a rigid body write rigid = true")
    return number(name, value)


def _dundurs(section: Section, contact: Section, plane: str) -> MaterialPair | None:
    if not section.present:
        return None
    convention = section.choice("convention", ("usual", "paper"))
    values = {
        "alpha": section.checked("alpha", number, -1.0, 1.0),
        "beta": section.number("beta"),
        "nu_pin": section.checked("nu_pin", number, 0.0, 0.5),
    }
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
    return _built(section, MaterialPair.from_dundurs, {**values, "plane": plane, "convention": convention}, {})


def _problem(contact: Section, pair: MaterialPair) -> Problem | None:
    """The problem. None if [contact] is missing, or pin_load, rotation or drive is wrong: the loads depend on them."""
    if not contact.present:
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
    values: dict[str, Any] = {"pair": pair, **{key: contact.number(key) for key in needed}}
    pin_load = contact.choice("pin_load", ("centre", "body"))
    rotation = contact.choice("rotation", ("free", "fixed", "spring"))
    drive = contact.choice("drive", ("force", "ux", "uy", "both"))
    hub = {key: contact.number(key) for key in ("hub_radius", "hub_stiffness", "gauge_radius")}
    if rotation == "spring" and "hub_stiffness" not in contact:
        contact.report('hub_stiffness: a pin with rotation = "spring" needs the stiffness of the spring', "rotation")
    radius = values.get("hole_radius", 1.0)
    if radius is None or not LEAST_RADIUS <= radius <= MOST_RADIUS:
        radius, hub = MOST_RADIUS, dict.fromkeys(hub)  # without the radius of the hole no hub can be checked
    unit = radius**2 / (1.0 if make is not Problem else pair.beta_star)
    held = None not in (pin_load, rotation, drive)
    if held:
        values |= {"pin_load": pin_load, "rotation": rotation, "drive": drive, **hub}
    harmless = {
        "hole_radius": MOST_RADIUS,
        "clearance": 0.0,
        "load_parameter": 0.0,
        "friction": 0.0,
        "hub_radius": None,
        "hub_stiffness": unit if rotation == "spring" else None,
        "gauge_radius": None,
    }
    problem = _built(contact, make, values, harmless)
    return problem if held else None


def _options(section: Section) -> SolveOptions:
    given = {key: section.value(key) for key in KEYS["solve"] if key in section}
    harmless = SolveOptions().keywords()
    if "increments" in given:
        harmless["method"] = "increment"  # replaces a wrong method, so that its increments are not reported as well
    return _built(section, SolveOptions, given, harmless) or SolveOptions()
