"""The figure of a finite plate: outline, holes, supports and loads."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.style import COLOURS, line
from fastpin.figures.words import quantity
from fastpin.model.checks import instance
from fastpin.model.lug import Lug, Part, PartLoad

HOLD_WORDS = {"both": "held", "x": "held along x", "y": "held along y", "normal": "held along the normal"}
"""Words of the legend for supports."""

ARROWS = 5
"""Arrows of a load on each part."""

ARROW = 0.08
"""Length of the longest arrow of a load, in parts of the plate's extent."""


def lug_of(lug: Lug) -> Plot:
    """Draw the outline with names of its parts, all holes, supports and loads. Lengths are in millimetres."""
    instance("lug", lug, Lug, "fastpin.model.Lug")
    return Plot(lambda look: _draw(look, lug), width=5.0)


plot_lug = plotter("plot_lug", lug_of)


def _draw(look: Look, lug: Lug) -> Sheet:
    sheet = look.sheet([1.1 * look.width], extra=0.0)
    panel = sheet.axes[0, 0]
    kinds = {}
    for part in (*lug.contact_edge, *lug.edges):
        hold = lug.supports.get(part.name) if part.name else None
        place = 0 if hold is None else 1 + list(HOLD_WORDS).index(hold)
        kinds[place] = ("free", line(5, 0, 1.4)) if hold is None else (HOLD_WORDS[hold], line(place - 1, 0, 4.0))
        z = 1e3 * part.at(np.linspace(0.0, 1.0, 61))
        # Snapped to pixels, straight parts would not meet the arcs.
        panel.plot(z.real, z.imag, **kinds[place][1], zorder=3 if hold else 2, snap=False)
    _write_names(panel, lug)
    for load in lug.loads:
        _draw_load(panel, lug, load)
    panel.set_aspect("equal")
    panel.margins(0.12)
    panel.set_xlabel(quantity("x", "mm"))
    panel.set_ylabel(quantity("y", "mm"))
    entries = [kinds[place] for place in sorted(kinds)]
    sheet.legend([Line2D([], [], label=label, **style) for label, style in entries], len(entries))
    sheet.head(look.title)
    return sheet


def _write_names(panel: Axes, lug: Lug) -> None:
    """Write the names beside the parts, inside the plate, and in the holes."""
    for part in lug.outline:
        middle, inwards = _at(part, np.array([0.5]))
        place = 1e3 * (middle[0] + 0.04 * lug.extent * inwards[0])
        rotation = 90.0 if abs(inwards[0].real) > abs(inwards[0].imag) else 0.0
        style: Any = {"ha": "center", "va": "center", "fontsize": 8.0, "rotation": rotation, "parse_math": False}
        panel.text(place.real, place.imag, part.name, **style)
    for name, centre in (("pin", 0j), *((hole.name, hole.centre) for hole in lug.holes)):
        panel.text(1e3 * centre.real, 1e3 * centre.imag, name, ha="center", va="center", fontsize=8.0, parse_math=False)


def _at(part: Part, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points of a part, and unit normals into the plate."""
    return part.at(share), 1j * part.direction(share)


def _draw_load(panel: Axes, lug: Lug, load: PartLoad) -> None:
    colour = COLOURS[2 + [each.name for each in lug.loads].index(load.name) % 3]
    longest = max(abs(complex(load.x, load.y)) + abs(load.normal), 1e-300)
    for part in lug.edges:
        if part.name not in load.parts:
            continue
        points, inwards = _at(part, (np.arange(ARROWS) + 0.5) / ARROWS)
        points = points - 0.2 * ARROW * lug.extent * inwards  # beside the line of the edge
        arrows = (complex(load.x, load.y) - load.normal * inwards) * ARROW * lug.extent / longest
        outwards = (np.conj(arrows) * inwards).real < 0.0
        tails = np.where(outwards, points, points - arrows)
        for tail, arrow in zip(1e3 * tails, 1e3 * arrows, strict=True):
            head = tail + arrow
            style: Any = {"arrowstyle": "->", "color": colour, "linewidth": 1.0}
            panel.annotate("", xy=(head.real, head.imag), xytext=(tail.real, tail.imag), arrowprops=style)
        end = 1e3 * (tails + arrows)[-1] if outwards[-1] else 1e3 * tails[-1]
        panel.text(end.real, end.imag, f" {load.name}", color=colour, fontsize=8.0, parse_math=False)
