"""Figure 3: tractions of a body-loaded Ti-6Al-4V pin in aluminium, highly conforming.

The caption gives L_p = 0.01 (left) and 0.1 (right). The coefficients of friction are our choice.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import line
from fastpin.paper.curves import Report
from fastpin.paper.tractions import NAMES, Panel, chosen, pushed_curves, traction_figure
from fastpin.report.curves import Curve

TITLE = "Tractions in body force loading (Ti-6Al-4V on aluminium), L_p = 0.01 and 0.1"
LEAST_NODES = 101
LOAD_PARAMETERS = (0.01, 0.1)
FRICTION = (0.1, 0.3, 0.5, 0.7)


def compute(nodes: int, progress: Report | None = None, pair: str = "Ti/Al") -> list[Curve]:
    """Tractions at the load P = F, one curve for each load parameter and coefficient of friction."""
    cases = [(load_parameter, friction) for load_parameter in LOAD_PARAMETERS for friction in FRICTION]
    return pushed_curves(pair, cases, nodes, progress)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw pressure above shear, with one column for each load parameter."""
    lines = {str(friction): line(index, index) for index, friction in enumerate(FRICTION)}
    titles = {"N": "load parameter $L_p$ = {:g}", "T": ""}
    layout = [
        [Panel(quantity, chosen(curves, L_p=parameter), title.format(parameter)) for parameter in LOAD_PARAMETERS]
        for quantity, title in titles.items()
    ]
    legend = [(f"friction coefficient {friction}", style) for friction, style in lines.items()]
    heading = f"{NAMES[curves[0].parameters['pair']]}, plane strain; body force F on the pin, downwards"
    return traction_figure(layout, lambda curve: lines[str(curve.parameters["mu"])], legend, heading=[heading])
