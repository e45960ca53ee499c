"""The limit of a rigid pin: centre load and body load become equal, and elastic pins tend to it.

Left: three pins in an aluminium plate, of steel, of ten times the plate's modulus, and rigid. They are free to rotate
and pushed down, mu = 0.4, L_p = 0.1. As the modulus grows, beta* falls and the clearance with it; L_p stays. A rigid
pin has 1/G_I = 0, so both loads are the same problem, and their tractions are equal in every bit. Right: int
|difference| over int N of an elastic pin's tractions (Poisson's ratio 0.3), between its two loads and to the rigid pin.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from fastpin.figures.style import add_legend, angle_axis, line, panels
from fastpin.model.joint import PinLoad
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report, steps, traction_curve
from fastpin.paper.tractions import BOTTOM
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve
from fastpin.states.state import State

TITLE = "Rigid pin in aluminium, mu = 0.4, L_p = 0.1: tractions, and how elastic pins tend to them"
LEAST_NODES = 101
LOAD_PARAMETER = 0.1
FRICTION = 0.4
PLATE = MATERIALS["aluminium"]
PINS = {"steel": MATERIALS["steel"], "10 E": Material(10.0 * PLATE.E, 0.3), "rigid": Material.rigid()}
RATIOS = tuple(10.0 ** (k / 2) for k in range(13))
"""E_pin / E_plate"""
ARC = (BOTTOM - 1.35, BOTTOM + 1.35)
LOADS: tuple[PinLoad, PinLoad] = ("centre", "body")
PAIRS = ("centre to body", "centre to rigid", "body to rigid")
"""Pairs of states that the right panel compares."""


def pushed_pin(pin: Material, pin_load: PinLoad, nodes: int) -> State:
    """Solve a pin pushed down by P = F, on the same nodes for all pins."""
    problem = Problem.from_load_parameter(MaterialPair(pin, PLATE), LOAD_PARAMETER, FRICTION, pin_load)
    return solve(problem, [{"P": 1.0}], nodes=nodes, arc=ARC)[-1]


def difference(one: State, two: State, quantity: str) -> float:
    """Return int |difference| over int N for a traction of two states, "pressure" or "shear"."""
    weights = one.grid.weights
    change = np.abs(getattr(one, quantity) - getattr(two, quantity))
    return float(weights @ change / (weights @ two.pressure))


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Tractions of three pins under both loads, then the differences against the ratio of the moduli."""
    cases = [*PINS.items(), *((ratio, Material(ratio * PLATE.E, 0.3)) for ratio in RATIOS)]
    rigid = pushed_pin(PINS["rigid"], "centre", nodes)
    curves, rows = [], []
    for name, pin in steps(cases, progress):
        centre, body = (pushed_pin(pin, pin_load, nodes) for pin_load in LOADS)
        if isinstance(name, str):
            curves.append(traction_curve(centre, pin=name, pin_load="centre"))
            curves.append(traction_curve(body, pin=name, pin_load="body"))
        else:
            pairs = ((centre, body), (centre, rigid), (body, rigid))
            rows.append([name, *(difference(*pair, traction) for traction in ("pressure", "shear") for pair in pairs)])
    names = [f"{traction}, {pair}" for traction in "NT" for pair in PAIRS]
    columns = dict(zip(["E_pin/E_plate", *names], np.array(rows).T, strict=True))
    return [*curves, Curve({}, columns)]


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw tractions on the left, differences on the right."""
    figure, axes = panels(1, 2, height=3.1)
    tractions, convergence = axes[0]
    colours = {name: index for index, name in enumerate(PINS)}
    for curve in curves[:-1]:
        style = line(colours[str(curve.parameters["pin"])], int(curve.parameters["pin_load"] == "body"))
        for quantity in "NT":
            tractions.plot(curve["angle_deg"], curve[quantity], **style)
    tractions.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
    tractions.set_xlabel("angle from the bottom  [deg]")
    tractions.set_ylabel("$N\\,R/F$,  $T\\,R/F$")
    tractions.text(-68.0, 0.4, "N")
    tractions.text(55.0, 0.17, "T")
    angle_axis(tractions)

    differences = curves[-1]
    for colour, pair in enumerate(PAIRS, start=3):
        for dashes, quantity in enumerate("NT"):
            style = line(colour, 2 * dashes)
            label = f"{quantity}, {pair}"
            convergence.plot(differences["E_pin/E_plate"], differences[label], label=label, **style)
    convergence.set_xscale("log")
    convergence.set_yscale("log")
    convergence.set_xlabel("$E_{pin}/E_{plate}$")
    convergence.set_ylabel("difference,  ∫|ΔN|/∫N  or  ∫|ΔT|/∫N")
    convergence.legend(loc="lower left", fontsize=7.0, handlelength=2.6, labelspacing=0.3)
    grey = {"color": "0.35"}
    add_legend(
        figure,
        [("steel in aluminium", line(0)), ("ten times as stiff", line(1)), ("rigid", line(2))],
        [("centre load", {**line(0), **grey}), ("body load", {**line(0, 1), **grey})],
    )
    return figure
