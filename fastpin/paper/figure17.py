"""Figure 17: fretting as in figure 16 (body forces, free rotation, aluminium pin in Ti-6Al-4V), for L_p = 1.0.

The contacts under +B_x and -B_x overlap in five degrees only. The nodes gather there, at the bottom: they resolve the
shear within the last degree of the second contact.
"""

from __future__ import annotations

import math

from fastpin.paper import figure16
from fastpin.paper.curves import Report
from fastpin.paper.fretting import cycled
from fastpin.paper.sweep import NODES_RATIO, gathered_grid
from fastpin.report.curves import Curve

TITLE = "Fretting type loads with body forces, free rotation, aluminium/Ti-6Al-4V, L_p = 1.0, |eta| = 1"
LEAST_NODES = 201
REACH = math.radians(65.0)
"""Half the width of the grid: the contacts end at +-60.3 deg."""

draw = figure16.draw


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions after B_y, +B_x and -B_x."""
    grid = gathered_grid(round(NODES_RATIO * nodes), REACH)
    return cycled([("Al/Ti", 1.0, 1.0)], "body", nodes, progress, grid)
