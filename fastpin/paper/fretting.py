"""Fretting: a vertical load that stays, and a horizontal one that goes to and fro (figures 11 to 17)."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import line
from fastpin.model.problem import PinLoad, Problem, Rotation
from fastpin.paper.curves import Curve, Report, steps, traction_curve
from fastpin.paper.tractions import PAIRS, Panel, chosen, traction_figure
from fastpin.solver.solving import solve

FRICTION = 0.55
LOADS: dict[PinLoad, tuple[str, str, str]] = {"centre": ("P", "+Q", "-Q"), "body": ("By", "+Bx", "-Bx")}
"""The paper's names of the loads after which tractions are shown, for loads at the centre and body forces."""


def cycled(
    cases: Sequence[tuple[str, float, float]], pin_load: PinLoad, nodes: int, progress: Report | None
) -> list[Curve]:
    """Tractions at P = F, then after +Q and -Q = eta mu P, for each pair, load parameter and eta.

    A centre-loaded pin keeps its rotation, a body-loaded one rotates freely.
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
    """Pressure above shear, a column for each value of a parameter, which stands in the `title`."""
    loads = list(dict.fromkeys(curve.parameters["load"] for curve in curves))
    lines = {load: line(index, index) for index, load in enumerate(loads)}
    values = list(dict.fromkeys(curve.parameters[parameter] for curve in curves))
    layout = [[Panel("N", chosen(curves, **{parameter: value}), title.format(value)) for value in values]]
    layout.append([Panel("T", panel.curves) for panel in layout[0]])
    legend = [(label(load), style) for load, style in lines.items()]
    return traction_figure(layout, lambda curve: lines[curve.parameters["load"]], legend)


def label(load: str) -> str:
    """A load as it is printed in a legend."""
    sign, name = (load[0], load[1:]) if load[0] in "+-" else ("", load)
    symbol = f"${name[0]}_{name[1]}$" if len(name) > 1 else f"${name}$"
    return f"{sign}{symbol}".replace("-", "−")
