"""Figure 5: half-angles of contact and stick over the load parameter; body-loaded Ti-6Al-4V pin in aluminium.

The caption leaves the coefficients of friction and the range of L_p open. Where slip begins inside the contact, rho is
the half-angle of the stick zone at the bottom. Where fewer than nine nodes stick, rho is left out (mu = 0.1, below
2 degrees).
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from fastpin.figures.style import add_legend, line, panels
from fastpin.paper.curves import Report
from fastpin.paper.sweep import load_parameter_axis, swept
from fastpin.report.curves import Curve

TITLE = "Contact and stick half-angles in body force loading (Ti-6Al-4V on aluminium)"
LEAST_NODES = 201
FRICTION = (0.1, 0.2, 0.3, 0.5, 0.7)


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Half-angles over the load parameter, one curve for each coefficient of friction."""
    return swept([("Ti/Al", friction) for friction in FRICTION], nodes, progress)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw contact half-angles left and stick half-angles right, with one scale."""
    figure, axes = panels(1, 2, height=2.9)
    contact, stick = axes[0]
    stick.sharey(contact)
    lines = [line(index, index) for index in range(len(curves))]
    for curve, style in zip(curves, lines, strict=True):
        contact.plot(curve["L_p"], curve["epsilon_deg"], **style)
        stick.plot(curve["L_p"], curve["rho_deg"], **style)
    contact.set_ylabel("contact half-angle  ε  [deg]")
    stick.set_ylabel("stick half-angle  ρ  [deg]")
    contact.set_ylim(0.0, 90.0)
    contact.set_yticks(range(0, 91, 15))
    for panel in axes[0]:
        load_parameter_axis(panel)
    add_legend(figure, [(f"μ = {curve.parameters['mu']:g}", style) for curve, style in zip(curves, lines, strict=True)])
    return figure
