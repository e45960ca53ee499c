"""Figure 13: steady shear tractions of the fretting of figure 12, beginning with +Q (left) or with -Q (right).

The caption gives L_p = 0.50, mu = 0.55 and C_omega = 0; in the text, steady states are solid. The horizontal load
eta = Q/(mu P) is our choice: 0.5 above, 1 below. The steady state is the third cycle. In the first direction it has a
notch. The notch is no error of the grid: there the pin still sticks where slip ended under the opposite load.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import line
from fastpin.model.history import LoadHistory
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report, steps, traction_curve
from fastpin.paper.fretting import FRICTION, label
from fastpin.paper.tractions import PAIRS, Panel, chosen, traction_figure
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve

TITLE = "Steady-state shear tractions with fretting loads, L_p = 0.50, mu = 0.55, C_omega = 0, Ti-6Al-4V/Ti-6Al-4V"
LEAST_NODES = 201
LOAD_PARAMETER = 0.5
ETAS = (0.5, 1.0)
FIRST_LOADS = ("+Q", "-Q")
CYCLES = 3


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions after each horizontal load of three cycles, for two sizes of Q and both first directions."""
    problem = Problem.from_load_parameter(PAIRS["Ti/Ti"], LOAD_PARAMETER, FRICTION, "centre", "fixed")
    curves = []
    for eta, first in steps([(eta, first) for eta in ETAS for first in FIRST_LOADS], progress):
        across = eta * FRICTION if first == "+Q" else -eta * FRICTION
        history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": across}, {"Q": -across}]).repeated(CYCLES)
        for index, state in enumerate(solve(problem, history, nodes=nodes)[1:]):
            load = "+Q" if state.load["Q"] > 0.0 else "-Q"
            cycle = 1 + index // 2
            curves.append(
                traction_curve(state, L_p=LOAD_PARAMETER, mu=FRICTION, eta=eta, first=first, load=load, cycle=cycle)
            )
    return curves


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw shear tractions: the first forward load dashed, the first reverse load and both steady states solid."""
    steady = {load: line(index) for index, load in enumerate(FIRST_LOADS)}
    forward = {load: line(index, 1) for index, load in enumerate(FIRST_LOADS)}
    reverse = {load: {**line(index, 0, 4.0), "alpha": 0.3} for index, load in enumerate(FIRST_LOADS)}

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
            row.append(Panel("T", drawn, f"0, {label(first)}, {label(second)}, …;  η = {eta:g}"))
        layout.append(row)
    legend = []
    for load in FIRST_LOADS:
        name = label(load)
        legend.append(
            [
                (f"{name}, steady", steady[load]),
                (f"{name}, first load", forward[load]),
                (f"{name}, first reverse", reverse[load]),
            ]
        )
    return traction_figure(layout, style, *legend)
