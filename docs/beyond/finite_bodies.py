"""Hollow pins and ring lugs: tractions, peak pressure and half-angle over their radii. Beyond the paper.

Like bodies, nu = 0.3, plane strain, L_p = 0.1. Rings have a solid pin with a body load, and mu = 0.3. The tractions
belong to a rim that is held, above, and to a free one with a uniform traction, below. The four distributions all round
a free rim differ in the slip that they cause only, so their lines lie close together. Hollow pins lie in an infinite
plate, with and without friction.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from docs.beyond.curves import curves_of
from fastpin.assess.outputs import Curve
from fastpin.bodies import Disk, Plate, Ring, Tube
from fastpin.bodies.pins import TubeLoad
from fastpin.bodies.ring import SUPPORTS, Support
from fastpin.figures.style import Line, line
from fastpin.model import Material, MaterialPair, Problem
from fastpin.published.records import PaperFigure, Report, add_legend, grey, head, marked, panels, steps
from fastpin.published.tractions import Panel, chosen, traction_curve, traction_figure
from fastpin.solver.solving import solve

PAIR = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
LOAD_PARAMETER, FRICTION = 0.1, 0.3
CASE = f"Like bodies (ν = 0.3), plane strain, load parameter {LOAD_PARAMETER:g}"
"""The words of a heading."""
INFINITE = "infinite plate"

SHOWN_SUPPORTS: tuple[Support, ...] = ("held", "uniform")
SHOWN_RADII = (1.5, 2.0, 3.0, 4.0)
"""Rings whose tractions are drawn."""

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

BORES = (0.0, 0.1, 0.2, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, *(0.02 * k for k in range(29, 37)), 0.75, 0.8, 0.85, 0.9)
FRICTIONS = (0.0, 0.3)
BORE_LOADS: dict[TubeLoad, str] = {"uniform": "uniform traction on a free bore", "held": "rigid core in the bore"}

PEAK_AND_ANGLE = {"N_max": "peak pressure  $N_{max} R/F$", "half_angle_deg": "half-angle of the contact (deg)"}
"""Columns and words of the left and the right panel."""


def peak_and_half_angle(problem: Problem, nodes: int) -> tuple[float, float]:
    """Return the peak pressure and the half-angle of the contact, deg, of a pin that is pushed down."""
    state = solve(problem, [{"P": 1.0}], nodes=nodes)[-1]
    return state.peak_pressure, float(np.degrees(0.5 * sum(stop - start for start, stop in state.contact)))


def compute_rings(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions at P = F, one curve for the infinite plate, and one for each support and outer radius."""
    cases: list[tuple[dict[str, Any], Plate | Ring]] = [({"support": INFINITE}, Plate())]
    for support in SHOWN_SUPPORTS:
        for outer in SHOWN_RADII:
            cases.append(({"support": support, "outer_radius": outer}, Ring(outer, support)))
    curves = []
    for parameters, body in steps(cases, progress):
        problem = Problem.from_load_parameter(PAIR, LOAD_PARAMETER, FRICTION, "body", plate_body=body)
        curves.append(traction_curve(solve(problem, [{"P": 1.0}], nodes=nodes)[-1], **parameters))
    return curves


def draw_rings(curves: Sequence[Curve]) -> Figure:
    """Draw pressure left, shear right; the held rim above, the uniform traction below."""
    lines: dict[float, Line] = {outer: line(k, k) for k, outer in enumerate(SHOWN_RADII)}
    infinite = line(5, 5, 1.0)
    plate = chosen(curves, support=INFINITE)
    layout = []
    for support, words in zip(SHOWN_SUPPORTS, ("ring held at its rim", "uniform traction on the rim"), strict=True):
        shown = [*plate, *chosen(curves, support=support)]
        layout.append([Panel("N", shown, words), Panel("T", shown, words)])
    return traction_figure(
        layout,
        lambda curve: lines.get(curve.parameters.get("outer_radius", 0.0), infinite),
        [*((f"outer radius {outer:g} R", style) for outer, style in lines.items()), (INFINITE, infinite)],
        heading=[CASE, f"friction coefficient {FRICTION:g}; body force F on the pin, downwards; R: radius of the hole"],
    )


def compute_supports(nodes: int, progress: Report | None = None) -> list[Curve]:
    """One curve over the outer radius for each support, and one for the infinite plate."""
    rings: list[tuple[str, float, Plate | Ring]] = [
        (support, outer, Ring(outer, support)) for support in SUPPORTS for outer in OUTER_RADII
    ]
    rows = []
    for support, outer, body in steps([(INFINITE, np.inf, Plate()), *rings], progress):
        problem = Problem.from_load_parameter(PAIR, LOAD_PARAMETER, FRICTION, "body", plate_body=body)
        rows.append(({"support": support}, (outer, *peak_and_half_angle(problem, nodes))))
    return curves_of(("outer_radius", *PEAK_AND_ANGLE), rows)


def draw_supports(curves: Sequence[Curve]) -> Figure:
    """Draw the peak pressure left, the half-angle right, over the outer radius."""
    figure, axes = panels(1, 2, height=3.0)
    head(figure, CASE, f"friction coefficient {FRICTION:g}; body force F on the pin, downwards")
    lines: dict[str, Line] = {support: line(k, k) for k, support in enumerate(SUPPORTS)}
    for panel, (name, label) in zip(axes[0], PEAK_AND_ANGLE.items(), strict=True):
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


def compute_hollow_pins(nodes: int, progress: Report | None = None) -> list[Curve]:
    """One curve over the bore radius for each load and coefficient of friction; bore 0 is a load at the centre."""
    cases = [(load, friction, bore) for load in BORE_LOADS for friction in FRICTIONS for bore in BORES]
    rows = []
    for load, friction, bore in steps(cases, progress):
        body: Disk | Tube = Tube(bore, load) if bore else Disk()
        problem = Problem.from_load_parameter(PAIR, LOAD_PARAMETER, friction, pin_body=body)
        rows.append(({"load": load, "mu": friction}, (bore, *peak_and_half_angle(problem, nodes))))
    return curves_of(("bore_radius", *PEAK_AND_ANGLE), rows)


def draw_hollow_pins(curves: Sequence[Curve]) -> Figure:
    """Draw the peak pressure left, the half-angle right. Colours show the load; dashed lines have friction."""
    figure, axes = panels(1, 2, height=3.0)
    head(figure, f"{CASE}; force F on the bore, downwards")
    colours: dict[str, int] = {load: k for k, load in enumerate(BORE_LOADS)}

    def style(load: str, friction: float) -> Line:
        return marked(colours[load], FRICTIONS.index(friction))

    for panel, (name, label) in zip(axes[0], PEAK_AND_ANGLE.items(), strict=True):
        for curve in curves:
            panel.plot(curve["bore_radius"], curve[name], **style(curve.parameters["load"], curve.parameters["mu"]))
        panel.set_xlabel("bore radius over the hole radius")
        panel.set_ylabel(label)
        panel.set_xlim(0.0, max(BORES))
    axes[0, 0].set_ylim(bottom=0.0)
    friction = [(f"friction coefficient {mu:g}", grey(k)) for k, mu in enumerate(FRICTIONS)]
    add_legend(figure, [(words, style(load, FRICTIONS[0])) for load, words in BORE_LOADS.items()], friction)
    return figure


FIGURES = (
    PaperFigure(
        "rings",
        "Ring lugs: tractions for outer radii from 1.5 R to an infinite plate; like bodies, L_p = 0.1, mu = 0.3",
        101, compute_rings, draw_rings,
    ),
    PaperFigure(
        "supports",
        "Ring lugs: peak pressure and half-angle over outer radius and support; like bodies, L_p = 0.1, mu = 0.3",
        101, compute_supports, draw_supports,
    ),
    PaperFigure(
        "hollow-pins",
        "Hollow pins: peak pressure and half-angle over the bore, by friction and load; like bodies, L_p = 0.1",
        101, compute_hollow_pins, draw_hollow_pins,
    ),
)  # fmt: skip
