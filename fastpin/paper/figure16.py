"""Figure 16: fretting with body forces on a pin that rotates freely; aluminium pin in Ti-6Al-4V.

The caption gives L_p = 0.25 and 0.50, and |eta| = |B_x|/(mu B_y) = 1. The friction is taken from figures 14 and 15.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.paper.curves import Report
from fastpin.paper.fretting import cycle_figure, cycled
from fastpin.report.curves import Curve

TITLE = "Fretting type loads with body forces, free rotation, aluminium/Ti-6Al-4V, L_p = 0.25 and 0.50, |eta| = 1"
LEAST_NODES = 101


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions after B_y, +B_x and -B_x, for two load parameters."""
    return cycled([("Al/Ti", load_parameter, 1.0) for load_parameter in (0.25, 0.5)], "body", nodes, progress)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw a column for each load parameter."""
    return cycle_figure(curves, "L_p")
