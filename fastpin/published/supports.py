"""Peak pressure and contact half-angle of a ring lug over its outer radius, for each kind of support. Beyond the paper.

Solid pin with a body load; like bodies, nu = 0.3, plane strain, L_p = 0.1, mu = 0.3. The four distributions all round a
free rim differ in the slip that they cause only, so their lines lie close together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from fastpin.bodies import Plate, Ring
from fastpin.bodies.ring import SUPPORTS
from fastpin.figures.style import Line, line
from fastpin.model.problem import Problem
from fastpin.published.drawing import add_legend, head, panels
from fastpin.published.records import PaperFigure, Report, steps
from fastpin.published.rings import CASE, FRICTION, INFINITE, LOAD_PARAMETER, PAIR
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve

OUTER_RADII = (
    1.2, 1.225, 1.25, 1.275, 1.3, 1.325, 1.35, 1.4, 1.5, 1.6, 1.8, 2.0, 2.25, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 10.0,
)  # fmt: skip
NAMES = {
    "held": "rim held",
    "uniform": "uniform traction",
    "normal": "normal traction, cosine",
    "shear": "shear traction, sine",
    "half": "pressure on half of the rim",
    "body": "body force",
}


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """One curve over the outer radius for each support, and one for the infinite plate."""
    rings: list[tuple[str, float, Plate | Ring]] = [
        (support, outer, Ring(outer, support)) for support in SUPPORTS for outer in OUTER_RADII
    ]
    rows: dict[str, list[tuple[float, float, float]]] = {}
    for support, outer, body in steps([(INFINITE, np.inf, Plate()), *rings], progress):
        problem = Problem.from_load_parameter(PAIR, LOAD_PARAMETER, FRICTION, "body", plate_body=body)
        state = solve(problem, [{"P": 1.0}], nodes=nodes)[-1]
        half = 0.5 * sum(stop - start for start, stop in state.contact)
        rows.setdefault(support, []).append((outer, state.peak_pressure, np.degrees(half)))
    names = ("outer_radius", "N_max", "half_angle_deg")
    return [
        Curve({"support": support}, dict(zip(names, np.array(row).T, strict=True))) for support, row in rows.items()
    ]


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw the peak pressure left, the half-angle right, over the outer radius."""
    figure, axes = panels(1, 2, height=3.0)
    head(figure, CASE, f"friction coefficient {FRICTION:g}; body force F on the pin, downwards")
    lines: dict[str, Line] = {support: line(k, k) for k, support in enumerate(SUPPORTS)}
    for panel, name, label in (
        (axes[0, 0], "N_max", "peak pressure  $N_{max} R/F$"),
        (axes[0, 1], "half_angle_deg", "half-angle of the contact (deg)"),
    ):
        for curve in curves:
            if curve.parameters["support"] == INFINITE:
                panel.axhline(float(curve[name][0]), color="0.55", linewidth=1.0, zorder=0)
            else:
                panel.plot(curve["outer_radius"], curve[name], **lines[curve.parameters["support"]])
        panel.set_xscale("log")
        panel.set_xticks([1.2, 1.5, 2.0, 3.0, 5.0, 10.0], labels=["1.2", "1.5", "2", "3", "5", "10"])
        panel.minorticks_off()
        panel.set_xlabel("outer radius of the ring over the hole radius")
        panel.set_ylabel(label)
    axes[0, 0].annotate(
        "all round a free rim:\nfour tractions, nearly equal", (1.55, 0.451), (2.6, 0.42), fontsize=8.0, va="center",
        arrowprops={"arrowstyle": "-", "linewidth": 0.7},
    )  # fmt: skip
    rows = [(NAMES[support], style) for support, style in lines.items()]
    add_legend(figure, [*rows[:3], (INFINITE, {"color": "0.55", "linewidth": 1.0})], rows[3:])
    return figure


FIGURES = (
    PaperFigure(
        "supports",
        "Ring lugs: peak pressure and half-angle over outer radius and support; like bodies, L_p = 0.1, mu = 0.3",
        101, compute, draw,
    ),
)  # fmt: skip
