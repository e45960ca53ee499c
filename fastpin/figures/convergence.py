"""Figures of convergence studies: distance to the limit against the number of nodes and of increments."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from fastpin.errors import InputError
from fastpin.figures.sheet import WIDE, Look, Plot, Sheet, plotter
from fastpin.figures.style import Line, caption, line, loads_text
from fastpin.model.checks import as_toml, instance, whole_number
from fastpin.report.convergence import ReportedSeries, reported_series
from fastpin.states.quantities import QUANTITIES
from fastpin.studies.convergence import Convergence

MOST_PANELS = 9
"""Most panels of a figure."""

COLUMNS = 3
"""Panels side by side."""

LETTERS = 9.5
"""Size of the words of a panel, points. They can be read at half size."""

LINE = 0.125
"""Height of a line of words in a panel, in parts of the panel."""

ORDER_OF_PANELS = (
    "peak_pressure", "peak_shear", "shear_magnitude", "contact_1_start", "contact_1_stop", "stick_1_start",
    "stick_1_stop", "rotation", "dissipation", "dx", "dy", "pressure_integral",
)  # fmt: skip
"""Quantities that get the first panels. All other quantities follow."""

_GUIDES: dict[int, Line] = {1: {"color": "0.55", "linestyle": (0, (4.0, 2.0)), "linewidth": 0.8},
           2: {"color": "0.55", "linestyle": (0, (1.0, 1.5)), "linewidth": 1.1}}  # fmt: skip


class _Method(NamedTuple):
    """The look of a solver: the words of the legend with the number of nodes, the mark in a text, and the lines."""

    words: str
    mark: str
    style: Line


_METHODS = {
    "path": _Method("path solver, against nodes", "\N{BLACK CIRCLE}", {**line(0), "marker": "o"}),
    "increment": _Method(
        "increment solver, {} nodes, against increments a step", "\N{BLACK SQUARE}", {**line(1, 1), "marker": "s"}
    ),
}
_BAR: Line = {"marker": "_", "markersize": 11.0, "markeredgewidth": 2.0}


def convergence_of(convergence: Convergence, corner: int | None = None) -> Plot:
    """Draw the convergence at one corner, with up to nine panels, one for each outcome or quantity.

    A panel shows the distance of the values to the limit of their sequence, against the number of nodes or of
    increments. Distances are relative to the value, and distances of places to the width of the contact. All panels
    have the same axes. Each panel names the verdict. Marks are filled if an order is observed. Else the marks are open,
    and the distance is measured from the last value. A dash at the last count is the error bar. Guides have the orders
    1 and 2. Quantities that are exact to rounding, or can't be compared, have no panel.

    The `corner` counts from 1; the last one of the study unless given.
    """
    instance("convergence", convergence, Convergence, "a Convergence")
    chosen = max(convergence.loads) if corner is None else whole_number("corner", corner, 1)
    if chosen not in convergence.loads:
        studied = ", ".join(map(str, convergence.loads))
        raise InputError("corner", f"must be a studied corner: {studied}, not {as_toml(chosen)}")
    return Plot(
        lambda look: _draw(look, convergence, chosen),
        instead="Charts of the distance of each quantity to its limit, against the number of nodes or increments.",
        caption="Distance to the limit at the last corner. A dash at the last count is the error bar.",
        width=WIDE,
    )


plot_convergence = plotter("plot_convergence", convergence_of)


def _draw(look: Look, convergence: Convergence, corner: int) -> Sheet:
    found: dict[str, dict[str, Sequence]] = {}
    for study in convergence.studies:
        for row in reported_series(study, convergence.problem, corner):
            if row.verdict in ("observed", "converged", "not converged"):
                found.setdefault(row.name, {})[study.method] = Sequence.of(study.counts, row)
    chosen = [name for name, each in found.items() if any(one.row.is_outcome for one in each.values())]
    names = [name for name in (*chosen, *ORDER_OF_PANELS, *QUANTITIES, *found) if name in found]
    names = list(dict.fromkeys(names))[:MOST_PANELS]
    rows = max(1, math.ceil(len(names) / COLUMNS))
    sheet = look.sheet([1.95] * rows, columns=COLUMNS)
    axes = sheet.axes
    sheet.grid()
    for name, panel in zip(names, axes.flat, strict=False):
        _draw_panel(panel, found[name])
    _scale_axes(axes.flat[: len(names)], [one for name in names for one in found[name].values()])
    for index, panel in enumerate(axes.flat):
        panel.set_visible(index < len(names))
        panel.tick_params(labelsize=LETTERS, labelleft=index % COLUMNS == 0, labelbottom=index + COLUMNS >= len(names))
        if index + COLUMNS >= len(names):
            panel.set_xlabel("nodes; increments a step" if len(convergence.studies) > 1 else "nodes")
    for panel in axes[:, 0]:
        panel.set_ylabel("relative distance")
    _add_legend(sheet, convergence, {method for each in found.values() for method in each})
    heading = f"corner {corner}: {loads_text(convergence.problem, convergence.loads[corner])}"
    sheet.head(*textwrap.wrap(look.title, 90), heading, caption=caption(convergence.problem))
    return sheet


def _add_legend(sheet: Sheet, convergence: Convergence, methods: set[str]) -> None:
    open_marks: Line = {"color": "0.3", "linestyle": "none", "marker": "o", "markersize": 5.0, "fillstyle": "none"}
    entries: list[tuple[str, Line]] = [
        (_METHODS[study.method].words.format(study.nodes), {**_METHODS[study.method].style, "markersize": 5.0})
        for study in convergence.studies
        if study.method in methods
    ]
    entries += [
        ("filled: distance to the limit", open_marks | {"fillstyle": "full"}),
        ("open: without an order, distance to the last value", open_marks),
        ("error bar of the last value", {**_BAR, "color": "0.3", "linestyle": "none"}),
        *((f"order {order}", style) for order, style in _GUIDES.items()),
    ]
    sheet.legend([Line2D([], [], label=label, **style) for label, style in entries], 2)


class Sequence(NamedTuple):
    """A sequence of values as a panel shows it.

    Attributes
    ----------
    counts : tuple of int
        Numbers of nodes or of increments.
    row : ReportedSeries
    distances : ndarray, shape (counts,)
        Distance to the limit, or to the last value without an order; relative to the reference. NaN in place of 0.
    bar : float
        Error bar of the last value, relative to the reference.
    """

    counts: tuple[int, ...]
    row: ReportedSeries
    distances: np.ndarray
    bar: float

    @classmethod
    def of(cls, counts: tuple[int, ...], row: ReportedSeries) -> Sequence:
        """Return the sequence of a reported series."""
        limit = row.limit if row.verdict == "observed" else row.values[-1]
        distances = np.abs(np.subtract(row.values, limit)) / row.reference
        distances[distances == 0.0] = np.nan
        return cls(counts, row, distances, row.bar / row.reference)


def _draw_panel(panel: Axes, sequences: dict[str, Sequence]) -> None:
    panel.set_title(next(iter(sequences.values())).row.label, fontsize=LETTERS, parse_math=False)
    panel.set_xscale("log")
    panel.set_yscale("log")
    for place, (method, one) in enumerate(sequences.items()):
        _, mark, style = _METHODS[method]
        fillstyle = "full" if one.row.verdict == "observed" else "none"
        panel.plot(one.counts, one.distances, markersize=4.5, fillstyle=fillstyle, **style)
        panel.plot(one.counts[-1:], [one.bar], **_BAR, color=style["color"])
        mark = f"{mark} " if len(sequences) > 1 else ""
        panel.text(
            0.98, 0.98 - LINE * place, mark + one.row.words.replace("-", "\N{MINUS SIGN}"), color=style["color"],
            fontsize=LETTERS - 0.5, ha="right", va="top", transform=panel.transAxes,
        )  # fmt: skip
        known = np.flatnonzero(np.isfinite(one.distances))
        if known.size:
            span = np.array([one.counts[known[0]], one.counts[-1]], dtype=float)
            for order, guide in _GUIDES.items():
                panel.plot(span, one.distances[known[0]] * (span[0] / span) ** order, zorder=0, **guide)


def _scale_axes(panels: Iterable[Axes], sequences: list[Sequence]) -> None:
    """Give all panels the same axes: with one scale the eye compares the quantities."""
    drawn = np.concatenate([[*one.distances, one.bar] for one in sequences]) if sequences else np.ones(1)
    drawn = drawn[np.isfinite(drawn) & (drawn > 0.0)]
    low, high = (float(drawn.min()), float(drawn.max())) if drawn.size else (1e-6, 1e-3)
    low = min(low, high / 100.0) / 2.0
    counts = [count for one in sequences for count in one.counts] or [1, 10]
    left, right = min(counts), max(counts)
    margin = (right / left) ** 0.12
    for panel in panels:
        panel.set_ylim(low, high * (high / low) ** (2.0 * LINE + 0.06))  # room for the words
        panel.set_xlim(left / margin, right * margin)
        panel.yaxis.set_major_locator(LogLocator(numticks=6))
        panel.yaxis.set_minor_formatter(NullFormatter())
        panel.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0) if right > 12.0 * left else (1.0, 2.0, 5.0)))
        panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        panel.xaxis.set_minor_formatter(NullFormatter())
