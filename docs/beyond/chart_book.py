"""The book of charts: a PDF with a page for each chart, and a first page of words.

``python -m docs.beyond.chart_book charts.pdf`` writes it from a copy of the source.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fastpin.charts.groups import WIDTHS, load_parameter_at
from fastpin.charts.lookups import CHARTS, ChartQuantity, lookup
from fastpin.figures.sheet import Look, Sheet
from fastpin.figures.style import house_style, line, new_figure
from fastpin.model.checks import file_path
from fastpin.report.charts import chart_list
from fastpin.storage.files import replacing

FRICTIONS = (0.0, 0.1, 0.2, 0.4, 0.7, 1.0)
"""Coefficients of friction of the curves of like bodies."""

ALPHAS = (-0.6, -0.3, 0.0, 0.3, 0.6)
"""Dundurs' first parameter of the curves of unlike bodies; both bodies have nu = 0.3 there."""

MOST_UNLIKE = 10.0
"""Largest load parameter of the charts of unlike bodies."""

LOAD_PARAMETERS = (0.03, 0.1, 0.3, 1.0, 3.0)
"""Load parameters of the curves of cycles."""

POINTS = 161
"""Points of a curve."""

LOADS = {"body": "body load", "centre": "load at the centre"}


def write_chart_book(path: str | Path) -> None:
    """Write the book of charts as a PDF, whole or not at all. Equal data gives equal files.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    whole = replacing(file_path("path", path))
    with house_style(), whole as temporary, PdfPages(temporary, metadata={"CreationDate": None}) as pages:
        for figure in _pages():
            pages.savefig(figure)


def _pages() -> Iterator[Figure]:
    """The list of charts with ranges and bounds as text, then a page for each chart."""
    figure = new_figure(8.3, 11.7)
    figure.text(0.04, 0.97, "Charts of a pin in a hole", fontsize=14.0, va="top")
    figure.text(0.04, 0.94, chart_list(), fontsize=7.5, family="monospace", va="top", parse_math=False)
    yield figure
    for chart in CHARTS.values():
        yield (_cycle_page if chart.is_cycle else _first_load_page)(chart).figure


def _first_load_page(chart: ChartQuantity) -> Sheet:
    """Curves over the load parameter: like bodies by friction above, unlike bodies by alpha below."""
    sheet = Look(width=7.6).sheet([2.9, 2.9], columns=2, sharex=True, sharey="row")
    at = np.maximum(load_parameter_at(np.linspace(*WIDTHS, POINTS)), 1e-3)
    near = at[at <= MOST_UNLIKE]
    for column, load in enumerate(LOADS):
        above, below = sheet.axes[:, column]
        for k, friction in enumerate(FRICTIONS):
            _draw(above, chart, at, k, load_parameter=at, friction=friction, pin_load=load)
        for k, alpha in enumerate(ALPHAS):
            more = {"alpha": alpha, "beta": alpha * 0.4 / 1.4} if alpha else {}
            _draw(below, chart, near, k, load_parameter=near, friction=0.3, pin_load=load, **more)
        above.set_title(f"{LOADS[load]}, like bodies", fontsize=8.5)
        below.set_title(f"{LOADS[load]}, friction 0.3, $\\nu$ = 0.3 in both bodies", fontsize=8.5)
        below.set_xlabel("load parameter $L_p$")
        below.set_xscale("log")
    if chart.name == "peak_pressure":
        for panel in sheet.axes[:, 0]:
            panel.set_yscale("log")
    legend = []  # columns of a legend are filled first: a friction of the row above, an alpha of the row below
    for k, friction in enumerate(FRICTIONS):
        legend.append(Line2D([], [], **line(k, k), label=f"friction {friction:g}"))
        has_alpha = k < len(ALPHAS)
        label = f"$\\alpha$ = {ALPHAS[k]:g}" if has_alpha else " "
        legend.append(Line2D([], [], **(line(k, k) if has_alpha else {"linestyle": "none"}), label=label))
    _finish(sheet, chart, legend, "above: like bodies; below: unlike bodies. kolosov 1.8")
    return sheet


def _cycle_page(chart: ChartQuantity) -> Sheet:
    """Curves over the part of sliding, for two coefficients of friction and both rotations: like bodies by load
    parameter, then unlike bodies by alpha.
    """
    rows = [(rotation, is_like) for rotation in ("fixed", "free") for is_like in (True, False)]
    sheet = Look(width=7.6).sheet([2.2] * len(rows), columns=2, sharex=True)
    part = np.linspace(0.2, 1.0, POINTS)
    for (row, column), panel in np.ndenumerate(sheet.axes):
        friction, (rotation, is_like) = (0.2, 0.6)[column], rows[row]
        given = {"friction": friction, "load_ratio": part * friction, "rotation": rotation}
        for k, (at, alpha) in enumerate(zip(LOAD_PARAMETERS, ALPHAS, strict=True)):
            if is_like:
                _draw(panel, chart, part, k, load_parameter=at, **given)
            else:
                _draw(panel, chart, part, k, load_parameter=0.3, alpha=alpha, beta=alpha * 0.4 / 1.4, **given)
        bodies = "like bodies" if is_like else "unlike, $L_p$ = 0.3"
        panel.set_title(f"{bodies}, rotation {rotation}, friction {friction:g}", fontsize=8.5)
    for panel in sheet.axes[-1]:
        panel.set_xlabel("load ratio over friction $Q/\\mu P$")
    legend = []
    for k, (at, alpha) in enumerate(zip(LOAD_PARAMETERS, ALPHAS, strict=True)):
        legend += [Line2D([], [], **line(k, k), label=text) for text in (f"$L_p$ = {at:g}", f"$\\alpha$ = {alpha:g}")]
    _finish(sheet, chart, legend, "load at the centre, kolosov 1.8; unlike bodies: nu = 0.3 in both")
    return sheet


def _draw(panel: Axes, chart: ChartQuantity, across: np.ndarray, k: int, **given: Any) -> None:
    """Draw a curve and the band of its error."""
    found = lookup(chart.name, **given)
    scale = np.degrees(1.0) if chart.unit == "rad" else 1.0
    value, error = scale * found.value, scale * np.broadcast_to(found.error, found.value.shape)
    panel.plot(across, value, **line(k, k))
    panel.fill_between(across, np.maximum(value - error, 0.0), value + error, color=line(k)["color"], alpha=0.15, lw=0)


def _finish(sheet: Sheet, chart: ChartQuantity, legend: Sequence[Line2D], caption: str) -> None:
    unit = {"rad": "deg", "": "ratio"}.get(chart.unit, chart.unit.replace("beta*", "$\\beta^*$").replace("^2", "$^2$"))
    for panel in sheet.axes[:, 0]:
        panel.set_ylabel(f"{chart.name.replace('_', ' ')} ({unit})")
    sheet.grid()
    sheet.head(chart.words, caption=f"{caption}; bands: error bounds")
    sheet.legend(legend, len(legend) // 2)


if __name__ == "__main__":
    write_chart_book(sys.argv[1])
