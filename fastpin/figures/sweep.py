"""Figures of sweeps: maps over two fields, curves over one."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from fastpin.figures.style import MAX_NAMED, Line, add_legend, line, panels, save_drawing
from fastpin.model.checks import instance
from fastpin.report.sweep import Axis, Chart

_FAILED: Any = {"facecolor": "0.93", "edgecolor": "0.45", "hatch": "////", "linewidth": 0.0}
_OPEN: Any = {"facecolor": "white", "edgecolor": "0.75", "linewidth": 0.5}
MOST_COLUMNS = 3
"""Most maps side by side."""

LOG_RATIO = 100.0
"""Ratio of the largest to the smallest value, all positive, from which on their scale is logarithmic."""


def plot_sweep(chart: Chart, path: str | Path, dpi: float = 160.0) -> None:
    """Save the figure of a sweep: maps over two fields, or curves over one field.

    A map has one cell for each pair of values. The edges of a cell lie halfway to its neighbours, on a logarithmic axis
    at the geometric mean. Hatched cells are failed runs. Crosses at the lower edge of a figure of curves are failed
    runs, too. Positive values that differ by a factor of 100 or more have a logarithmic scale.

    Parameters
    ----------
    chart : Chart
        From :func:`fastpin.report.sweep.chart`.
    path : path
        The suffix chooses the format.
    dpi : float
        Dots per inch of a bitmap.

    Raises
    ------
    InputError
        If an argument is out of range, the figure's format is unknown, or the file can't be written.
    """
    instance("chart", chart, Chart, "a Chart")
    save_drawing(_draw_curves if chart.y is None else _draw_maps, chart, path, dpi)


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


def _draw_maps(chart: Chart) -> Figure:
    assert chart.y is not None
    columns = min(len(chart.parts), MOST_COLUMNS)
    rows = math.ceil(len(chart.parts) / columns)
    figure, axes = panels(rows, columns, height=3.4 if columns == 1 else 2.5, width=5.4 if columns == 1 else 7.6)
    known = _known_values(chart)
    scale = (LogNorm if _spans_decades(known) else Normalize)(known.min(), known.max())
    x, y = cell_edges(chart.x), cell_edges(chart.y)
    mesh: Any = None
    for panel, (name, numbers, failed) in zip(axes.flat, chart.parts, strict=False):
        mesh = panel.pcolormesh(x, y, np.ma.masked_invalid(numbers), norm=scale, cmap="viridis", edgecolors="face")
        mesh.set_linewidth(0.2)
        for row, column in np.argwhere(np.isnan(numbers)):
            size = x[column + 1] - x[column], y[row + 1] - y[row]
            style = _FAILED if failed[row, column] else _OPEN
            panel.add_patch(Rectangle((x[column], y[row]), *size, **style))
        _scale_axes(panel, chart)
        panel.grid(False)
        panel.set_title(name, fontsize=8.0)
    _finish(figure, axes, chart)
    for panel in axes[:, 0]:
        panel.set_ylabel(chart.y.label)
    bar = figure.colorbar(mesh, ax=list(axes.flat), aspect=30, pad=0.02)
    bar.set_label(chart.label, parse_math=False)
    bar.outline.set_linewidth(0.5)
    _explain(figure, chart)
    return figure


def _known_values(chart: Chart) -> np.ndarray:
    """Return all values of a chart in one array; a single zero if there are none."""
    values = np.concatenate([numbers[np.isfinite(numbers)] for _, numbers, _ in chart.parts])
    return values if values.size else np.zeros(1)


def _spans_decades(values: np.ndarray) -> bool:
    """Whether the values are positive, and too different for a linear scale."""
    return bool(values.min() > 0.0 and values.max() >= LOG_RATIO * values.min())


def _explain(figure: Figure, chart: Chart) -> None:
    """Add a legend of the cells without a value: of failed runs, and of all others."""
    failed = any(part.any() for _, _, part in chart.parts)
    empty = any((np.isnan(numbers) & ~part).any() for _, numbers, part in chart.parts)
    handles = [Patch(label="failed", **_FAILED)] * failed + [Patch(label="no value", **_OPEN)] * empty
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=8.0)


def _draw_curves(chart: Chart) -> Figure:
    names = [name.replace("\n", ", ") for name, _, _ in chart.parts]
    across = max(1, min(3, 78 // (max(map(len, names)) + 8)))  # entries of the legend side by side
    figure, axes = panels(1, 1, height=2.9 + 0.17 * math.ceil(len(names) / across), width=5.8)
    panel = axes[0, 0]
    entries: list[tuple[str, Line]] = []
    shades = mpl.colormaps["viridis"](np.linspace(0.9, 0.0, len(chart.parts)))
    for index, (name, (_, numbers, failed)) in enumerate(zip(names, chart.parts, strict=True)):
        style = line(index, index) if len(chart.parts) <= MAX_NAMED else {**line(), "color": shades[index]}
        panel.plot(chart.x.values, numbers, marker="o", markersize=2.5, **style)
        x = chart.x.values[failed]
        panel.plot(
            x,
            np.full(len(x), 0.02 + 0.03 * index),
            transform=panel.get_xaxis_transform(),
            marker="x",
            markersize=4.0,
            linestyle="none",
            color=style["color"],
        )
        entries.append((name, style))
    _scale_axes(panel, chart)
    panel.set_ylabel(chart.label, parse_math=False)
    if _spans_decades(_known_values(chart)):
        panel.set_yscale("log")
    _finish(figure, axes, chart)
    cross: Line = {"color": "0.3", "linestyle": "none", "marker": "x", "markersize": 4.0}
    marks = [("failed", cross)] if any(failed.any() for _, _, failed in chart.parts) else []
    named = [entry for entry in entries if entry[0]] + marks
    if named:
        add_legend(figure, *[named[k : k + across] for k in range(0, len(named), across)])
    return figure


def _scale_axes(panel: Axes, chart: Chart) -> None:
    if chart.x.log:
        panel.set_xscale("log")
    if chart.y is not None and chart.y.log:
        panel.set_yscale("log")


def _finish(figure: Figure, axes: np.ndarray, chart: Chart) -> None:
    """Add the title and the labels of the x axes, and hide the panels without a map."""
    filled = 1 if chart.y is None else len(chart.parts)
    for index, panel in enumerate(axes.flat):
        panel.set_visible(index < filled)
        if index + axes.shape[1] >= filled:
            panel.set_xlabel(chart.x.label)
    if chart.title:
        figure.suptitle(chart.title, fontsize=9.5, parse_math=False)
