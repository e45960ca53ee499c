"""Figures of cracks that grow from the edge of the hole."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from fastpin.assess.crack import growth_curve
from fastpin.assess.outputs import write_csv
from fastpin.cracks import Growth
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.style import COLOURS, MAX_NAMED, draw_grid, line
from fastpin.figures.words import caption, quantity
from fastpin.model.angles import from_bottom
from fastpin.model.checks import instances
from fastpin.model.units import units


def crack_growth_of(found: Growth | Sequence[Growth]) -> Plot:
    """Draw the range of the stress intensity with the threshold over the length of a crack, and below it the growth.

    All axes are logarithmic. A dot marks the length at which a crack stops. Several cracks of one problem, or several
    laws, share the panels.
    """
    each = instances("found", [found] if isinstance(found, Growth) else found, Growth, "a Growth, or a list of them")
    if not 1 <= len(each) <= MAX_NAMED:
        raise InputError("found", f"must be a Growth, or a list of 1 to {MAX_NAMED} of them, not of {len(each)}")
    if any(one.problem != each[0].problem for one in each):
        raise InputError("found", "must be of one problem")
    if any(one.per != each[0].per for one in each):
        raise InputError("found", "must be all of cycles, or all of spectra")
    words = "; ".join(f"at {_place(one)}: {one.words}" for one in each)
    return Plot(
        lambda look: _draw(look, each),
        lambda path: write_csv([growth_curve(one) for one in each], path),
        f"Line chart of the range of the stress intensity and of the growth over the length of a crack {words}.",
        "Range of the stress intensity over the length of a crack, with the threshold, and the growth in a cycle.",
        doubts=[str(doubt) for one in each for doubt in one.doubts],
    )


plot_crack_growth = plotter("plot_crack_growth", crack_growth_of)


def _place(growth: Growth) -> str:
    return f"{from_bottom(growth.crack.theta):.1f} deg".replace("-", "−")


def _draw(look: Look, growths: Sequence[Growth]) -> Sheet:
    sheet, unit = look.sheet([2.4, 1.9], extra=1.4, sharex=True), units(growths[0].problem)
    top, bottom = sheet.axes[:, 0]
    length, length_name = unit["length"].scale([float(one.length[-1]) for one in growths])
    intensity, intensity_name = unit["stress intensity"].scale([float(one.delta_K.max()) for one in growths])
    finite = [one.rate[np.isfinite(one.rate)].max(initial=0.0) for one in growths]
    rate, rate_name = unit["crack growth"].scale([float(value) for value in finite])
    rate_name, handles = rate_name.replace("cycle", growths[0].per), []
    for k, one in enumerate(growths):
        a = length * one.length
        top.plot(a, _shown(intensity * one.delta_K), **line(k))
        top.plot(a, _shown(intensity * one.K_max), **line(k, 2, 1.0))
        top.plot(a, _shown(intensity * one.threshold), **line(k, 1, 1.0))
        bottom.plot(a, _shown(rate * one.rate), **line(k))
        if np.isfinite(one.arrest):
            stopped = np.interp(np.log(one.arrest), np.log(one.length), one.delta_K)
            top.plot(length * one.arrest, intensity * stopped, "o", markersize=4.5, color=COLOURS[k])
        handles.append(Line2D([], [], label=f"{_place(one)}: {one.words}".replace(" um", " µm"), **line(k)))
    for dashes, label in ((2, "largest K_I"), (1, "threshold")):
        handles.append(Line2D([], [], label=label, **line(7, dashes, 1.0)))
    for panel in (top, bottom):
        panel.set_xscale("log")
        panel.set_yscale("log")
        draw_grid(panel)
    top.set_ylabel(quantity("range of K", intensity_name))
    bottom.set_ylabel(quantity("growth", rate_name))
    bottom.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    bottom.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    bottom.xaxis.set_minor_formatter(NullFormatter())
    bottom.set_xlabel(quantity("length of the crack", length_name))
    bottom.set_xlim(
        length * min(float(one.length[0]) for one in growths), length * max(one.length[-1] for one in growths)
    )
    sheet.figure.align_ylabels([top, bottom])
    sheet.legend(handles, 1 if len(growths) > 1 else 3)
    sheet.head(look.title, caption=caption(growths[0].problem))
    return sheet


def _shown(values: np.ndarray) -> np.ndarray:
    """Values on a logarithmic axis: NaN where they are not positive, or infinite."""
    return np.where((values > 0.0) & np.isfinite(values), values, np.nan)
