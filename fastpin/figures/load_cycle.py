"""Figures of one load cycle: slip and friction energy on the arc, and hysteresis loops."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from fastpin.errors import InputError
from fastpin.figures.states import Frame
from fastpin.figures.style import add_heading, angle_axis, check_figure_text, draw_and_save, fitted_legend, line, panels
from fastpin.model.checks import instance
from fastpin.model.loads import LOAD_KIND
from fastpin.model.units import scaled, units, with_unit
from fastpin.states.load_cycle import LoadCycle, NodeBehaviour

SHADES = {NodeBehaviour.SLIPS: ("0.80", "slips at some time"), NodeBehaviour.OPENS: ("0.92", "opens at some time")}
"""Shades of the nodes that do not stick all the time, and their names."""

CONJUGATES = {
    "force": ("displacement", "displacement"),
    "moment": ("rotation", "rotation"),
    "traction": ("conjugate displacement", ""),
}
"""By kind of load: the name of the displacement on which it does work, and its kind of quantity."""

STRAIGHT = 3
"""States of a cycle, with both ends, between which a loop is a line. Its area tells nothing then."""

NO_AREA = "area unknown: no states between the corners"
"""Title of a loop that is a line."""


def plot_slip(
    cycle: LoadCycle, path: str | Path | None = None, title: str = "", width: float = 6.7, dpi: float = 200.0
) -> Figure:
    """Draw slip and friction energy of a cycle on the arc of the contact.

    The upper panel shows the slip range, and the slip distance if it is known. The lower panel shows the friction
    energy, or if that is not known the range of the shear traction. Nodes that slip or open at some time are shaded.

    Parameters
    ----------
    cycle : LoadCycle
        From :meth:`fastpin.Result.cycle`.
    path, title, width, dpi
        See :func:`fastpin.plot_tractions`.

    Raises
    ------
    InputError
        If `cycle` is no load cycle. Also see :func:`fastpin.plot_tractions`.
    """
    instance("cycle", cycle, LoadCycle, "a load cycle, such as result.cycle()")
    inches = check_figure_text(title, width)
    return draw_and_save(lambda: _draw_slip(cycle, title, inches), path, dpi)


def _draw_slip(cycle: LoadCycle, title: str, width: float) -> Figure:
    known = cycle.friction_energy is not None
    figure, axes = panels(2, 1, 2.0, width)
    figure.set_figheight(5.2)
    unit = units(cycle.states[0].problem)
    frame = Frame(cycle.states)
    angle, order = frame.angle, frame.order
    upper, lower = axes[:, 0]
    curves = [("slip range", cycle.slip_range), *([("slip distance", cycle.slip_distance)] if known else [])]
    factor, label = scaled([float(np.max(values)) for _, values in curves if values is not None], unit["displacement"])
    for k, (_, values) in enumerate(curves):
        upper.plot(angle, factor * np.asarray(values)[order], **line(k, k))
    upper.set_ylabel(f"slip  [{label}]")
    if cycle.friction_energy is not None:
        factor, label = scaled([float(cycle.friction_energy.max())], unit["energy density"])
        lower.plot(angle, factor * cycle.friction_energy[order], **line(2, 2))
        lower.set_ylabel(f"friction energy  [{label}]")
    else:
        factor, label = scaled([float(cycle.shear_range.max())], unit["traction"])
        lower.plot(angle, factor * cycle.shear_range[order], **line(2, 2))
        lower.set_ylabel(f"range of shear traction  [{label}]")
    _shade(lower, cycle, frame)
    shades = _shade(upper, cycle, frame)
    for panel in (upper, lower):
        panel.set_ylim(bottom=0.0)
        angle_axis(panel)
        panel.set_xlim(*frame.limits)
    lower.set_xlabel("angle from the bottom of the hole, counter-clockwise  [deg]")
    handles: list[Artist] = [Line2D([], [], label=name, **line(k, k)) for k, (name, _) in enumerate(curves)]
    fitted_legend(figure, [*handles, *shades], len(handles) + len(shades))
    heading = f"cycle from corner {cycle.first:,} to {cycle.last:,}"
    add_heading(figure, title, heading)
    return figure


def _shade(panel: Axes, cycle: LoadCycle, frame: Frame) -> list[Artist]:
    """Shade the nodes that slip or open at some time, and return the entries of the legend."""
    middles = 0.5 * (frame.angle[1:] + frame.angle[:-1])
    ends = np.r_[frame.angle[0], middles, frame.angle[-1]]
    entries: list[Artist] = []
    for behaviour, (shade, label) in SHADES.items():
        shaded = np.flatnonzero(cycle.behaviour[frame.order] == behaviour)
        for k in shaded:
            panel.axvspan(ends[k], ends[k + 1], color=shade, linewidth=0, zorder=-1)
        if shaded.size:
            entries.append(Patch(color=shade, linewidth=0, label=label))
    return entries


def plot_loops(
    cycle: LoadCycle, path: str | Path | None = None, title: str = "", width: float = 6.7, dpi: float = 200.0
) -> Figure:
    """Draw the hysteresis loops of a cycle: each load against the displacement on which it does work.

    Each panel names the area of its loop, which is the work of the load. Over a closed cycle of a settled contact the
    areas sum up to the dissipation. The area needs more states than the ends of a line: see `between` of
    :func:`fastpin.solve`.

    Parameters
    ----------
    cycle : LoadCycle
        From :meth:`fastpin.Result.cycle`.
    path, title, width, dpi
        See :func:`fastpin.plot_tractions`.

    Raises
    ------
    InputError
        If `cycle` is no load cycle, or no load changes in it. Also see :func:`fastpin.plot_tractions`.
    """
    instance("cycle", cycle, LoadCycle, "a load cycle, such as result.cycle()")
    inches = check_figure_text(title, width)
    if not _changing(cycle):
        raise InputError("cycle", "has no loop: no load changes in it")
    return draw_and_save(lambda: _draw_loops(cycle, title, inches), path, dpi)


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


def _draw_loops(cycle: LoadCycle, title: str, width: float) -> Figure:
    names = _changing(cycle)
    across = min(len(names), 3)
    figure, axes = panels(-(-len(names) // across), across, 2.6, width)
    unit = units(cycle.states[0].problem)
    for panel in axes.flat[len(names) :]:
        panel.set_visible(False)
    for name, panel in zip(names, axes.flat, strict=False):
        loop, kind = cycle.loops[name], LOAD_KIND[name]
        load, load_unit = scaled(loop.load.tolist(), unit[kind])
        words, conjugate = CONJUGATES[kind]
        moved, moved_unit = scaled(loop.displacement.tolist(), unit.get(conjugate, ""))
        if kind == "traction":  # of a square unit, which has no prefixes
            moved = 1.0 / max(float(np.abs(loop.displacement).max()), 1e-300)
            moved_unit = "largest: 1"
        panel.plot(moved * loop.displacement, load * loop.load, marker="o", markersize=2.2, **line(0))
        panel.set_xlabel(f"{words}  [{moved_unit}]")
        panel.set_ylabel(f"{name}  [{load_unit}]")
        area = f"area {with_unit(loop.work, unit['energy'], 4)}" if len(loop.load) > STRAIGHT else NO_AREA
        panel.set_title(area, fontsize=8.5)
    heading = f"cycle from corner {cycle.first:,} to {cycle.last:,}"
    add_heading(figure, title, heading)
    return figure
