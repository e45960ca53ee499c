"""Pressure and shear in ring lugs, from a wide ring to a narrow one, against the infinite plate. Beyond the paper.

Solid pin with a body load; like bodies, nu = 0.3, plane strain. The outer rim is held above, free with a uniform
traction below.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from fastpin.bodies import Plate, Ring
from fastpin.bodies.ring import Support
from fastpin.figures.style import Line, line
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.published.curves import traction_curve
from fastpin.published.records import PaperFigure, Report, steps
from fastpin.published.tractions import Panel, chosen, traction_figure
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve

PAIR = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
LOAD_PARAMETER, FRICTION = 0.1, 0.3
CASE = f"Like bodies (ν = 0.3), plane strain, load parameter {LOAD_PARAMETER:g}"
"""The words of a heading."""
SUPPORTS: tuple[Support, ...] = ("held", "uniform")
OUTER_RADII = (1.5, 2.0, 3.0, 4.0)
INFINITE = "infinite plate"


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions at P = F, one curve for the infinite plate, and one for each support and outer radius."""
    cases: list[tuple[dict[str, Any], Plate | Ring]] = [({"support": INFINITE}, Plate())]
    for support in SUPPORTS:
        for outer in OUTER_RADII:
            cases.append(({"support": support, "outer_radius": outer}, Ring(outer, support)))
    curves = []
    for parameters, body in steps(cases, progress):
        problem = Problem.from_load_parameter(PAIR, LOAD_PARAMETER, FRICTION, "body", plate_body=body)
        curves.append(traction_curve(solve(problem, [{"P": 1.0}], nodes=nodes)[-1], **parameters))
    return curves


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw pressure left, shear right; the held rim above, the uniform traction below."""
    lines: dict[float, Line] = {outer: line(k, k) for k, outer in enumerate(OUTER_RADII)}
    infinite = line(5, 5, 1.0)
    plate = chosen(curves, support=INFINITE)
    layout = []
    for support, words in zip(SUPPORTS, ("ring held at its rim", "uniform traction on the rim"), strict=True):
        shown = [*plate, *chosen(curves, support=support)]
        layout.append([Panel("N", shown, words), Panel("T", shown, words)])
    return traction_figure(
        layout,
        lambda curve: lines.get(curve.parameters.get("outer_radius", 0.0), infinite),
        [*((f"outer radius {outer:g} R", style) for outer, style in lines.items()), (INFINITE, infinite)],
        heading=[CASE, f"friction coefficient {FRICTION:g}; body force F on the pin, downwards; R: radius of the hole"],
    )


FIGURES = (
    PaperFigure(
        "rings",
        "Ring lugs: tractions for outer radii from 1.5 R to an infinite plate; like bodies, L_p = 0.1, mu = 0.3",
        101, compute, draw,
    ),
)  # fmt: skip
