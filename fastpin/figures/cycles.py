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
from fastpin.figures.style import MAX_NAMED, check_figure_text, draw_and_save, fitted_legend, line
from fastpin.model.checks import instance
from fastpin.model.units import scaled, units
from fastpin.solver.result import Result
from fastpin.states.cycles import consecutive_cycles


def plot_cycles(
    result: Result, path: str | Path | None = None, width: float = 6.7, title: str = "", dpi: float = 200.0
) -> Figure:
    """Draw the changes that each cycle of a load history makes, from the beginning to the end of the cycle.

    The upper panel shows the largest change of pressure and shear traction, relative to the largest pressure. Its scale
    is logarithmic, so it omits the cycles of a periodic contact, whose change is zero to rounding. The middle panel
    shows the energy dissipated in each cycle. The lower panel shows how far the cycles of a block have turned the pin
    in all (ratcheting), counter-clockwise positive.

    Parameters
    ----------
    result : Result
        Result of a history with repeated blocks.
    path, title, width, dpi
        See :func:`fastpin.plot_tractions`.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there are no cycles, an argument is out of range, or the figure's format is unknown.
    """
    inches = check_figure_text(title, width)
    instance("result", result, Result, "a Result")
    if not result.cycles:
        raise InputError("cycles", "the history has no repeated blocks")
    return draw_and_save(lambda: _draw_cycles(result, title, inches), path, dpi)


def _draw_cycles(result: Result, title: str, width: float) -> Figure:
    figure = Figure(figsize=(width, 0.95 * width), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(3, 1, sharex=True)
    kind = units(result.problem)
    lengths = sorted({cycle.length for cycle in result.cycles})[:MAX_NAMED]
    blocks = [cycles for cycles in consecutive_cycles(result.cycles) if cycles[0].length in lengths]
    energy, unit = scaled([cycle.dissipation for cycle in result.cycles], kind["energy"])
    turns = [np.nancumsum([0.0, *(cycle.rotation_change for cycle in cycles)]) for cycles in blocks]
    angle, unit_of_angle = scaled(np.concatenate(turns).tolist(), kind["rotation"])
    for cycles, turn in zip(blocks, turns, strict=True):
        colour = lengths.index(cycles[0].length)
        corner = [cycle.corner + 1 for cycle in cycles]
        marker: dict[str, Any] = {"marker": "o", "markersize": 2.2} if len(cycles) <= 60 else {}
        for dashes, field in enumerate(("pressure_change", "shear_change")):
            change = np.array([getattr(cycle, field) for cycle in cycles])
            change[change == 0.0] = np.nan
            panels[0].plot(corner, change, **line(colour, dashes), **marker)
        dissipated = np.array([energy * cycle.dissipation for cycle in cycles])
        dissipated[~(dissipated > 0.0)] = np.nan
        panels[1].plot(corner, dissipated, **line(colour), **marker)
        panels[2].plot([corner[0] - cycles[0].length, *corner], angle * turn, **line(colour), **marker)
    for panel in panels[:2]:
        panel.set_yscale("log")
    largest = np.nanmax([0.0, *(energy * cycle.dissipation for cycle in result.cycles)])
    if largest > 0.0:
        panels[1].set_ylim(bottom=max(panels[1].get_ylim()[0], 1e-9 * largest))  # less is rounding
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
        figure.suptitle(title, fontsize=9.5, parse_math=False)
    return figure
