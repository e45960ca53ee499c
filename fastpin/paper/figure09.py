"""Figure 9: a centre load and a body load compared; Ti-6Al-4V pin in aluminium, pressure left, shear right.

The caption gives mu = 0.4. The load parameters are our choice.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import line
from fastpin.model.joint import PinLoad
from fastpin.paper.curves import Report, steps, traction_curve
from fastpin.paper.tractions import Panel, pushed, traction_figure
from fastpin.report.curves import Curve

TITLE = "Centre loading and body force loading, Ti-6Al-4V/aluminium, mu = 0.4"
LEAST_NODES = 101
LOAD_PARAMETERS = (0.01, 0.1, 0.5)
FRICTION = 0.4
PIN_LOADS: dict[PinLoad, int] = {"centre": 0, "body": 1}
"""Each kind of load and its dashes."""


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions at the load P = F, one curve for each load parameter and kind of load."""
    cases = [(load_parameter, pin_load) for load_parameter in LOAD_PARAMETERS for pin_load in PIN_LOADS]
    return [
        traction_curve(
            pushed("Ti/Al", load_parameter, FRICTION, nodes, pin_load),
            L_p=load_parameter,
            mu=FRICTION,
            pin_load=pin_load,
        )
        for load_parameter, pin_load in steps(cases, progress)
    ]


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw pressure left, shear right. Colours show the load parameter; centre loads are solid, body loads dashed."""
    lines = {
        (load_parameter, pin_load): line(colour, dashes)
        for colour, load_parameter in enumerate(LOAD_PARAMETERS)
        for pin_load, dashes in PIN_LOADS.items()
    }
    return traction_figure(
        [[Panel("N", curves), Panel("T", curves)]],
        lambda curve: lines[curve.parameters["L_p"], curve.parameters["pin_load"]],
        [(f"$L_p$ = {parameter:g}", lines[parameter, "centre"]) for parameter in LOAD_PARAMETERS],
        [(f"{pin_load} load", {**lines[0.1, pin_load], "color": "0.35"}) for pin_load in PIN_LOADS],
    )
