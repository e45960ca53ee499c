"""Figure 4: tractions of a body-loaded Ti-6Al-4V pin in aluminium, less conforming.

By the caption, the paper shows the pressure without friction too, and more friction than the largest shown changes
nothing visible. By the text, for L_p = 0.5 the shear hardly changes beyond mu = 0.4. The other two load parameters are
our choice. Their largest friction has the same effect: with mu = 2.0 instead, the shear changes by less than 2 % of its
peak, the pressure by less than 0.1 %.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import line
from fastpin.paper.curves import Report
from fastpin.paper.tractions import NAMES, Panel, chosen, pushed_curves, traction_figure
from fastpin.report.curves import Curve

TITLE = "Tractions in body force loading (Ti-6Al-4V on aluminium) at high L_p and different mu"
LEAST_NODES = 101
FRICTION = {0.25: (0.0, 0.1, 0.2, 0.6), 0.5: (0.0, 0.1, 0.2, 0.4), 1.0: (0.0, 0.1, 0.2, 0.3)}


def compute(nodes: int, progress: Report | None = None, pair: str = "Ti/Al") -> list[Curve]:
    """Tractions at the load P = F, one curve for each load parameter and coefficient of friction."""
    cases = [(load_parameter, mu) for load_parameter, coefficients in FRICTION.items() for mu in coefficients]
    return pushed_curves(pair, cases, nodes, progress)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw pressure above shear, with one column for each load parameter. The largest friction of a column is solid."""
    dashes = (1, 2, 3, 0)
    lines = {
        (load_parameter, friction): line(dash, dash)
        for load_parameter, coefficients in FRICTION.items()
        for friction, dash in zip(coefficients, dashes, strict=True)
    }
    columns = [chosen(curves, L_p=load_parameter) for load_parameter in FRICTION]
    rubbing = [[curve for curve in column if curve.parameters["mu"] != 0.0] for column in columns]
    titles = [f"load parameter $L_p$ = {load_parameter:g}" for load_parameter in FRICTION]
    layout = [
        [Panel("N", column, title) for column, title in zip(columns, titles, strict=True)],
        [Panel("T", column) for column in rubbing],
    ]
    largest = ", ".join(f"{coefficients[-1]:g}" for coefficients in FRICTION.values())
    words = ["friction coefficient 0 (pressure only)", "0.1", "0.2", f"{largest} (left, middle, right)"]
    return traction_figure(
        layout,
        lambda curve: lines[curve.parameters["L_p"], curve.parameters["mu"]],
        [(word, line(dash, dash)) for word, dash in zip(words, dashes, strict=True)],
        heading=[f"{NAMES[curves[0].parameters['pair']]}, plane strain; body force F on the pin, downwards"],
    )
