"""Kt of the net section of lugs over the diameter of the hole in parts of the width. Beyond the paper.

The end is round about the hole's centre, or square one width below it. The shank is held three widths above. Pin and
lug are of steel, in plane stress, without friction. The numbers of the joint are those of a public exercise, a clevis
lug with a square end: hole 12 mm, width 30 mm, thickness 6 mm, 8.75 kN, clearance 0.002 of the diameter. Peterson's
chart itself was not seen. For d/w = 0.4 a public note takes 2.7 from a handbook, and a fit to the chart gives 2.85.
"""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from docs.beyond.curves import curves_of
from fastpin.assess.outputs import Curve
from fastpin.bodies import Compliance
from fastpin.figures.style import line
from fastpin.lugs.outline import Lug, Part, rectangle
from fastpin.lugs.plates import plate_compliance
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.published.records import PaperFigure, Report, add_legend, head, panels, steps
from fastpin.solver.solving import solve

RADIUS, THICKNESS, FORCE = 6e-3, 6e-3, 8.75e3
"""Radius of the hole, m, thickness, m, and force, N."""

RATIOS = (0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7)
"""Diameter of the hole over the width."""

SHAPES = ("round", "square")
"""The end of the lug."""

CLEARANCES = (0.0, 0.001)
"""Radial clearances in parts of the diameter."""

KNOWN = {"value of a public note": (0.4, 2.7), "fit to Peterson's chart (not seen)": (0.4, 2.85)}
"""Values of others: d/w, and Kt of the net section."""

PAIR = MaterialPair(MATERIALS["steel"], MATERIALS["steel"], plane="stress")


def lug_of(ratio: float, shape: str) -> Compliance:
    """Return the compliance of a lug with an end of a shape."""
    half = RADIUS / ratio
    ends = [complex(half, 0.0), complex(half, 6.0 * half), complex(-half, 6.0 * half), complex(-half, 0.0)]
    parts = [Part(name, ends[k], ends[k + 1]) for k, name in enumerate(("right", "top", "left"))]
    outline = (*parts, Part("nose", ends[3], ends[0], complex(0.0, -half)))
    if shape == "square":
        outline = rectangle((-half, half), (-2.0 * half, 6.0 * half))
    lug = Lug(PAIR.plate.nu, "stress", RADIUS, outline, {"top": "both"}, net_section=2.0 * (half - RADIUS))
    return plate_compliance(lug).compliance


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Kt of the net section over d/w, for each shape and clearance."""
    found = []
    for ratio, shape in steps([(ratio, shape) for shape in SHAPES for ratio in RATIOS], progress):
        body = lug_of(ratio, shape)
        for clearance in CLEARANCES:
            problem = Problem(PAIR, RADIUS, clearance * 2.0 * RADIUS, 0.0, plate_body=body)
            peak = solve(problem, [{"P": FORCE / THICKNESS}], nodes=nodes)[-1].peak_hoop_stress()
            found.append(({"end": shape, "clearance": clearance}, (ratio, peak.kt_net)))
    return curves_of(("d_over_w", "kt_net"), found)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw Kt of the net section over d/w, with the values of others."""
    figure, axes = panels(1, 1)
    head(
        figure,
        "steel pin in a steel lug, plane stress, no friction",
        f"hole {2e3 * RADIUS:g} mm, {1e3 * THICKNESS:g} mm thick, {1e-3 * FORCE:g} kN; shank held three widths above",
    )
    panel, entries = axes[0, 0], []
    for curve in curves:
        shape, clearance = (curve.parameters[name] for name in ("end", "clearance"))
        style = line(2 * SHAPES.index(shape), CLEARANCES.index(clearance))
        panel.plot(curve["d_over_w"], curve["kt_net"], marker=".", **style)
        entries.append((f"{shape} end, {f'clearance {2.0 * clearance:g} d' if clearance else 'neat fit'}", style))
    for (words, place), marker in zip(KNOWN.items(), "sD", strict=True):
        point = {"linestyle": "none", "marker": marker, "markersize": 4.0, "color": "0.2"}
        panel.plot(*place, **point)
        entries.append((words, point))
    panel.set_xlabel("diameter of the hole over the width, d/w")
    panel.set_ylabel("Kt of the net section")
    panel.set_ylim(bottom=0.0)
    add_legend(figure, entries)
    return figure


FIGURES = (
    PaperFigure(
        "lug-concentration", "Kt of the net section of lugs over d/w; steel, plane stress, no friction",
        201, compute, draw,
    ),
)  # fmt: skip
