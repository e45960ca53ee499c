"""Figures of convergence studies: distance to the limit against the number of nodes and of increments."""

from __future__ import annotations

import math
import textwrap
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Sheet
from fastpin.figures.style import Line, line
from fastpin.figures.words import caption, loads_text, quantity
from fastpin.model.checks import as_toml, instance, whole_number
from fastpin.model.units import scaled
from fastpin.report.convergence import ReportedSeries, reported_series
from fastpin.states.quantities import QUANTITIES
from fastpin.studies.convergence import Convergence

MOST_PANELS = 9
"""Most panels of a figure."""

COLUMNS = 3
"""Panels side by side."""

ORDER_OF_PANELS = (
    "peak_pressure", "peak_shear", "shear_magnitude", "contact_1_start", "contact_1_stop", "stick_1_start",
    "stick_1_stop", "rotation", "dissipation", "dx", "dy", "pressure_integral",
)  # fmt: skip
"""Quantities that get the first panels. All other quantities follow."""

_GUIDES: dict[int, Line] = {1: {"color": "0.6", "linestyle": (0, (4.0, 2.0)), "linewidth": 0.8},
           2: {"color": "0.6", "linestyle": (0, (1.0, 1.5)), "linewidth": 1.0}}  # fmt: skip

_STYLES: dict[str, Line] = {"path": {**line(0), "marker": "o"}, "increment": {**line(1, 1), "marker": "s"}}
_NAMES = {"path": "path solver, against nodes", "increment": "increment solver, {} nodes, against increments a step"}
TITLE_WIDTH = 90
"""Characters in a line of the title."""


def plot_convergence(
    convergence: Convergence,
    path: str | Path | None = None,
    corner: int | None = None,
    title: str = "",
    dpi: float = 300.0,
    *,
    width: float = 7.6,
    ax: Axes | None = None,
) -> Figure:
    """Draw the convergence at one corner, with up to nine panels, one for each outcome or quantity.

    A panel shows the distance of the values to the limit of their sequence, against the number of nodes or of
    increments. Marks are filled if an order is observed; the panel names it. Else the marks are open, and the distance
    is measured from the last value. A dash at the last count is the error bar. Guides have the orders 1 and 2.
    Quantities that are exact to rounding, or can't be compared, have no panel.

    Parameters
    ----------
    convergence : Convergence
    path : path, optional
        Also save the figure; the suffix chooses the format.
    corner : int, optional
        From 1; the last corner of the study unless given.
    title, dpi, width, ax
        See :func:`fastpin.plot_tractions`.

    Returns
    -------
    Figure
        The new figure, or the figure of `ax`.

    Raises
    ------
    InputError
        If an argument is out of range, the figure's format is unknown, or the file can't be written.
    """
    instance("convergence", convergence, Convergence, "a Convergence")
    look = Look(path, title, width, dpi, ax)
    chosen = max(convergence.loads) if corner is None else whole_number("corner", corner, 1)
    if chosen not in convergence.loads:
        studied = ", ".join(map(str, convergence.loads))
        raise InputError("corner", f"must be a studied corner: {studied}, not {as_toml(chosen)}")
    return look.drawn(lambda: _draw(convergence, chosen, look))


def _draw(convergence: Convergence, corner: int, look: Look) -> Sheet:
    found: dict[str, dict[str, tuple[tuple[int, ...], ReportedSeries]]] = {}
    for study in convergence.studies:
        for row in reported_series(study, convergence.problem, corner):
            if row.verdict in ("observed", "not observed"):
                found.setdefault(row.name, {})[study.method] = study.counts, row
    chosen = [name for name, rows in found.items() if any(row.is_outcome for _, row in rows.values())]
    names = [name for name in (*chosen, *ORDER_OF_PANELS, *QUANTITIES, *found) if name in found]
    names = list(dict.fromkeys(names))[:MOST_PANELS]
    rows = max(1, math.ceil(len(names) / COLUMNS))
    sheet = look.sheet([2.0] * rows, columns=COLUMNS)
    axes = sheet.axes
    sheet.grid()
    for index, panel in enumerate(axes.flat):
        panel.set_visible(index < len(names))
        if index + COLUMNS >= len(names):
            panel.set_xlabel("nodes; increments a step" if len(convergence.studies) > 1 else "nodes")
    for name, panel in zip(names, axes.flat, strict=False):
        _draw_panel(panel, found[name])
    for panel in axes[:, 0]:
        panel.set_ylabel("| value \N{MINUS SIGN} limit |")
    methods = list(dict.fromkeys(method for each in found.values() for method in each))
    guides: list[tuple[str, Line]] = [(f"order {order}", style) for order, style in _GUIDES.items()]
    open_marks: Line = {"color": "0.3", "linestyle": "none", "marker": "o", "markersize": 4.0, "fillstyle": "none"}
    bar: Line = {"color": "0.3", "linestyle": "none", "marker": "_", "markersize": 9.0, "markeredgewidth": 1.6}
    entries: list[tuple[str, Line]] = [
        (_NAMES[study.method].format(study.nodes), {**_STYLES[study.method], "markersize": 4.0})
        for study in convergence.studies
        if study.method in methods
    ]
    entries += [("no order observed: to the last value", open_marks), ("error bar of the last value", bar), *guides]
    sheet.legend([Line2D([], [], label=label, **style) for label, style in entries], 2)
    heading = f"corner {corner}: {loads_text(convergence.problem, convergence.loads[corner])}"
    sheet.head(*textwrap.wrap(look.title, TITLE_WIDTH), heading, caption=caption(convergence.problem))
    return sheet


def _draw_panel(panel: Axes, sequences: dict[str, tuple[tuple[int, ...], ReportedSeries]]) -> None:
    rows = [row for _, row in sequences.values()]
    largest = max(float(np.ptp(row.values)) for row in rows)
    factor, unit = scaled([largest], rows[0].unit)
    panel.set_title(quantity(rows[0].label, unit), fontsize=8.5, parse_math=False)
    panel.set_xscale("log")
    panel.set_yscale("log")
    words = []
    for method, (counts, row) in sequences.items():
        style = _STYLES[method]
        observed = row.verdict == "observed"
        distance = factor * np.abs(np.subtract(row.values, row.limit if observed else row.values[-1]))
        distance[distance == 0.0] = np.nan
        fillstyle = "full" if observed else "none"
        panel.plot(counts, distance, markersize=3.6, fillstyle=fillstyle, **style)
        panel.plot(
            counts[-1:], [factor * row.bar], marker="_", markersize=9.0, markeredgewidth=1.6, color=style["color"]
        )
        words.append((f"order {row.order:.1f}" if observed else "no order", style["color"]))
        if np.isfinite(distance).any():
            first = int(np.flatnonzero(np.isfinite(distance))[0])
            span = np.array([counts[first], counts[-1]], dtype=float)
            for order, guide in _GUIDES.items():
                panel.plot(span, distance[first] * (counts[first] / span) ** order, zorder=0, **guide)
    for place, (word, colour) in enumerate(words):
        panel.text(
            0.98, 0.98 - 0.11 * place, word, color=colour, fontsize=8.0, ha="right", va="top", transform=panel.transAxes
        )
    panel.margins(x=0.12, y=0.08)
    low, high = panel.get_ylim()
    low = min(low, high / 30.0)  # a decade at least
    if high < 100.0 * low:
        panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.yaxis.set_minor_formatter(NullFormatter())
    panel.set_ylim(low, high * (high / low) ** (0.14 * len(words) + 0.04))  # room for the words
    left, right = panel.get_xlim()
    panel.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0) if right > 12.0 * left else (1.0, 2.0, 5.0)))
    panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    panel.xaxis.set_minor_formatter(NullFormatter())
