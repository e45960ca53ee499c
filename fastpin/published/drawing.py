"""How figures of the paper and of benchmarks are drawn: panels, headings, legends, and lines that marks tell apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from fastpin.figures.sheet import Look
from fastpin.figures.style import (
    Line,
    draw_grid,
    fitted_legend,
    house_style,
    line,
    new_figure,
    save_figure,
)


def save_drawing(draw: Callable[[Any], Figure], curves: Any, path: str | Path, dpi: float = 160.0) -> None:
    """Draw the figure of ``draw(curves)`` in the house style, and save it.

    Raises
    ------
    InputError
        If `dpi` is out of range, the format is unknown, or the file can't be written. It comes before the figure is
        drawn where possible.
    """
    look = Look(path, dpi=dpi)
    with house_style():
        save_figure(draw(curves), Path(path), look.dpi)


def panels(rows: int, columns: int, height: float = 2.3, width: float = 7.2) -> tuple[Figure, np.ndarray]:
    """Return a new figure, `width` inches wide, and its panels, shape (rows, columns), each `height` inches high."""
    figure = new_figure(width, rows * height + 0.6)
    axes = figure.subplots(rows, columns, squeeze=False)
    for panel in axes.flat:
        draw_grid(panel)
    return figure, axes


def add_legend(figure: Figure, *rows: Sequence[tuple[str, Line]]) -> None:
    """Add a legend below the panels. Each of `rows` is a row of the legend: labels and their lines."""
    columns = max(len(row) for row in rows)
    entries = [[Line2D([], [], label=label, **style) for label, style in row] for row in rows]
    blank = Line2D([], [], linestyle="none", label=" ")
    filled: list[Artist] = [row[k] if k < len(row) else blank for k in range(columns) for row in entries]
    fitted_legend(figure, filled, columns)


def head(figure: Figure, *sentences: str) -> None:
    """Write sentences above the panels of a figure, each on a new line, and long ones on several."""
    # A figure 7.2 inches wide has room for 95 characters.
    lines = [line for text in sentences for line in wrap(text, 88, break_on_hyphens=False)]
    figure.suptitle("\n".join(lines), fontsize=9.5, parse_math=False)


def marked(colour: int, dashes: int = 0, width: float = 1.4) -> Line:
    """Return a line with the mark of its colour, which tells lines apart in grey and where dashes mean something else.

    The mark is small and stands at every third point.
    """
    return line(colour, dashes, width) | {"marker": "os^DvxP"[colour], "markersize": 3.5, "markevery": 3}


def grey(dashes: int, width: float = 1.4) -> Line:
    """Return the line of a legend that shows dashes alone."""
    return line(0, dashes, width) | {"color": "0.35"}


def legend_below(panel: Axes, entries: Sequence[tuple[str, Line]], columns: int = 1, title: str = "") -> Legend:
    """Add a legend below a panel and its labels, and return it."""
    shown = [Line2D([], [], label=label, **{**style, "markevery": None}) for label, style in entries]
    return panel.legend(
        handles=shown,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.2),
        ncols=columns,
        title=title or None,
        fontsize=7.5,
        title_fontsize=7.5,
        handlelength=2.6,
        labelspacing=0.3,
        columnspacing=1.2,
    )
