"""Figure 11: fretting with centre loads and no rotation, highly conforming; Ti-6Al-4V in Ti-6Al-4V.

The caption gives L_p = 0.05, mu = 0.55 and C_omega = 0. The horizontal load eta = Q/(mu P) is our choice: 0.5 left,
1 right.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.paper.curves import Report
from fastpin.paper.fretting import cycle_figure, cycled
from fastpin.report.curves import Curve

TITLE = "Fretting type loads, L_p = 0.05, mu = 0.55, C_omega = 0, Ti-6Al-4V/Ti-6Al-4V"
LEAST_NODES = 101
ETAS = (0.5, 1.0)


def compute(nodes: int, progress: Report | None = None, load_parameter: float = 0.05) -> list[Curve]:
    """Tractions after P, +Q and -Q, for two sizes of Q."""
    return cycled([("Ti/Ti", load_parameter, eta) for eta in ETAS], "centre", nodes, progress)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw a column for each size of Q."""
    return cycle_figure(curves, "eta")
