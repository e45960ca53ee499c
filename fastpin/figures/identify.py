"""Figures of measured loops beside the computed ones."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.style import COLOURS, caption, line, quantity
from fastpin.model import checks, loads
from fastpin.model.units import units
from fastpin.report.identify import loop_curve
from fastpin.studies.identification import Identified


def identified_of(found: Identified) -> Plot:
    """Draw a measured loop with the computed one, the energy of each whole cycle, and the friction of each cycle.

    The second panel shows both loops less the straight line through the ends of the computed one: most of a loop is
    elastic, and a slender one is a line. Both loops have the measured offsets and drift. Bars are intervals of 95 %. An
    arrow stands for an interval without an upper bound.
    """
    checks.instance("found", found, Identified, "an Identified")
    return Plot(
        lambda look: _draw(look, found),
        [loop_curve(found)],
        f"Measured samples of {found.names[1]} over {found.names[0]} on the computed loop, and energies by cycle.",
        "Measured samples and computed loop, and the energy of each whole cycle.",
        doubts=found.notes,
    )


plot_identified = plotter("plot_identified", identified_of)


def _draw(look: Look, found: Identified) -> Sheet:
    by_cycle = len(found.frictions) > 1
    heights = [2.6, 2.2] + [1.4] * bool(len(found.energies)) + [1.4] * by_cycle
    sheet = look.sheet(heights, extra=1.3)
    sheet.grid()
    panels = list(sheet.axes[:, 0])
    handles = _draw_loops(panels.pop(0), panels.pop(0), found)
    if len(found.energies):
        _draw_energies(panels.pop(0), found)
    if by_cycle:
        _draw_frictions(panels[0], found)
    sheet.figure.align_ylabels(sheet.axes)
    friction = found.frictions[0]
    words = f"friction {friction.value:.3g}, 95 %: {friction.low:.3g} to {friction.high:.3g}"
    if math.isnan(friction.value):
        words = f"friction at least {friction.low:.3g}"
    sheet.head(look.title, "" if by_cycle else words.replace("inf", "no bound"), caption=caption(found.problem))
    sheet.legend(handles, 2)
    return sheet


def _draw_loops(panel: Axes, lower: Axes, found: Identified) -> list[Line2D]:
    """Draw the loops, and below them what is left of their forces without a straight line."""
    unit, loop, (x, y) = units(found.problem), found.loop, found.computed
    moves, move_unit = unit[loads.LOAD_KIND[found.names[0]]].scale(x.tolist())
    low, high = int(np.argmin(x)), int(np.argmax(x))
    slope = (y[high] - y[low]) / (x[high] - x[low])

    def left(displacement: np.ndarray, force: np.ndarray) -> np.ndarray:
        return force - y[low] - slope * (displacement - x[low])

    measured = (loop.displacement, loop.force)
    for each, forces in ((panel, (loop.force, y)), (lower, (left(*measured), left(x, y)))):
        factor, label = unit[loads.LOAD_KIND[found.names[1]]].scale(np.concatenate(forces).tolist())
        each.plot(moves * loop.displacement, factor * forces[0], ".", markersize=2.5, color="0.5", zorder=2)
        each.plot(moves * x, factor * forces[1], zorder=3, **line(0, width=1.1))
        words = loads.LOAD[found.names[1]].short
        each.set_ylabel(quantity(words if each is panel else f"{words} less a line", label))
    lower.set_xlabel(quantity(loads.LOAD[found.names[0]].short, move_unit))
    dots = Line2D([], [], marker=".", linestyle="none", color="0.5", label=f"measured, {loop.time.size:,} samples")
    return [dots, Line2D([], [], label="computed", **line(0))]


def _draw_energies(panel: Axes, found: Identified) -> None:
    factor, label = units(found.problem)["energy"].scale(found.energies.ravel().tolist())
    cycles = np.arange(1, len(found.energies) + 1)
    measured, deviation, computed = factor * found.energies.T
    panel.errorbar(cycles, measured, 1.96 * deviation, fmt="o", markersize=4.0, linewidth=1.0, color="0.45")
    panel.plot(cycles, computed, marker="_", markersize=12.0, markeredgewidth=1.6, **line(0))
    _set_cycles(panel, len(cycles))
    panel.set_ylim(bottom=min(0.0, panel.get_ylim()[0]))
    panel.set_ylabel(quantity("energy", label))


def _draw_frictions(panel: Axes, found: Identified) -> None:
    top = max(each.high if math.isfinite(each.high) else 1.3 * each.low for each in found.frictions)
    for cycle, each in enumerate(found.frictions, start=1):
        bounded = math.isfinite(each.high)
        end = each.high if bounded else top
        panel.plot([cycle, cycle], [each.low, end], color=COLOURS[1], linewidth=1.2)
        panel.plot([cycle], [end], marker="_" if bounded else "^", markersize=6.0, color=COLOURS[1])
        panel.plot([cycle, cycle], [each.low, each.value], "o", markersize=3.5, color=COLOURS[1], markevery=[1])
    _set_cycles(panel, len(found.frictions))
    panel.set_ylabel("friction")


def _set_cycles(panel: Axes, count: int) -> None:
    panel.set_xlim(0.5, count + 0.5)
    panel.xaxis.set_major_locator(MaxNLocator(8, integer=True, min_n_ticks=1))
    panel.set_xlabel("cycle")
