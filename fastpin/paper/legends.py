"""Legends below single panels, and lines that marks tell apart in grey."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from fastpin.figures.style import Line, add_heading, line

MARKERS = ("o", "s", "^", "D", "v", "x")
"""Marks beside the colours of lines whose dashes show something else. They also tell the lines apart in grey."""

HEADING_WIDTH = 88
"""Most characters in a line of a heading. A figure 7.2 inches wide has room for 95."""

GREY = "0.35"
"""Colour of the lines in a legend that show dashes alone."""


def head(figure: Figure, *sentences: str) -> None:
    """Write sentences above the panels of a figure, each on a new line, and long ones on several."""
    add_heading(figure, *(part for text in sentences for part in wrap(text, HEADING_WIDTH, break_on_hyphens=False)))


def marked(colour: int, dashes: int = 0, width: float = 1.4) -> Line:
    """Return a line with the mark of its colour. The mark is small and stands at every third point."""
    return line(colour, dashes, width) | {"marker": MARKERS[colour], "markersize": 3.5, "markevery": 3}


def grey(dashes: int, width: float = 1.4) -> Line:
    """Return the line of a legend that shows dashes alone."""
    return line(0, dashes, width) | {"color": GREY}


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
