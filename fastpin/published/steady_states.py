"""Figure 13: steady shear tractions of the fretting of figure 12, beginning with +Q (left) or with -Q (right).

The caption gives L_p = 0.50, mu = 0.55 and C_omega = 0; in the text, steady states are solid. The horizontal load
eta = Q/(mu P) is our choice: 0.5 above, 1 below. The steady state is the third cycle. In the first direction it has a
notch. The notch is no error of the grid: there the pin still sticks where slip ended under the opposite load.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fastpin.figures.style import line
from fastpin.model.history import LoadHistory
from fastpin.model.problem import Problem
from fastpin.published.fretting import FRICTION, RATIOS, case_lines
from fastpin.published.records import PaperFigure, Report, steps
from fastpin.published.tractions import PAIRS, Panel, chosen, traction_curve, traction_figure
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve

ETAS = (0.5, 1.0)
FIRST_LOADS = ("+Q", "-Q")
SYMBOLS = {"+Q": "$+Q$", "-Q": "$−Q$"}
CYCLES = 3


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions after each horizontal load of three cycles, for two sizes of Q and both first directions."""
    problem = Problem.from_load_parameter(PAIRS["Ti/Ti"], 0.5, FRICTION, "centre", "fixed")
    curves = []
    for eta, first in steps([(eta, first) for eta in ETAS for first in FIRST_LOADS], progress):
        across = eta * FRICTION if first == "+Q" else -eta * FRICTION
        history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": across}, {"Q": -across}]).repeated(CYCLES)
        for index, state in enumerate(solve(problem, history, nodes=nodes)[1:]):
            load = "+Q" if state.load["Q"] > 0.0 else "-Q"
            cycle = 1 + index // 2
            parameters: dict[str, Any] = {"eta": eta, "first": first, "load": load, "cycle": cycle}
            curves.append(traction_curve(state, pair="Ti/Ti", L_p=0.5, mu=FRICTION, **parameters))
    return curves


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw shear tractions: the first load dashed, the first reverse load wide and pale, both steady states solid."""
    steady = {load: line(index) for index, load in enumerate(FIRST_LOADS)}
    forward = {load: line(index, 1) for index, load in enumerate(FIRST_LOADS)}
    reverse = {load: {**line(index, 0, 4.5), "alpha": 0.3} for index, load in enumerate(FIRST_LOADS)}

    def style(curve: Curve) -> dict[str, object]:
        load = curve.parameters["load"]
        if curve.parameters["cycle"] == CYCLES:
            return steady[load]
        return (forward if load == curve.parameters["first"] else reverse)[load]

    layout = []
    for eta in ETAS:
        row = []
        for first, second in (FIRST_LOADS, FIRST_LOADS[::-1]):
            drawn = [
                curve for curve in chosen(curves, eta=eta, first=first) if curve.parameters["cycle"] in (1, CYCLES)
            ]
            title = f"$P$, then {SYMBOLS[first]}, {SYMBOLS[second]}, {SYMBOLS[first]}, …;  {RATIOS['centre']} = {eta:g}"
            row.append(Panel("T", drawn, title))
        layout.append(row)
    states = {"steady state": steady, "first load": forward, "first load the other way": reverse}
    legend = [[(f"{SYMBOLS[load]}, {words}", lines[load]) for words, lines in states.items()] for load in FIRST_LOADS]
    heading = [case_lines(curves[0], "eta")[0], "pin that can't rotate; P at its centre, then three cycles of Q"]
    figure = traction_figure(layout, style, *legend, heading=heading)
    for panel, content in zip(figure.axes, (content for row in layout for content in row), strict=True):
        _name_steady_states(panel, content.curves)
    return figure


def _name_steady_states(panel: Axes, curves: Sequence[Curve]) -> None:
    """Write the load beside each steady state, at its largest shear, so that it is known without colours."""
    for curve in curves:
        if curve.parameters["cycle"] == CYCLES:
            largest = int(np.argmax(np.abs(curve["T"])))
            side = math.copysign(1.0, curve["angle_deg"][largest])
            panel.annotate(
                SYMBOLS[str(curve.parameters["load"])],
                (curve["angle_deg"][largest], curve["T"][largest]),
                (7.0 * side, 0.0),
                textcoords="offset points",
                ha="left" if side > 0.0 else "right",
                va="center",
                fontsize=9.0,
            )


FIGURES = (
    PaperFigure(
        "13",
        "Steady-state shear tractions with fretting loads, L_p = 0.50, mu = 0.55, C_omega = 0, Ti-6Al-4V/Ti-6Al-4V",
        201, compute, draw,
    ),
)  # fmt: skip
