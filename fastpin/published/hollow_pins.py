"""Peak pressure and contact half-angle of a hollow pin over its bore, with and without friction. Beyond the paper.

Infinite plate; like bodies, nu = 0.3, plane strain, L_p = 0.1.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from fastpin.bodies import Disk, Tube
from fastpin.bodies.tube import TubeLoad
from fastpin.figures.style import Line
from fastpin.model.problem import Problem
from fastpin.published.drawing import add_legend, grey, head, marked, panels
from fastpin.published.records import PaperFigure, Report, steps
from fastpin.published.rings import CASE, LOAD_PARAMETER, PAIR
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve

BORES = (0.0, 0.1, 0.2, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, *(0.02 * k for k in range(29, 37)), 0.75, 0.8, 0.85, 0.9)
FRICTION = (0.0, 0.3)
LOADS: dict[TubeLoad, str] = {"uniform": "uniform traction on a free bore", "held": "rigid core in the bore"}


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """One curve over the bore radius for each load and coefficient of friction; bore 0 is a load at the centre."""
    cases = [(load, friction, bore) for load in LOADS for friction in FRICTION for bore in BORES]
    rows: dict[tuple[str, float], list[tuple[float, float, float]]] = {}
    for load, friction, bore in steps(cases, progress):
        body: Disk | Tube = Tube(bore, load) if bore else Disk()
        problem = Problem.from_load_parameter(PAIR, LOAD_PARAMETER, friction, pin_body=body)
        state = solve(problem, [{"P": 1.0}], nodes=nodes)[-1]
        half = 0.5 * sum(stop - start for start, stop in state.contact)
        rows.setdefault((load, friction), []).append((bore, state.peak_pressure, np.degrees(half)))
    names = ("bore_radius", "N_max", "half_angle_deg")
    return [
        Curve({"load": load, "mu": friction}, dict(zip(names, np.array(row).T, strict=True)))
        for (load, friction), row in rows.items()
    ]


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw the peak pressure left, the half-angle right. Colours show the load; dashed lines have friction."""
    figure, axes = panels(1, 2, height=3.0)
    head(figure, f"{CASE}; force F on the bore, downwards")
    colours: dict[str, int] = {load: k for k, load in enumerate(LOADS)}

    def style(load: str, friction: float) -> Line:
        return marked(colours[load], FRICTION.index(friction))

    for panel, name, label in (
        (axes[0, 0], "N_max", "peak pressure  $N_{max} R/F$"),
        (axes[0, 1], "half_angle_deg", "half-angle of the contact (deg)"),
    ):
        for curve in curves:
            panel.plot(curve["bore_radius"], curve[name], **style(curve.parameters["load"], curve.parameters["mu"]))
        panel.set_xlabel("bore radius over the hole radius")
        panel.set_ylabel(label)
        panel.set_xlim(0.0, max(BORES))
    axes[0, 0].set_ylim(bottom=0.0)
    friction = [(f"friction coefficient {mu:g}", grey(k)) for k, mu in enumerate(FRICTION)]
    add_legend(figure, [(words, style(load, FRICTION[0])) for load, words in LOADS.items()], friction)
    return figure


FIGURES = (
    PaperFigure(
        "hollow-pins",
        "Hollow pins: peak pressure and half-angle over the bore, by friction and load; like bodies, L_p = 0.1",
        101, compute, draw,
    ),
)  # fmt: skip
