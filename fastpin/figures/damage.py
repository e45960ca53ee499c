"""Figures of the damage of material that wears away."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.contour import QuadContourSet
from matplotlib.lines import Line2D

from fastpin.assess.outputs import write_csv
from fastpin.assess.wear import damage_curve, followed_words
from fastpin.damage import WornFatigue
from fastpin.damage.criteria import Criterion, criterion_title
from fastpin.figures.scar import MARGIN, cycles_axis, life_caption
from fastpin.figures.sheet import Look, Plot, Sheet
from fastpin.figures.style import COLOURS, MAX_NAMED, Line, angle_axis, draw_grid, line
from fastpin.figures.subjects import Subject, with_stored_cycles
from fastpin.figures.sweep import round_numbers
from fastpin.figures.words import ANGLE, quantity
from fastpin.model.angles import from_bottom
from fastpin.model.points import Body, edge_body
from fastpin.model.units import units
from fastpin.model.wear import cycles_text
from fastpin.solver.wear_result import WearResult

DECADES = 6
"""Decades of damage that a figure shows."""

NEAR = 1e-4
"""Damage from which on a figure shows the damage 1, of a crack, too."""

SURFACE = line(1, 0, 1.6)
"""Line of the worn surface."""

CRACK: Line = {"marker": "o", "markersize": 5.0, "linestyle": "none", "color": COLOURS[1]}
"""Mark of the first crack."""

LEFT, EVER = line(0, 0), line(2, 1)
"""Lines of the largest damage of all material still there, and of all material."""


def damage_plot(subject: Subject, criterion: Criterion = "smith-watson-topper", body: Body | None = None) -> Plot:
    """Return the damage of the material of one body over a life of wear."""
    life = with_stored_cycles(subject)
    return damage_of(life, life.fatigue(criterion, body or "plate"))


def damage_of(life: WearResult, found: WornFatigue) -> Plot:
    """Return the damage of material that wears: its field at the end, and the largest one over the cycles."""
    return Plot(
        lambda look: _draw(look, life, found),
        lambda path: write_csv([damage_curve(found)], path),
        f"Map of the damage under the first surface of the {edge_body(found.problem, found.body)}, and its largest "
        f"value over {cycles_text(life[-1].cycle)}: {found.words}.",
        f"Damage by {criterion_title(found.criterion)} of the material under the first surface, and the largest damage "
        "of all material that is still there. Damage goes with the material that wears off.",
        bitmap=True,
    )


def _draw(look: Look, life: WearResult, found: WornFatigue) -> Sheet:
    sheet = look.sheet([2.4, 1.7], extra=1.5)
    field, curve = sheet.axes[:, 0]
    filled = _draw_field(field, found)
    if filled is not None:
        bar = sheet.figure.colorbar(filled, ax=field, aspect=18, pad=0.02)
        bar.set_label("damage")
        powers = np.log10(np.array(filled.levels))
        bar.set_ticks((10.0 ** np.arange(math.ceil(powers[0]), math.floor(powers[-1]) + 1)).tolist())
    _draw_growth(curve, found)
    handles = [Line2D([], [], label="worn surface", **SURFACE)]
    if math.isfinite(found.life):
        handles.append(Line2D([], [], label="first crack", **CRACK))
    handles += [
        Line2D([], [], label="of all material still there", **LEFT),
        Line2D([], [], label="of all material", **EVER),
    ]
    sheet.legend(handles, 2)
    words = found.words.replace(" um ", " µm ") + ("" if life.complete else f"; {followed_words(life)}")
    head = f"{edge_body(found.problem, found.body)}, {criterion_title(found.criterion)}: {words}"
    sheet.head(look.title, head, caption=life_caption(life))
    return sheet


def _draw_field(panel: Axes, found: WornFatigue) -> QuadContourSet | None:
    """Draw the damage of all material at the end, and what is worn off. Returns its colours; None without damage."""
    angles = np.array([from_bottom(angle) for angle in found.theta.tolist()])
    order = np.argsort(angles)
    length, name = units(found.problem)["displacement"].scale(found.depth.tolist())
    angle, depth, damage, worn = angles[order], length * found.depth, found.damage[-1][:, order], found.worn[-1][order]
    top, filled = float(damage.max()), None
    if top > 0.0:
        levels = np.geomspace(top * 10.0**-DECADES, top, 4 * DECADES + 1)  # four colours in each decade
        drawn, scale = np.clip(damage, levels[0], top), LogNorm(levels[0], top)
        filled = panel.contourf(angle, depth, drawn, levels, norm=scale, cmap="viridis", extend="min")
        if damage.min() < 1.0 < top:
            panel.contour(angle, depth, damage, [1.0], colors="white", linewidths=1.2)
    panel.fill_between(angle, 0.0, length * worn, facecolor="white", edgecolor="0.4", hatch="////", linewidth=0.0)
    panel.plot(angle, length * worn, **SURFACE)
    crack = found.crack
    if math.isfinite(crack.cycle):
        panel.plot(from_bottom(crack.theta), length * crack.depth, clip_on=False, zorder=5, **CRACK)
    much = (damage.max(axis=0) > 1e-2 * top) | (worn > 0.0)
    low, high = (float(angle[much].min()), float(angle[much].max())) if much.any() else (-180.0, 180.0)
    margin = MARGIN * max(high - low, 10.0)
    panel.set_xlim(max(low - margin, angle[0]), min(high + margin, angle[-1]))
    deep = found.depth[damage.max(axis=1) > 1e-3 * top] if top > 0.0 else found.depth
    panel.set_ylim(length * max(float(deep.max()), 2.0 * float(worn.max()), float(found.depth[1:2].sum())), 0.0)
    panel.set_ylabel(quantity("depth under the\nfirst surface", name))
    panel.set_xlabel(ANGLE)
    angle_axis(panel)
    return filled


def _draw_growth(panel: Axes, found: WornFatigue) -> None:
    """Draw the largest damage over the cycles: of the material that is still there, and of all material."""
    left, ever = np.array([spot.damage for spot in found.hot_spots]), found.damage.max(axis=(1, 2))
    top, positive = float(ever.max()), left[left > 0.0]
    highest = max(top, 1.0) if top > NEAR else top
    if highest >= 1.0:
        panel.axhline(1.0, **line(7, 2, 1.0))
    if positive.size and found.cycles[-1] > MAX_NAMED:
        panel.set_yscale("log")
        panel.set_ylim(max(0.5 * float(positive.min()), top * 10.0**-DECADES), 3.0 * highest)
        round_numbers(panel.yaxis, np.array(panel.get_ylim()))
        left, ever = (np.where(values > 0.0, values, np.nan) for values in (left, ever))
    else:
        panel.set_ylim(0.0, 1.08 * highest or 1.0)
    panel.plot(found.cycles, left, marker="o", markersize=3.0, **LEFT)
    panel.plot(found.cycles, ever, **EVER)
    draw_grid(panel)
    cycles_axis([panel], found.cycles)
    panel.set_ylabel("largest damage")
