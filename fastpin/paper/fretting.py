"""Fretting (figures 11 to 17): a vertical load that stays, and a horizontal load that changes its direction."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import line
from fastpin.model.joint import PinLoad
from fastpin.model.problem import Problem, Rotation
from fastpin.paper.curves import Report, steps, traction_curve
from fastpin.paper.tractions import PAIRS, Panel, chosen, traction_figure
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve

FRICTION = 0.55
LOADS: dict[PinLoad, tuple[str, str, str]] = {"centre": ("P", "+Q", "-Q"), "body": ("By", "+Bx", "-Bx")}
"""The paper's names of the loads of a history, for centre loads and for body forces. Figures show all three states."""


def cycled(
    cases: Sequence[tuple[str, float, float]], pin_load: PinLoad, nodes: int, progress: Report | None
) -> list[Curve]:
    """Return the tractions after P = F, +Q and -Q, with Q = eta mu P, for each case.

    A case is a pair of :data:`~fastpin.paper.tractions.PAIRS`, a load parameter and eta. A centre-loaded pin keeps its
    rotation, a body-loaded pin rotates freely.
    """
    rotation: Rotation = "fixed" if pin_load == "centre" else "free"
    curves = []
    for pair, load_parameter, eta in steps(cases, progress):
        problem = Problem.from_load_parameter(PAIRS[pair], load_parameter, FRICTION, pin_load, rotation)
        across = eta * FRICTION
        result = solve(problem, [{"P": 1.0}, {"Q": across}, {"Q": -across}], nodes=nodes)
        curves += [
            traction_curve(state, pair=pair, L_p=load_parameter, mu=FRICTION, eta=eta, load=load)
            for state, load in zip(result, LOADS[pin_load], strict=True)
        ]
    return curves


def cycle_figure(curves: Sequence[Curve], parameter: str, title: str) -> Figure:
    """Draw pressure above shear, with a column for each value of a parameter. `title` is a format for the value."""
    loads = list(dict.fromkeys(curve.parameters["load"] for curve in curves))
    lines = {load: line(index, index) for index, load in enumerate(loads)}
    values = list(dict.fromkeys(curve.parameters[parameter] for curve in curves))
    layout = [[Panel("N", chosen(curves, **{parameter: value}), title.format(value)) for value in values]]
    layout.append([Panel("T", panel.curves) for panel in layout[0]])
    legend = [(label(load), style) for load, style in lines.items()]
    return traction_figure(layout, lambda curve: lines[curve.parameters["load"]], legend)


def label(load: str) -> str:
    """Return the text of a load, such as "+Bx", for a legend."""
    sign, name = (load[0], load[1:]) if load[0] in "+-" else ("", load)
    symbol = f"${name[0]}_{name[1]}$" if len(name) > 1 else f"${name}$"
    return f"{sign}{symbol}".replace("-", "−")
