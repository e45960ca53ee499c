"""Figure 12: fretting with centre loads and no rotation, less conforming than in figure 11: L_p = 0.50."""

from __future__ import annotations

from fastpin.paper import figure11
from fastpin.paper.curves import Report
from fastpin.report.curves import Curve

TITLE = "Fretting type loads, L_p = 0.50, mu = 0.55, C_omega = 0, Ti-6Al-4V/Ti-6Al-4V"
LEAST_NODES = figure11.LEAST_NODES
draw = figure11.draw


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions after P, +Q and -Q, for two sizes of Q."""
    return figure11.compute(nodes, progress, 0.5)
