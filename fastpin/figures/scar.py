"""Figures of a life of wear: profile and pressure, and the numbers over the cycles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from fastpin.assess.outputs import write_csv
from fastpin.assess.wear import coefficient_words, cycles_curve, followed_words, scar_curves
from fastpin.figures.sheet import Look, Plot, Sheet
from fastpin.figures.sketch import load_ranges
from fastpin.figures.style import MAX_NAMED, angle_axis, line
from fastpin.figures.subjects import Subject, with_stored_cycles
from fastpin.figures.words import ANGLE, caption, quantity, range_text, short, without_rounding
from fastpin.model.angles import from_bottom
from fastpin.model.units import units
from fastpin.model.wear import cycles_text
from fastpin.solver.wear_result import WearResult, WornCycle

MARGIN = 0.15
"""Angles beside the contact that are shown, in parts of its width."""


def scar_plot(subject: Subject) -> Plot:
    """Return the profiles of wear, and the pressure on them, after some of the stored cycles."""
    life = with_stored_cycles(subject)
    shown = _by_depth(life)
    numbers = ", ".join(f"{each.cycle:,}" for each in shown)
    return Plot(
        lambda look: _draw_scar(look, life, shown),
        lambda path: write_csv(scar_curves(life), path),
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
        lambda path: write_csv([cycles_curve(life)], path),
        f"Line charts over {cycles_text(life[-1].cycle)} of volume, depth, dissipation and pressure.",
        "Worn volume, largest depth, dissipation of one cycle, and largest pressure over one cycle. A first cycle that "
        "begins with other loads than it ends with has no dissipation of a cycle.",
    )


def life_caption(life: WearResult) -> str:
    """The parameters of a life of wear as text: those of its problem, the loads of its cycle, law and coefficients."""
    ranges = load_ranges(life[-1].states)
    loads = ", ".join(range_text(life.problem, name, span) for name, span in ranges.items())
    words = ", ".join(f"{body} {text}" for body, text in coefficient_words(life).items())
    control = f", tolerance {life.tolerance:g}" if life.tolerance else ", every cycle solved"
    return f"{caption(life.problem)}; cycle: {loads or 'no load'}; {life.law} wear: {words}{control}"


def cycles_axis(panels: Sequence[Axes], numbers: np.ndarray) -> None:
    """Set the shared axis of cycles: logarithmic beyond 1 for a long life. The cycle 0 then stands at its left end."""
    panels[-1].set_xlabel("cycles")
    if numbers[-1] <= MAX_NAMED:
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
    if len(life) <= MAX_NAMED:
        return list(life)
    depths = np.array([each.depth for each in life])
    wanted = np.linspace(depths[0], depths[-1], MAX_NAMED)
    near = {0, len(life) - 1, *(int(np.argmin(np.abs(depths - depth))) for depth in wanted[1:-1])}
    return [life[k] for k in sorted(near)]


def _part(life: WearResult, shown: Sequence[WornCycle]) -> str:
    """Words on the part of the stored cycles that a figure shows; empty if it shows all."""
    return f"{len(shown)} of {len(life)} stored cycles" if len(shown) < len(life) else ""


def _draw_scar(look: Look, life: WearResult, shown: Sequence[WornCycle]) -> Sheet:
    unit, deepest = units(life.problem), max(each.depth for each in life)
    depths = [without_rounding(each.gap_growth, deepest) for each in shown]
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
            panel.plot(angles[order], factor * values[order], **line(place, place))
        panel.set_ylim(0.0, 1.08 * factor * highest or 1.0)
        if not highest:
            panel.set_yticks([0.0])
        panel.set_ylabel(quantity(words, name))
    upper.invert_yaxis()  # a scar goes down
    _contact_axis(lower, life, angles)
    sheet.figure.align_ylabels(sheet.axes)
    share = life[-1].pin_share
    head = [
        "" if life.complete else followed_words(life),
        _part(life, shown),
        f"largest depth of all {short(deepest, unit['displacement'])}",
        f"{100.0 * share:.3g} % of the volume from the pin" if 0.0 < share < 1.0 else "",
    ]
    sheet.head(look.title, "; ".join(filter(None, head)), caption=life_caption(life))
    handles = [Line2D([], [], label=f"{each.cycle:,}", **line(k, k)) for k, each in enumerate(shown)]
    sheet.legend(handles, min(len(handles), 4), "cycles")
    return sheet


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
    angle_axis(panel)
    panel.set_xlabel(ANGLE)


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
        PanelRow("dissipated in\none cycle", "energy", {"": without_rounding(energies)}),
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
            style = line(place, place)
            panel.plot(numbers, factor * values, marker="o", markersize=3.8 if len(life) <= 15 else 2.5, **style)
        panel.set_ylabel(quantity(row.words, name))
        if row.grows and numbers[-1] > MAX_NAMED and highest:
            panel.set_yscale("log")
            panel.yaxis.set_major_locator(LogLocator(numticks=5))
            panel.yaxis.set_minor_locator(NullLocator())
            continue
        panel.set_ylim(0.0, 1.08 * factor * highest or 1.0)
        if not highest:
            panel.set_yticks([0.0])
    cycles_axis(list(sheet.axes[:, 0]), numbers)
    sheet.figure.align_ylabels(sheet.axes)
    sheet.head(look.title, f"{followed_words(life)}, {life[-1].solved:,} solved", caption=life_caption(life))
    bodies = rows[0].curves
    if len(bodies) > 1:
        sheet.legend([Line2D([], [], label=name, **line(k, k)) for k, name in enumerate(bodies)], len(bodies))
    return sheet
