"""Figures of fatigue along the edge of hole or pin."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fastpin.damage import Fatigue
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Sheet
from fastpin.figures.style import COLOURS, angle_axis, line
from fastpin.figures.words import ANGLE, caption, quantity, short
from fastpin.model.angles import from_bottom
from fastpin.model.checks import instance
from fastpin.model.units import scaled, units
from fastpin.report.case import edge_body

PLANES = 40
"""Planes that are drawn as short lines, spread over the edge."""

LEAST = 0.02
"""Least parameter with a plane, in parts of the largest."""


def plot_fatigue(
    found: Fatigue,
    path: str | Path | None = None,
    title: str = "",
    width: float = 6.7,
    dpi: float = 300.0,
    *,
    ax: Axes | None = None,
) -> Figure:
    """Draw the parameter of a criterion along the edge, with its hot spot, and below it the life if it is known.

    Short lines show the worst planes as they cut the edge: a line along the axis lies along the edge, an upright line
    is a crack that goes straight into the body.

    Parameters
    ----------
    found : Fatigue
        Of points at one depth, such as from :meth:`fastpin.Result.fatigue`.
    path, title, width, dpi, ax
        See :func:`fastpin.plot_tractions`.

    Raises
    ------
    InputError
        If `found` is no fatigue of points at one depth. Also see :func:`fastpin.plot_tractions`.
    """
    instance("found", found, Fatigue, "a fatigue result, such as result.fatigue(...)")
    if np.ptp(found.depth) > 0.0:
        raise InputError("found", "must be of points at one depth")
    look = Look(path, title, width, dpi, ax)
    return look.drawn(lambda: _draw(found, look))


def _draw(found: Fatigue, look: Look) -> Sheet:
    sheet = look.sheet([2.2] * (1 if found.life is None else 2), extra=1.2)
    axes = sheet.axes
    sheet.grid()
    theta, parameter = found.theta.ravel(), found.parameter.ravel()
    angle = np.array([from_bottom(place) for place in theta.tolist()])
    order, spot = np.argsort(angle), found.hot_spot
    angle, parameter = angle[order], parameter[order]
    top = axes[0, 0]
    factor, unit = scaled([spot.parameter], found.unit)
    parameter = factor * parameter
    top.plot(angle, parameter, **line(0))
    top.plot(from_bottom(spot.theta), factor * spot.parameter, "o", markersize=4.5, color=COLOURS[1])
    top.set_ylabel(quantity(f"parameter of\n{found.criterion}", unit))
    lowest, highest = float(parameter.min()), float(parameter.max())
    top.set_ylim(min(1.15 * lowest, 0.0), max(1.15 * highest, 0.0) or 1.0)
    where = f"hot spot at {from_bottom(spot.theta):.1f} deg".replace("-", "−")
    handles = [Line2D([], [], label=where, linestyle="none", marker="o", markersize=4.5, color=COLOURS[1])]
    if found.plane is not None:
        _draw_planes(top, angle, parameter, (found.plane.ravel() - theta)[order])
        handles.append(Line2D([], [], color="0.3", linewidth=1.0, label="worst planes"))
    if found.limit is not None and found.limit < 3.0 * spot.parameter:
        top.axhline(factor * found.limit, **line(2, 1))
        handles.append(Line2D([], [], label="fatigue limit", **line(2, 1)))
    if found.life is not None:
        life = found.life.ravel()[order]
        axes[1, 0].semilogy(angle, np.where(np.isfinite(life), life, np.nan), **line(0))
        axes[1, 0].set_ylabel("life (cycles)")
        shortest = float(np.nanmin(life))
        if math.isfinite(shortest):
            axes[1, 0].set_ylim(0.5 * shortest, 1e4 * shortest)
    for panel in axes[:, 0]:
        panel.set_xlim(-180.0, 180.0)
        angle_axis(panel)
    axes[-1, 0].set_xlabel(ANGLE)
    sheet.figure.align_ylabels(axes)
    sheet.legend(handles, len(handles))
    depth = float(found.depth.ravel()[0])
    place = "on the edge" if depth == 0.0 else f"{short(depth, units(found.problem)['length'])} below the edge"
    sheet.head(look.title, f"{edge_body(found.problem, found.body)}, {place}", caption=caption(found.problem))
    return sheet


def _draw_planes(panel: Axes, angle: np.ndarray, parameter: np.ndarray, turned: np.ndarray) -> None:
    """Draw planes as short lines; `turned` is the angle from the edge to the plane, rad."""
    cells = np.floor((angle + 180.0) / 360.0 * PLANES)
    drawn = [int(np.flatnonzero(cells == cell)[np.argmax(parameter[cells == cell])]) for cell in np.unique(cells)]
    drawn = [k for k in drawn if np.isfinite(turned[k]) and parameter[k] >= LEAST * parameter.max()]
    panel.quiver(
        angle[drawn], parameter[drawn], np.cos(turned[drawn]), np.sin(turned[drawn]), color="0.3", pivot="middle",
        units="inches", width=0.014, headwidth=1.0, headlength=0.0, headaxislength=0.0, scale=8.0, scale_units="inches",
    )  # fmt: skip
