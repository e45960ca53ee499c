"""Figures of a life of wear: the scar, its numbers over the cycles, and the damage of material that wears away."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.contour import QuadContourSet
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from fastpin.assess.wear import coefficient_words, cycles_curve, damage_curve, followed_words, scar_curves
from fastpin.damage import WornFatigue
from fastpin.damage.criteria import Criterion
from fastpin.figures import style
from fastpin.figures.sheet import Look, Plot, Sheet
from fastpin.figures.sketch import load_ranges
from fastpin.figures.states import Subject, with_stored_cycles
from fastpin.figures.sweep import round_numbers
from fastpin.model.angles import from_bottom
from fastpin.model.points import Body, edge_body
from fastpin.model.units import units
from fastpin.model.wear import cycles_text
from fastpin.wear_lives.wear_result import WearResult, WornCycle

MARGIN = 0.15
"""Angles beside the contact that are shown, in parts of its width."""

DECADES = 6
"""Decades of damage that a figure shows."""

NEAR = 1e-4
"""Damage from which on a figure shows the damage 1, of a crack, too."""

SURFACE = style.line(1, 0, 1.6)
"""Line of the worn surface."""

CRACK: style.Line = {"marker": "o", "markersize": 5.0, "linestyle": "none", "color": style.COLOURS[1]}
"""Mark of the first crack."""

LEFT, EVER = style.line(0, 0), style.line(2, 1)
"""Lines of the largest damage of all material still there, and of all material."""


def scar_plot(subject: Subject) -> Plot:
    """Return the profiles of wear, and the pressure on them, after some of the stored cycles."""
    life = with_stored_cycles(subject)
    shown = _by_depth(life)
    numbers = ", ".join(f"{each.cycle:,}" for each in shown)
    return Plot(
        lambda look: _draw_scar(look, life, shown),
        scar_curves(life),
        f"Line charts of worn depth and pressure along the hole after {numbers} cycles.",
        "Depth worn off both bodies after some cycles, and the nodal pressure on these profiles at the end of one more "
        "cycle.",
        [f"{part} are drawn"] if (part := _part(life, shown)) else [],
    )


def wear_plot(subject: Subject) -> Plot:
    """Return the numbers of a life of wear over the cycles."""
    life = with_stored_cycles(subject)
    return Plot(
        lambda look: _draw_wear(look, life),
        [cycles_curve(life)],
        f"Line charts over {cycles_text(life[-1].cycle)} of volume, depth, dissipation and pressure.",
        "Worn volume, largest depth, dissipation of one cycle, and largest pressure over one cycle. A first cycle that "
        "begins with other loads than it ends with has no dissipation of a cycle.",
    )


def life_caption(life: WearResult) -> str:
    """The parameters of a life of wear as text: those of its problem, the loads of its cycle, law and coefficients."""
    ranges = load_ranges(life[-1].states)
    loads = ", ".join(style.range_text(life.problem, name, span) for name, span in ranges.items())
    words = ", ".join(f"{body} {text}" for body, text in coefficient_words(life).items())
    control = f", tolerance {life.tolerance:g}" if life.tolerance else ", every cycle solved"
    return f"{style.caption(life.problem)}; cycle: {loads or 'no load'}; {life.law} wear: {words}{control}"


def cycles_axis(panels: Sequence[Axes], numbers: np.ndarray) -> None:
    """Set the shared axis of cycles: logarithmic beyond 1 for a long life. The cycle 0 then stands at its left end."""
    panels[-1].set_xlabel("cycles")
    if numbers[-1] <= style.MAX_NAMED:
        panels[-1].xaxis.set_major_locator(MaxNLocator(nbins=9, integer=True, min_n_ticks=1))
        return
    first = float(numbers[numbers > 0].min())
    powers = [10.0**k for k in range(math.ceil(math.log10(first)), 13) if 10.0**k <= numbers[-1]]
    for panel in panels:
        panel.set_xscale("symlog", linthresh=first, linscale=0.4)
        panel.set_xticks([0.0, *powers])
        panel.xaxis.set_minor_locator(NullLocator())
        panel.set_xlim(0.0, 1.1 * float(numbers[-1]))


def _by_depth(life: WearResult) -> list[WornCycle]:
    """Return at most :data:`MAX_NAMED` stored cycles, evenly spread over the worn depth, the first and the last."""
    if len(life) <= style.MAX_NAMED:
        return list(life)
    depths = np.array([each.depth for each in life])
    wanted = np.linspace(depths[0], depths[-1], style.MAX_NAMED)
    near = {0, len(life) - 1, *(int(np.argmin(np.abs(depths - depth))) for depth in wanted[1:-1])}
    return [life[k] for k in sorted(near)]


def _part(life: WearResult, shown: Sequence[WornCycle]) -> str:
    """Words on the part of the stored cycles that a figure shows; empty if it shows all."""
    return f"{len(shown)} of {len(life)} stored cycles" if len(shown) < len(life) else ""


def _draw_scar(look: Look, life: WearResult, shown: Sequence[WornCycle]) -> Sheet:
    unit, deepest = units(life.problem), max(each.depth for each in life)
    depths = [style.without_rounding(each.gap_growth, deepest) for each in shown]
    pressures = [each.states[-1].pressure for each in shown]
    sheet = look.sheet([2.0, 2.0], extra=1.4, sharex=True)
    sheet.grid()
    upper, lower = sheet.axes[:, 0]
    angles = np.array([from_bottom(angle) for angle in life.theta.tolist()])
    order = np.argsort(angles)
    bodies = [*coefficient_words(life)]
    for panel, kind, curves, words in (
        (upper, "displacement", depths, f"worn depth of\n{'both bodies' if len(bodies) > 1 else f'the {bodies[0]}'}"),
        (lower, "traction", pressures, "pressure"),
    ):
        highest = max(float(values.max()) for values in curves)
        factor, name = unit[kind].scale([highest])
        for place, values in enumerate(curves):
            panel.plot(angles[order], factor * values[order], **style.line(place, place))
        _from_zero(panel, factor * highest)
        panel.set_ylabel(style.quantity(words, name))
    upper.invert_yaxis()  # a scar goes down
    _contact_axis(lower, life, angles)
    sheet.figure.align_ylabels(sheet.axes)
    share = life[-1].pin_share
    head = [
        "" if life.complete else followed_words(life),
        _part(life, shown),
        f"largest depth of all {style.short(deepest, unit['displacement'])}",
        f"{100.0 * share:.3g} % of the volume from the pin" if 0.0 < share < 1.0 else "",
    ]
    sheet.head(look.title, "; ".join(filter(None, head)), caption=life_caption(life))
    handles = [Line2D([], [], label=f"{each.cycle:,}", **style.line(k, k)) for k, each in enumerate(shown)]
    sheet.legend(handles, min(len(handles), 4), "cycles")
    return sheet


def _from_zero(panel: Axes, highest: float) -> None:
    """Let an axis of values begin at zero. It has no other tick if all values are zero."""
    panel.set_ylim(0.0, 1.08 * highest or 1.0)
    if not highest:
        panel.set_yticks([0.0])


def _contact_axis(panel: Axes, life: WearResult, angles: np.ndarray) -> None:
    """Show the angles at which a state of the life touches, or anything is worn, with a margin."""
    touched = life[-1].gap_growth > 1e-9 * life[-1].depth
    for each in life:
        for state in each.states:
            touched = touched | (state.pressure > 0.0)
    shown = angles[touched]
    low, high = (float(shown.min()), float(shown.max())) if shown.size else (-180.0, 180.0)
    margin = MARGIN * max(high - low, 10.0)
    panel.set_xlim(max(low - margin, -180.0), min(high + margin, 180.0))
    style.angle_axis(panel)
    panel.set_xlabel(style.ANGLE)


class PanelRow(NamedTuple):
    """A panel over the cycles: its words, the kind of its values, the values by body, and whether they only grow."""

    words: str
    kind: str
    curves: dict[str, np.ndarray]
    grows: bool = False


def _rows(life: WearResult) -> list[PanelRow]:
    pin, plate = np.array([each.volumes for each in life]).T
    bodies = {"": pin + plate}
    if pin.any() and plate.any():
        bodies = {"both bodies": pin + plate, "pin": pin, "plate": plate}
    energies = np.array([each.energy_per_cycle for each in life])
    begins_elsewhere = life[0].states[0].load != life[0].states[-1].load
    if begins_elsewhere and len(life) > 1:
        energies[0] = np.nan
    return [
        PanelRow("worn\nvolume", "work per stress", bodies, grows=True),
        PanelRow("largest\ndepth", "displacement", {"": np.array([each.depth for each in life])}, grows=True),
        PanelRow("dissipated in\none cycle", "energy", {"": style.without_rounding(energies)}),
        PanelRow("largest\npressure", "traction", {"": np.array([each.largest_pressure for each in life])}),
    ]


def _draw_wear(look: Look, life: WearResult) -> Sheet:
    unit, numbers, rows = units(life.problem), life.numbers, _rows(life)
    sheet = look.sheet([1.3] * len(rows), extra=1.3, sharex=True)
    sheet.grid()
    for panel, row in zip(sheet.axes[:, 0], rows, strict=True):
        highest = max(float(np.nanmax(values)) for values in row.curves.values())
        factor, name = unit[row.kind].scale([highest])
        for place, values in enumerate(row.curves.values()):
            size = 3.8 if len(life) <= 15 else 2.5
            panel.plot(numbers, factor * values, marker="o", markersize=size, **style.line(place, place))
        panel.set_ylabel(style.quantity(row.words, name))
        if row.grows and numbers[-1] > style.MAX_NAMED and highest:
            panel.set_yscale("log")
            panel.yaxis.set_major_locator(LogLocator(numticks=5))
            panel.yaxis.set_minor_locator(NullLocator())
            continue
        _from_zero(panel, factor * highest)
    cycles_axis(list(sheet.axes[:, 0]), numbers)
    sheet.figure.align_ylabels(sheet.axes)
    sheet.head(look.title, f"{followed_words(life)}, {life[-1].solved:,} solved", caption=life_caption(life))
    bodies = rows[0].curves
    if len(bodies) > 1:
        sheet.legend([Line2D([], [], label=name, **style.line(k, k)) for k, name in enumerate(bodies)], len(bodies))
    return sheet


def damage_plot(subject: Subject, criterion: Criterion = "smith-watson-topper", body: Body | None = None) -> Plot:
    """Return the damage of the material of one body over a life of wear."""
    life = with_stored_cycles(subject)
    return damage_of(life, life.fatigue(criterion, body or "plate"))


def damage_of(life: WearResult, found: WornFatigue) -> Plot:
    """Return the damage of material that wears: its field at the end, and the largest one over the cycles."""
    return Plot(
        lambda look: _draw(look, life, found),
        [damage_curve(found)],
        f"Map of the damage under the first surface of the {edge_body(found.problem, found.body)}, and its largest "
        f"value over {cycles_text(life[-1].cycle)}: {found.words}.",
        f"Damage by {found.criterion.title()} of the material under the first surface, and the largest damage "
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
    head = f"{edge_body(found.problem, found.body)}, {found.criterion.title()}: {words}"
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
    panel.set_ylabel(style.quantity("depth under the\nfirst surface", name))
    panel.set_xlabel(style.ANGLE)
    style.angle_axis(panel)
    return filled


def _draw_growth(panel: Axes, found: WornFatigue) -> None:
    """Draw the largest damage over the cycles: of the material that is still there, and of all material."""
    left, ever = np.array([spot.damage for spot in found.hot_spots]), found.damage.max(axis=(1, 2))
    top, positive = float(ever.max()), left[left > 0.0]
    highest = max(top, 1.0) if top > NEAR else top
    if highest >= 1.0:
        panel.axhline(1.0, **style.line(7, 2, 1.0))
    if positive.size and found.cycles[-1] > style.MAX_NAMED:
        panel.set_yscale("log")
        panel.set_ylim(max(0.5 * float(positive.min()), top * 10.0**-DECADES), 3.0 * highest)
        round_numbers(panel.yaxis, np.array(panel.get_ylim()))
        left, ever = (np.where(values > 0.0, values, np.nan) for values in (left, ever))
    else:
        panel.set_ylim(0.0, 1.08 * highest or 1.0)
    panel.plot(found.cycles, left, marker="o", markersize=3.0, **LEFT)
    panel.plot(found.cycles, ever, **EVER)
    style.draw_grid(panel)
    cycles_axis([panel], found.cycles)
    panel.set_ylabel("largest damage")
