"""Figures of load cycles: how the contact changes from cycle to cycle."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, LogFormatterSciNotation, LogLocator, MaxNLocator, NullLocator

from fastpin.assess.cycle import cycles_curve
from fastpin.assess.outputs import ROUNDING
from fastpin.errors import InputError
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import Subject, with_cycles
from fastpin.figures.style import MAX_NAMED, caption, line, quantity, without_rounding
from fastpin.model import checks, loads
from fastpin.model.units import units
from fastpin.solver.result import Result
from fastpin.states.cycles import Cycle, consecutive_cycles, periodic_from

MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
"""Marks of cycles of different lengths, which differ without colour."""

PERIODIC: dict[str, Any] = {"color": "0.45", "linewidth": 0.8, "linestyle": (0, (1.0, 2.0))}
"""Line of the first periodic cycle of a block."""

CHANGE, DISSIPATION, ROTATION = (
    "largest change of\ntractions / peak N",
    "dissipated\nin the cycle",
    "turned by all\ncycles so far",
)
"""Words of the panels."""

CHANGES = {"pressure_change": "pressure", "shear_change": "shear"}
"""Changes of a cycle, and their words."""


def cycles_plot(subject: Subject) -> Plot:
    """Return the changes of all cycles of a result."""
    return cycles_of(with_cycles(subject))


def cycles_of(result: Result) -> Plot:
    """Draw the changes that each cycle of a load history makes, from the beginning to the end of the cycle.

    Cycles count from 1 in the order of their ends, also those that contain others. The upper panel shows the largest
    change of pressure and shear traction, relative to the largest pressure. The middle panel shows the energy
    dissipated in each cycle. Both scales are logarithmic; 0 stands at their lower end. Values below rounding are 0. A
    vertical line marks the end of the first cycle from which on the contact is periodic. The lower panel sums up how
    far the cycles so far have turned the pin (ratcheting), counter-clockwise positive. Cycles that contain others have
    a sum of their own. A panel whose values are all 0 to rounding is left out.

    Without cycles this raises :class:`InputError`.
    """
    checks.instance("result", result, Result, "a Result")
    if not result.cycles:
        raise InputError("cycles", "the history has no repeated blocks")
    return Plot(
        lambda look: _draw(look, result),
        [cycles_curve(result.problem, result.cycles)],
        f"Line charts of the changes that each of {len(result.cycles):,} cycles makes.",
        "Changes of the tractions over each cycle, its dissipation, and the rotation of the pin in all.",
    )


plot_cycles = plotter("plot_cycles", cycles_of)


def _draw(look: Look, result: Result) -> Sheet:
    kind, cycles = units(result.problem), result.cycles
    lengths = sorted({cycle.length for cycle in cycles})[:MAX_NAMED]
    energy, unit = units(result.problem)["energy"].scale([cycle.dissipation for cycle in cycles])
    turns = _turned(cycles)
    angle, unit_of_angle = kind["rotation"].scale(np.concatenate(list(turns.values())).tolist())
    shown = _panels_with_values(result, turns)
    sheet = look.sheet([1.7] * len(shown), extra=1.2, sharex=True)
    panels = dict(zip(shown, sheet.axes[:, 0], strict=True))
    sheet.grid()
    numbers = {(cycle.length, cycle.corner): number for number, cycle in enumerate(cycles, start=1)}
    ends = [cycle.corner for cycle in cycles]
    changes = [np.array([getattr(cycle, name) for cycle in cycles]) for name in CHANGES]
    floors = [_floor(np.concatenate(changes)), _floor(energy * np.array([cycle.dissipation for cycle in cycles]))]
    for kind_of_length, length in enumerate(lengths):
        mine = [cycle for cycle in cycles if cycle.length == length]
        for part in _parts(mine):  # the blocks of one length stand apart where other blocks lie between them
            where = [numbers[length, cycle.corner] for cycle in part]
            begin = bisect_right(ends, part[0].corner - length)  # cycles that had ended before
            if ROTATION in panels:
                turn = angle * turns[length, part[0].corner]
                panels[ROTATION].plot([begin, *where], turn, **_style(kind_of_length, 0, len(mine)))
            for dashes, name in enumerate(CHANGES if CHANGE in panels else ()):
                drawn = _above(np.array([getattr(cycle, name) for cycle in part]), floors[0])
                panels[CHANGE].plot(where, drawn, **_style(kind_of_length, dashes, len(mine)))
            if DISSIPATION in panels:
                lost = energy * np.array([cycle.dissipation for cycle in part])
                panels[DISSIPATION].plot(where, _above(lost, floors[1]), **_style(kind_of_length, 0, len(mine)))
    words = {CHANGE: CHANGE, DISSIPATION: quantity(DISSIPATION, unit), ROTATION: quantity(ROTATION, unit_of_angle)}
    for name, panel in panels.items():
        panel.set_ylabel(words[name])
        if name != ROTATION:
            _log_axis_with_zero(panel, floors[name == DISSIPATION])
    drawn_panels = list(panels.values())
    marked = _mark_periodic(drawn_panels, cycles, numbers)
    _cycle_axis(drawn_panels, cycles)
    sheet.figure.align_ylabels(drawn_panels)
    sheet.head(look.title, _counts(cycles), caption=caption(result.problem))
    handles = _handles(lengths, marked)
    sheet.legend(handles, min(len(handles), 4))
    return sheet


def _panels_with_values(result: Result, turns: dict[tuple[int, int], np.ndarray]) -> list[str]:
    """Return the panels with values beyond rounding; the first panel without any."""
    cycles, surfaces, radius = result.cycles, result.problem.surfaces, result.problem.hole_radius
    largest_loads = dict(zip(loads.LOADS, np.abs(result.history.distinct()).max(axis=0).tolist(), strict=True))
    strains = {"force": surfaces.beta_star / radius, "traction": surfaces.beta_star, "displacement": 1.0 / radius}
    strain = max(strains.get(loads.LOAD_KIND[name], 0.0) * load for name, load in largest_loads.items())
    changes = [getattr(cycle, name) for cycle in cycles for name in CHANGES]
    found = {
        CHANGE: max(np.nan_to_num(changes), default=0.0),
        DISSIPATION: max(np.nan_to_num([abs(cycle.dissipation) for cycle in cycles])),
        ROTATION: max(float(np.abs(turned).max()) for turned in turns.values()),
    }
    least = {ROTATION: ROUNDING * strain}
    return [name for name, largest in found.items() if largest > least.get(name, 0.0)] or [CHANGE]


def _turned(cycles: Sequence[Cycle]) -> dict[tuple[int, int], np.ndarray]:
    """Return the rotation of the pin by all cycles so far, rad, for each part of :func:`_parts`.

    The keys are length and last corner of the part's first cycle. A part goes on from the last part that ended before
    it began, of any length. Sums below rounding are 0.
    """
    lengths = {cycle.length for cycle in cycles}
    parts = [part for length in lengths for part in _parts([each for each in cycles if each.length == length])]
    parts.sort(key=lambda part: part[-1].corner)
    ended: list[tuple[int, float]] = [(-1, 0.0)]
    found: dict[tuple[int, int], np.ndarray] = {}
    for part in parts:
        begin = part[0].corner - part[0].length
        before = next(turned for corner, turned in reversed(ended) if corner <= max(begin, -1))
        turned = before + np.nancumsum([0.0, *(cycle.rotation_change for cycle in part)])
        found[part[0].length, part[0].corner] = turned
        ended.append((part[-1].corner, float(turned[-1])))
    largest = max(float(np.abs(turned).max()) for turned in found.values())
    return {key: without_rounding(turned, largest) for key, turned in found.items()}


def _parts(cycles: Sequence[Cycle]) -> list[list[Cycle]]:
    """Return runs of cycles of one length. Each cycle of a run begins where the cycle before it ends."""
    parts: list[list[Cycle]] = []
    for cycle in cycles:
        if parts and parts[-1][-1].corner + cycle.length == cycle.corner:
            parts[-1].append(cycle)
        else:
            parts.append([cycle])
    return parts


def _style(kind: int, dashes: int, count: int) -> dict[str, Any]:
    """Return a line with marks. Each length of cycles has a mark of its own. Marks of shear are open."""
    marks: dict[str, Any] = {"marker": MARKERS[kind], "markersize": 3.8, "clip_on": False, "zorder": 3}
    if count > 60:  # of more cycles some have a mark
        marks["markevery"] = 0.12  # distance of the marks, in diagonals of the panel
    if dashes:
        marks["markerfacecolor"] = "white"
    return {**line(kind, dashes), **marks}


def _floor(values: np.ndarray) -> float:
    """Return the power of ten below the smallest significant value. It stands for 0 on a logarithmic axis."""
    known = values[np.isfinite(values)]
    positive = known[known > ROUNDING * np.max(known, initial=0.0)]
    return 10.0 ** (math.floor(math.log10(positive.min())) - 1) if positive.size else 0.1


def _above(values: np.ndarray, floor: float) -> np.ndarray:
    """Return values of at least `floor`, which stands for 0. NaN stays."""
    return np.where(np.isnan(values), np.nan, np.maximum(values, floor))


def _log_axis_with_zero(panel: Axes, floor: float) -> None:
    """Make the axis logarithmic from the floor on, which is named 0."""
    panel.set_yscale("log")
    top = max((float(np.nanmax(drawn.get_ydata())) for drawn in panel.lines if np.isfinite(drawn.get_ydata()).any()),
              default=10.0 * floor)  # fmt: skip
    panel.set_ylim(floor, max(2.0 * top, 10.0 * floor))
    decades = math.ceil(math.log10(panel.get_ylim()[1] / floor))
    step = max(1, math.ceil(decades / 5))
    ticks = [floor * 10.0**k for k in range(0, decades + 1, step) if floor * 10.0**k <= panel.get_ylim()[1]]
    written = LogFormatterSciNotation()
    written.create_dummy_axis()
    panel.yaxis.set_major_locator(FixedLocator(ticks))
    panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: "0" if value < 1.5 * floor else written(value)))
    panel.yaxis.set_minor_locator(NullLocator())


def _mark_periodic(panels: Sequence[Axes], cycles: Sequence[Cycle], numbers: dict[tuple[int, int], int]) -> bool:
    """Mark the first periodic cycle of each block, and return whether there is one."""
    steady = [found for block in consecutive_cycles(cycles) if (found := periodic_from(block)) is not None]
    for found in steady[:MAX_NAMED]:
        for panel in panels:
            panel.axvline(numbers[found.length, found.corner], zorder=1, **PERIODIC)
    return bool(steady)


def _cycle_axis(panels: Sequence[Axes], cycles: Sequence[Cycle]) -> None:
    """Set the axis of cycles: logarithmic for one long block, since transients are short, else with whole numbers.

    A logarithmic axis would squeeze all blocks but the first.
    """
    last = len(cycles)
    panels[-1].set_xlabel("cycle (1: first of the history)")
    if last > 50 and len(consecutive_cycles(cycles)) == 1:
        for panel in panels:
            panel.set_xscale("log")
            panel.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=15))
            panel.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
            panel.xaxis.set_minor_locator(NullLocator())
        panels[0].set_xlim(0.93, 1.07 * last)
        return
    panels[0].set_xlim(-0.02 * last, 1.02 * last)
    panels[-1].xaxis.set_major_locator(MaxNLocator(nbins=9, integer=True, min_n_ticks=1))


def _counts(cycles: Sequence[Cycle]) -> str:
    """Return the number of cycles, and the first periodic one, as text."""
    steady = periodic_from(consecutive_cycles(cycles)[-1])
    words = f"periodic from cycle {steady.number:,} of the last block on" if steady else "not yet periodic"
    return f"{len(cycles):,} cycle{'s' if len(cycles) > 1 else ''}, {words}"


def _handles(lengths: Sequence[int], marked: bool) -> list[Artist]:
    handles: list[Artist] = [
        Line2D([], [], label=f"cycles of {length} corner{'s' if length > 1 else ''}", **_style(kind, 0, 1))
        for kind, length in enumerate(lengths)
    ]
    for dashes, name in enumerate(CHANGES.values()):
        style = {**_style(0, dashes, 1), "color": "0.3"}
        handles.append(Line2D([], [], label=f"change of {name}", **style))
    if marked:
        handles.append(Line2D([], [], label="periodic from here", **PERIODIC))
    return handles
