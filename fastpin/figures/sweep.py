"""Figures of sweeps: maps over two fields, curves over one, and envelopes of bearing and bypass stress."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis as MatplotlibAxis
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from matplotlib.transforms import Bbox

from fastpin.assess.outputs import Curve
from fastpin.errors import InputError
from fastpin.figures.sheet import SMALL, WIDE, Look, Plot, Sheet, plotter
from fastpin.figures.style import HATCH, MAX_NAMED, Line, caption, fill, line, quantity, shown_label, spread, wrapped
from fastpin.model.checks import instances
from fastpin.model.problem import Problem
from fastpin.model.units import scaled
from fastpin.report.sweep import Axis, Chart

_FAILED: Any = {"facecolor": "0.93", "edgecolor": "0.45", "hatch": "////", "linewidth": 0.0}
_UNSURE: Any = {
    "marker": "o", "markersize": 4.5, "markerfacecolor": "white", "markeredgecolor": "black", "markeredgewidth": 0.9,
    "linestyle": "none",
}  # fmt: skip
_ENDLESS: Any = {"marker": r"$\uparrow$", "markersize": 7.0, "linestyle": "none", "clip_on": False}
_CROSS: Any = {"marker": "x", "markersize": 4.0, "linestyle": "none"}
_OPEN: Any = {"facecolor": "white", "edgecolor": "0.75", "linewidth": 0.5}
MARKERS = ("o", "s", "^", "D", "v", "<", "P", "*")
"""Marks of the computed values, as many as colours. Crosses mark failed runs."""

CLASS_LOOKS = (
    ("#ECECEC", ""),
    ("#A9D0EA", "..."),
    ("#F2A541", "\\\\\\\\"),
    ("#0B3C5D", ""),
    ("#6FB58F", "////"),
    ("#F4E58A", "+++"),
    ("#C77CA6", "xxx"),
    ("#7A5C3E", "ooo"),
)
"""Colour and hatch of each class, in the order of their numbers. They differ in grey, or by the hatch."""

LEVELS = 7
"""Most contour lines of a map."""

BESIDE, BETWEEN = 1.2, 0.2
"""Inches beside all panels, for the bar of colours, and between the titles of two panels."""

DECADES = 1.7
"""Decades of an axis up to which its numbers stand at 1, 2 and 5 times powers of ten.

Up to twice as many they stand at 1 and 3 times powers of ten, and beyond at powers of ten.
"""

CAPTION_WORDS = {
    "contact.friction": ("friction",),
    "contact.hole_radius": ("hole radius",),
    "contact.clearance": ("clearance", "interference", "neat fit"),
    "gap.hole": ("initial gap of the hole",),
    "gap.pin": ("initial gap of the pin",),
}
"""Words with which the parts of a caption begin that belong to a field."""


def sweeps_of(charts: Sequence[Chart]) -> Plot:
    """Return several charts side by side, two in a row, see :func:`plot_sweep`."""
    for chart in charts:
        if chart.y is not None and len(chart.parts) > 1:
            raise InputError("chart", f"{chart.label} has {len(chart.parts)} maps; side by side each chart has one")
    names, missing = ", ".join(chart.label for chart in charts), [chart for chart in charts if chart.missing]
    gaps = [f"{chart.label}: {chart.missing:,} points have no value." for chart in missing]
    return Plot(
        lambda look: _draw_beside(look, charts),
        instead=f"{'Curves' if charts[0].y is None else 'Maps'} of {names} over {_over(charts[0])}.",
        caption=" ".join([f"{names[0].upper()}{names[1:]} over {_over(charts[0])}.", *gaps]),
        title=charts[0].title,
        width=WIDE,
        alone="holds one chart; give a list of charts no axes",
    )


def _draw_beside(look: Look, charts: Sequence[Chart]) -> Sheet:
    columns = min(len(charts), 2)
    with mpl.rc_context(SMALL):
        sheet = look.sheet([2.9] * -(-len(charts) // columns), columns, 0.5)
        for panel in sheet.axes.flat[len(charts) :]:
            panel.set_visible(False)
        for panel, chart in zip(sheet.axes.flat, charts, strict=False):
            draw_chart = _draw_curves if chart.y is None else _draw_maps
            draw_chart(Look(ax=panel), replace(chart, problem=None, title="", label=""))
            _set_title(sheet, panel, "\n".join(filter(None, [chart.label, panel.get_title()])))
    sheet.head(look.title, caption=_fixed_parameters(charts[0]))
    return sheet


def _set_title(sheet: Sheet, panel: Axes, text: str) -> None:
    """Write the title of a panel in lines that end before its neighbours."""
    figure, host = sheet.figure, sheet.host
    width = figure.get_figwidth() if host is None else host.get_window_extent().width / figure.dpi
    inches = (width - BESIDE) / sheet.axes.shape[1] - BETWEEN
    lines = [row for line in shown_label(text).split("\n") for row in wrapped(line, inches, 8.0)]
    panel.set_title("\n".join(lines), fontsize=8.0, parse_math=False)


def _over(chart: Chart) -> str:
    """Words for the axes of a chart."""
    return chart.x.label if chart.y is None else f"{chart.x.label} and {chart.y.label}"


def sweep_of(chart: Chart) -> Plot:
    """Return the maps or the curves of one chart of a sweep, see :func:`plot_sweep`."""
    over, maps = _over(chart), 0 if chart.y is None else len(chart.parts)
    missing = f" {chart.missing:,} points have no value." if chart.missing else ""
    return Plot(
        lambda look: _draw_curves(look, chart) if chart.y is None else _draw_maps(look, chart),
        instead=f"{'Curves' if chart.y is None else 'Map'} of {chart.label} over {over}.",
        caption=f"{chart.label[0].upper()}{chart.label[1:]} over {over}.{missing}",
        title=chart.title,
        width=5.8 if chart.y is None else 5.4 if len(chart.parts) == 1 else 7.6,
        alone="" if maps <= 1 else f"holds one map, but the chart has {maps}",
    )


def _plot_of(chart: Chart | Sequence[Chart]) -> Plot:
    """Draw the figure of a sweep: maps over two fields, or curves over one field.

    A map has one cell for each pair of values. The edges of a cell lie halfway to its neighbours, on a logarithmic axis
    at the geometric mean. Contour lines join equal values. Classes have colours, hatches and a legend instead, and
    lines where two classes meet. Hatched cells are failed runs. Crosses at the lower edge of a figure of curves are
    failed runs, too. Error bars are drawn at the points of curves. The error of an open point is not known: the nodes
    do not resolve it. In a map error bars are dots in the cells whose bar is not known, or larger than the differences
    to the cells beside them, or whose class is another one on the coarse grid. A line above the maps names the largest
    bar. Positive values that differ by a factor of 30 or more have a logarithmic scale. Of more than
    :data:`~fastpin.figures.style.MAX_NAMED` curves an even choice is drawn, and the legend says so.

    The chart is made by :func:`fastpin.report.sweep.chart`. Only curves or a single map go into `ax`. Several charts,
    of curves or of a single map each, stand side by side.
    """
    if isinstance(chart, Chart):
        return sweep_of(chart)
    each = instances("chart", chart, Chart, "a Chart, or a list of charts")
    if not each:
        raise InputError("chart", "must hold at least one chart")
    return sweeps_of(each)


plot_sweep = plotter("plot_sweep", _plot_of)


def cell_edges(axis: Axis) -> np.ndarray:
    """Return the edges of the cells around the n values of an axis, shape (n + 1,)."""
    centres = np.log(axis.values) if axis.log else axis.values
    if len(centres) == 1:
        half = 0.5 * (abs(centres[0]) or 1.0)
        edges = np.array([centres[0] - half, centres[0] + half])
    else:
        middles = 0.5 * (centres[1:] + centres[:-1])
        edges = np.r_[2.0 * centres[0] - middles[0], middles, 2.0 * centres[-1] - middles[-1]]
    return np.exp(edges) if axis.log else edges


def _draw_maps(look: Look, chart: Chart) -> Sheet:
    """Draw a map for each part of a chart. A bar tells the colours of numbers, and the legend those of classes."""
    assert chart.y is not None
    columns = min(len(chart.parts), 3)
    sheet = look.sheet([3.4 if columns == 1 else 2.5] * math.ceil(len(chart.parts) / columns), columns, 0.6)
    known, x, y = _known_values(chart), cell_edges(chart.x), cell_edges(chart.y)
    scale = (LogNorm if _spans_decades(known) else Normalize)(known.min(), known.max())
    levels, labels, mesh = _levels(known), list[Text](), None
    for panel, (name, numbers, failed), unsure in zip(sheet.axes.flat, chart.parts, _unsure(chart), strict=False):
        if chart.classes:
            draw_classes(panel, x, y, numbers, chart.classes)
        else:
            shown = np.ma.masked_invalid(numbers)
            mesh = panel.pcolormesh(x, y, shown, norm=scale, cmap="viridis", edgecolors="face", linewidth=0.2)
            labels += _draw_contours(panel, chart, numbers, levels)
        for row, column in np.argwhere(np.isnan(numbers)):
            size = x[column + 1] - x[column], y[row + 1] - y[row]
            panel.add_patch(Rectangle((x[column], y[row]), *size, **(_FAILED if failed[row, column] else _OPEN)))
        rows, places = np.nonzero(unsure)
        panel.plot(chart.x.values[places], chart.y.values[rows], **_UNSURE)
        _scale_axes(panel, chart)
        _set_title(sheet, panel, name)
    _label_panels(sheet, chart)
    has_bar = mesh is not None and any(np.isfinite(numbers).any() for _, numbers, _ in chart.parts)
    if mesh is not None and has_bar:
        bar = sheet.figure.colorbar(mesh, ax=list(sheet.axes.flat), aspect=30, pad=0.02)
        bar.set_label(shown_label(chart.label), parse_math=False)
        bar.outline.set_linewidth(0.5)
        if isinstance(scale, LogNorm):
            round_numbers(bar.ax.yaxis, known)
    heading = "" if has_bar else shown_label(chart.label)
    sheet.head(look.title, heading, _bar_line(chart), caption=_fixed_parameters(chart))
    _explain(sheet, chart)
    if not chart.classes:
        _thin_out(sheet, labels)
    return sheet


def draw_classes(panel: Axes, x: np.ndarray, y: np.ndarray, numbers: np.ndarray, classes: Mapping[int, str]) -> None:
    """Draw the cells of a map, and a line wherever two classes meet.

    Parameters
    ----------
    panel : Axes
    x, y : ndarray, shape (columns + 1,), (rows + 1,)
        Edges of the cells.
    numbers : ndarray, shape (rows, columns)
        Numbers of the classes; NaN without a value.
    classes : dict of int to str
        All classes, at most as many as :data:`CLASS_LOOKS`.
    """
    for number, (colour, hatch) in zip(classes, CLASS_LOOKS, strict=False):
        cells = [
            [(x[k], y[j]), (x[k + 1], y[j]), (x[k + 1], y[j + 1]), (x[k], y[j + 1])]
            for j, k in np.argwhere(numbers == number)
        ]
        if cells:
            fill(panel, cells, colour, hatch)
    panel.add_collection(LineCollection(class_borders(x, y, numbers), colors="black", linewidths=1.6))
    panel.set_xlim(x[0], x[-1])
    panel.set_ylim(y[0], y[-1])


def class_borders(x: np.ndarray, y: np.ndarray, numbers: np.ndarray) -> list[list[tuple[float, float]]]:
    """Return the sides that two cells of different classes share, as pairs of points."""
    known = np.isfinite(numbers)
    beside = known[:, :-1] & known[:, 1:] & (numbers[:, :-1] != numbers[:, 1:])
    above = known[:-1] & known[1:] & (numbers[:-1] != numbers[1:])
    upright = [[(x[k + 1], y[j]), (x[k + 1], y[j + 1])] for j, k in np.argwhere(beside)]
    level = [[(x[k], y[j + 1]), (x[k + 1], y[j + 1])] for j, k in np.argwhere(above)]
    return [*upright, *level]


def class_patches(classes: Mapping[int, str], present: np.ndarray) -> list[Patch]:
    """Return the entries of the legend for the classes whose numbers are `present`."""
    return [
        Patch(facecolor=colour, edgecolor=HATCH, hatch=hatch, linewidth=0.5, label=words)
        for (number, words), (colour, hatch) in zip(classes.items(), CLASS_LOOKS, strict=False)
        if np.any(present == number)
    ]


def _thin_out(sheet: Sheet, labels: Sequence[Text]) -> None:
    """Remove the labels of contour lines that would overlap others. The size of the panels must be final."""
    sheet.figure.draw_without_rendering()
    kept: list[Bbox] = []
    for label in labels:
        space = label.get_window_extent().padded(2.0 * sheet.figure.dpi / 72.0)  # two points on each side
        if any(space.overlaps(other) for other in kept):
            label.remove()
        else:
            kept.append(space)


def _unsure(chart: Chart) -> list[np.ndarray]:
    """Return where a map shows less than its error bars, for each map: shape (len(y), len(x)), bool.

    That is a cell whose error bar is not known, or larger than the differences to all cells beside it. A class is
    unsure if the coarse grid finds another one.
    """
    if not chart.bars:
        return [np.zeros(numbers.shape, dtype=bool) for _, numbers, _ in chart.parts]
    found = []
    for (_, numbers, _), bars in zip(chart.parts, chart.bars, strict=True):
        known = np.isfinite(numbers) & ~np.isnan(bars)
        if chart.classes:
            found.append(known & (bars > 0.0))
            continue
        round_about = np.pad(numbers, 1, constant_values=np.nan)
        beside = (round_about[1:-1, :-2], round_about[1:-1, 2:], round_about[:-2, 1:-1], round_about[2:, 1:-1])
        steps = np.array([np.where(np.isnan(each), -np.inf, np.abs(each - numbers)) for each in beside]).max(axis=0)
        is_beyond = (bars > steps) & np.isfinite(np.maximum(steps, 0.0)) & (steps > -np.inf)
        found.append(known & (is_beyond | np.isinf(bars)))
    return found


def _bar_line(chart: Chart) -> str:
    """Words on the error bars of a map; empty without any."""
    bars = np.concatenate([each[~np.isnan(each)] for each in chart.bars]) if chart.bars else np.empty(0)
    if not bars.size:
        return ""
    if chart.classes:
        return f"another class on the coarse grid: {np.count_nonzero(bars):,} of {bars.size:,} runs"
    spread_of_values, finite = float(np.ptp(_known_values(chart))), bars[np.isfinite(bars)]
    if not finite.size:
        return f"not resolved by the nodes: {bars.size:,} runs"
    largest = float(finite.max())
    part = f", {100.0 * largest / spread_of_values:.2g} % of the range" if spread_of_values > 0.0 else ""
    unknown = f"; not known in {bars.size - finite.size:,} runs" if finite.size < bars.size else ""
    unit = re.search(r"\(([^()]*)\)$", shown_label(chart.label))
    return f"largest error bar: {largest:.2g}{f' {unit[1]}' if unit else ''}{part}{unknown}"


def _levels(known: np.ndarray) -> np.ndarray:
    """Return round values for contour lines, strictly between the smallest and the largest known value."""
    low, high = float(known.min()), float(known.max())
    if _spans_decades(known):
        few = math.log10(high / low) > 0.5 * LEVELS
        found = np.asarray(LogLocator(subs=(1.0,) if few else (1.0, 3.0), numticks=50).tick_values(low, high))
    else:
        found = np.asarray(MaxNLocator(LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high))
    return found[(found > low) & (found < high)]


def _draw_contours(panel: Axes, chart: Chart, numbers: np.ndarray, levels: np.ndarray) -> list[Text]:
    """Draw lines of equal values through the middles of the cells, and return their labels."""
    assert chart.y is not None
    known = np.isfinite(numbers)
    labels: list[Text] = []
    if min(numbers.shape) < 3 or not known.any():  # so few cells along an axis show no lines
        return labels
    inside = levels[(levels > numbers[known].min()) & (levels < numbers[known].max())]
    if inside.size:
        lines = panel.contour(
            chart.x.values, chart.y.values, np.ma.masked_invalid(numbers), inside, colors="white", linewidths=0.8
        )
        # A gap in a line would stay where its label is removed.
        labels = list(panel.clabel(lines, fmt=_in_round_numbers(inside), fontsize=6.5, inline=False))
        for text in labels:
            text.set_bbox({"facecolor": "0.15", "edgecolor": "none", "pad": 0.6})
    return labels


def _known_values(chart: Chart) -> np.ndarray:
    """Return all values of a chart in one array; a single zero if there are none."""
    values = np.concatenate([numbers[np.isfinite(numbers)] for _, numbers, _ in chart.parts])
    return values if values.size else np.zeros(1)


def _spans_decades(values: np.ndarray) -> bool:
    """Whether the values are positive, and too different for a linear scale: from a ratio of 30 on."""
    return bool(values.min() > 0.0 and values.max() >= 30.0 * values.min())


def _explain(sheet: Sheet, chart: Chart) -> None:
    """Add a legend of classes, and of the cells without a value: of failed runs, and of all others."""
    failed = any(part.any() for _, _, part in chart.parts)
    empty = any((np.isnan(numbers) & ~part).any() for _, numbers, part in chart.parts)
    handles: list[Any] = [*class_patches(chart.classes, _known_values(chart))] if chart.classes else []
    handles += [Patch(label="failed run", **_FAILED)] * failed + [Patch(label="no value", **_OPEN)] * empty
    if any(unsure.any() for unsure in _unsure(chart)):
        of_number = "error bar not known, or above the differences to all sides"
        words = "another class on the coarse grid" if chart.classes else of_number
        handles.append(Line2D([], [], label=words, **_UNSURE))
    _add_legend(sheet, handles, 4)


def _draw_curves(look: Look, chart: Chart) -> Sheet:
    shown = spread(len(chart.parts), MAX_NAMED)
    names = [shown_label(chart.parts[k][0].replace("\n", ", ")) for k in shown]
    across = max(1, min(3, 78 // (max(map(len, names)) + 8)))  # entries of the legend side by side
    sheet = look.sheet([2.9], extra=0.6 + 0.17 * math.ceil(len(names) / across))
    panel = sheet.axes[0, 0]
    sheet.grid()
    handles: list[Any] = []
    any_failed = any_unknown = False
    for index, (part, name) in enumerate(zip(shown, names, strict=True)):
        _, numbers, failed = chart.parts[part]
        style: Line = line(index, index) | {"marker": MARKERS[index], "markersize": 3.5}
        panel.plot(chart.x.values, numbers, **style)
        if chart.bars and not chart.classes:
            bars = np.where(np.isfinite(chart.bars[part]), chart.bars[part], 0.0)  # an infinite bar has no ends
            kept = bars > 0.0
            panel.errorbar(
                chart.x.values[kept], numbers[kept], bars[kept], fmt="none", ecolor=style["color"], elinewidth=1.0,
                capsize=2.5,
            )  # fmt: skip
            unknown = np.isinf(chart.bars[part]) & np.isfinite(numbers)
            panel.plot(chart.x.values[unknown], numbers[unknown], **_UNSURE)
            any_unknown = any_unknown or bool(unknown.any())
        if chart.endless:
            _mark(panel, chart.x.values[chart.endless[part]], index, 0.97 - 0.04 * index, **_ENDLESS)
        _mark(panel, chart.x.values[failed], index, 0.02 + 0.03 * index, **_CROSS)
        any_failed = any_failed or bool(failed.any())
        if name:
            handles.append(Line2D([], [], label=name, **style))
    _scale_axes(panel, chart)
    panel.set_ylabel(shown_label(chart.label), parse_math=False)
    if chart.classes:
        panel.set_yticks(list(chart.classes), list(chart.classes.values()))
        panel.set_ylim(min(chart.classes) - 0.5, max(chart.classes) + 0.5)
    elif _spans_decades(_known_values(chart)) or (chart.endless and _known_values(chart).min() > 0.0):
        panel.set_yscale("log")
        round_numbers(panel.yaxis, np.array(panel.get_ylim()))
    panel.set_xlim(*_with_margin(chart.x))
    _label_panels(sheet, chart)
    if any(ends.any() for ends in chart.endless):
        handles.append(Line2D([], [], label="life does not end", color="0.3", **_ENDLESS))
    if any_unknown:
        handles.append(Line2D([], [], label="error not known", **_UNSURE))
    if any_failed:
        handles.append(Line2D([], [], color="0.3", label="failed run", **_CROSS))
    some = f"{len(shown)} of {len(chart.parts)} curves" if len(shown) < len(chart.parts) else ""
    sheet.head(look.title, _bar_line(chart), caption=_fixed_parameters(chart))
    _add_legend(sheet, handles, across, some)
    return sheet


def _fixed_parameters(chart: Chart) -> str:
    return "" if chart.problem is None else fixed_parameters(chart.problem, chart.varied)


def fixed_parameters(problem: Problem, varied: Collection[str]) -> str:
    """The parameters of a joint without the `varied` fields of a sweep, as text."""
    parts = re.split("(?<=[,;]) ", caption(problem))
    of_bodies = ("pin", "plate", "dundurs", "pin_body", "plate_body")
    if any(field.split(".")[0] in of_bodies or field == "contact.pin_load" for field in varied):
        parts = parts[next(k for k, part in enumerate(parts) if part.startswith("plane ")) :]
    for field, words in CAPTION_WORDS.items():
        if any(name == field or name.startswith(f"{field}.") for name in varied):
            parts = [part for part in parts if not part.startswith(words)]
    return " ".join(parts).rstrip(",;")


def _add_legend(sheet: Sheet, handles: Sequence[Any], columns: int, title: str = "") -> None:
    """Add a legend whose entries read row by row, though it is filled column by column. Given axes hold two columns."""
    columns = columns if sheet.host is None else min(columns, 2)
    blank = Line2D([], [], linestyle="none", label=" ")
    filled = [*handles, *[blank] * (-len(handles) % columns)] if len(handles) > columns else list(handles)
    sheet.legend([filled[k] for first in range(columns) for k in range(first, len(filled), columns)], columns, title)


def _mark(panel: Axes, x: np.ndarray, index: int, height: float, **style: Any) -> None:
    """Mark runs of a curve near an edge of the panel, at a height in parts of it: each curve has a row of marks."""
    panel.plot(x, np.full(len(x), height), transform=panel.get_xaxis_transform(), color=line(index)["color"], **style)


def _with_margin(axis: Axis) -> tuple[float, float]:
    """The ends of an axis of curves: all its values, with or without a number."""
    low, high = float(axis.values.min()), float(axis.values.max())
    if axis.log:
        part = (high / low) ** 0.04 if high > low else 2.0
        return low / part, high * part
    margin = 0.04 * (high - low) or 0.5 * (abs(high) or 1.0)
    return low - margin, high + margin


def _scale_axes(panel: Axes, chart: Chart) -> None:
    if chart.x.log:
        panel.set_xscale("log")
        round_numbers(panel.xaxis, chart.x.values)
    if chart.y is not None and chart.y.log:
        panel.set_yscale("log")
        round_numbers(panel.yaxis, chart.y.values)


def round_numbers(axis: MatplotlibAxis, values: np.ndarray) -> None:
    """Put numbers at 1, 2 and 5 times powers of ten on a logarithmic axis, or at powers of ten on a long one."""
    decades = math.log10(float(values.max()) / float(values.min()))
    subs = (1.0, 2.0, 5.0) if decades <= DECADES else (1.0, 3.0) if decades <= 2.0 * DECADES else (1.0,)
    axis.set_major_locator(LogLocator(subs=subs, numticks=12))
    axis.set_minor_formatter(NullFormatter())
    written = _in_round_numbers(values)
    axis.set_major_formatter(FuncFormatter(lambda value, _: written(value)))


def _in_round_numbers(values: np.ndarray) -> Callable[[float], str]:
    """Return how round numbers like some values are written: all in full, or all as powers of ten."""
    sizes = np.abs(values[values != 0.0])
    if not sizes.size or (sizes.min() >= 1e-3 and sizes.max() <= 1e5):
        return lambda value: f"{value:.6g}".replace("-", "−")

    def written(value: float) -> str:
        digits, power = f"{value:.3e}".split("e")
        digits = digits.rstrip("0").rstrip(".")
        return f"$10^{{{int(power)}}}$" if digits == "1" else rf"${digits}\times10^{{{int(power)}}}$"

    return written


def _label_panels(sheet: Sheet, chart: Chart) -> None:
    """Add the labels of the axes, and hide the panels without a map."""
    filled = 1 if chart.y is None else len(chart.parts)
    for index, panel in enumerate(sheet.axes.flat):
        panel.set_visible(index < filled)
        if index + sheet.axes.shape[1] >= filled:
            panel.set_xlabel(shown_label(chart.x.label))
    if chart.y is not None:
        for panel in sheet.axes[:, 0]:
            panel.set_ylabel(shown_label(chart.y.label))


def envelope_of(found: Sequence[Curve], problem: Problem | None = None, varied: Collection[str] = ()) -> Plot:
    """Draw the envelopes of :func:`fastpin.report.sweep.envelopes`: no ply fails below a line.

    The caption has the parameters of a `problem` without the `varied` fields of the sweep. See
    :func:`fastpin.plot_tractions` for the other arguments.
    """
    each = instances("found", found, Curve, "a list of envelopes")
    if not 1 <= len(each) <= MAX_NAMED:
        raise InputError("found", f"must be 1 to {MAX_NAMED} envelopes, not {len(each)}")
    words = "bearing stress over the bypass stress at which the first ply fails"
    return Plot(
        lambda look: _draw_envelope(look, each, "" if problem is None else fixed_parameters(problem, varied)),
        each,
        f"Line chart of the {words}.",
        f"{words[0].upper()}{words[1:]}.",
        width=5.8,
    )


plot_envelope = plotter("plot_envelope", envelope_of)


def _draw_envelope(look: Look, curves: Sequence[Curve], parameters: str) -> Sheet:
    sheet = look.sheet([0.6 * look.width], extra=0.8)
    (panel,) = sheet.axes[0]
    bypass, bearing = curves[0].columns
    largest = [float(np.abs(curve[name]).max()) for curve in curves for name in (bypass, bearing)]
    factor, label = scaled(largest, bypass.partition("[")[2].rstrip("]"))
    handles = []
    for place, curve in enumerate(curves):
        (drawn,) = panel.plot(
            factor * curve[bypass], factor * curve[bearing], marker=MARKERS[place], markersize=3.5,
            label=shown_label(str(curve.parameters.get("case", ""))), **line(place),
        )  # fmt: skip
        handles.append(drawn)
    panel.axvline(0.0, color="0.6", linewidth=0.8)
    panel.set_ylim(bottom=0.0)
    panel.set_xlabel(quantity("bypass stress", label))
    panel.set_ylabel(quantity("bearing stress", label))
    if any("case" in curve.parameters for curve in curves):
        sheet.legend(handles, 2)
    criterion = str(curves[0].parameters["criterion"]).replace(" um", " µm")
    sheet.head(look.title, f"failure of the first ply by {criterion}", caption=parameters)
    sheet.grid()
    return sheet
