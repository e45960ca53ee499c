"""The records of what others publish, beside fastpin's numbers: figures and benchmarks, with the rows of these.

A row has a published number as printed, fastpin's number, and what follows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any, TypeVar

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D

from fastpin.assess.outputs import Curve, aligned
from fastpin.figures import style
from fastpin.figures.sheet import Look
from fastpin.figures.style import Line, line

AGREES = "agrees to the digits printed"
"""The verdict on a number that differs by at most one unit of the last digit printed."""

Report = Callable[[float], None]
"""A callable that receives the computed fraction of a figure, 0 to 1."""

Item = TypeVar("Item")


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper, or one like them.

    Attributes
    ----------
    name : str
        The number in the paper, or a name in lower case with dashes.
    title : str
        A description, the first line of the CSV file.
    least_nodes : int
        The fewest nodes that resolve the subject of the figure.
    compute : callable
        ``compute(nodes, progress)`` solves, and returns the curves.
    draw : callable
        ``draw(curves)`` draws the curves of `compute`.
    """

    name: str
    title: str
    least_nodes: int
    compute: Callable[[int, Report | None], list[Curve]]
    draw: Callable[[Sequence[Curve]], Figure]


@dataclass(frozen=True)
class Row:
    """One quantity of a benchmark.

    Attributes
    ----------
    quantity, unit : str
    published : str
        The number as printed; empty if no number was seen.
    ours : float
        fastpin's number, in `unit`.
    why : str
        The verdict if the numbers differ. It begins with "differs", "open", "comparison only" or "misprint".
    last_digit : float, optional
        A unit of the last digit of the published number, where it is not a decimal one.
    """

    quantity: str
    unit: str
    published: str
    ours: float
    why: str = "differs"
    last_digit: float | None = None

    @property
    def difference(self) -> float | None:
        """fastpin's number minus the published one; None if there is none."""
        return self.ours - float(self.published) if self.published else None

    @property
    def places(self) -> int:
        """The number of decimal places of the published number."""
        return len(self.published.partition(".")[2])

    @property
    def resolution(self) -> float:
        """A unit of the last digit printed."""
        return 10.0**-self.places if self.last_digit is None else self.last_digit

    @property
    def agrees(self) -> bool:
        """Whether the numbers differ by at most one unit of the last digit printed."""
        # The difference of two decimal numbers is rounded.
        return self.difference is not None and abs(self.difference) <= (1.0 + 1e-9) * self.resolution

    @property
    def verdict(self) -> str:
        """What follows from the difference, in words."""
        return AGREES if self.agrees else self.why


@dataclass(frozen=True)
class Outcome:
    """The rows of a benchmark."""

    rows: Sequence[Row]


@dataclass(frozen=True)
class Benchmark:
    """A problem that others publish.

    Attributes
    ----------
    name, title : str
    statement : str
        Geometry, materials and loads.
    sources : sequence of str
    compute : callable
        ``compute(progress)`` solves, and returns the outcome.
    """

    name: str
    title: str
    statement: str
    sources: Sequence[str]
    compute: Callable[[Report | None], Outcome]


def steps(items: Sequence[Item], progress: Report | None) -> Iterator[Item]:
    """Yield the items, and report the fraction that is done after each of them."""
    for index, item in enumerate(items):
        yield item
        if progress is not None:
            progress((index + 1) / len(items))


def table(title: str, statement: str, sources: Sequence[str], rows: Sequence[Row]) -> str:
    """Return a benchmark as text: its statement, its sources, and a line for each row with its verdict.

    fastpin's numbers have one digit more than the published ones.
    """
    words = [statement, *(f"source: {source}" for source in sources)]
    lines = [f"  {line}" for paragraph in words for line in wrap(paragraph, 118, break_on_hyphens=False)]
    cells = [("quantity", "unit", "published", "fastpin", "difference", "verdict")]
    for row in rows:
        places = row.places + 1 if row.published else 2
        ours = f"{round(row.ours, places) + 0.0:.{places}f}"  # + 0.0 makes 0 of -0
        difference = "" if row.difference is None else f"{row.difference:+.{places}f}"
        cells.append((row.quantity, row.unit, row.published or "-", ours, difference, row.verdict))
    return "\n".join([title, *lines, *aligned(cells, "llrrrl")])


def row_curves(rows: Sequence[Row]) -> list[Curve]:
    """Return a curve of one point for each row, for a CSV file."""
    names = ("quantity", "unit", "published", "verdict")
    numbers = [{"fastpin": np.array([row.ours]), "difference": np.array([row.difference], dtype=float)} for row in rows]
    return [Curve({name: getattr(row, name) for name in names}, own) for row, own in zip(rows, numbers, strict=True)]


def save_drawing(draw: Callable[[Any], Figure], curves: Any, path: str | Path, dpi: float = 160.0) -> None:
    """Draw the figure of ``draw(curves)`` in the house style, and save it.

    Raises
    ------
    InputError
        If `dpi` is out of range, the format is unknown, or the file can't be written. It comes before the figure is
        drawn where possible.
    """
    look = Look(path, dpi=dpi)
    with style.house_style():
        style.save_figure(draw(curves), Path(path), look.dpi)


def panels(rows: int, columns: int, height: float = 2.3, width: float = 7.2) -> tuple[Figure, np.ndarray]:
    """Return a new figure, `width` inches wide, and its panels, shape (rows, columns), each `height` inches high."""
    figure = style.new_figure(width, rows * height + 0.6)
    axes = figure.subplots(rows, columns, squeeze=False)
    for panel in axes.flat:
        style.draw_grid(panel)
    return figure, axes


def add_legend(figure: Figure, *rows: Sequence[tuple[str, Line]]) -> None:
    """Add a legend below the panels. Each of `rows` is a row of the legend: labels and their lines."""
    columns = max(len(row) for row in rows)
    entries = [[Line2D([], [], label=label, **look) for label, look in row] for row in rows]
    blank = Line2D([], [], linestyle="none", label=" ")
    filled: list[Artist] = [row[k] if k < len(row) else blank for k in range(columns) for row in entries]
    style.fitted_legend(figure, filled, columns)


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
    shown = [Line2D([], [], label=label, **{**look, "markevery": None}) for label, look in entries]
    spaces: Any = {"handlelength": 2.6, "labelspacing": 0.3, "columnspacing": 1.2}
    place: Any = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.2), "fontsize": 7.5, "title_fontsize": 7.5}
    return panel.legend(handles=shown, ncols=columns, title=title or None, **place, **spaces)
