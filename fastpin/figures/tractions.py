"""Figures. Only this module and sweepplot.py import matplotlib; they keep no global state and need no display."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from fastpin.errors import InputError
from fastpin.files import check_writable, replacing
from fastpin.loading import LOADS
from fastpin.report import LOAD_KIND, acting_loads, load_point, scaled, units
from fastpin.state import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, Result, State, series

# Okabe and Ito's colours, distinct for all kinds of colour vision, without the yellow: too light for a line.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#000000")
_DASHES: tuple[tuple[int, tuple[float, ...]], ...] = (
    (0, ()),
    (0, (5.0, 1.6)),
    (0, (1.2, 1.2)),
    (0, (5.0, 1.4, 1.2, 1.4)),
    (0, (8.0, 2.0)),
    (0, (3.0, 1.2, 1.0, 1.2, 1.0, 1.2)),
)
_SHADE = "0.93"
MAX_NAMED = len(_COLOURS)
"""Up to so many states are drawn with a legend; more get a colour scale."""
MAX_LINES = 60

_STYLE: Any = {
    "font.size": 9.0,
    "font.family": "sans-serif",
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "mathtext.default": "regular",
    "svg.fonttype": "none",
}


def plot_tractions(
    states: Sequence[State] | State,
    path: str | Path | None = None,
    title: str = "",
    width: float = 6.7,
    dpi: float = 200.0,
) -> Figure:
    """Pressure and shear traction round the hole.

    The upper panel shows the pressure N, the middle one the shear traction T on the pin (counter-clockwise
    positive) within its bounds +-mu N (thin), the lower one where a state slips (shaded) or sticks (solid).
    Angles are in degrees from the bottom of the hole, counter-clockwise positive. More than
    :data:`MAX_NAMED` states are coloured by their place in the history instead of being named, and the lower
    panel is left out.

    Parameters
    ----------
    states : State, Result or sequence of State
        Of one problem and on one grid.
    path : path, optional
        Also save the figure; its suffix chooses the format.
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
        If there is no state, or the figure's format is unknown.
    """
    shown = [states] if isinstance(states, State) else list(states)
    if not shown:
        raise InputError("states", "there is no state to plot")
    if len(shown) > MAX_LINES:
        shown = [shown[k] for k in spread(len(shown), MAX_LINES)]
    return _drawn(lambda: _draw(shown, title, width), path, dpi)


def _drawn(draw: Callable[[], Figure], path: str | Path | None, dpi: float) -> Figure:
    """The figure that ``draw()`` returns, drawn in the house style, and saved if there is a path."""
    if path is not None:
        _check_format(Path(path))
    with mpl.rc_context(_STYLE):
        figure = draw()
        if path is not None:
            _save(figure, Path(path), dpi)
    return figure


def spread(count: int, most: int) -> list[int]:
    """Places of at most so many of `count` things, evenly spread, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist() if count else []


def plot_cycles(
    result: Result, path: str | Path | None = None, width: float = 6.7, title: str = "", dpi: float = 200.0
) -> Figure:
    """What each cycle of a load history has changed, from its beginning to its end.

    The upper panel shows the largest change of pressure and shear traction, relative to the largest pressure; what has
    changed by rounding only, where the contact is periodic, has no place on its logarithmic scale.
    Below are the energy dissipated in each cycle, and how far the cycles of a block have turned the pin (ratcheting).

    Parameters
    ----------
    result : Result
        With cycles: of a history with repeated blocks.
    path, title, width, dpi
        See :func:`plot_tractions`.

    Raises
    ------
    InputError
        If there are no cycles, or the figure's format is unknown.
    """
    if not result.cycles:
        raise InputError("cycles", "the history has no repeated blocks")
    return _drawn(lambda: _draw_cycles(result, title, width), path, dpi)


def _draw_cycles(result: Result, title: str, width: float) -> Figure:
    figure = Figure(figsize=(width, 0.95 * width), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(3, 1, sharex=True)
    kind = units(result.problem)
    lengths = sorted({cycle.length for cycle in result.cycles})[:MAX_NAMED]
    shown = [one for one in series(result.cycles) if one[0].length in lengths]
    energy, unit = scaled([cycle.dissipation for cycle in result.cycles], kind["energy"])
    turns = [np.nancumsum([0.0, *(cycle.rotation_change for cycle in one)]) for one in shown]
    angle, unit_of_angle = scaled(np.concatenate(turns).tolist(), kind["rotation"])
    for one, turned in zip(shown, turns, strict=True):
        colour = lengths.index(one[0].length)
        corner = [cycle.corner + 1 for cycle in one]
        marker: dict[str, Any] = {"marker": "o", "markersize": 2.2} if len(one) <= 60 else {}
        for dashes, field in enumerate(("pressure_change", "shear_change")):
            change = np.array([getattr(cycle, field) for cycle in one])
            change[change == 0.0] = np.nan
            panels[0].plot(corner, change, **line(colour, dashes), **marker)
        dissipated = np.array([energy * cycle.dissipation for cycle in one])
        dissipated[~(dissipated > 0.0)] = np.nan
        panels[1].plot(corner, dissipated, **line(colour), **marker)
        panels[2].plot([corner[0] - one[0].length, *corner], angle * turned, **line(colour), **marker)
    for panel in panels[:2]:
        panel.set_yscale("log")
    largest = np.nanmax([0.0, *(energy * cycle.dissipation for cycle in result.cycles)])
    if largest > 0.0:
        panels[1].set_ylim(bottom=max(panels[1].get_ylim()[0], 1e-9 * largest))  # below is rounding
    panels[0].set_ylabel("largest change / peak N")
    panels[1].set_ylabel(f"dissipated in a cycle  [{unit}]")
    panels[2].set_ylabel(f"turned, in all  [{unit_of_angle}]")
    panels[2].set_xlabel("corner of the load history at which the cycle ends")
    handles: list[Artist] = [
        Line2D([], [], label=f"cycles of {length} corner{'s' if length > 1 else ''}", **line(colour))
        for colour, length in enumerate(lengths)
    ]
    for dashes, name in enumerate(("pressure", "shear")):
        handles.append(Line2D([], [], label=name, **{**line(0, dashes), "color": "0.3"}))
    _fitted_legend(figure, handles, min(len(handles), 4))
    if len({cycle.corner for cycle in result.cycles}) > 1:
        panels[2].xaxis.set_major_locator(MaxNLocator(nbins=9, integer=True))
    figure.align_ylabels(panels)
    if title:
        figure.suptitle(title, fontsize=9.5)
    return figure


Line = dict[str, Any]
"""How a line is drawn: keywords of ``Axes.plot``."""


def line(colour: int = 0, dashes: int = 0, width: float = 1.4) -> Line:
    """A line in the house's colours and dashes, of which there are :data:`MAX_NAMED` each; 0 is solid."""
    return {"color": _COLOURS[colour], "linestyle": _DASHES[dashes], "linewidth": width}


def draw_with(draw: Callable[[Any], Figure], curves: Any, path: str | Path, dpi: float = 160.0) -> None:
    """Save the figure that ``draw(curves)`` returns, drawn in the house style."""
    _drawn(lambda: draw(curves), path, dpi)


def panels(rows: int, columns: int, height: float = 2.3, width: float = 7.2) -> tuple[Figure, np.ndarray]:
    """A figure, `width` inches wide, and its panels, shape (rows, columns), each `height` inches high."""
    figure = Figure(figsize=(width, rows * height + 0.6), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(rows, columns, squeeze=False)
    for panel in axes.flat:
        panel.grid(True, color="0.92", linewidth=0.6)
        panel.set_axisbelow(True)
    return figure, axes


def angle_axis(panel: Axes) -> None:
    """Ticks at whole parts of a right angle."""
    panel.xaxis.set_major_locator(MaxNLocator(nbins=7, steps=[1, 1.5, 2, 3, 4.5, 6, 9, 10]))


def key(figure: Figure, *rows: Sequence[tuple[str, Line]]) -> None:
    """A legend below the panels; each row holds labels with their lines."""
    columns = max(len(row) for row in rows)
    entries = [[Line2D([], [], label=label, **style) for label, style in row] for row in rows]
    blank = Line2D([], [], linestyle="none", label=" ")
    filled: list[Artist] = [row[k] if k < len(row) else blank for k in range(columns) for row in entries]
    _fitted_legend(figure, filled, columns)


def _check_format(path: Path) -> None:
    formats = FigureCanvasAgg.get_supported_filetypes()
    if path.suffix[1:].lower() not in formats:
        known = ", ".join(sorted(formats))
        raise InputError("path", f"a figure's name must end in one of {known}, not {path.name!r}")
    check_writable(path)


def _save(figure: Figure, path: Path, dpi: float) -> None:
    dated = {"svg": "Date", "pdf": "CreationDate"}.get(path.suffix[1:].lower())
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=dpi, metadata={dated: None} if dated else None)


def _draw(states: list[State], title: str, width: float) -> Figure:
    problem = states[0].problem
    named = len(states) <= MAX_NAMED
    shades = _scale(states).to_rgba(np.array([load_point(state) for state in states]))
    colours: Sequence[Any] = _COLOURS if named else list(shades)
    zones = named and not problem.frictionless and len(states) > 1
    strip = 0.16 * len(states) + 0.15  # inches
    panels = [1.9] if problem.frictionless else [1.9, 1.9]
    heights = [*panels, strip] if zones else panels

    figure = Figure(figsize=(width, sum(heights) + 1.35), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]

    frame = _Frame(states)
    unit = units(problem)["traction"]
    factor, label = scaled([float(state.pressure.max()) for state in states], unit)
    label = label.replace("beta*", "β*")
    for index, state in enumerate(states):
        colour = colours[index]
        dashes = _DASHES[index] if named else _DASHES[0]
        thickness = 1.4 if named else 0.9
        angle, pressure, shear = frame.curves(state)
        axes[0].plot(angle, factor * pressure, color=colour, linestyle=dashes, linewidth=thickness)
        if not problem.frictionless:
            for sign in (1.0, -1.0) if named else ():
                bound = factor * sign * problem.friction * pressure
                axes[1].plot(angle, bound, color=colour, linewidth=0.5, alpha=0.55, zorder=1)
            axes[1].plot(angle, factor * shear, color=colour, linestyle=dashes, linewidth=thickness)
    axes[0].set_ylabel(f"pressure  N  [{label}]")
    axes[0].set_ylim(bottom=0.0)
    if not problem.frictionless:
        axes[1].set_ylabel(f"shear  T  [{label}]")
        axes[1].axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
    if len(states) == 1:
        _shade_slip(list(axes), states[0], frame)
    if zones:
        _draw_zones(axes[-1], states, colours, frame)
    for panel in axes:
        panel.grid(True, axis="x", color="0.92", linewidth=0.6)
        panel.set_axisbelow(True)
    axes[-1].set_xlim(*frame.limits)
    axes[-1].xaxis.set_major_locator(MaxNLocator(nbins=9, steps=[1, 1.5, 2, 3, 4.5, 5, 6, 9, 10]))
    axes[-1].set_xlabel("angle from the bottom of the hole, counter-clockwise  [deg]")
    figure.align_ylabels(axes)
    _name_states(figure, axes, states, colours, title, named)
    return figure


class _Frame:
    """Where on the angle axis things are drawn: all that touches in some state, and a little more."""

    def __init__(self, states: list[State]) -> None:
        grid = states[0].grid
        touched = np.any([state.status != OPEN for state in states], axis=0)
        self.order = np.arange(grid.size)
        if grid.closed and not touched.all():
            # The circle is cut open in the middle of the longest stretch that never touches.
            self.order = np.roll(self.order, -_middle_of_longest_gap(touched))
        angle = np.degrees(np.unwrap(grid.theta[self.order])) + 90.0
        if grid.closed:
            self.order = np.append(self.order, self.order[0])
            angle = np.append(angle, angle[0] + 360.0)
        inside = angle[touched[self.order]]
        first, last = (inside[0], inside[-1]) if inside.size else (angle[0], angle[-1])
        turn = 360.0 * math.floor((0.5 * (first + last) + 180.0) / 360.0)
        self.angle = angle - turn
        margin = 0.04 * (last - first) + 1.0
        self.limits = (max(first - margin, angle[0]) - turn, min(last + margin, angle[-1]) - turn)

    def curves(self, state: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Angle, pressure and shear to draw; nothing where two neighbours are open."""
        closed = state.status != OPEN
        beside = closed.copy()
        beside[1:] |= closed[:-1]
        beside[:-1] |= closed[1:]
        if state.grid.closed:
            beside[0] |= closed[-1]
            beside[-1] |= closed[0]
        pressure = np.where(beside, state.pressure, np.nan)
        shear = np.where(beside, state.shear, np.nan)
        return self.angle, pressure[self.order], shear[self.order]

    def place(self, start: float, stop: float) -> list[tuple[float, float]]:
        """Parts (first angle, width) of an interval in rad on the axis, in degrees."""
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
    for k in range(2 * size):  # twice round, so that a stretch across the seam counts in full
        run = 0 if touched[k % size] else run + 1
        if run > best:
            best, middle = run, k - run // 2
    return middle % size


def _shade_slip(axes: Sequence[Axes], state: State, frame: _Frame) -> None:
    for start, stop, _ in state.slip_zones:
        for left, width in frame.place(start, stop):
            for panel in axes:
                panel.axvspan(left, left + width, color=_SHADE, linewidth=0, zorder=-1)


def _draw_zones(panel: Axes, states: list[State], colours: Sequence[Any], frame: _Frame) -> None:
    """One row a state: solid where it sticks, shaded where it slips, with an arrow for the pin's sense."""
    for row, state in enumerate(states):
        colour = colours[row]
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


def _name_states(
    figure: Figure, axes: np.ndarray, states: list[State], colours: Sequence[Any], title: str, named: bool
) -> None:
    """Legend or colour scale; what all states share goes to the title."""
    loads = [state.load for state in states]
    acting = acting_loads(loads)
    varying = [name for name in acting if any(load[name] != loads[0][name] for load in loads)]
    common = [_load_text(states, 0, name) for name in acting if name not in varying]
    heading = "\n".join(line for line in (title, ",  ".join(common)) if line)
    if heading:
        figure.suptitle(heading, fontsize=9.5, x=0.5)
    if not named:
        bar = figure.colorbar(_scale(states), ax=list(axes), aspect=40, pad=0.02)
        bar.set_label("load point (1: first corner of the history)")
        bar.ax.yaxis.set_major_locator(MaxNLocator(nbins=8, integer=True))
        bar.outline.set_linewidth(0.5)
        return
    handles: list[Artist] = []
    for index, state in enumerate(states):
        parts = ",  ".join(_load_text(states, index, name) for name in varying)
        text = f"{load_point(state):.4g}:  {parts}" if parts else f"{load_point(state):.4g}"
        handles.append(Line2D([], [], color=colours[index], linestyle=_DASHES[index], label=text))
    styles: list[Artist] = []
    if not states[0].problem.frictionless:
        friction = states[0].problem.friction
        styles.append(Line2D([], [], color="0.5", linewidth=0.5, label=f"±μN,  μ = {friction:g}"))
        if len(states) == 1:
            styles.append(Patch(color=_SHADE, linewidth=0, label="slip"))
        else:
            styles.append(Patch(color="0.35", linewidth=0, label="stick"))
            styles.append(Patch(color="0.35", alpha=0.22, linewidth=0, label="slip, → counter-clockwise"))
    handles, columns = _in_columns(handles if len(states) > 1 else [], styles)
    if handles:
        _fitted_legend(figure, handles, columns)


def _fitted_legend(figure: Figure, handles: list[Artist], columns: int) -> None:
    """A legend below the panels, in a font small enough for the figure's width."""
    size = 8.0
    while True:
        legend = figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=columns,
            fontsize=size,
            handlelength=2.8,
            columnspacing=2.0,
        )
        share = legend.get_window_extent().width / figure.bbox.width
        if share <= 0.98 or size <= 4.0:
            return
        legend.remove()
        size = max(4.0, size * 0.96 / share)


def _in_columns(states: list[Artist], styles: list[Artist]) -> tuple[list[Artist], int]:
    """Legend entries, filled up so that states and styles stand in columns of their own, and the columns."""
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


def _load_text(states: list[State], index: int, name: str) -> str:
    """A load with its unit; all loads of one kind are given in the same one."""
    alike = [state.load[other] for state in states for other in LOADS if LOAD_KIND[other] == LOAD_KIND[name]]
    factor, unit = scaled(alike, units(states[0].problem)[LOAD_KIND[name]])
    symbol = {"sxx": "$σ_{xx}$", "syy": "$σ_{yy}$"}.get(name, name)
    value = f"{states[index].load[name] * factor:+.4g}".replace("-", "−")
    if states[index].load[name] == 0.0:
        return f"{symbol} = 0"
    value = value.lstrip("+") if name == "P" else value
    return f"{symbol} = {value} {unit.replace('beta*', 'β*')}"


def _scale(states: list[State]) -> ScalarMappable:
    points = [load_point(state) for state in states]
    # The lightest tenth of the scale can't be seen on white.
    shades = ListedColormap(mpl.colormaps["viridis"](np.linspace(0.9, 0.0, 256)))
    return ScalarMappable(Normalize(min(points), max(points)), shades)
