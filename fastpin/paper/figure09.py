"""Figure 9: a centre load and a body load compared; Ti-6Al-4V pin in aluminium.

The caption gives mu = 0.4. The load parameters are our choice.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.bodies.body import PinLoad
from fastpin.figures.style import line
from fastpin.paper.curves import Report, steps, traction_curve
from fastpin.paper.tractions import NAMES, Panel, chosen, pushed, traction_figure
from fastpin.report.curves import Curve

TITLE = "Centre loading and body force loading, Ti-6Al-4V/aluminium, mu = 0.4"
LEAST_NODES = 101
LOAD_PARAMETERS = (0.01, 0.1, 0.5)
PAIR = "Ti/Al"
FRICTION = 0.4
PIN_LOADS: dict[PinLoad, int] = {"centre": 0, "body": 1}
"""Each kind of load and its dashes."""


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions at the load P = F, one curve for each load parameter and kind of load."""
    cases = [(load_parameter, pin_load) for load_parameter in LOAD_PARAMETERS for pin_load in PIN_LOADS]
    return [
        traction_curve(
            pushed(PAIR, load_parameter, FRICTION, nodes, pin_load), L_p=load_parameter, mu=FRICTION, pin_load=pin_load
        )
        for load_parameter, pin_load in steps(cases, progress)
    ]


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw pressure above shear, with one column for each load parameter. Centre loads are solid, body loads dashed."""
    lines = {pin_load: line(dashes, dashes) for pin_load, dashes in PIN_LOADS.items()}
    columns = [chosen(curves, L_p=parameter) for parameter in LOAD_PARAMETERS]
    titles = [f"load parameter $L_p$ = {parameter:g}" for parameter in LOAD_PARAMETERS]
    layout = [
        [Panel("N", column, title) for column, title in zip(columns, titles, strict=True)],
        [Panel("T", column) for column in columns],
    ]
    return traction_figure(
        layout,
        lambda curve: lines[curve.parameters["pin_load"]],
        [("force F at the centre of the pin", lines["centre"]), ("body force F on the whole pin", lines["body"])],
        heading=[f"{NAMES[PAIR]}, plane strain, friction coefficient {FRICTION:g}; F acts downwards"],
    )
