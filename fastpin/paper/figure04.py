"""Figure 4: tractions of a body-loaded Ti-6Al-4V pin in aluminium, less conforming; pressure left, shear right.

By the caption, the dashed lines are the pressure without friction, and more friction than the largest shown changes
nothing visible. By the text, for L_p = 0.5 the shear hardly changes beyond mu = 0.4. The other two load parameters are
our choice. Their largest friction has the same effect: with mu = 2.0 instead, the shear changes by less than 2 % of its
peak, the pressure by less than 0.1 %.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import line
from fastpin.paper.curves import Report
from fastpin.paper.tractions import Panel, pushed_curves, traction_figure
from fastpin.report.curves import Curve

TITLE = "Tractions in body force loading (Ti-6Al-4V on aluminium) at high L_p and different mu"
LEAST_NODES = 101
FRICTION = {0.25: (0.0, 0.1, 0.2, 0.6), 0.5: (0.0, 0.1, 0.2, 0.4), 1.0: (0.0, 0.1, 0.2, 0.3)}


def compute(nodes: int, progress: Report | None = None, pair: str = "Ti/Al") -> list[Curve]:
    """Tractions at the load P = F, one curve for each load parameter and coefficient of friction."""
    cases = [(load_parameter, mu) for load_parameter, coefficients in FRICTION.items() for mu in coefficients]
    return pushed_curves(pair, cases, nodes, progress)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw pressure left, shear right. Colours show the load parameter, dashes the friction; the largest is solid."""
    lines = {
        (load_parameter, friction): line(colour, dashes)
        for colour, (load_parameter, coefficients) in enumerate(FRICTION.items())
        for friction, dashes in zip(coefficients, (1, 2, 3, 0), strict=True)
    }
    rubbing = [curve for curve in curves if curve.parameters["mu"] != 0.0]
    return traction_figure(
        [[Panel("N", curves), Panel("T", rubbing)]],
        lambda curve: lines[curve.parameters["L_p"], curve.parameters["mu"]],
        [(f"$L_p$ = {parameter:g},  μ = {mu[-1]:g}", lines[parameter, mu[-1]]) for parameter, mu in FRICTION.items()],
        [(f"μ = {mu:g}", {**lines[0.25, mu], "color": "0.35"}) for mu in (0.0, 0.1, 0.2)],
    )
