"""Figures of one load cycle: slip and friction energy on the arc, and hysteresis loops."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Sheet
from fastpin.figures.states import Frame
from fastpin.figures.style import line
from fastpin.figures.words import (
    ANGLE,
    ROUNDING,
    caption,
    load_text,
    loads_by_change,
    quantity,
    short,
    shown_unit,
    without_rounding,
)
from fastpin.model.checks import instance
from fastpin.model.loads import LOAD_KIND
from fastpin.model.units import Unit, units
from fastpin.report.cycle import CONJUGATES, natural_sizes
from fastpin.solver.result import Result
from fastpin.states.load_cycle import LoadCycle, NodeBehaviour

SHADES = {NodeBehaviour.SLIPS: ("0.80", "slips at some time"), NodeBehaviour.OPENS: ("0.92", "opens at some time")}
"""Shades of the nodes that do not stick all the time, and their names."""

STRAIGHT = 3
"""States of a cycle, with both ends, between which a loop is a line. Its area tells nothing then."""

SMALL = 0.1
"""Displacement without a prefix below which the unit gets a power of ten: long numbers would overlap on the axis."""

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

TICKS = {1: 9, 2: 6, 3: 3}
"""Most intervals on the axis of displacements, by the number of panels side by side."""

NO_AREA = "area unknown: no states between the corners"
"""Title of a loop that is a line."""


def plot_slip(
    cycle: LoadCycle | Result,
    path: str | Path | None = None,
    title: str = "",
    width: float = 6.7,
    dpi: float = 300.0,
    *,
    ax: Axes | None = None,
) -> Figure:
    """Draw slip and friction energy of a cycle on the arc of the contact.

    The upper panel shows the slip range, and the slip distance if it is known. The lower panel shows the friction
    energy, or if that is not known the range of the shear traction. Nodes that slip or open at some time are shaded.

    Parameters
    ----------
    cycle : LoadCycle or Result
        From :meth:`fastpin.Result.cycle`; of a result the last cycle.
    path, title, width, dpi, ax
        See :func:`fastpin.plot_tractions`.

    Raises
    ------
    InputError
        If `cycle` is no load cycle, or a result without one. Also see :func:`fastpin.plot_tractions`.
    """
    look, found = Look(path, title, width, dpi, ax), _cycle_of(cycle)
    return look.drawn(lambda: _draw_slip(found, look))


def _cycle_of(cycle: LoadCycle | Result) -> LoadCycle:
    """The cycle, or the last one of a result."""
    if isinstance(cycle, Result):
        return cycle.cycle()
    return instance("cycle", cycle, LoadCycle, "a result, or a load cycle such as result.cycle()")


def _draw_slip(cycle: LoadCycle, look: Look) -> Sheet:
    known = cycle.friction_energy is not None
    sheet = look.sheet([2.0, 2.0])
    axes = sheet.axes
    sheet.grid()
    unit = units(cycle.states[0].problem)
    frame = Frame(cycle.states)
    angle, order = frame.angle, frame.order
    upper, lower = axes[:, 0]
    sizes = natural_sizes(cycle)
    named = {"slip range": cycle.slip_range, **({"slip distance": cycle.slip_distance} if known else {})}
    curves = {name: without_rounding(np.asarray(each), sizes["displacement"]) for name, each in named.items()}
    slips = any(each.any() for each in curves.values())
    factor, label = unit["displacement"].scale([float(each.max()) for each in curves.values()])
    for k, each in enumerate(curves.values()):
        upper.plot(angle, factor * each[order], **line(k, k))
    upper.set_ylabel(quantity("slip", label))
    words, kind, values = "range of shear traction", "traction", cycle.shear_range
    if cycle.friction_energy is not None:
        words, kind, values = "friction energy", "energy density", cycle.friction_energy
    values = without_rounding(values, sizes[kind])
    factor, label = unit[kind].scale([float(values.max())])
    lower.plot(angle, factor * values[order], **line(2, 2))
    lower.set_ylabel(quantity(words, label))
    _shade(lower, cycle, frame, slips)
    shades = _shade(upper, cycle, frame, slips)
    for panel in (upper, lower):
        top = max(float(np.nanmax(drawn.get_ydata())) for drawn in panel.lines)
        panel.set_ylim(0.0, 1.08 * top or 1.0)
        if top == 0.0:
            panel.text(0.5, 0.5, "0: no node slips", ha="center", transform=panel.transAxes)
            panel.set_yticks([0.0])
        frame.scale(panel)
    lower.set_xlabel(ANGLE)
    handles: list[Artist] = [Line2D([], [], label=name, **line(k, k)) for k, name in enumerate(curves)]
    handles.append(Line2D([], [], label=words, **line(2, 2)))
    sheet.figure.align_ylabels(axes)
    sheet.legend([*handles, *shades], len(handles) + len(shades))
    _head(sheet, cycle, look.title)
    return sheet


def _head(sheet: Sheet, cycle: LoadCycle, title: str, lift: float = 5.0) -> None:
    """Write title, corners, loads that are constant, and the parameters, `lift` points above the panel."""
    common = ",  ".join(load_text(cycle.states, 0, name) for name in loads_by_change(cycle.states)[0])
    heading = f"cycle from corner {cycle.first:,} to {cycle.last:,}{f',  {common}' if common else ''}"
    sheet.head(title, heading, caption=caption(cycle.states[0].problem, cycle.states), lift=lift)


def _shade(panel: Axes, cycle: LoadCycle, frame: Frame, slips: bool) -> list[Artist]:
    """Shade the nodes that slip or open at some time, and return the entries of the legend.

    If the cycle has no slip beyond rounding (`slips` is False), no node counts as slipping.
    """
    middles = 0.5 * (frame.angle[1:] + frame.angle[:-1])
    ends = np.r_[frame.angle[0], middles, frame.angle[-1]]
    entries: list[Artist] = []
    for behaviour, (shade, label) in SHADES.items():
        shaded = cycle.behaviour[frame.order] == behaviour
        if not shaded.any() or (behaviour == NodeBehaviour.SLIPS and not slips):
            continue
        # One span for each row of nodes: spans that meet would show hairlines.
        changes = np.flatnonzero(np.diff(np.r_[False, shaded, False]))
        for first, last in changes.reshape(-1, 2):
            panel.axvspan(ends[first], ends[last], color=shade, linewidth=0, zorder=-1)
        entries.append(Patch(color=shade, linewidth=0, label=label))
    return entries


def plot_loops(
    cycle: LoadCycle | Result,
    path: str | Path | None = None,
    title: str = "",
    width: float = 6.7,
    dpi: float = 300.0,
    *,
    ax: Axes | None = None,
) -> Figure:
    """Draw the hysteresis loops of a cycle: each load against the displacement on which it does work.

    Each panel names the area of its loop, which is the work of the load. Over a closed cycle of a settled contact the
    areas sum up to the dissipation. The area needs more states than the ends of a line: see `between` of
    :func:`fastpin.solve`.

    Parameters
    ----------
    cycle : LoadCycle or Result
        From :meth:`fastpin.Result.cycle`; of a result the last cycle.
    path, title, width, dpi, ax
        See :func:`fastpin.plot_tractions`.

    Raises
    ------
    InputError
        If `cycle` is no load cycle, or a result without one, or if no load changes in it. Also see
        :func:`fastpin.plot_tractions`.
    """
    look, found = Look(path, title, width, dpi, ax), _cycle_of(cycle)
    check_loops(found)
    return look.drawn(lambda: _draw_loops(found, look))


def check_loops(cycle: LoadCycle) -> None:
    """Raise :class:`InputError` if a cycle has no hysteresis loop."""
    if _changing(cycle):
        return
    if len(cycle.states) == 2 and cycle.last - cycle.first > 1:
        raise InputError("cycle", 'has no loop: only its ends were kept; keep "corners" or "all" keeps its corners')
    raise InputError("cycle", "has no loop: no load changes in it")


def _changing(cycle: LoadCycle) -> list[str]:
    """Names of the loads that change in a cycle, beyond rounding."""
    loops = cycle.loops
    force = max(float(np.abs(loops[name].load).max()) for name in ("P", "Q"))
    sizes = {"moment": force * cycle.states[0].problem.hole_radius, "force": force}
    return [
        name
        for name, loop in loops.items()
        if np.ptp(loop.load) > 1e-9 * sizes.get(LOAD_KIND[name], float(np.abs(loop.load).max()))
    ]


def _draw_loops(cycle: LoadCycle, look: Look) -> Sheet:
    names = _changing(cycle)
    across = min(len(names), 3)
    sheet = look.sheet([2.6] * -(-len(names) // across), columns=across, extra=0.9)
    axes = sheet.axes
    sheet.grid()
    unit = units(cycle.states[0].problem)
    for panel in axes.flat[len(names) :]:
        panel.set_visible(False)
    for name, panel in zip(names, axes.flat, strict=False):
        loop, kind = cycle.loops[name], LOAD_KIND[name]
        load, load_unit = unit[kind].scale(loop.load.tolist())
        words, conjugate = CONJUGATES[kind]
        moved, moved_unit = _displacement_scale(loop.displacement, unit[conjugate])
        if kind == "traction":  # of a square unit, which has no prefixes
            moved = 1.0 / max(float(np.abs(loop.displacement).max()), 1e-300)
            moved_unit = "largest is 1"
        panel.plot(moved * loop.displacement, load * loop.load, marker="o", markersize=2.2, **line(0))
        panel.set_xlabel(f"{words}\n({shown_unit(moved_unit)})" if across > 2 else quantity(words, moved_unit))
        panel.set_ylabel(quantity(name, load_unit))
        area = _area(cycle, name, float(loop.work)) if len(loop.load) > STRAIGHT else NO_AREA
        panel.text(0.0, 1.02, area, fontsize=8.0, ha="left", va="bottom", transform=panel.transAxes)
        panel.xaxis.set_major_locator(MaxNLocator(TICKS[across], steps=[1, 2, 5, 10]))
    _head(sheet, cycle, look.title, lift=18.0)
    return sheet


def _displacement_scale(values: np.ndarray, unit: Unit) -> tuple[float, str]:
    """As :meth:`fastpin.model.units.Unit.scale`; a unit without prefixes gets a power of ten for small values."""
    factor, label = unit.scale(values.tolist())
    largest = factor * float(np.abs(values).max())
    if not 0.0 < largest < SMALL:
        return factor, label
    power = math.floor(math.log10(largest))
    return factor / 10.0**power, f"10{str(power).translate(SUPERSCRIPTS)} {label}"


def _area(cycle: LoadCycle, name: str, work: float) -> str:
    """The area of a loop as text: 0 where it is rounding beside load times displacement."""
    loop = cycle.loops[name]
    size = float(np.abs(loop.load).max() * np.abs(loop.displacement).max())
    unit = units(cycle.states[0].problem)["energy"]
    return f"area {short(work, unit)}" if abs(work) > ROUNDING * size else "area 0"
