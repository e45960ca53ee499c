"""Figures of a life of wear: profile and pressure, numbers over the cycles, and the damage of the material."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

from fastpin.damage import WornFatigue
from fastpin.damage.criteria import Criterion
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet
from fastpin.figures.style import COLOURS, MAX_NAMED, Line, angle_axis, line
from fastpin.figures.subjects import Subject
from fastpin.figures.words import ANGLE, caption, quantity, short, without_rounding
from fastpin.model.angles import from_bottom
from fastpin.model.points import Body
from fastpin.model.units import units
from fastpin.report.case import edge_body
from fastpin.report.curves import write_csv
from fastpin.report.wear import cycles_curve, damage_curve, scar_curves
from fastpin.solver.wear_result import WearResult, WornCycle

MARGIN = 0.15
"""Angles beside the contact that are shown, in parts of its width."""

DECADES = 6
"""Decades of damage that a map shows."""

LEVELS = 4
"""Colours of a map in each decade."""

VOLUME, DEPTH = "worn volume\nper thickness", "largest\ndepth"
"""Words of the panels of numbers that grow with the cycles."""

GROWING = (VOLUME, DEPTH)
"""The panels with a logarithmic scale over many cycles."""

CYCLES = "cycles"
"""Words of the axis of cycles."""


def scar_plot(subject: Subject) -> Plot:
    """Return the profiles of wear, and the pressure on them, after some of the stored cycles."""
    result = _with_cycles(subject.wear())
    shown = _by_depth(result)
    return Plot(
        lambda look: _draw_scar(look, result, shown),
        lambda path: write_csv(scar_curves(result), path),
        f"Line charts of worn depth and pressure along the hole after {_numbers(shown)} cycles.",
        "Depth worn off both bodies, and the pressure on this profile at the beginning of the next cycle.",
        _part_note(result, shown),
    )


def wear_plot(subject: Subject) -> Plot:
    """Return the numbers of a life of wear over the cycles."""
    result = _with_cycles(subject.wear())
    return Plot(
        lambda look: _draw_wear(look, result),
        lambda path: write_csv([cycles_curve(result)], path),
        f"Line charts over {result[-1].cycle:,} cycles of volume, depth, dissipation and pressure.",
        "Worn volume and depth, dissipation of one cycle, and largest pressure over the cycles.",
    )


def damage_plot(subject: Subject, criterion: Criterion = "smith-watson-topper", body: Body | None = None) -> Plot:
    """Return the damage of the material of one body over a life of wear."""
    result = _with_cycles(subject.wear())
    return damage_of(result.fatigue(criterion, body or "plate"))


def damage_of(found: WornFatigue) -> Plot:
    """Return the damage of material that wears: its field at the end, and the largest one over the cycles."""
    return Plot(
        lambda look: _draw_damage(look, found),
        lambda path: write_csv([damage_curve(found)], path),
        f"Map of the damage under the first surface of the {edge_body(found.problem, found.body)}, and its largest "
        f"value over {found.cycles[-1]:,} cycles: {found.words}.",
        f"Damage by {found.criterion} of the material under the first surface, and the largest damage of all material "
        "that is still there. Damage goes with the material that wears off.",
        bitmap=True,
    )


def _with_cycles(result: WearResult) -> WearResult:
    if not len(result):
        raise InputError("result", "has no stored cycle: the life of wear ended before its first one")
    return result


def _by_depth(result: WearResult) -> list[WornCycle]:
    """Return at most :data:`MAX_NAMED` stored cycles, evenly spread over the worn depth, the first and the last."""
    if len(result) <= MAX_NAMED:
        return list(result)
    depths = np.array([each.depth for each in result])
    wanted = np.linspace(depths[0], depths[-1], MAX_NAMED)
    near = {0, len(result) - 1, *(int(np.argmin(np.abs(depths - depth))) for depth in wanted[1:-1])}
    return [result[k] for k in sorted(near)]


def _numbers(cycles: Sequence[WornCycle]) -> str:
    return ", ".join(f"{each.cycle:,}" for each in cycles)


def _part_note(result: WearResult, shown: Sequence[WornCycle]) -> list[str]:
    """Say that a figure shows a part of the stored cycles."""
    return [f"{len(shown)} of {len(result)} stored cycles are drawn"] if len(shown) < len(result) else []


def _draw_scar(look: Look, result: WearResult, shown: Sequence[WornCycle]) -> Sheet:
    unit = units(result.problem)
    depths = {each.cycle: without_rounding(each.gap_growth, result[-1].depth) for each in result}
    pressures = {each.cycle: each.pressure for each in result}
    length, name = unit["displacement"].scale([float(depth.max()) for depth in depths.values()])
    traction, traction_name = unit["traction"].scale([float(values.max()) for values in pressures.values()])
    sheet = look.sheet([2.0, 2.0], extra=1.3, sharex=True)
    sheet.grid()
    upper, lower = sheet.axes[:, 0]
    order = np.argsort(_angles(result))
    for place, each in enumerate(shown):
        style = line(place, place)
        upper.plot(_angles(result)[order], length * depths[each.cycle][order], **style)
        lower.plot(_angles(result)[order], traction * pressures[each.cycle][order], **style)
    highest = length * max(float(depth.max()) for depth in depths.values())
    upper.set_ylim(1.08 * highest or 1.0, 0.0)  # a scar goes down
    lower.set_ylim(0.0, 1.08 * traction * max(float(values.max()) for values in pressures.values()) or 1.0)
    if not highest:
        upper.set_yticks([0.0])
    upper.set_ylabel(quantity("worn depth of\nboth bodies", name))
    lower.set_ylabel(quantity("pressure", traction_name))
    _contact_axis(lower, result)
    sheet.figure.align_ylabels(sheet.axes)
    part = f"{len(shown)} of {len(result)} stored cycles; " if len(shown) < len(result) else ""
    share = result[-1].pin_share
    pin = "" if math.isnan(share) else f", {100.0 * share:.3g} % of the volume from the pin"
    deepest = short(max(each.depth for each in result), unit["displacement"])
    sheet.head(look.title, f"{part}largest depth of all {deepest}{pin}", caption=caption(result.problem))
    handles = [Line2D([], [], label=f"{each.cycle:,}", **line(k, k)) for k, each in enumerate(shown)]
    sheet.legend(handles, min(len(handles), 4), "cycles")
    return sheet


def _angles(result: WearResult) -> np.ndarray:
    """Angles of the nodes from the bottom, deg."""
    return np.array([from_bottom(angle) for angle in result.theta.tolist()])


def _contact_axis(panel: Axes, result: WearResult) -> None:
    """Show the angles at which a state of the life touches, or anything is worn, with a margin."""
    touched = result[-1].gap_growth > 1e-9 * result[-1].depth
    for each in result:
        for state in each.states:
            touched = touched | (state.pressure > 0.0)
    angles = _angles(result)[touched]
    low, high = (float(angles.min()), float(angles.max())) if angles.size else (-180.0, 180.0)
    margin = MARGIN * max(high - low, 10.0)
    panel.set_xlim(max(low - margin, -180.0), min(high + margin, 180.0))
    angle_axis(panel)
    panel.set_xlabel(ANGLE)


def _draw_wear(look: Look, result: WearResult) -> Sheet:
    unit, numbers = units(result.problem), result.numbers
    pin, plate = np.array([each.volumes for each in result]).T
    bodies = (
        {"both bodies": pin + plate, "pin": pin, "plate": plate} if pin.any() and plate.any() else {"": pin + plate}
    )
    energies = np.array([each.energy_per_cycle for each in result])
    rows = {
        VOLUME: ("work per stress", bodies),
        DEPTH: ("displacement", {"": np.array([each.depth for each in result])}),
        "dissipated in\none cycle": ("energy", {"": without_rounding(energies)}),
        "largest pressure\nover one cycle": ("traction", {"": np.array([each.largest_pressure for each in result])}),
    }
    sheet = look.sheet([1.3] * len(rows), extra=1.2, sharex=True)
    sheet.grid()
    for panel, (words, (kind, curves)) in zip(sheet.axes[:, 0], rows.items(), strict=True):
        factor, name = unit[kind].scale(np.concatenate(list(curves.values())).tolist())
        for place, values in enumerate(curves.values()):
            style = line(place, place)
            panel.plot(numbers, factor * values, marker="o", markersize=2.5 if len(result) > 15 else 3.8, **style)
        panel.set_ylabel(quantity(words, name))
        highest = factor * max(float(values.max()) for values in curves.values())
        if words in GROWING and numbers[-1] > MAX_NAMED and highest:
            panel.set_yscale("log")
            panel.yaxis.set_major_locator(LogLocator(numticks=5))
            panel.yaxis.set_minor_locator(NullLocator())
            continue
        panel.set_ylim(0.0, 1.08 * highest or 1.0)
        if not highest:
            panel.set_yticks([0.0])
    _cycles_axis(sheet, numbers)
    sheet.figure.align_ylabels(sheet.axes)
    solved = f", {result[-1].solved:,} of them solved" if result[-1].solved <= result[-1].cycle else ""
    sheet.head(look.title, f"{result[-1].cycle:,} cycles{solved}", caption=caption(result.problem))
    if len(bodies) > 1:
        sheet.legend([Line2D([], [], label=name, **line(k, k)) for k, name in enumerate(bodies)], len(bodies))
    return sheet


def _cycles_axis(sheet: Sheet, numbers: np.ndarray) -> None:
    """Set the axis of cycles: logarithmic beyond 1 for a long life. The cycle 0 then stands at its left end."""
    last = sheet.axes[-1, 0]
    last.set_xlabel(CYCLES)
    if numbers[-1] <= MAX_NAMED:
        last.xaxis.set_major_locator(MaxNLocator(nbins=9, integer=True, min_n_ticks=1))
        return
    first = float(numbers[numbers > 0].min())
    for panel in sheet.axes[:, 0]:
        panel.set_xscale("symlog", linthresh=first, linscale=0.4)
        panel.xaxis.set_major_locator(LogLocator(numticks=12))
        panel.set_xticks([0.0, *(10.0**k for k in range(math.ceil(math.log10(first)), 13) if 10.0**k <= numbers[-1])])
        panel.xaxis.set_minor_locator(NullLocator())
        panel.set_xlim(0.0, 1.1 * float(numbers[-1]))


def _draw_damage(look: Look, found: WornFatigue) -> Sheet:
    unit = units(found.problem)
    sheet = look.sheet([2.4, 1.7], extra=1.4)
    field, curve = sheet.axes[:, 0]
    order = np.argsort([from_bottom(angle) for angle in found.theta.tolist()])
    angle = np.array([from_bottom(angle) for angle in found.theta.tolist()])[order]
    length, name = unit["displacement"].scale(found.depth.tolist())
    damage, worn = found.damage[-1][:, order], found.worn[-1][order]
    top = float(damage.max())
    if top > 0.0:
        scale = LogNorm(top * 10.0**-DECADES, top)
        levels = np.geomspace(top * 10.0**-DECADES, top, DECADES * LEVELS + 1)
        drawn = np.clip(damage, levels[0], top)
        filled = field.contourf(angle, length * found.depth, drawn, levels, norm=scale, cmap="viridis", extend="min")
        if damage.min() < 1.0 < top:
            field.contour(angle, length * found.depth, damage, [1.0], colors="white", linewidths=1.2)
        bar = sheet.figure.colorbar(filled, ax=field, aspect=18, pad=0.02)
        bar.set_label("damage")
        bar.set_ticks([10.0**k for k in range(math.ceil(math.log10(levels[0])), math.floor(math.log10(top)) + 1)])
    field.fill_between(angle, 0.0, length * worn, facecolor="white", edgecolor="0.4", hatch="////", linewidth=0.0)
    field.plot(angle, length * worn, **line(1, 0, 1.6))
    _zoom(field, found, angle, damage, length)
    field.set_ylabel(quantity("depth under the\nfirst surface", name))
    field.set_xlabel(ANGLE)
    angle_axis(field)
    spots = found.hot_spots
    curve.plot(found.cycles, [spot.damage for spot in spots], marker="o", markersize=3.0, **line(0, 0))
    curve.plot(found.cycles, found.damage.max(axis=(1, 2)), **line(2, 1))
    curve.axhline(1.0, **line(7, 2, 1.0))
    positive = [spot.damage for spot in spots if spot.damage > 0.0]
    if positive and found.cycles[-1] > MAX_NAMED:
        curve.set_xscale("log")
        curve.set_yscale("log")
        curve.set_ylim(max(0.5 * min(positive), 1e-6 * max(*positive, 1.0)), 3.0 * max(1.0, top))
    curve.grid(True, color="0.92", linewidth=0.6)
    curve.set_xlabel(CYCLES)
    curve.set_ylabel("largest damage")
    handles = [Line2D([], [], label="worn surface", **line(1, 0, 1.6))]
    crack = found.crack
    if math.isfinite(crack.cycle):
        style: Line = {"marker": "o", "markersize": 5.0, "linestyle": "none", "color": COLOURS[1]}
        field.plot(from_bottom(crack.theta), length * crack.depth, clip_on=False, zorder=5, **style)
        handles.append(Line2D([], [], label="first crack", **style))
    handles += [
        Line2D([], [], label="of all material still there", **line(0, 0)),
        Line2D([], [], label="of all material", **line(2, 1)),
    ]
    sheet.legend(handles, 2)
    head = f"{edge_body(found.problem, found.body)}, {found.criterion}: {found.words}"
    sheet.head(look.title, head, caption=caption(found.problem))
    return sheet


def _zoom(panel: Axes, found: WornFatigue, angle: np.ndarray, damage: np.ndarray, length: float) -> None:
    """Show the angles with much damage or wear, down to a depth at which the damage has become small."""
    much = (damage.max(axis=0) > 1e-2 * damage.max()) | (found.worn[-1][np.argsort(angle)] > 0.0)
    low, high = (float(angle[much].min()), float(angle[much].max())) if much.any() else (-180.0, 180.0)
    margin = MARGIN * max(high - low, 10.0)
    panel.set_xlim(max(low - margin, angle[0]), min(high + margin, angle[-1]))
    deep = found.depth[damage.max(axis=1) > 1e-3 * damage.max()] if damage.any() else found.depth
    panel.set_ylim(length * max(float(deep.max()), 2.0 * float(found.worn.max()), float(found.depth[1:2].sum())), 0.0)
