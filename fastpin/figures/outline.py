"""Figure of the hoop stress along the outline and the further holes of a plate of any outline."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import groupby

import numpy as np
from matplotlib.lines import Line2D

from fastpin.assess.outputs import Curve, write_csv
from fastpin.figures.sheet import Look, Plot, Sheet, plotter
from fastpin.figures.states import DrawnStates, InMemory, Subject, name_states, state_lines
from fastpin.figures.style import draw_zero, points_text, quantity
from fastpin.model.units import units
from fastpin.report.stress import outline_curves
from fastpin.states.choice import StateChoice
from fastpin.states.margins import part_of


def outline_plot(subject: Subject, states: StateChoice = None) -> Plot:
    """Draw the hoop stress along the outline, counter-clockwise, and then along the further holes.

    A dot marks the largest value of each state. Tension is positive. A plate without an outline raises
    :class:`InputError`. See :func:`fastpin.plot_tractions` for the `states`.
    """
    drawn = subject.states(states, extremes=(("peak_hoop_outline", "largest"),))
    curves = outline_curves(drawn)
    left_out = part_of(drawn[0].problem, "plate")
    return Plot(
        lambda look: _draw(look, drawn, curves),
        partial(write_csv, curves),
        f"Line chart of the hoop stress along the outline of the plate, at load points {points_text(drawn)}.",
        f"Hoop stress along the outline of the plate{f', {left_out}' if left_out else ''}. Dots mark the largest value "
        "of each state.",
        drawn.notes,
    )


plot_outline = plotter("plot_outline", outline_plot, InMemory)


def _draw(look: Look, states: DrawnStates, curves: Sequence[Curve]) -> Sheet:
    sheet = look.sheet([2.6], extra=1.5)
    panel, unit, edges = sheet.axes[0, 0], units(states[0].problem), curves[0]["edge"]
    along, hoop = (next(name for name in curves[0].columns if name.startswith(word)) for word in ("along", "hoop"))
    factor, label = unit["traction"].printed.scale([float(np.abs(curve[hoop]).max()) for curve in curves])
    length, length_label = unit["length"].printed.scale([float(curves[0][along].max())])
    sides = [list(group) for _, group in groupby(range(edges.size), lambda k: edges[k])]
    for state, curve, style in zip(states, curves, state_lines(states), strict=True):
        x, y = length * curve[along], factor * curve[hoop]
        for side in sides:
            panel.plot(x[side], y[side], **style)
        found, peak = state.outline_hoop_stress(), state.outline_peak
        top = int(np.argmin(np.hypot(found.x - peak.x, found.y - peak.y)))
        panel.plot(x[top], y[top], "o", markersize=4.0, color=style["color"])
    for side in sides:
        start, end = (length * curves[0][along][k] for k in (side[0], side[-1]))
        panel.axvline(start, color="0.8", linewidth=0.6, zorder=0)
        panel.text(
            0.5 * (start + end), 0.98, edges[side[0]], rotation=90.0, ha="center", va="top", fontsize=7.0, color="0.4",
            transform=panel.get_xaxis_transform(), parse_math=False,
        )  # fmt: skip
    draw_zero(panel)
    panel.set_xlabel(quantity("along the outline, counter-clockwise, then the further holes", length_label))
    panel.set_ylabel(quantity("hoop stress", label))
    dot = Line2D([], [], linestyle="none", marker="o", markersize=4.0, color="0.4", label="largest of each state")
    name_states(sheet, states, [look.title], [dot])
    return sheet
