"""Figure 15: fretting with body forces on a pin that rotates freely, for both dissimilar pairs.

The caption gives L_p = 0.05 and mu = 0.55, the text gives the pairs. The horizontal load is our choice, as in
figure 14. It is eta = B_x/(mu B_y) = 1, the load of figures 16 and 17.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.paper.curves import Report
from fastpin.paper.fretting import cycle_figure, cycled
from fastpin.report.curves import Curve

TITLE = "Fretting type loads with body forces, free rotation, L_p = 0.05, mu = 0.55, dissimilar pairs"
LEAST_NODES = 101


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions after B_y, +B_x and -B_x, for two pairs."""
    return cycled([(pair, 0.05, 1.0) for pair in ("Ti/Al", "Al/Ti")], "body", nodes, progress)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw a column for each pair."""
    return cycle_figure(curves, "pair")
