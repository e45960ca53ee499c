"""Figure 6: tractions of a body-loaded pin in a plate of the same material, highly conforming.

Loads and friction are the same as in figure 3. The material, Ti-6Al-4V, is our choice: for similar materials only
Poisson's ratio matters.
"""

from __future__ import annotations

from fastpin.paper import figure03
from fastpin.paper.curves import Report
from fastpin.report.curves import Curve

TITLE = "Tractions in body force loading of similar materials (Ti-6Al-4V), L_p = 0.01 and 0.1"
LEAST_NODES = figure03.LEAST_NODES
draw = figure03.draw


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions at the load P = F, one curve for each load parameter and coefficient of friction."""
    return figure03.compute(nodes, progress, "Ti/Ti")
