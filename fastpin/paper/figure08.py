"""Figure 8: peak pressure and relative size of the stick zone of three pairs over the load parameter, body loads.

The caption leaves the coefficients of friction and the range of L_p open. The text names the materials, and compares
mu = 0.1 and 0.7: for Ti-6Al-4V in aluminium at L_p = 0.01, 0.7 should give less than half the peak pressure of 0.1.
Here it gives 0.70 of it. The stick half-angle rho is defined as in figure 5.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from fastpin.figures.style import add_legend, panels
from fastpin.paper.curves import Report
from fastpin.paper.legends import grey, head, marked
from fastpin.paper.sweep import load_parameter_axis, swept
from fastpin.paper.tractions import NAMES
from fastpin.report.curves import Curve

TITLE = "Peak pressures and tan(rho/2)/tan(epsilon/2) in body force loading"
LEAST_NODES = 201
PAIRS = ("Ti/Al", "Ti/Ti", "Al/Ti")
FRICTION = (0.1, 0.3, 0.7)


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Peak pressure and half-angles over the load parameter, one curve for each pair and coefficient of friction."""
    curves = swept([(pair, friction) for pair in PAIRS for friction in FRICTION], nodes, progress)
    for curve in curves:
        rho, epsilon = np.radians(curve["rho_deg"]), np.radians(curve["epsilon_deg"])
        curve.columns["tan_ratio"] = np.tan(0.5 * rho) / np.tan(0.5 * epsilon)
    return curves


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw peak pressure left and the ratio of half-angles right. Colours show the pair, dashes the friction."""
    figure, axes = panels(1, 2, height=3.3)
    head(figure, "Plane strain; body force F downwards; ρ and ε: half-angles of stick zone and contact")
    lines = {
        (pair, mu): marked(colour, dashes) for colour, pair in enumerate(PAIRS) for dashes, mu in enumerate(FRICTION)
    }
    peak, ratio = axes[0]
    for curve in curves:
        pair, friction = curve.parameters["pair"], curve.parameters["mu"]
        style = {**lines[pair, friction], "markevery": (5 * PAIRS.index(pair), 15)}
        peak.plot(curve["L_p"], curve["N_max"], **style)
        ratio.plot(curve["L_p"], curve["tan_ratio"], **style)
    peak.set_ylabel("peak pressure  $N_{max}\\,R/F$")
    peak.set_yscale("log")
    peak.set_yticks([0.4, 0.5, 0.7, 1.0, 1.5, 2.0], labels=["0.4", "0.5", "0.7", "1", "1.5", "2"])
    peak.set_yticks([], minor=True)
    ratio.set_ylabel("tan(ρ/2) / tan(ε/2)")
    ratio.set_ylim(0.0, 1.03)
    for panel in axes[0]:
        load_parameter_axis(panel)
    add_legend(
        figure,
        [(NAMES[pair], lines[pair, FRICTION[0]]) for pair in PAIRS],
        [(f"friction coefficient {mu:g}", grey(FRICTION.index(mu))) for mu in FRICTION],
    )
    return figure
