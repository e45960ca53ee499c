"""Figure 14: fretting with body forces on a pin that rotates freely, highly conforming; Ti-6Al-4V in Ti-6Al-4V.

The caption gives L_p = 0.05 and mu = 0.55. The horizontal load eta = B_x/(mu B_y) is our choice: 0.5 left, 1 right.
"""

from __future__ import annotations

from fastpin.paper import figure11
from fastpin.paper.curves import Report
from fastpin.paper.fretting import cycled
from fastpin.report.curves import Curve

TITLE = "Fretting type loads with body forces, free rotation, L_p = 0.05, mu = 0.55, Ti-6Al-4V/Ti-6Al-4V"
LEAST_NODES = 101
draw = figure11.draw


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions after B_y, +B_x and -B_x, for two sizes of B_x."""
    return cycled([("Ti/Ti", 0.05, eta) for eta in figure11.ETAS], "body", nodes, progress)
