"""Names, colours and dashes of the states in a figure."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from fastpin.errors import InputError
from fastpin.figures.style import MAX_NAMED, Line, fitted_legend, line, spread
from fastpin.kernels.status import OPEN
from fastpin.model.angles import AT_TOP, turns_from_bottom
from fastpin.model.checks import as_toml
from fastpin.model.loads import LOAD_KIND, LOADS
from fastpin.model.units import acting_loads, scaled, units
from fastpin.states.quantities import load_point
from fastpin.states.state import State
from fastpin.states.zones import ALL_ROUND

MAX_LINES = 60
"""Most states in a figure. Of more, it shows an even choice."""


def drawn_states(states: Sequence[State] | State) -> list[State]:
    """Return the states that a figure draws, at most :data:`MAX_LINES`.

    Raises
    ------
    InputError
        If there is no state, or the states are not on one grid.
    """
    drawn = [states] if isinstance(states, State) else states
    if not isinstance(drawn, Sequence) or not all(isinstance(state, State) for state in drawn):
        raise InputError("states", f"must be states or a result, not {as_toml(states)}")
    if any(not np.array_equal(state.theta, drawn[0].theta) for state in drawn):
        raise InputError("states", "must all be on one grid")
    if not len(drawn):
        raise InputError("states", "there is no state to plot")
    return [drawn[k] for k in drawn_places(len(drawn))]


def drawn_places(count: int) -> list[int]:
    """Return the indices of the states that a figure draws of `count`: all, or :data:`MAX_LINES` spread evenly."""
    return spread(count, MAX_LINES)


class Frame:
    """The angle axis of a figure. It spans all nodes that touch in some state, and a little more.

    Attributes
    ----------
    order : ndarray of int
        Nodes in the order in which they are drawn. A circle is cut open; its first node then stands at both ends.
    angle : ndarray
        Angles of these nodes, degrees from the bottom, increasing.
    limits : (float, float)
        Ends of the axis, degrees.
    """

    def __init__(self, states: Sequence[State]) -> None:
        grid = states[0].grid
        touched = np.any([state.status != OPEN for state in states], axis=0)
        self.order = np.arange(grid.size)
        if grid.closed and not touched.all():
            # The circle is cut open in the middle of the longest stretch that is open in all states.
            self.order = np.roll(self.order, -_middle_of_longest_gap(touched))
        elif grid.closed:  # cut open at the top
            self.order = np.roll(self.order, -int(np.argmin(np.mod(grid.theta - ALL_ROUND[0] + AT_TOP, 2.0 * math.pi))))
        angle = np.degrees(np.unwrap(grid.theta[self.order])) + 90.0
        if grid.closed:
            self.order = np.append(self.order, self.order[0])
            angle = np.append(angle, angle[0] + 360.0)
        inside = angle[touched[self.order]]
        first, last = (inside[0], inside[-1]) if inside.size else (angle[0], angle[-1])
        turn = 360.0 * turns_from_bottom(math.radians(0.5 * (first + last) - 90.0))
        self.angle = angle - turn
        margin = 0.04 * (last - first) + 1.0
        self.limits = (max(first - margin, angle[0]) - turn, min(last + margin, angle[-1]) - turn)

    def curves(self, state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return angle, pressure and shear in the order of drawing; NaN at open nodes without a closed neighbour."""
        closed = state.status != OPEN
        drawn = closed.copy()
        drawn[1:] |= closed[:-1]
        drawn[:-1] |= closed[1:]
        if state.grid.closed:
            drawn[0] |= closed[-1]
            drawn[-1] |= closed[0]
        pressure = np.where(drawn, state.pressure, np.nan)
        shear = np.where(drawn, state.shear, np.nan)
        return self.angle, pressure[self.order], shear[self.order]

    def place(self, start: float, stop: float) -> list[tuple[float, float]]:
        """Return the parts of an interval, given in rad, that lie on the axis: (first angle, width) in degrees."""
        length = math.degrees(stop - start)
        first = math.degrees(start) + 90.0
        first += 360.0 * math.ceil((self.limits[0] - first - length) / 360.0)
        parts = []
        while first < self.limits[1]:
            left, right = max(first, self.limits[0]), min(first + length, self.limits[1])
            if right > left:
                parts.append((left, right - left))
            first += 360.0
        return parts


def _middle_of_longest_gap(touched: np.ndarray) -> int:
    size = touched.size
    best, middle, run = 0, 0, 0
    for k in range(2 * size):  # twice round: a stretch may cross the seam of the circle
        run = 0 if touched[k % size] else run + 1
        if run > best:
            best, middle = run, k - run // 2
    return middle % size


def name_states(
    figure: Figure, axes: Sequence[Axes], states: Sequence[State], title: str, styles: list[Artist]
) -> None:
    """Add the legend or the colour scale. Loads that are equal in all states stand in the title.

    `styles` are entries of the legend that hold for all states. A single state has no entry of its own.
    """
    loads = [state.load for state in states]
    acting = acting_loads(loads)
    varying = [name for name in acting if any(load[name] != loads[0][name] for load in loads)]
    common = [_load_text(states, 0, name) for name in acting if name not in varying]
    heading = "\n".join(line for line in (title, ",  ".join(common)) if line)
    if heading:
        figure.suptitle(heading, fontsize=9.5, x=0.5, parse_math=False)
    if len(states) > MAX_NAMED:
        bar = figure.colorbar(state_scale(states), ax=list(axes), aspect=40, pad=0.02)
        bar.set_label("load point (1: first corner of the history)")
        bar.ax.yaxis.set_major_locator(MaxNLocator(nbins=8, integer=True))
        bar.outline.set_linewidth(0.5)
        return
    handles: list[Artist] = []
    for index, (state, style) in enumerate(zip(states, state_lines(states), strict=True)):
        parts = ",  ".join(_load_text(states, index, name) for name in varying)
        text = f"{load_point(state):.4g}:  {parts}" if parts else f"{load_point(state):.4g}"
        handles.append(Line2D([], [], label=text, **style))
    handles, columns = _in_columns(handles if len(states) > 1 else [], styles)
    if handles:
        fitted_legend(figure, handles, columns)


def _in_columns(states: list[Artist], styles: list[Artist]) -> tuple[list[Artist], int]:
    """Return legend entries and the number of columns. Blank entries keep states and styles in separate columns."""
    if not states:
        return styles, max(len(styles), 1)
    rows = len(states) if len(states) <= 3 else math.ceil(len(states) / 2)
    columns = [states[k : k + rows] for k in range(0, len(states), rows)]
    if styles:
        columns.append(styles)
    rows = max(len(column) for column in columns)
    blank = Line2D([], [], linestyle="none", label=" ")
    filled = [entry for column in columns for entry in [*column, *[blank] * (rows - len(column))]]
    return filled, len(columns)


def _load_text(states: Sequence[State], index: int, name: str) -> str:
    """Return a load with its unit as text. All loads of one kind have the same unit."""
    same_kind = [state.load[other] for state in states for other in LOADS if LOAD_KIND[other] == LOAD_KIND[name]]
    factor, unit = scaled(same_kind, units(states[0].problem)[LOAD_KIND[name]])
    value = f"{states[index].load[name] * factor:+.4g}".replace("-", "−")
    if states[index].load[name] == 0.0:
        return f"{name} = 0"
    value = value.lstrip("+") if name == "P" else value
    return f"{name} = {value} {unit.replace('beta*', 'β*')}"


def state_lines(states: Sequence[State]) -> list[Line]:
    """Return the style of each state's line: colours and dashes of few states, a scale of colours for many."""
    if len(states) <= MAX_NAMED:
        return [line(k, k) for k in range(len(states))]
    shades = state_scale(states).to_rgba(np.array([load_point(state) for state in states]))
    return [{**line(width=0.9), "color": shade} for shade in shades]


def state_scale(states: Sequence[State]) -> ScalarMappable:
    """Return the scale of colours of many states, by their load points."""
    points = [load_point(state) for state in states]
    # The lightest tenth of the scale can't be seen on white.
    shades = ListedColormap(mpl.colormaps["viridis"](np.linspace(0.9, 0.0, 256)))
    return ScalarMappable(Normalize(min(points), max(points)), shades)
