"""Figure 7: tractions of a body-loaded pin in a plate of the same material, less conforming.

Loads and friction are the same as in figure 4. With more friction than the largest shown, the shear still changes by
up to 5 % of its peak. The material, Ti-6Al-4V, is our choice: for similar materials only Poisson's ratio matters.
"""

from __future__ import annotations

from fastpin.paper import figure04
from fastpin.paper.curves import Report
from fastpin.report.curves import Curve

TITLE = "Tractions in body force loading of similar materials (Ti-6Al-4V) at high L_p and different mu"
LEAST_NODES = figure04.LEAST_NODES
draw = figure04.draw


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions at the load P = F, one curve for each load parameter and coefficient of friction."""
    return figure04.compute(nodes, progress, "Ti/Ti")
