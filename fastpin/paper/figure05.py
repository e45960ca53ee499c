"""Figure 5: half-angles of contact and stick over the load parameter; body-loaded Ti-6Al-4V pin in aluminium.

The caption leaves the coefficients of friction and the range of L_p open. Where slip begins inside the contact, rho is
the half-angle of the stick zone at the bottom. The narrowest is 0.2 degrees (mu = 0.1). With few nodes, rho is left out
where fewer than nine nodes stick.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import add_legend, line, panels
from fastpin.paper.curves import Report
from fastpin.paper.legends import head
from fastpin.paper.sweep import load_parameter_axis, swept
from fastpin.paper.tractions import NAMES
from fastpin.report.curves import Curve

TITLE = "Contact and stick half-angles in body force loading (Ti-6Al-4V on aluminium)"
LEAST_NODES = 201
PAIR = "Ti/Al"
FRICTION = (0.1, 0.2, 0.3, 0.5, 0.7)
STYLES = (0, 1, 2, 3, 5)
"""Colours and dashes of the curves. The dashes of the fifth style look like those of the second."""


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Half-angles over the load parameter, one curve for each coefficient of friction."""
    return swept([(PAIR, friction) for friction in FRICTION], nodes, progress)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw contact half-angles left and stick half-angles right, with one scale."""
    figure, axes = panels(1, 2, height=2.9)
    head(figure, f"{NAMES[PAIR]}, plane strain; body force F on the pin, downwards")
    contact, stick = axes[0]
    stick.sharey(contact)
    lines = [line(k, k) for k in STYLES[: len(curves)]]
    for curve, style in zip(curves, lines, strict=True):
        contact.plot(curve["L_p"], curve["epsilon_deg"], **style)
        stick.plot(curve["L_p"], curve["rho_deg"], **style)
    contact.set_ylabel("half-angle of the contact  ε  (deg)")
    stick.set_ylabel("half-angle of the stick zone  ρ  (deg)")
    contact.set_ylim(0.0, 90.0)
    contact.set_yticks(range(0, 91, 15))
    for panel in axes[0]:
        load_parameter_axis(panel)
    stick.annotate(
        "the whole contact\nsticks: ρ = ε",
        (0.5, 39.5),
        (0.55, 60.0),
        fontsize=8.0,
        arrowprops={"arrowstyle": "-", "linewidth": 0.7},
    )
    names = [f"friction coefficient {curve.parameters['mu']:g}" for curve in curves]
    add_legend(figure, list(zip(names, lines, strict=True)))
    return figure
