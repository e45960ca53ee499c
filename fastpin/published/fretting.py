"""Figures 11 to 17: fretting. A vertical load stays, and a horizontal load changes its direction.

The captions give L_p, and mu = 0.55 for figures 11 to 15. Figures 16 and 17 take this friction over.

*Figures 11 and 12*: centre loads without rotation (C_omega = 0), Ti-6Al-4V in Ti-6Al-4V. The horizontal load
eta = Q/(mu P) is our choice: 0.5 left, 1 right.

*Figures 14 and 15*: body forces on a pin that rotates freely. eta = B_x/(mu B_y) is our choice, in figure 14 as in
figures 11 and 12, in figure 15 the 1 of figures 16 and 17. The text gives the two pairs of figure 15.

*Figures 16 and 17*: as figure 15, with an aluminium pin in Ti-6Al-4V. The caption of figure 16 gives
|eta| = |B_x|/(mu B_y) = 1. In figure 17 the contacts under +B_x and -B_x overlap in five degrees only. The nodes gather
there, at the bottom: they resolve the shear within the last degree of the second contact.

*Figure 13*: steady shear tractions of the fretting of figure 12, beginning with +Q (left) or with -Q (right). In the
text, steady states are solid. eta is our choice: 0.5 above, 1 below. The steady state is the third cycle. In the first
direction it has a notch. The notch is no error of the grid: there the pin still sticks where slip ended under the
opposite load.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve
from fastpin.bodies.body import PinLoad
from fastpin.figures.style import line
from fastpin.model import Grid, LoadHistory
from fastpin.model.problem import Problem, Rotation
from fastpin.published.records import PaperFigure, Report, steps
from fastpin.published.sweep import NODES_RATIO, gathered_grid
from fastpin.published.tractions import NAMES, PAIRS, Panel, chosen, traction_curve, traction_figure, values_of
from fastpin.solver.solving import solve

FRICTION = 0.55
LOADS: dict[PinLoad, dict[str, str]] = {
    "centre": {
        "P": "$P = F$ alone (downwards)",
        "+Q": "$P$ and $+Q$ (to the right)",
        "-Q": "$P$ and $−Q$ (to the left)",
    },
    "body": {
        "By": "$B_y = F$ alone (downwards)",
        "+Bx": "$B_y$ and $+B_x$ (to the right)",
        "-Bx": "$B_y$ and $−B_x$ (to the left)",
    },
}
"""The paper's names of the loads of a history, and words for them, for centre loads and for body forces."""

RATIOS: dict[PinLoad, str] = {"centre": "$η = Q/(μP)$", "body": "$η = B_x/(μB_y)$"}
"""The horizontal load over the load of sliding in a half-plane."""


def cycled(
    cases: Sequence[tuple[str, float, float]],
    pin_load: PinLoad,
    nodes: int,
    progress: Report | None,
    grid: Grid | None = None,
) -> list[Curve]:
    """Return the tractions after P = F, +Q and -Q, with Q = eta mu P, for each case.

    A case is a pair of :data:`~fastpin.published.tractions.PAIRS`, a load parameter and eta. A centre-loaded pin keeps
    its rotation, a body-loaded pin rotates freely. A `grid` replaces `nodes`.
    """
    rotation: Rotation = "fixed" if pin_load == "centre" else "free"
    curves = []
    for pair, load_parameter, eta in steps(cases, progress):
        problem = Problem.from_load_parameter(PAIRS[pair], load_parameter, FRICTION, pin_load, rotation)
        across = eta * FRICTION
        result = solve(problem, [{"P": 1.0}, {"Q": across}, {"Q": -across}], nodes=nodes, grid=grid)
        curves += [
            traction_curve(state, pair=pair, L_p=load_parameter, mu=FRICTION, eta=eta, load=load)
            for state, load in zip(result, LOADS[pin_load], strict=True)
        ]
    return curves


def cycle_figure(curves: Sequence[Curve], parameter: str) -> Figure:
    """Draw pressure above shear, with a column for each value of a parameter: "pair", "L_p" or "eta"."""
    words = LOADS[_pin_load(curves[0])]
    lines = {load: line(index, index) for index, load in enumerate(words)}
    columns = [chosen(curves, **{parameter: value}) for value in values_of(curves, parameter)]
    upper = [Panel("N", column, _panel_title(column[0], parameter)) for column in columns]
    layout = [upper, [Panel("T", column) for column in columns]]
    legend = [(words[load], style) for load, style in lines.items()]
    heading = case_lines(curves[0], parameter)
    return traction_figure(layout, lambda curve: lines[curve.parameters["load"]], legend, heading=heading)


def case_lines(curve: Curve, varied: str) -> list[str]:
    """Return the heading of a figure of fretting: all parameters but the `varied` one, which panels name."""
    parameters = curve.parameters
    words = {"pair": NAMES[parameters["pair"]], "plane": "plane strain"}
    words |= {"mu": f"friction coefficient {parameters['mu']:g}", "L_p": f"load parameter {parameters['L_p']:g}"}
    first = ", ".join(text for name, text in words.items() if name != varied)
    held, force, ratio = "pin that can't rotate", "P at its centre, then +Q, then −Q", "Q/(μP)"
    if _pin_load(curve) == "body":
        held, force, ratio = "pin free to rotate", "body force By, then +Bx, then −Bx", "Bx/(μBy)"
    eta = "" if varied == "eta" else f"; η = {ratio} = {parameters['eta']:g}"
    return [first[0].upper() + first[1:], f"{held}; {force}{eta}"]


def _pin_load(curve: Curve) -> PinLoad:
    return "centre" if curve.parameters["load"] in LOADS["centre"] else "body"


def _panel_title(curve: Curve, parameter: str) -> str:
    """Return the title of a panel: the value of the varied parameter of a curve in it."""
    value = curve.parameters[parameter]
    if parameter == "pair":
        return NAMES[value]
    return f"{RATIOS[_pin_load(curve)]} = {value:g}" if parameter == "eta" else f"load parameter $L_p$ = {value:g}"


def _figure(
    name: str,
    title: str,
    pin_load: PinLoad,
    cases: Sequence[tuple[str, float, float]],
    varied: str,
    least_nodes: int = 101,
    grid: Callable[[int], Grid] | None = None,
) -> PaperFigure:
    """Return a figure of the states of :func:`cycled`, with a column for each value of the `varied` parameter."""

    def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
        return cycled(cases, pin_load, nodes, progress, None if grid is None else grid(nodes))

    def draw(curves: Sequence[Curve]) -> Figure:
        return cycle_figure(curves, varied)

    return PaperFigure(name, title, least_nodes, compute, draw)


ETAS = (0.5, 1.0)
FIRST_LOADS = ("+Q", "-Q")
SYMBOLS = {"+Q": "$+Q$", "-Q": "$−Q$"}
CYCLES = 3


def compute_steady_states(nodes: int, progress: Report | None = None) -> list[Curve]:
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


def draw_steady_states(curves: Sequence[Curve]) -> Figure:
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
            words, at = SYMBOLS[str(curve.parameters["load"])], (curve["angle_deg"][largest], curve["T"][largest])
            look: Any = {"ha": "left" if side > 0.0 else "right", "va": "center", "fontsize": 9.0}
            panel.annotate(words, at, (7.0 * side, 0.0), textcoords="offset points", **look)


FIGURES = (
    _figure(
        "11", "Fretting type loads, L_p = 0.05, mu = 0.55, C_omega = 0, Ti-6Al-4V/Ti-6Al-4V",
        "centre", [("Ti/Ti", 0.05, eta) for eta in (0.5, 1.0)], "eta",
    ),
    _figure(
        "12", "Fretting type loads, L_p = 0.50, mu = 0.55, C_omega = 0, Ti-6Al-4V/Ti-6Al-4V",
        "centre", [("Ti/Ti", 0.5, eta) for eta in (0.5, 1.0)], "eta",
    ),
    _figure(
        "14", "Fretting type loads with body forces, free rotation, L_p = 0.05, mu = 0.55, Ti-6Al-4V/Ti-6Al-4V",
        "body", [("Ti/Ti", 0.05, eta) for eta in (0.5, 1.0)], "eta",
    ),
    _figure(
        "15", "Fretting type loads with body forces, free rotation, L_p = 0.05, mu = 0.55, dissimilar pairs",
        "body", [(pair, 0.05, 1.0) for pair in ("Ti/Al", "Al/Ti")], "pair",
    ),
    _figure(
        "16",
        "Fretting type loads with body forces, free rotation, aluminium/Ti-6Al-4V, L_p = 0.25 and 0.50, |eta| = 1",
        "body", [("Al/Ti", load_parameter, 1.0) for load_parameter in (0.25, 0.5)], "L_p",
    ),
    _figure(
        "17", "Fretting type loads with body forces, free rotation, aluminium/Ti-6Al-4V, L_p = 1.0, |eta| = 1",
        "body", [("Al/Ti", 1.0, 1.0)], "L_p", 201,
        lambda nodes: gathered_grid(round(NODES_RATIO * nodes), math.radians(65.0)),  # the contacts end at +-60.3
    ),
    PaperFigure(
        "13",
        "Steady-state shear tractions with fretting loads, L_p = 0.50, mu = 0.55, C_omega = 0, Ti-6Al-4V/Ti-6Al-4V",
        201, compute_steady_states, draw_steady_states,
    ),
)  # fmt: skip
