"""Figures of load cycles."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from fastpin.errors import InputError
from fastpin.figures.style import MAX_NAMED, draw_and_save, fitted_legend, line
from fastpin.model.units import scaled, units
from fastpin.solver.result import Result
from fastpin.states.cycles import consecutive_cycles


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
    return draw_and_save(lambda: _draw_cycles(result, title, width), path, dpi)


def _draw_cycles(result: Result, title: str, width: float) -> Figure:
    figure = Figure(figsize=(width, 0.95 * width), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(3, 1, sharex=True)
    kind = units(result.problem)
    lengths = sorted({cycle.length for cycle in result.cycles})[:MAX_NAMED]
    shown = [one for one in consecutive_cycles(result.cycles) if one[0].length in lengths]
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
    fitted_legend(figure, handles, min(len(handles), 4))
    if len({cycle.corner for cycle in result.cycles}) > 1:
        panels[2].xaxis.set_major_locator(MaxNLocator(nbins=9, integer=True))
    figure.align_ylabels(panels)
    if title:
        figure.suptitle(title, fontsize=9.5)
    return figure
