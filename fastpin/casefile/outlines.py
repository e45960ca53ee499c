"""The outline of a lug from a file: points of a mesh's edge (CSV), or a drawing (DXF, SVG).

Lines and arcs are fitted to the points, and the notes say to which. Corners part the sides, which get names.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, TypeAlias

import numpy as np

from fastpin.casefile.toml_text import Section
from fastpin.errors import CaseFileError, InputError
from fastpin.lugs.drawings import from_dxf, from_svg, loops, polygon
from fastpin.lugs.fitting import FittedArc, circle_of, fitted, is_corner
from fastpin.lugs.outline import Hole, Part, crossing, distances, encloses, kinks, point_text
from fastpin.model.checks import as_toml, number, string
from fastpin.tables.columns import CsvColumn, title_and_unit
from fastpin.tables.load_units import Basis, LoadUnit, load_unit, plain_unit
from fastpin.tables.reader import Wanted, read_table

FILE_KEYS = ("file", "unit", "layer", "origin", "tolerance")
"""Keys of [outline] for a file."""

TOLERANCE = 2e-4
"""Largest distance of points from a fitted line or arc, in hole radii, unless given.

Points rounded to 5e-6 hole radii leave 7e-7 of the matrix (40 and 100 chords of a round end)."""

NEAR = 1e-2
"""Largest tolerance, and distance of a point `at` from its part and of a drawn circle from a hole, in hole radii."""

MOST_POINTS = 5_000
"""Most points of a CSV file. Fitting takes two seconds."""


Drawn: TypeAlias = tuple[tuple[Part, ...], tuple[str, ...]]
"""An outline from a file, and sentences on its parts."""


class _Frame(NamedTuple):
    """The unit of the lug file, the radius of the pin's hole, and the place of its centre in the file, m."""

    unit: float
    radius: float
    origin: complex

    def text(self, z: complex) -> str:
        """A point in messages, to 1e-5 hole radii."""
        step = 1e-5 * self.radius
        return point_text(complex(round(z.real / step), round(z.imag / step)) * step / self.unit)


def drawn_outline(
    section: Section, folder: Path, radius: float, holes: Sequence[Hole], origin: complex
) -> Drawn | None:
    """The outline of a file that [outline] names; None if it is wrong (reported).

    `radius` is that of the pin's hole, m, whose centre is at `origin` in the file. Further loops must be `holes`.
    """
    name, unit = section.checked("file", string), section.checked("unit", string)
    tolerance, given = section.checked("tolerance", number, 0.0, NEAR * radius), section.value("layer")
    layers = None if given is None else tuple(map(str, given if isinstance(given, list) else [given]))
    if name is None:
        return None
    frame = _Frame(_factor(plain_unit("length", Basis(system=section.units))), radius, origin)
    try:
        parts = [_moved(part, -origin) for part in _parts(folder / name, unit, layers, section.units)]
        return _chosen(parts, TOLERANCE * radius if tolerance is None else tolerance, holes, frame)
    except CaseFileError as error:
        for line, sentence in error.problems:
            section.report(f"file: {name}{f', line {line}' if line else ''}: {sentence}", "file")
    except InputError as error:
        field = "unit" if error.field == "ux" else error.field
        section.report(f"{field}: {f'{name}: ' * (field == 'file')}{error.reason}", field)
    return None


def _factor(unit: LoadUnit) -> float:
    return float(10.0**unit.power * unit.factor)


def _moved(part: Part, by: complex, factor: float = 1.0) -> Part:
    through = None if part.through is None else part.through * factor + by
    return replace(part, start=part.start * factor + by, end=part.end * factor + by, through=through)


def _parts(path: Path, unit: str | None, layers: tuple[str, ...] | None, system: str) -> list[Part]:
    """Lines and arcs of a file, m."""
    kind = path.suffix.lower()
    if layers is not None and kind != ".dxf":
        raise InputError("layer", "is for a DXF file only")
    given = None if unit is None else _factor(load_unit("ux", unit, Basis()))
    if kind not in (".dxf", ".svg"):
        return polygon(_points(path, unit, system))
    parts, own = from_dxf(path, layers) if kind == ".dxf" else (from_svg(path), None)
    if (factor := given or own) is None:
        raise InputError("unit", 'is missing, and the drawing says none; give the unit of its numbers, such as "mm"')
    return [_moved(part, 0j, factor) for part in parts]


def _points(path: Path, unit: str | None, system: str) -> list[complex]:
    """The points of a CSV file: the columns x and y of its header, or the first two."""

    def find(titles: list[str]) -> list[CsvColumn]:
        parts = [title_and_unit(title) for title in titles]
        names = [name.strip().lower() for name, _ in parts]
        if not any(titles):
            names[:2] = ["x", "y"]
        if "x" not in names or "y" not in names:
            raise InputError("", "the header must name the columns x and y; without a header they are the first two")
        return [CsvColumn(place, name, titles[place], unit=parts[place][1])
                for name in ("x", "y") for place in [names.index(name)]]  # fmt: skip

    def to_si(name: str, written: str) -> LoadUnit:
        if unit and written and unit != written:
            raise InputError(name, f"the unit is {unit}, and the header has {written}; give one of them")
        return (
            load_unit("ux", unit or written, Basis()) if unit or written else plain_unit("length", Basis(system=system))
        )

    too_many = f"more than {MOST_POINTS:,} points can't be read"
    _, (x, y) = read_table(path, Wanted(find, (0, 1), to_si, "points", MOST_POINTS, too_many, False, "x and y"))
    if x.size < 3:
        raise InputError("file", f"an outline has at least 3 points, not {x.size}")
    return [complex(*pair) for pair in zip(x.tolist(), y.tolist(), strict=True)]


def _chosen(parts: list[Part], same: float, holes: Sequence[Hole], frame: _Frame) -> Drawn:
    """The loop round the hole's centre, fitted and named. Every other loop must be the pin's hole or one of `holes`."""
    near, outlines, others = NEAR * frame.radius, [], []
    for loop in loops(parts, max(1e-9 * frame.radius, 0.1 * same)):
        place = crossing(loop)
        if place is not None:
            where = frame.text(place)
            raise InputError("file", f"crosses itself near {where}; the points must follow one another along the edge")
        outline, fits = fitted(loop, same)
        centre, size = circle_of(outline, 3.0 * same) or (0j, math.inf)
        known = [Hole("", 0j, frame.radius), *holes]
        if any(abs(centre - hole.centre) < near > abs(size - hole.radius) for hole in known):
            continue
        if encloses(loop, np.zeros(1))[0]:
            outlines.append((outline, fits, len(loop)))
        elif size == math.inf:
            words = f"of {len(outline)} lines and arcs at {frame.text(outline[0].start)}; further holes are circles"
            others.append(words)
        else:
            words = f"of radius {size / frame.unit:.6g} about {frame.text(centre)}; name it by a block [[hole]]"
            others.append(f"{words} with this centre and radius, or choose layers without it")
    if len(outlines) != 1:
        found = f"{len(outlines)} loops go" if outlines else "no loop goes"
        places = "".join(f", one from {frame.text(outline[0].start)}" for outline, *_ in outlines)
        words = f"at {frame.text(frame.origin)}{places}; origin is its centre in the file"
        raise InputError("file", f"{found} round the pin's hole {words}")
    if others:
        raise InputError("file", f"has a further loop {others[0]}")
    return _named(*outlines[0], frame)


def _named(outline: tuple[Part, ...], fits: Sequence[FittedArc], count: int, frame: _Frame) -> Drawn:
    """Number the sides, unless layers name them, and write the notes. A side goes on over small kinks."""
    names = {id(part): part.name for part in outline}
    if len(set(names.values())) == 1:
        corners = [k > 0 and is_corner(outline[k - 1], part) for k, part in enumerate(outline)]
        names = {key: f"side {side}" for key, side in zip(names, (np.cumsum(corners) + 1).tolist(), strict=True)}
    named = tuple(replace(part, name=names[id(part)]) for part in outline)
    notes = [f"{count:,} lines and arcs became {len(outline):,} parts"]
    for name in dict.fromkeys(part.name for part in named):
        own = [part for part in named if part.name == name]
        ends = f"{frame.text(own[0].start)} to {frame.text(own[-1].end)}"
        notes.append(f"{as_toml(name)}: {len(own)} part{'s' * (len(own) > 1)}, {ends}")
    for fit in fits:
        centre, size, first, sweep = fit.part.circle or (0j, 0.0, 0.0, 0.0)
        degrees = np.round(np.degrees([first, first + sweep]), 2)
        notes.append(
            f"{as_toml(names[id(fit.part)])}: an arc through {fit.points} points, radius {size / frame.unit:.6g} about "
            f"{frame.text(centre)}, {degrees[0] + 0.0:g} to {degrees[1] + 0.0:g} deg, within "
            f"{fit.deviation / frame.unit:.1g}"
        )
    turns = [turn for turn, *_ in kinks(outline)]
    if turns:
        notes.append(
            f"{len(turns)} corners turn by at most {math.degrees(max(turns)):.2g} deg, and no arc fits: the stress on "
            "such sides is that of a polyline, and not of a smooth edge"
        )
    return named, tuple(notes)


def renamed(outline: tuple[Part, ...], block: Section, name: str, at: complex, radius: float) -> tuple[Part, ...]:
    """The outline with a name for the side that goes through a point. No side, or two of them, are reported."""
    away = np.array([float(distances(part, np.array([at]))[0]) for part in outline])
    near = dict.fromkeys(outline[k].name for k in np.flatnonzero(away <= max(NEAR * radius, away.min())))
    if away.min() > NEAR * radius:
        block.report(f"at: the outline is {away.min():.3g} m away from this point", "at")
    elif len(near) > 1:
        block.report(f"at: {' and '.join(map(as_toml, near))} meet here; give a point inside of one", "at")
    else:
        return tuple(replace(part, name=name) if part.name in near else part for part in outline)
    return outline
