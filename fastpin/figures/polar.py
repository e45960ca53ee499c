"""The tractions round the hole, as a picture of the hole: pressure and shear as heights over the circle."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from fastpin.assess.outputs import Curve, write_csv
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import DrawnStates, name_states, state_lines
from fastpin.figures.subjects import InMemory, Subject
from fastpin.figures.tractions import traction_curves
from fastpin.figures.words import quantity, shown_unit
from fastpin.model.laminate import Laminate
from fastpin.model.units import units
from fastpin.states.choice import StateChoice

HEIGHT = 0.9
"""Height of the largest traction over the circle, in radii of the hole."""

PLIES = "0.6"
"""Colour of a line in the direction of a ply."""

RINGS = 2
"""Circles of round values, about."""


def polar_plot(subject: Subject, states: StateChoice = None) -> Plot:
    """Draw the tractions over the circle of the hole, as they lie in space.

    The left panel shows the pressure, outwards from the hole. The right panel shows the shear traction on the pin:
    outwards where it acts counter-clockwise, inwards where it acts clockwise. Without friction there is only the
    pressure. See :func:`fastpin.plot_tractions` for the `states`.
    """
    drawn = subject.states(states)
    curves = traction_curves(drawn)
    return Plot(lambda look: _draw(look, drawn, curves), partial(write_csv, curves), notes=drawn.notes)


plot_polar = plotter("plot_polar", polar_plot, InMemory)


def _draw(look: Look, states: DrawnStates, curves: Sequence[Curve]) -> Sheet:
    problem = states[0].problem
    columns = 1 if problem.frictionless else 2
    sheet = look.sheet([0.5 * look.width], columns=columns, extra=1.3)
    unit = units(problem)["traction"]
    angle, *tractions = curves[0].columns
    words = ("pressure N", "shear traction T on the pin")
    for kind, panel in enumerate(sheet.axes[0]):
        values = [curve[tractions[kind]] for curve in curves]
        largest = max(float(np.nanmax(np.abs(each), initial=0.0)) for each in values)
        factor, label = unit.scale([largest])
        height = HEIGHT / (factor * largest) if largest > 0.0 else 0.0
        if kind == 1:
            height *= 0.6  # the shear needs room inwards too
        _draw_circle(panel, factor * largest, height, label, both=kind == 1)
        for curve, each, style in zip(curves, values, state_lines(states), strict=True):
            x, y = _over_circle(curve[angle], height * factor * each)
            panel.plot(x, y, **style)
        panel.set_xlabel(quantity(words[kind], label))
    styles: list[Artist] = [Line2D([], [], color="0.2", linewidth=1.0, label="edge of the hole")]
    laminate = problem.joint.hole.laminate
    if laminate is not None and laminate.plies:
        for panel in sheet.axes[0]:
            _draw_plies(panel, laminate)
        styles.append(Line2D([], [], color=PLIES, linewidth=0.8, label="directions of the plies"))
    if columns == 2:
        styles.append(Line2D([], [], linestyle="none", marker=r"$↑$", markersize=7.0, color="0.3",
                             label="T outwards: counter-clockwise"))  # fmt: skip
    name_states(sheet, states, [look.title], styles)
    return sheet


def _draw_plies(panel: Axes, laminate: Laminate) -> None:
    """Draw lines in the directions of the plies, and the angles of the plies beside them."""
    for angle in sorted({angle for _, angle in laminate.plies}):
        along = cmath.rect(0.4, laminate.axis + math.radians(angle))  # radii of the hole
        panel.plot([-along.real, along.real], [-along.imag, along.imag], color=PLIES, linewidth=0.8)
        text = f"{angle:g}°".replace("-", "−")
        panel.text(1.2 * along.real, 1.2 * along.imag, text, color="0.3", fontsize=6.0, ha="center", va="center")


def _over_circle(angle: np.ndarray, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of points at some heights over the circle. Angles are in degrees from the bottom."""
    theta = np.radians(angle - 90.0)
    return (1.0 + height) * np.cos(theta), (1.0 + height) * np.sin(theta)


def _draw_circle(panel: Axes, largest: float, height: float, label: str, both: bool) -> None:
    """Draw the hole, circles of round values on one side or on both, and the angles."""
    panel.set_aspect("equal")
    panel.set_xticks([])
    panel.set_yticks([])
    for spine in panel.spines.values():
        spine.set_visible(False)
    turn = np.linspace(0.0, 2.0 * math.pi, 361)
    outer = 1.0 + (0.6 if both else 1.0) * HEIGHT
    for value in _round_values(largest):
        for sign in (1.0, -1.0) if both else (1.0,):
            radius = 1.0 + sign * value * height
            panel.plot(radius * np.cos(turn), radius * np.sin(turn), color="0.85", linewidth=0.6, zorder=0)
            text = f"{sign * value:g}".replace("-", "−")
            x, y = _over_circle(np.array([157.5]), np.array([radius - 1.0]))  # few joints touch at this angle
            halo = [withStroke(linewidth=2.0, foreground="white")]  # hides less of the curves than a box
            style: Any = {"fontsize": 6.5, "color": "0.25", "ha": "center", "va": "center", "path_effects": halo}
            panel.text(x[0], y[0], f"{text} {shown_unit(label)}" if sign > 0.0 else text, **style)
    panel.plot(np.cos(turn), np.sin(turn), color="0.2", linewidth=1.0, zorder=1)
    for degrees in range(-135, 181, 45):
        x, y = _over_circle(np.array([degrees, degrees]), np.array([outer - 1.0, outer - 0.95]))
        panel.plot(x, y, color="0.6", linewidth=0.7)
        far = 1.14 * outer / math.hypot(x[1], y[1])
        panel.text(far * x[1], far * y[1], f"{degrees}°".replace("-", "−"), ha="center", va="center", fontsize=7.0)
    panel.set_xlim(-1.25 * outer, 1.25 * outer)
    panel.set_ylim(-1.25 * outer, 1.25 * outer)


def _round_values(largest: float) -> list[float]:
    """Round values up to the largest one, about :data:`RINGS`; none if it is 0."""
    if largest == 0.0:
        return []
    step = 10.0 ** math.floor(math.log10(largest / RINGS))
    step *= max(part for part in (1.0, 2.0, 5.0) if part * step <= largest / RINGS)
    return [k * step for k in range(1, int(largest / step) + 1)]
