"""Legends below single panels, and lines that marks tell apart in grey."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from fastpin.figures.style import Line, line


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
