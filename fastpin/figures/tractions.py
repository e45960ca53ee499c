"""Figures of states: pressure, shear traction, and zones of stick and slip round the hole."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from fastpin.assess.outputs import Curve
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.sketch import draw_sketch, load_ranges
from fastpin.figures.states import DrawnStates, Frame, Subject, name_states, of_states, state_lines
from fastpin.figures.style import ANGLE, Line, is_bonded, point_text, points_text, quantity
from fastpin.kernels.status import SLIP_NEGATIVE, SLIP_POSITIVE
from fastpin.model import checks, points
from fastpin.model.units import units
from fastpin.states.choice import StateChoice
from fastpin.states.curves import friction_along
from fastpin.states.quantities import load_point
from fastpin.states.state import State

_SHADE = "0.9"

_BAND = 0.3
"""Opacity of the bands of error bars. They are darker than the shade of slip, also in grey."""

_BAR = 0.46
"""Height of the bars of a zone, in parts of a row. The arrows of narrow zones stand between the bars."""


def tractions_plot(subject: Subject, states: StateChoice = None, sketch: bool = False, bars: bool = False) -> Plot:
    """Draw pressure and shear traction round the hole.

    The upper panel shows the pressure N. The middle panel shows the shear traction T on the pin, counter-clockwise
    positive, and its bounds +-mu N as thin lines. The lower panel shows where each state slips (light) or sticks
    (solid). Arrows show how the pin slips. A single state has no lower panel; its slip zones are shaded. Angles are in
    degrees from the bottom of the hole, counter-clockwise positive. At most eight states are drawn.

    Parameters
    ----------
    result : State, Result or sequence of State
        Of one problem and on one grid.
    states : str, number, sequence of numbers or slice, optional
        "last", "cycle" (the last one), "all", or load points, which count from 1 as in tables: 2, [2, 3.5] or "2,3.5".
        A slice chooses places in the result. Unless given, all states of a short history, or the last cycle of a long
        one.
    sketch : bool
        Whether a small sketch of the joint with its loads stands beside the pressure.
    bars : bool
        Whether a light band shows the error bars of each curve; see :mod:`fastpin.states.error_bars`.

    Raises
    ------
    InputError
        If there is no such state, or `bars` are asked for but the states have none.
    """
    drawn = subject.states(states)
    checks.true_or_false("sketch", sketch)
    curves = traction_curves(drawn, checks.true_or_false("bars", bars))
    return Plot(
        lambda look: _draw(look, drawn, curves, sketch, bars),
        curves,
        f"Line charts of contact pressure and shear traction over the angle round the hole, at load points "
        f"{points_text(drawn)}. Bars below show where each state sticks and slips.",
        "Pressure N and shear traction T on the pin, counter-clockwise positive; below, stick and slip of each state.",
        drawn.notes,
    )


plot_tractions = plotter("plot_tractions", tractions_plot, of_states)


def _draw(look: Look, states: DrawnStates, curves: Sequence[Curve], sketch: bool, bars: bool) -> Sheet:
    frictionless = states[0].problem.frictionless
    lines = state_lines(states)
    zones = not frictionless and len(states) > 1
    panels = [1.9] if frictionless else [1.9, 1.9]
    strip = max(0.23 * len(states) + 0.15, 0.75)  # the words beside the rows need the least height
    sheet = look.sheet([*panels, strip] if zones else panels, extra=1.6, sharex=True)
    axes, frame = sheet.axes[:, 0], Frame(states)
    _draw_curves(list(axes), states, curves, lines)
    if len(states) == 1:
        _shade_slip(list(axes), states[0], frame)
    if zones:
        _draw_zones(axes[-1], states, lines, frame)
    sheet.grid("x")
    frame.scale(axes[-1])
    axes[-1].set_xlabel(ANGLE)
    for panel in axes[:-1]:
        panel.tick_params(labelbottom=False)
    sheet.figure.align_ylabels(list(axes))
    if sketch:
        ranges = load_ranges(states)
        beside = axes[0].inset_axes((1.02, -0.05, 0.36, 1.1))
        draw_sketch(states[0].problem, ranges, Look(ax=beside), words=False)
    name_states(sheet, states, [look.title], _styles(states, bars))
    return sheet


def _draw_curves(axes: Sequence[Axes], states: DrawnStates, curves: Sequence[Curve], lines: Sequence[Line]) -> None:
    """Draw the pressure and, with friction, the shear traction of all states, with the bands of their bars if any."""
    problem = states[0].problem
    of_traction = units(problem)["traction"]
    factor, unit = of_traction.printed.scale([of_traction.factor * float(state.pressure.max()) for state in states])
    for state, curve, style in zip(states, curves, lines, strict=True):
        angle, pressure, shear, *bars = curve.columns.values()
        for panel, traction, bar in zip(axes, (pressure, shear), bars, strict=False):
            band = factor * (traction - bar), factor * (traction + bar)
            panel.fill_between(angle, *band, color=style["color"], alpha=_BAND, linewidth=0.0, zorder=1)
        axes[0].plot(angle, factor * pressure, **style)
        if not problem.frictionless:
            friction = friction_along(state, angle)
            for sign in () if is_bonded(problem) else (1.0, -1.0):
                bound = factor * sign * friction * pressure
                axes[1].plot(angle, bound, color=style["color"], linewidth=0.5, alpha=0.55, zorder=1)
            axes[1].plot(angle, factor * shear, **style)
    axes[0].set_ylabel(quantity("pressure N", unit))
    axes[0].set_ylim(bottom=0.0)
    if not problem.frictionless:
        axes[1].set_ylabel(quantity("shear traction T", unit))
        axes[1].axhline(0.0, color="0.6", linewidth=0.6, zorder=0)


def traction_curves(states: DrawnStates, bars: bool = False) -> list[Curve]:
    """The drawn curves of these states, with NaN between contact zones.

    Columns: the angle in degrees from the bottom, increasing, pressure and shear traction in Pa or F/R, and with `bars`
    the error bars of both. The values follow the fits at edges and borders; the nodal values are in the result.

    Raises
    ------
    InputError
        If `bars` are asked for, and a state has none.
    """
    unit, frame, curves = units(states[0].problem)["traction"], Frame(states), []
    for state in states:
        angle, pressure, shear = frame.curves(state)
        columns = {"angle [deg]": angle} | unit.column("pressure", pressure) | unit.column("shear", shear)
        if bars:
            of_pressure, of_shear = _bars_of_curves(state, angle)
            columns |= unit.column("pressure bar", of_pressure) | unit.column("shear bar", of_shear)
        curves.append(Curve({"load point": load_point(state)}, columns))
    return curves


def _bars_of_curves(state: State, angle: np.ndarray) -> np.ndarray:
    """The error bars of both curves of a state, shape (2, m). NaN where the angle is NaN."""
    if state.error_bars is None:
        raise InputError(
            "bars", "needs states with error bars: fastpin run CASE --error-bars, or solve(..., error_bars=True)"
        )
    found, known = np.full((2, angle.size), np.nan), np.isfinite(angle)
    found[:, known] = state.error_bars.of_curves(np.radians(angle[known] - 90.0))
    return found


def _styles(states: DrawnStates, bars: bool) -> list[Artist]:
    """Return the entries of the legend that hold for all states."""
    styles: list[Artist] = []
    if bars:
        styles.append(Patch(color="0.35", alpha=_BAND, linewidth=0, label="band: error bars of the curves"))
    if not states[0].problem.frictionless:
        if not is_bonded(states[0].problem):
            styles.append(Line2D([], [], color="0.5", linewidth=0.5, label="thin: bounds ±μN of T"))
        if len(states) == 1:
            styles.append(Patch(color=_SHADE, linewidth=0, label="slip"))
        else:
            styles.append(Patch(color="0.35", linewidth=0, label="dark: stick"))
            styles.append(Patch(color="0.35", alpha=0.22, linewidth=0, label="light: slip"))
        styles.append(Line2D([], [], linestyle="none", marker=r"$→$", markersize=8.0, color="0.25",
                             label=f"{points.owner_of(states[0].problem, 'pin')} slips counter-clockwise"))  # fmt: skip
    return styles


def _shade_slip(axes: Sequence[Axes], state: State, frame: Frame) -> None:
    """Shade the slip zones of a state. Arrows at the top show the pin's direction."""
    for start, stop, sign in state.slip_zones:
        for left, width in frame.place(start, stop):
            for panel in axes:
                panel.axvspan(left, left + width, color=_SHADE, linewidth=0, zorder=-1)
            _write_arrow(axes[0], left + 0.5 * width, 0.9, sign, axes[0].get_xaxis_transform(), above=True)


def _draw_zones(panel: Axes, states: DrawnStates, lines: Sequence[Line], frame: Frame) -> None:
    """Draw one row for each state: solid where it sticks, light where it slips."""
    for row, state in enumerate(states):
        colour = lines[row]["color"]
        for start, stop in state.stick:
            for left, width in frame.place(start, stop):
                panel.barh(row, width, left=left, height=_BAR, color=colour, linewidth=0)
        for start, stop, sign in state.slip_zones:
            for left, width in frame.place(start, stop):
                panel.barh(row, width, left=left, height=_BAR, color=colour, alpha=0.22, linewidth=0)
                narrow = width < 0.03 * (frame.limits[1] - frame.limits[0])
                _write_arrow(panel, left + 0.5 * width, row - 0.5 * _BAR * narrow, sign, panel.transData, above=narrow)
    panel.set_ylim(len(states) - 0.45, -0.75)
    panel.set_yticks(range(len(states)), [point_text(state) for state in states])
    panel.tick_params(axis="y", length=0, labelsize=7.5)
    panel.set_ylabel("load point")
    panel.spines["left"].set_visible(False)


def _write_arrow(panel: Axes, x: float, y: float, sign: int, transform: Any, above: bool) -> None:
    """Write an arrow in a zone: the direction in which the pin slips over the plate.

    Above a narrow zone a stroke under the arrow points at the zone.
    """
    arrow = {SLIP_POSITIVE: "→", SLIP_NEGATIVE: "←"}.get(int(sign), "")
    stroke = {"arrowstyle": "-", "linewidth": 0.7, "color": "0.15", "shrinkA": 0, "shrinkB": 0}
    panel.annotate(
        arrow, (x, y), xycoords=transform, xytext=(0.0, 2.5 if above else 0.0),
        textcoords="offset points", ha="center", va="bottom" if above else "center", fontsize=7.0, color="0.15",
        arrowprops=stroke if above else None,
        annotation_clip=False,
    )  # fmt: skip
