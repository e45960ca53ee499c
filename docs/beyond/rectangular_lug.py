"""A rectangular lug against the infinite plate: tractions, hoop stress, peak pressure over the width. Beyond the paper.

The lug is held at its top, 6 R above the hole's centre, and ends 2.5 R below it. A solid pin with a body load is pushed
down; like bodies, nu = 0.3, plane strain, L_p = 0.1. Tractions and hoop stress belong to a half-width of 2.5 R.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from docs.beyond.curves import curves_of
from docs.beyond.finite_bodies import CASE, INFINITE, LOAD_PARAMETER, PAIR
from fastpin.assess.outputs import Curve
from fastpin.bodies import Compliance, Plate
from fastpin.figures.style import Line, angle_axis, line
from fastpin.lugs.outline import Lug, rectangle
from fastpin.lugs.plates import plate_compliance
from fastpin.model.angles import BOTTOM
from fastpin.model.problem import Problem
from fastpin.published.records import PaperFigure, Report, add_legend, grey, head, panels, steps
from fastpin.published.tractions import ANGLE, QUANTITIES, traction_curve
from fastpin.solver.solving import solve

FRICTION = (0.0, 0.4)
HALF_WIDTHS = (1.4, 1.5, 1.6, 1.7, 1.8, 2.0, 2.25, 2.5, 3.0, 4.0, 5.0, 6.0)
SHOWN = 2.5
"""Half-width of the lug whose tractions are drawn, in units of R."""

BELOW, ABOVE = 2.5, 6.0
"""Distances of the lug's end and of its held edge from the hole's centre, in units of R."""

LUG = "rectangular lug"


def lug_of(half_width: float) -> Compliance:
    """Return the compliance of the lug of a half-width, in units of R."""
    outline = rectangle((-half_width, half_width), (-BELOW, ABOVE))
    return plate_compliance(Lug(PAIR.plate.nu, PAIR.plane, 1.0, outline, {"top": "both"})).compliance


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions and hoop stress of lug and infinite plate, then the peak pressure over the half-width."""
    curves: list[Curve] = []
    peaks = []
    for width in steps([math.inf, *HALF_WIDTHS], progress):
        body: Plate | Compliance = Plate() if math.isinf(width) else lug_of(width)
        for friction in FRICTION:
            problem = Problem.from_load_parameter(PAIR, LOAD_PARAMETER, friction, "body", plate_body=body)
            state = solve(problem, [{"P": 1.0}], nodes=nodes)[-1]
            peaks.append(({"mu": friction}, (width, state.peak_pressure)))
            if width in (SHOWN, math.inf):
                parameters: dict[str, Any] = {"plate": INFINITE if math.isinf(width) else LUG, "mu": friction}
                theta = BOTTOM + np.linspace(-math.pi, math.pi, 361)
                hoop = {"angle_deg": np.degrees(theta) + 90.0, "hoop": state.hoop_stress("plate", theta)}
                curves += [traction_curve(state, **parameters), Curve(parameters, hoop)]
    return [*curves, *curves_of(("half_width", "N_max"), peaks)]


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw tractions above, hoop stress and peak pressure below. Colours show the plate; dashed lines have friction."""
    figure, axes = panels(2, 2)
    head(
        figure,
        f"{CASE}; body force F; hole radius R",
        f"lug held at its top, {ABOVE:g} R above the centre of the hole, and cut off {BELOW:g} R below it",
    )

    def style(plate: str, friction: float) -> Line:
        return line(0 if plate == LUG else 5, FRICTION.index(friction), 1.4 if plate == LUG else 1.0)

    for panel, column, label in (
        (axes[0, 0], "N", QUANTITIES["N"]),
        (axes[0, 1], "T", QUANTITIES["T"]),
        (axes[1, 0], "hoop", "hoop stress (F/R)"),
    ):
        for curve in curves:
            if column in curve.columns and (column != "T" or curve.parameters["mu"] > 0.0):
                panel.plot(
                    curve["angle_deg"], curve[column], **style(curve.parameters["plate"], curve.parameters["mu"])
                )
        panel.set_xlabel(ANGLE)
        panel.set_ylabel(label)
        angle_axis(panel)
    axes[0, 0].set_ylim(bottom=0.0)
    for friction in FRICTION:
        widths = next(curve for curve in width_curves(curves) if curve.parameters["mu"] == friction)
        finite = np.isfinite(widths["half_width"])
        axes[1, 1].plot(widths["half_width"][finite], widths["N_max"][finite], marker=".", **style(LUG, friction))
        axes[1, 1].axhline(float(widths["N_max"][~finite][0]), **style(INFINITE, friction))
    axes[1, 1].set_xlabel("half-width of the lug over the hole radius")
    axes[1, 1].set_ylabel("peak pressure  $N_{max} R/F$")
    plates = [(f"{LUG}, half-width {SHOWN:g} R", style(LUG, 0.0)), (INFINITE, style(INFINITE, 0.0))]
    friction_lines = [(f"friction coefficient {mu:g}", grey(k)) for k, mu in enumerate(FRICTION)]
    add_legend(figure, [*plates, *friction_lines])
    return figure


def width_curves(curves: Sequence[Curve]) -> list[Curve]:
    """Return the curves of the peak pressure over the half-width."""
    return [curve for curve in curves if "N_max" in curve.columns]


FIGURES = (
    PaperFigure(
        "rectangular-lug",
        "Rectangular lug held at its top: tractions, hoop stress and peak pressure; like bodies, L_p = 0.1",
        101, compute, draw,
    ),
)  # fmt: skip
