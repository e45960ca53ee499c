"""Fretting (figures 11 to 17): a vertical load that stays, and a horizontal load that changes its direction."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.bodies.body import PinLoad
from fastpin.figures.style import line
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem, Rotation
from fastpin.paper.curves import Report, steps, traction_curve
from fastpin.paper.tractions import NAMES, PAIRS, Panel, chosen, traction_figure
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve

FRICTION = 0.55
LOADS: dict[PinLoad, tuple[str, str, str]] = {"centre": ("P", "+Q", "-Q"), "body": ("By", "+Bx", "-Bx")}
"""The paper's names of the loads of a history, for centre loads and for body forces. Figures show all three states."""

WORDS = {
    "P": "$P = F$ alone (downwards)",
    "+Q": "$P$ and $+Q$ (to the right)",
    "-Q": "$P$ and $−Q$ (to the left)",
    "By": "$B_y = F$ alone (downwards)",
    "+Bx": "$B_y$ and $+B_x$ (to the right)",
    "-Bx": "$B_y$ and $−B_x$ (to the left)",
}
"""Words for the loads of each state."""

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

    A case is a pair of :data:`~fastpin.paper.tractions.PAIRS`, a load parameter and eta. A centre-loaded pin keeps its
    rotation, a body-loaded pin rotates freely. A `grid` takes the place of `nodes`.
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
    loads = list(dict.fromkeys(curve.parameters["load"] for curve in curves))
    lines = {load: line(index, index) for index, load in enumerate(loads)}
    values = list(dict.fromkeys(curve.parameters[parameter] for curve in curves))
    titles = [_panel_title(chosen(curves, **{parameter: value})[0], parameter) for value in values]
    layout = [
        [Panel("N", chosen(curves, **{parameter: value}), title) for value, title in zip(values, titles, strict=True)]
    ]
    layout.append([Panel("T", panel.curves) for panel in layout[0]])
    legend = [(WORDS[load], style) for load, style in lines.items()]
    heading = case_lines(curves[0], parameter)
    return traction_figure(layout, lambda curve: lines[curve.parameters["load"]], legend, heading=heading)


def case_lines(curve: Curve, varied: str) -> list[str]:
    """Return the heading of a figure of fretting: all parameters but the `varied` one, which panels name."""
    given = curve.parameters
    words = {
        "pair": NAMES[given["pair"]],
        "plane": "plane strain",
        "mu": f"friction coefficient {given['mu']:g}",
        "L_p": f"load parameter {given['L_p']:g}",
    }
    first = ", ".join(text for name, text in words.items() if name != varied)
    held, force, ratio = "pin that can't rotate", "P at its centre, then +Q, then −Q", "Q/(μP)"
    if _pin_load(curve) == "body":
        held, force, ratio = "pin free to rotate", "body force By, then +Bx, then −Bx", "Bx/(μBy)"
    eta = "" if varied == "eta" else f"; η = {ratio} = {given['eta']:g}"
    return [first[0].upper() + first[1:], f"{held}; {force}{eta}"]


def _pin_load(curve: Curve) -> PinLoad:
    return "centre" if curve.parameters["load"] in LOADS["centre"] else "body"


def _panel_title(curve: Curve, parameter: str) -> str:
    """Return the title of a panel: the value of the varied parameter of a curve in it."""
    value = curve.parameters[parameter]
    if parameter == "pair":
        return NAMES[value]
    return f"{RATIOS[_pin_load(curve)]} = {value:g}" if parameter == "eta" else f"load parameter $L_p$ = {value:g}"
