"""Klang's problem: differences of the pressure from his, and the shear in parts of the limit of friction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve
from fastpin.figures.style import Line
from fastpin.model.angles import BOTTOM
from fastpin.published.klang import BAR, CORRECTED, LAST_DIGIT, MISPRINT, PUBLISHED, STICK, VARIANTS, solved
from fastpin.published.records import PaperFigure, Report, add_legend, head, marked, panels, steps


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Return Klang's pressures, and the tractions of each way to solve the problem. They have nodes of their own."""
    angles = 3.0 * np.arange(len(PUBLISHED))
    curves = [Curve({"source": "Klang"}, {"angle_deg": angles, "pressure_bar": np.array(PUBLISHED, dtype=float)})]
    for variant in steps(VARIANTS, progress):
        state = solved(variant)
        inside = np.flatnonzero(state.pressure > 0.0)
        columns = {
            "angle_deg": np.degrees(state.theta[inside] - BOTTOM),
            "pressure_bar": state.pressure[inside] / BAR,
            "shear_over_limit": state.shear[inside] / (state.problem.friction * state.pressure[inside]),
        }
        curves.append(Curve({"source": variant.words}, columns))
    return curves


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw the differences of the pressure from Klang's, and the shear in parts of the limit of friction."""
    figure, ((left, right),) = panels(1, 2, height=3.2)
    head(figure, "Like bodies, plane stress, friction coefficient 0.4; half-angle of contact 60 degrees")
    published, *ours = curves
    angles = published["angle_deg"]
    printed = np.where(angles == MISPRINT, CORRECTED, published["pressure_bar"])
    for colour, curve in enumerate(ours):
        shown = curve["angle_deg"] >= 0.0
        differences = np.interp(angles, curve["angle_deg"], curve["pressure_bar"]) - printed
        left.plot(angles, differences, **_line(colour, (colour % 3, 3)))
        right.plot(
            curve["angle_deg"][shown], np.abs(curve["shear_over_limit"][shown]), **_line(colour, (2 * colour, 14))
        )
    left.axhspan(-LAST_DIGIT, LAST_DIGIT, color="0.85", zorder=0)
    right.axvline(STICK, color="0.2", linewidth=0.9)
    right.annotate("Klang's border", (STICK, 0.02), (-4, 0), textcoords="offset points", ha="right", fontsize=7.5)
    left.set_ylabel("pressure minus Klang's (bar)")
    right.set_ylabel("shear over limit")
    for panel in (left, right):
        panel.set_xlabel("angle from the bottom (deg)")
        panel.set_xlim(0.0, 60.0)
    add_legend(figure, *([(str(curve.parameters["source"]), _line(k, 1))] for k, curve in enumerate(ours)))
    return figure


def _line(colour: int, mark: int | tuple[int, int]) -> Line:
    """Return the line of a variant, with marks at the places `mark` of Matplotlib's ``markevery``."""
    return marked(colour, colour, 1.1) | {"markevery": mark}


FIGURES = (PaperFigure("klang", "Klang's problem: pressures and shear beside his", 5, compute, draw),)
