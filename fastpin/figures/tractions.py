"""Figures of states: pressure, shear traction, and zones of stick and slip round the hole."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from fastpin.figures.states import Frame, drawn_states, name_states, state_lines
from fastpin.figures.style import MAX_NAMED, Line, check_figure_text, draw_and_save
from fastpin.kernels.status import SLIP_NEGATIVE, SLIP_POSITIVE
from fastpin.model.units import scaled, units
from fastpin.states.quantities import load_point
from fastpin.states.state import State

_SHADE = "0.93"


def plot_tractions(
    states: Sequence[State] | State,
    path: str | Path | None = None,
    title: str = "",
    width: float = 6.7,
    dpi: float = 200.0,
) -> Figure:
    """Draw pressure and shear traction round the hole.

    The upper panel shows the pressure N. The middle panel shows the shear traction T on the pin, counter-clockwise
    positive, and its bounds +-mu N as thin lines. The lower panel shows where each state slips (shaded) or sticks
    (solid). A single state has no lower panel; its slip zones are shaded in the panels above. Without friction there is
    only the upper panel. Angles are in degrees from the bottom of the hole, counter-clockwise positive.

    Up to :data:`~fastpin.figures.style.MAX_NAMED` states are named in the legend. More states are coloured by their
    place in the history, without a lower panel. Of more than :data:`~fastpin.figures.states.MAX_LINES` states an even
    choice is drawn.

    Parameters
    ----------
    states : State, Result or sequence of State
        Of one problem and on one grid.
    path : path, optional
        Also save the figure; the suffix chooses the format.
    title : str
    width : float
        Width in inches.
    dpi : float
        Dots per inch of a saved bitmap.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there is no state, an argument is out of range, the figure's format is unknown, or the file can't be written.
    """
    inches = check_figure_text(title, width)
    drawn = drawn_states(states)
    return draw_and_save(lambda: _draw(drawn, title, inches), path, dpi)


def _draw(states: list[State], title: str, width: float) -> Figure:
    problem = states[0].problem
    named = len(states) <= MAX_NAMED
    lines = state_lines(states)
    zones = named and not problem.frictionless and len(states) > 1
    strip = 0.16 * len(states) + 0.15  # inches
    panels = [1.9] if problem.frictionless else [1.9, 1.9]
    heights = [*panels, strip] if zones else panels

    figure = Figure(figsize=(width, sum(heights) + 1.35), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]

    frame = Frame(states)
    unit = units(problem)["traction"]
    factor, label = scaled([float(state.pressure.max()) for state in states], unit)
    label = label.replace("beta*", "β*")
    for index, state in enumerate(states):
        angle, pressure, shear = frame.curves(state)
        axes[0].plot(angle, factor * pressure, **lines[index])
        if not problem.frictionless:
            for sign in (1.0, -1.0) if named else ():
                bound = factor * sign * problem.friction * pressure
                axes[1].plot(angle, bound, color=lines[index]["color"], linewidth=0.5, alpha=0.55, zorder=1)
            axes[1].plot(angle, factor * shear, **lines[index])
    axes[0].set_ylabel(f"pressure  N  [{label}]")
    axes[0].set_ylim(bottom=0.0)
    if not problem.frictionless:
        axes[1].set_ylabel(f"shear  T  [{label}]")
        axes[1].axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
    if len(states) == 1:
        _shade_slip(list(axes), states[0], frame)
    if zones:
        _draw_zones(axes[-1], states, lines, frame)
    for panel in axes:
        panel.grid(True, axis="x", color="0.92", linewidth=0.6)
        panel.set_axisbelow(True)
    axes[-1].set_xlim(*frame.limits)
    axes[-1].xaxis.set_major_locator(MaxNLocator(nbins=9, steps=[1, 1.5, 2, 3, 4.5, 5, 6, 9, 10]))
    axes[-1].set_xlabel("angle from the bottom of the hole, counter-clockwise  [deg]")
    figure.align_ylabels(axes)
    name_states(figure, list(axes), states, title, _styles(states))
    return figure


def _styles(states: list[State]) -> list[Artist]:
    """Return the entries of the legend that hold for all states."""
    styles: list[Artist] = []
    if not states[0].problem.frictionless:
        friction = states[0].problem.friction
        styles.append(Line2D([], [], color="0.5", linewidth=0.5, label=f"±μN,  μ = {friction:g}"))
        if len(states) == 1:
            styles.append(Patch(color=_SHADE, linewidth=0, label="slip"))
        else:
            styles.append(Patch(color="0.35", linewidth=0, label="stick"))
            styles.append(Patch(color="0.35", alpha=0.22, linewidth=0, label="slip, → counter-clockwise"))
    return styles


def _shade_slip(axes: Sequence[Axes], state: State, frame: Frame) -> None:
    for start, stop, _ in state.slip_zones:
        for left, width in frame.place(start, stop):
            for panel in axes:
                panel.axvspan(left, left + width, color=_SHADE, linewidth=0, zorder=-1)


def _draw_zones(panel: Axes, states: list[State], lines: Sequence[Line], frame: Frame) -> None:
    """Draw one row for each state: solid where it sticks, shaded where it slips. Arrows show the pin's direction."""
    for row, state in enumerate(states):
        colour = lines[row]["color"]
        for start, stop, sign in state.slip_zones:
            for left, width in frame.place(start, stop):
                panel.barh(row, width, left=left, height=0.66, color=colour, alpha=0.22, linewidth=0)
                if width > 0.03 * (frame.limits[1] - frame.limits[0]):
                    arrow = {SLIP_POSITIVE: "→", SLIP_NEGATIVE: "←"}.get(int(sign), "")
                    panel.text(left + 0.5 * width, row, arrow, ha="center", va="center", fontsize=7.0, color="0.25")
        for start, stop in state.stick:
            for left, width in frame.place(start, stop):
                panel.barh(row, width, left=left, height=0.66, color=colour, linewidth=0)
    panel.set_ylim(len(states) - 0.45, -0.55)
    panel.set_yticks(range(len(states)), [f"{load_point(state):.4g}" for state in states])
    panel.tick_params(axis="y", length=0)
    panel.set_ylabel("stick, slip")
    panel.spines["left"].set_visible(False)
