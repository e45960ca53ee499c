"""The reader of lug files: a finite plate with a hole, its supports and loads, in one TOML file.

All faults of a file are reported at once, each with its line. :data:`LUG_EXAMPLE` is a commented lug file.
``fastpin compliance --example`` prints it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from fastpin.bodies.compliance import COLUMNS, LEAST_ORDER, MOST_ORDER
from fastpin.casefile.outlines import FILE_KEYS, drawn_outline, renamed
from fastpin.casefile.toml_text import CaseText, Section, parse_text, read_text
from fastpin.errors import InputError
from fastpin.lugs.outline import HOLD, Hole, Lug, Part, PartLoad, check_name, check_not_held, rectangle
from fastpin.model.checks import as_toml, choice, file_path, number, positive, string, whole_number
from fastpin.model.keys import of
from fastpin.model.materials import MATERIALS, PLANES
from fastpin.model.problem import LEAST_RADIUS, MOST_RADIUS

LUG_EXAMPLE = Path(__file__).with_name("lug.toml").read_text(encoding="utf-8")
"""A commented lug file: a lug with a round end."""

LUG_KEYS: dict[str, tuple[str, ...]] = {
    "plate": ("material", "nu", "plane", "hole_radius", "net_section"),
    "outline": ("shape", "x", "y", "start", *FILE_KEYS),
    "part": ("name", "to", "through", "at"),
    "hole": ("name", "centre", "radius"),
    "support": ("parts", "hold"),
    "load": ("name", "parts", "x", "y", "normal"),
    "solve": ("harmonics",),
}
"""Sections of a lug file and their keys."""

_KINDS = {
    "plate": of("length", "hole_radius", "net_section"),
    "outline": of("length", "x", "y", "start", "origin", "tolerance"),
    "part": of("length", "to", "through", "at"),
    "hole": of("length", "centre", "radius"),
}
"""The kinds of the keys. The loads are parts of the stress of a case."""

BLOCKS = ("part", "hole", "support", "load")
"""Sections that may appear several times."""


class LugFile(NamedTuple):
    """The content of a lug file.

    Attributes
    ----------
    lug : Lug
    title : str
    harmonics : int or None
        The highest harmonic; None: chosen by the decay.
    notes : tuple of str
        Sentences on an outline from a file: its sides, and the arcs that were fitted.
    """

    lug: Lug
    title: str
    harmonics: int | None
    notes: tuple[str, ...] = ()


def read_lug(path: str | Path) -> LugFile:
    """Read a lug file.

    Raises
    ------
    CaseFileError, InputError
        See :func:`fastpin.read_case`.
    """
    path = file_path("path", path)
    return parse_lug(read_text(path), str(path), path.parent)


def parse_lug(text: str, name: str = "lug file", folder: str | Path = ".") -> LugFile:
    """Read a lug from a TOML text.

    `name` is the name of the file in error messages. Files that the text names are looked for in the `folder`.

    Raises
    ------
    CaseFileError, InputError
        See :func:`fastpin.read_case`.
    """
    place = file_path("folder", folder)
    return parse_text(text, name, "lug file", lambda source: _lug_file(source, place))


def _lug_file(source: CaseText, folder: Path) -> LugFile | None:
    source.to_si(_KINDS, False)
    source.check_sections(LUG_KEYS, BLOCKS)
    title = source.root.checked("title", string) or ""
    plate = source.section("plate", required=True)
    nu, plane = _poisson_ratio(plate), plate.choice("plane", PLANES)
    radius = plate.checked("hole_radius", number, LEAST_RADIUS, MOST_RADIUS)
    width = plate.checked("net_section", positive)
    if plate.present:
        plate.require("hole_radius")
    holes = [_hole(section) for section in source.blocks("hole")]
    outline, notes = _outline(source, folder, radius, [hole for hole in holes if hole is not None])
    names = [part.name for part in outline or ()] + [hole.name for hole in holes if hole is not None]
    known = names if outline is not None and None not in holes else None
    supports = _supports(source, known)
    loads = [_load(section, known, supports) for section in source.blocks("load")]
    harmonics = source.section("solve").checked("harmonics", whole_number, LEAST_ORDER, MOST_ORDER)
    if source.faults or nu is None or radius is None or outline is None:
        return None
    given = [load for load in loads if load is not None], [hole for hole in holes if hole is not None]
    try:
        lug = Lug(nu, plane, radius, outline, supports, *given, net_section=width)  # type: ignore[arg-type]
    except InputError as error:
        places = {"holes": ("hole",), "radius": ("hole",), "hole_radius": ("plate", "hole_radius")}
        section, *key = places.get(error.field, (error.field,))
        is_drawn = section == "outline" and "file" in source.section("outline")
        source.report(str(error), section, *(("file",) if is_drawn else key))
        return None
    return LugFile(lug, title, harmonics, notes)


def _poisson_ratio(plate: Section) -> float | None:
    """Poisson's ratio, of `material` or `nu`."""
    if not plate.present:
        return None
    if "material" in plate and "nu" in plate:
        plate.report("[plate]: nu can't be given together with material", "nu")
    if "material" in plate:
        name = plate.checked("material", choice, tuple(MATERIALS))
        return None if name is None else MATERIALS[name].nu
    plate.require("nu", "; give nu or material")
    return plate.checked("nu", number, 0.0, 0.5)


def _outline(
    source: CaseText, folder: Path, radius: float | None, holes: Sequence[Hole]
) -> tuple[tuple[Part, ...] | None, tuple[str, ...]]:
    """The outline, None if it is missing or wrong (reported), and sentences on it."""
    section = source.section("outline", required=True)
    if not section.present:
        return None, ()
    if "file" not in section:
        for key in FILE_KEYS:
            if key in section:
                section.report(f"{key}: is for a file of the outline only", key)
        for block in source.blocks("part"):
            if "at" in block:
                block.report("at: is for a file of the outline only; a part ends at `to`", "at")
        return _written_outline(source, section), ()
    for key in ("shape", "x", "y", "start"):
        if key in section:
            section.report(f"{key}: can't be given together with file", key)
    origin = section.checked("origin", point_of) or 0j
    drawn = drawn_outline(section, folder, radius, holes, origin) if radius is not None else None
    outline, notes = drawn or (None, ())
    for block in source.blocks("part"):
        for key in ("name", "at"):
            block.require(key, "; a part of a file is named by a point of it")
        name, at = block.checked("name", string), block.checked("at", point_of)
        if name is not None and at is not None and outline is not None and radius is not None:
            outline = renamed(outline, block, name, at, radius)
    return outline, notes


def _written_outline(source: CaseText, section: Section) -> tuple[Part, ...] | None:
    """The outline of a lug file itself; None if it is wrong (reported)."""
    shape = section.choice("shape", ("parts", "rectangle"))  # the first one is meant if none is given
    if shape == "rectangle":
        if "start" in section:
            section.report("start: has no meaning for a rectangle", "start")
        for block in source.blocks("part"):
            block.report("[[part]]: has no meaning for a rectangle, whose parts are bottom, right, top and left")
        for key in ("x", "y"):
            section.require(key)
        x, y = section.checked("x", limits_of), section.checked("y", limits_of)
        return None if x is None or y is None else rectangle(x, y)
    for key in ("x", "y"):
        if key in section:
            section.report(f'{key}: is for shape = "rectangle" only', key)
    section.require("start")
    point = section.checked("start", point_of)
    parts: list[Part] = []
    blocks = source.blocks("part")
    if not blocks:
        section.report("[outline]: [[part]] blocks are missing")
    for block in blocks:
        block.require("name")
        block.require("to")
        name, end = block.checked("name", string), block.checked("to", point_of)
        through = block.checked("through", point_of)
        if name is not None and end is not None and point is not None:
            parts.append(Part(name, point, end, through))
        point = end
    return tuple(parts) if len(parts) == len(blocks) and parts else None


def limits_of(field: str, value: object) -> tuple[float, float]:
    """Check a lower and an upper limit."""
    low, high = _two_numbers(field, value, "two numbers [lower, upper]")
    if low >= high:
        raise InputError(field, f"its first number must be below its second, not {as_toml(value)}")
    return low, high


def point_of(field: str, value: object) -> complex:
    """Check a point [x, y], m."""
    return complex(*_two_numbers(field, value, "a point [x, y]"))


def _two_numbers(field: str, value: object, words: str) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(field, f"must be {words}, not {as_toml(value)}")
    return number(field, value[0]), number(field, value[1])


def _names(field: str, value: object, known: Sequence[str] | None) -> tuple[str, ...]:
    """Check a name or a list of names. They are among the `known` ones, if these could be read."""
    names = tuple(string(field, name) for name in (value if isinstance(value, list) else [value]))
    if not names:
        raise InputError(field, "must name at least one part")
    for name in names if known is not None else ():
        check_name(field, name, known or ())
    return names


def _hole(section: Section) -> Hole | None:
    for key in LUG_KEYS["hole"]:
        section.require(key)
    name, centre = section.checked("name", string), section.checked("centre", point_of)
    radius = section.checked("radius", positive)
    return None if name is None or centre is None or radius is None else Hole(name, centre, radius)


def _supports(source: CaseText, known: Sequence[str] | None) -> dict[str, str]:
    found: dict[str, str] = {}
    for section in source.blocks("support"):
        hold = section.choice("hold", HOLD)
        section.require("parts")
        for name in section.checked("parts", _names, known) or ():
            if name in found:
                section.report(f"parts: {as_toml(name)} has a support already", "parts")
            elif hold is not None:
                found[name] = hold
    return found


def _load(section: Section, known: Sequence[str] | None, supports: dict[str, str]) -> PartLoad | None:
    for key in ("name", "parts"):
        section.require(key)
    name, parts = section.checked("name", choice, COLUMNS), section.checked("parts", _names, known)
    components = {key: section.number(key) or 0.0 for key in ("x", "y", "normal")}
    if not any(key in section for key in components):
        section.report("[[load]]: has no traction; give x, y or normal")
    if name is None or parts is None:
        return None
    load = PartLoad(name, parts, **components)
    section.made(lambda: check_not_held(load, supports))
    return load
