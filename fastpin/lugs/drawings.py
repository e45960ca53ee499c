"""Lines and arcs of drawings, DXF and SVG, and the closed loops that they make.

DXF is read by ezdxf. SVG is read here: paths of lines and circular arcs, polygons, polylines, rectangles and circles.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.lugs.outline import Part, point_text
from fastpin.model.checks import as_toml, why_unreadable
from fastpin.model.inputs import open_input

MOST_LINES = 10_000
"""Most lines and arcs of a drawing that are read."""

MOST_BYTES = 50_000_000
"""Most bytes of a drawing."""

SHAPES = {
    "path": "{d}",
    "polygon": "M{points}z",
    "polyline": "M{points}",
    "line": "M{x1},{y1} {x2},{y2}",
    "rect": "M{x},{y}h{width}v{height}h-{width}z",
    "circle": "M{cx},{cy}m-{r},0"
    + "".join(f"a{{r}},{{r}} 0 0 0 {x}{{r}},{y}{{r}}" for x, y in ("++", "+-", "--", "-+")),
}
"""Elements of SVG, as paths of their attributes."""

NUMBER = re.compile(r"[\s,]*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)")
FLAG = re.compile(r"[\s,]*([01])")
LETTER = re.compile(r"[\s,]*([A-Za-z])")


def polygon(corners: Sequence[complex], name: str = "", closed: bool = True) -> list[Part]:
    """Straight parts from corner to corner; corners that follow on themselves count once."""
    kept = [corner for k, corner in enumerate(corners) if k == 0 or corner != corners[k - 1]]
    ends = [*kept, kept[0]] if closed and kept[-1] != kept[0] else kept
    return [Part(name, one, other) for one, other in pairwise(ends)]


def loops(parts: Sequence[Part], same: float) -> list[list[Part]]:
    """Closed loops of lines and arcs in any order and direction. Ends nearer than `same` are one point.

    An :class:`InputError` gives the place of an end that is open, or of three ends that meet.
    """
    parts = [part for part in parts if part.through is not None or abs(part.end - part.start) > same]
    starts, ends = (np.array([getattr(part, key) for part in parts]) for key in ("start", "end"))
    left, found = np.ones(len(parts), dtype=bool), []
    while left.any():
        first = int(left.argmax())
        left[first] = False
        loop = [parts[first]]
        while len(loop) == 1 or abs(loop[-1].end - loop[0].start) > same:
            here = loop[-1].end
            at_start = np.abs(starts - here) <= same
            near = np.flatnonzero(left & (at_start | (np.abs(ends - here) <= same)))
            if near.size != 1:
                kind = "a line" if loop[-1].through is None else "an arc"
                on = f' on the layer "{loop[-1].name}"' if loop[-1].name else ""
                words = "ends" if not near.size else f"meets {near.size} others"
                raise InputError("file", f"{kind}{on} {words} at {point_text(here)}")
            following = parts[near[0]]
            left[near[0]] = False
            loop.append(replace(following if at_start[near[0]] else following.reversed(), start=here))
        loop[-1] = replace(loop[-1], end=loop[0].start)
        found.append(loop)
    return found


def _checked(parts: list[Part]) -> list[Part]:
    if not parts:
        raise InputError("file", "has no lines or arcs")
    if len(parts) > MOST_LINES:
        raise InputError("file", f"has {len(parts):,} lines and arcs, more than {MOST_LINES:,}; choose a layer")
    return parts


# -- DXF ------------------------------------------------------------------------------------------------------


def from_dxf(path: Path, chosen: Collection[str] | None = None) -> tuple[list[Part], float | None]:
    """Lines and arcs of a DXF file, named as their layers, and its unit of length, m; None if the file says none.

    Layers may be `chosen`.
    LINE, ARC, CIRCLE, polylines with bulges, and blocks of these are read. Texts, dimensions, hatches and points are
    left out. Without ezdxf, for another file, or for another curve on a layer that is read, it raises
    :class:`InputError`.
    """
    try:
        import ezdxf
        from ezdxf.enums import InsertUnits
        from ezdxf.units import conversion_factor
    except ImportError:
        raise InputError("file", "a DXF file needs ezdxf: pip install 'fastpin[dxf]'") from None
    found: list[Part] = []
    layers: set[str] = set()
    try:
        with open_input(path) as file:
            if len(file.read(MOST_BYTES + 1)) > MOST_BYTES:
                raise InputError("file", f"is larger than {MOST_BYTES:,} bytes")
        drawing = ezdxf.readfile(path)  # type: ignore[attr-defined]
        for entity in islice(_entities(drawing.modelspace()), 10 * MOST_LINES):
            layers.add(entity.dxf.layer)
            if chosen is None or entity.dxf.layer in chosen:
                found += _of_entity(entity)
    except InputError:
        raise
    except OSError as error:
        raise InputError("file", why_unreadable(error) if error.errno else "is no DXF file") from None
    except Exception as error:  # ezdxf raises errors of many kinds for a damaged file
        raise InputError("file", f"can't be read as DXF: {error}") from None
    if not found and layers:
        raise InputError("layer", f"has no lines or arcs; the layers are {', '.join(map(as_toml, sorted(layers)))}")
    unit = conversion_factor(InsertUnits(drawing.units), InsertUnits.Meters) if drawing.units else None
    return _checked(found), unit


def _entities(entities: Iterable[Any], depth: int = 0) -> Iterator[Any]:
    """The entities, with those of blocks and polylines one by one."""
    if depth > 8:
        raise InputError("file", "has more than 8 blocks within one another")
    for entity in entities:
        kind = entity.dxftype()
        is_polyline = kind == "POLYLINE" and (entity.is_2d_polyline or entity.is_3d_polyline)
        if is_polyline or kind in ("INSERT", "LWPOLYLINE"):
            yield from _entities(entity.virtual_entities(), depth + 1)
        else:
            yield entity


def _of_entity(entity: Any) -> list[Part]:
    kind, name = entity.dxftype(), entity.dxf.layer
    if kind in ("ELLIPSE", "SPLINE", "HELIX"):
        raise InputError("file", f"has a curve {kind} on the layer {as_toml(name)}; save it as lines and arcs")
    if kind == "LINE":
        return [Part(name, *(complex(end.x, end.y) for end in (entity.dxf.start, entity.dxf.end)))]
    if kind not in ("ARC", "CIRCLE"):
        return []
    angles = [0.0, 90.0, 180.0, 270.0, 360.0]
    if kind == "ARC":
        first = entity.dxf.start_angle
        sweep = (entity.dxf.end_angle - first) % 360.0 or 360.0
        angles = [first, first + 0.5 * sweep, first + sweep]
    points = [complex(point.x, point.y) for point in entity.vertices(angles)]
    return [Part(name, points[k], points[k + 2], points[k + 1]) for k in range(0, len(points) - 1, 2)]


# -- SVG ------------------------------------------------------------------------------------------------------


def from_svg(path: Path) -> list[Part]:
    """Lines and arcs of an SVG file, y upwards. Other curves and transforms raise :class:`InputError`."""
    try:
        with open_input(path) as file:
            root = ET.fromstring(file.read(MOST_BYTES))
    except OSError as error:
        raise InputError("file", why_unreadable(error)) from None
    except (ET.ParseError, ValueError) as error:
        raise InputError("file", f"can't be read as SVG: {error}") from None
    found: list[Part] = []
    for element in root.iter():
        kind = str(element.tag).rpartition("}")[2]
        if "transform" in element.attrib:
            raise InputError("file", f"has a transform at <{kind}>; apply it in the program that draws")
        if kind == "ellipse" or (kind == "rect" and not {"rx", "ry"}.isdisjoint(element.attrib)):
            raise InputError("file", f"has a round <{kind}>; save it as a path of lines and arcs")
        if kind in SHAPES:
            found += _of_path(kind, SHAPES[kind].format_map(defaultdict(lambda: "0", element.attrib)))
    return _checked(found)


def _of_path(kind: str, text: str) -> list[Part]:
    """The parts of a path of the commands M, L, H, V, A and Z, absolute or relative. SVG's y points down."""
    found: list[Part] = []
    here = start = 0j
    place, command = 0, ""

    def read(form: re.Pattern[str]) -> float:
        nonlocal place
        match = form.match(text, place)
        if match is None:
            before = as_toml(text[max(place - 20, 0) : place])
            raise InputError("file", f"has a <{kind}> that can't be read after {before}")
        place = match.end()
        return float(match[1])

    while text[place:].strip():
        if letter := LETTER.match(text, place):
            place, command = letter.end(), letter[1]
        if command.upper() not in ("M", "L", "H", "V", "A", "Z"):
            raise InputError("file", f"has a <{kind}> with the curve {as_toml(command)}; save it as lines and arcs")
        base = here if command.islower() else 0j
        form, before = command.upper(), here
        arc = [read(each) for each in (NUMBER, NUMBER, NUMBER, FLAG, FLAG)] if form == "A" else None
        if form == "Z":
            here, command = start, ""
        else:
            x = here.real if form == "V" else base.real + read(NUMBER)
            here = complex(x, here.imag if form == "H" else base.imag + read(NUMBER))
        if form == "M":
            start, command = here, "l" if command == "m" else "L"
        elif here != before:
            ends = before.conjugate(), here.conjugate()
            found.append(Part("", *ends, None if arc is None else _through(*ends, arc)))
    return found


def _through(start: complex, end: complex, arc: Sequence[float]) -> complex:
    """The point in the middle of an arc of SVG."""
    width, height, _, large, sweeps = arc
    if abs(width - height) > 1e-6 * abs(width):
        raise InputError("file", "has an arc of an ellipse; save it as lines and circular arcs")
    half = 0.5 * abs(end - start)
    radius = max(abs(width), half)
    rise = radius + (1.0 if large else -1.0) * math.sqrt(radius**2 - half**2)
    return 0.5 * (start + end) + (1j if sweeps else -1j) * rise * (end - start) / abs(end - start)
