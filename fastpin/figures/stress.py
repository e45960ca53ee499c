"""Figures of stresses: round hole and pin, along outlines, below a place of the edge, and as a map of both bodies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.lines import Line2D
from matplotlib.patheffects import Normal, Stroke

from fastpin.assess.outputs import Curve
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import HOOP, DrawnStates, Subject, name_states, of_states, state_lines
from fastpin.figures.style import caption, draw_zero, line, loads_text, point_text, points_text, quantity
from fastpin.model.checks import choice, instance
from fastpin.model.points import BODIES, Body, bodies_of, edge_body
from fastpin.model.units import named_loads, units
from fastpin.report.stress import FIELDS, UTILIZATION, depth_curves, field_curves, hoop_curves, outline_curves
from fastpin.solver.result import Result
from fastpin.states.choice import StateChoice
from fastpin.states.margins import part_of
from fastpin.states.quantities import load_point, point_name
from fastpin.states.state import State

LEVELS = 15
"""Colours of a map, about."""

FARTHEST = 0.995
"""Part of the points of a map whose values lie within the colours. The values beyond take the end colours."""


def hoop_plot(subject: Subject, states: StateChoice = None, body: str = "both") -> Plot:
    """Draw the hoop stress round the hole, of the plate at the seat of a bush, and round the pin, a panel each.

    A dot marks the largest hoop stress of each state; an open dot if the nodes do not resolve the peak. A dotted line
    is the part that the assembly leaves before any load, if something is pressed. Angles are in degrees from the bottom
    of the hole, counter-clockwise positive. Tension is positive. The `body` is "plate", "seat", "pin", or "both" for
    all that the problem has, without rigid bodies. A rigid one raises :class:`InputError`. See
    :func:`fastpin.plot_tractions` for the `states`.
    """
    drawn = subject.states(states, extremes=HOOP[choice("body", body, tuple(HOOP))])
    curves = hoop_curves(drawn, body)
    seat = ", the seat of the bush" if "seat" in bodies_of(drawn[0].problem) else ""
    return Plot(
        lambda look: _draw_hoop(look, drawn, curves),
        curves,
        f"Line charts of the hoop stress over the angle round the hole, at load points {points_text(drawn)}.",
        f"Hoop stress round the hole{seat} and the pin. Dots mark the largest value of each state.",
        drawn.notes,
    )


plot_hoop_stress = plotter("plot_hoop_stress", hoop_plot, of_states)


def _draw_hoop(look: Look, states: DrawnStates, curves: Sequence[Curve]) -> Sheet:
    bodies = list(dict.fromkeys(curve.parameters["body"] for curve in curves))
    sheet = look.sheet([2.1] * len(bodies), extra=1.5)
    axes = sheet.axes
    sheet.grid()
    unit, lines = units(states[0].problem)["traction"], state_lines(states)
    column, before = f"hoop stress [{unit.name}]", f"hoop stress of the assembly [{unit.name}]"
    factor, label = unit.printed.scale([float(np.abs(curve[column]).max()) for curve in curves])
    open_dots = False
    for body, panel in zip(bodies, axes[:, 0], strict=True):
        mine = [curve for curve in curves if curve.parameters["body"] == body]
        for state, curve, style in zip(states, mine, lines, strict=True):
            panel.plot(curve["angle [deg]"], factor * curve[column], **style)
            peak = state.peak_hoop_stress(body)
            open_dots = open_dots or not peak.resolved
            face = style["color"] if peak.resolved else "white"
            angle = math.degrees(peak.angle) + 90.0
            panel.plot(
                angle,
                factor * unit.factor * peak.value,
                "o",
                markersize=4.0,
                color=style["color"],
                markerfacecolor=face,
            )
        if before in mine[0].columns:
            panel.plot(mine[0]["angle [deg]"], factor * mine[0][before], color="0.4", linestyle=":", linewidth=1.2)
        draw_zero(panel)
        words = edge_body(states[0].problem, body).replace("plate at", "plate\nat")
        panel.set_ylabel(quantity(f"hoop stress of the {words}", label))
    sheet.go_round()
    styles: list[Artist] = [_dot("largest of each state", "0.4")]
    if before in curves[0].columns:
        styles.append(
            Line2D([], [], color="0.4", linestyle=":", linewidth=1.2, label="of the assembly, before any load")
        )
    if open_dots:
        styles.append(_dot("largest, not resolved by the nodes", "white"))
    name_states(sheet, states, [look.title], styles)
    return sheet


def _dot(label: str, face: str) -> Line2D:
    return Line2D([], [], linestyle="none", marker="o", markersize=4.0, color="0.4", markerfacecolor=face, label=label)


def outline_plot(subject: Subject, states: StateChoice = None) -> Plot:
    """Draw the hoop stress along the outline, counter-clockwise, and then along the further holes.

    A dot marks the largest value of each state. Tension is positive. A plate without an outline raises
    :class:`InputError`. See :func:`fastpin.plot_tractions` for the `states`.
    """
    drawn = subject.states(states, extremes=(("peak_hoop_outline", "largest"),))
    curves = outline_curves(drawn)
    left_out = part_of(drawn[0].problem, "plate")
    return Plot(
        lambda look: _draw_outline(look, drawn, curves),
        curves,
        f"Line chart of the hoop stress along the outline of the plate, at load points {points_text(drawn)}.",
        f"Hoop stress along the outline of the plate{f', {left_out}' if left_out else ''}. Dots mark the largest value "
        "of each state.",
        drawn.notes,
    )


plot_outline = plotter("plot_outline", outline_plot, of_states)


def _draw_outline(look: Look, states: DrawnStates, curves: Sequence[Curve]) -> Sheet:
    sheet = look.sheet([2.6], extra=1.5)
    panel, unit, edges = sheet.axes[0, 0], units(states[0].problem), curves[0]["edge"]
    along, hoop = (next(name for name in curves[0].columns if name.startswith(word)) for word in ("along", "hoop"))
    factor, label = unit["traction"].printed.scale([float(np.abs(curve[hoop]).max()) for curve in curves])
    length, length_label = unit["length"].printed.scale([float(curves[0][along].max())])
    sides = [list(group) for _, group in groupby(range(edges.size), lambda k: edges[k])]
    for state, curve, style in zip(states, curves, state_lines(states), strict=True):
        x, y = length * curve[along], factor * curve[hoop]
        for side in sides:
            panel.plot(x[side], y[side], **style)
        found, peak = state.outline_hoop_stress(), state.outline_peak
        top = int(np.argmin(np.hypot(found.x - peak.x, found.y - peak.y)))
        panel.plot(x[top], y[top], "o", markersize=4.0, color=style["color"])
    for side in sides:
        start, end = (length * curves[0][along][k] for k in (side[0], side[-1]))
        panel.axvline(start, color="0.8", linewidth=0.6, zorder=0)
        panel.text(
            0.5 * (start + end), 0.98, edges[side[0]], rotation=90.0, ha="center", va="top", fontsize=7.0, color="0.4",
            transform=panel.get_xaxis_transform(), parse_math=False,
        )  # fmt: skip
    draw_zero(panel)
    panel.set_xlabel(quantity("along the outline, counter-clockwise, then the further holes", length_label))
    panel.set_ylabel(quantity("hoop stress", label))
    dot = Line2D([], [], linestyle="none", marker="o", markersize=4.0, color="0.4", label="largest of each state")
    name_states(sheet, states, [look.title], [dot])
    return sheet


def profile_plot(
    subject: Subject,
    states: StateChoice = None,
    body: Body = "plate",
    angle: float | None = None,
    depth: float | None = None,
) -> Plot:
    """Draw radial, hoop, shear and von Mises stress below a place of the edge of a body.

    The `angle` is in degrees from the bottom. Unless given, it is the angle of each state's largest hoop stress. The
    largest `depth` is in units of the hole's radius. Unless given, it is 0.5 in the pin and 1 elsewhere, but no more
    than the wall, or than is known of a compliance. A rigid `body` raises :class:`InputError`. See
    :func:`fastpin.plot_tractions` for the `states`.
    """
    drawn = subject.states(states, extremes=HOOP[choice("body", body, BODIES)])
    curves = depth_curves(drawn, body, angle, depth)
    return Plot(lambda look: _draw_profile(look, drawn, curves), curves, notes=drawn.notes)


plot_stress_profile = plotter("plot_stress_profile", profile_plot, of_states)


def _draw_profile(look: Look, states: DrawnStates, curves: Sequence[Curve]) -> Sheet:
    sheet = look.sheet([2.0, 2.0], columns=2, extra=1.5)
    axes = sheet.axes
    sheet.grid()
    unit = units(states[0].problem)
    radius = unit["length"].factor * states[0].problem.hole_radius
    depth, *columns = curves[0].columns
    factor, label = unit["traction"].printed.scale(
        [float(np.abs(curve[name]).max()) for curve in curves for name in columns]
    )
    for name, panel in zip(columns, axes.flat, strict=True):
        for curve, style in zip(curves, state_lines(states), strict=True):
            panel.plot(curve[depth] / radius, factor * curve[name], **style)
        draw_zero(panel)
        panel.set_ylabel(quantity(name.partition(" [")[0], label))
        panel.set_xlim(left=0.0)
    for panel in axes[-1]:
        panel.set_xlabel("depth / radius of the hole")
    sheet.figure.align_ylabels(axes)
    places = sorted({round(curve.parameters["angle [deg]"], 2) for curve in curves})
    where = f"at {places[0]:.2f} deg" if len(places) == 1 else "at the largest hoop stress of each state"
    edge = edge_body(states[0].problem, curves[0].parameters["body"])
    name_states(sheet, states, [look.title, f"below the edge of the {edge}, {where}"], [])
    return sheet


def last_state(state: State | Result) -> Subject:
    """The state, or the last one of a result."""
    return Subject(state if isinstance(state, Result) else instance("state", state, State, "a State"))


def map_plot(
    subject: Subject, states: StateChoice = None, component: str = "von_mises", body: str = "both", extent: float = 2.0
) -> Plot:
    """Draw a map of one component of the stress in pin and plate.

    The hole's edge is a thin line, and the contact a thick one. The clearance is too narrow to be seen. Under a point
    force at the pin's centre the stress is infinite; the values near the force do not set the colours.

    Parameters
    ----------
    state : State or Result
    states : str, number, sequence of numbers or slice, optional
        See :func:`fastpin.plot_tractions`. The map shows the last one of them; unless given, of the result.
    component : str
        A name of :data:`fastpin.report.stress.FIELDS`.
    body : {"both", "plate", "pin"}
        "both" leaves out a rigid body.
    extent : float
        Outer radius of the map, in units of the hole's radius.
    """
    drawn = subject.states("last" if states is None else states)
    state = drawn[-1]
    curves = field_curves(state, component, body, extent)
    words = FIELDS[component]
    point = f"load point {point_name(load_point(state))}: {named_loads(state.problem, state.load)}"
    doubt = " The force acts at a point in the pin's centre: stress round it is no margin." if _has_point(state) else ""
    return Plot(
        lambda look: _draw_field(look, state, curves, component),
        curves,
        f"Map of the {words} in {'plate' if component == UTILIZATION else 'pin and plate'} at {point}.",
        f"{words[0].upper()}{words[1:]} at {point}. The thick line is the contact, white where it slips.{doubt}",
        drawn.notes,
        width=5.2,
        bitmap=True,
    )


plot_stress_field = plotter("plot_stress_field", map_plot, last_state)


def _has_point(state: State) -> bool:
    """Whether the force acts at a point in the pin, where the stress is infinite."""
    return not state.problem.pin_body.bore_radius and state.problem.pin_load == "centre"


def _draw_field(look: Look, state: State, curves: Sequence[Curve], component: str) -> Sheet:
    sheet = look.sheet([0.9 * look.width], extra=0.0)
    panel = sheet.axes[0, 0]
    unit = units(state.problem)
    radius = unit["length"].factor * state.problem.hole_radius
    distance, angle, value = curves[0].columns
    # The infinite stress at a point force at the pin's centre does not set the colours.
    nearest = 0.3 * radius if _has_point(state) else 0.0
    every = np.concatenate([curve[value][curve[distance] >= nearest] for curve in curves])
    low, high = np.nanquantile(every, [1.0 - FARTHEST, FARTHEST])
    factor, label = (1.0, "") if component == UTILIZATION else unit["traction"].printed.scale([low, high])
    signed = low < -0.02 * max(high, -low)
    levels = _levels(factor * low, factor * high)
    beyond = "both" if factor * min(float(np.nanmin(curve[value])) for curve in curves) < levels[0] else "max"
    for curve in curves:
        around = int(np.flatnonzero(np.diff(curve[distance]) != 0.0)[0]) + 1
        r, theta, z = (np.ma.masked_invalid(curve[name].reshape(-1, around)) for name in (distance, angle, value))
        x, y = (r / radius * turn(np.radians(theta - 90.0)) for turn in (np.cos, np.sin))
        norm = TwoSlopeNorm(0.0, min(levels[0], -1e-12), max(levels[-1], 1e-12)) if signed else None
        colours = panel.contourf(
            x, y, factor * z, levels=levels, norm=norm, cmap="RdBu_r" if signed else "viridis_r", extend=beyond
        )
        panel.contour(x, y, factor * z, levels=levels[:: max(1, LEVELS // 5)], colors="0.25", linewidths=0.3)
    _draw_edges(panel, state, max(float(curve[distance].max()) for curve in curves) / radius)
    handles = _draw_contact(panel, state)
    bar = sheet.figure.colorbar(colours, ax=panel, shrink=0.85, aspect=30)
    bar.set_label(quantity(FIELDS[component], label))
    panel.set_aspect("equal")
    panel.set_xlabel("x / radius of the hole")
    panel.set_ylabel("y / radius of the hole")
    heading = f"load point {point_text(state)}: {loads_text(state.problem, state.load)}"
    sheet.head(look.title, heading, caption=caption(state.problem, [state]))
    sheet.legend(handles, max(len(handles), 1))
    return sheet


def _draw_edges(panel: Axes, state: State, most: float) -> None:
    """Draw the edges of a plate of any outline up to a radius, and leave out what is beyond them."""
    geometry = state.problem.plate_body.lug.geometry
    edges = [] if geometry is None else [state.problem.joint.seat_ratio * edge for edge in geometry.edge_lines]
    for edge in edges:
        seen = np.where(np.abs(edge) <= 1.01 * most, edge, math.nan)
        panel.plot(seen.real, seen.imag, color="0.2", linewidth=0.6)
    if edges:
        every = np.concatenate(edges)
        ends = [(max(part.min(), -most), min(part.max(), most)) for part in (every.real, every.imag)]
        half = 0.52 * max(high - low for low, high in ends)
        x, y = (0.5 * (low + high) for low, high in ends)
        panel.set(xlim=(x - half, x + half), ylim=(y - half, y + half))


def _levels(low: float, high: float) -> np.ndarray:
    """Round values from `low` to `high`, about :data:`LEVELS`; from 0 to 1 if all is zero."""
    span = high - low or abs(high) or 1.0
    step = 10.0 ** math.floor(math.log10(span / LEVELS))
    step *= next(part for part in (1.0, 2.0, 2.5, 5.0, 10.0) if span / (part * step) <= LEVELS)
    first, last = math.floor(low / step), math.ceil(high / step)
    return step * np.arange(first, max(last, first + 1) + 1)


def _draw_contact(panel: Axes, state: State) -> list[Artist]:
    """Draw the edge of the hole, and the contact as a thick line: solid where it sticks, white-cored where it slips.

    Return the entries of the legend.
    """
    sticks: Any = {**line(5, 0, 3.0), "solid_capstyle": "butt"}
    slips: Any = {"color": "white", "linewidth": 1.4, "solid_capstyle": "butt"}
    turn = np.linspace(0.0, 2.0 * math.pi, 361)
    panel.plot(np.cos(turn), np.sin(turn), color="0.2", linewidth=0.6)
    for start, stop in state.contact:
        part = np.linspace(start, stop, 181)
        panel.plot(np.cos(part), np.sin(part), **sticks)
    for start, stop, _ in state.slip_zones:
        part = np.linspace(start, stop, 91)
        panel.plot(np.cos(part), np.sin(part), **slips)
    handles: list[Artist] = [Line2D([], [], label="contact sticks", **sticks)] if state.stick else []
    if state.slip_zones:
        border = [Stroke(linewidth=3.0, foreground=sticks["color"]), Normal()]
        handles.append(Line2D([], [], label="contact slips", path_effects=border, **slips))
    return handles
