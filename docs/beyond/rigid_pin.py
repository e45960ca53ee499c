"""The limit of a rigid pin: centre load and body load become equal, and elastic pins tend to it.

Above: three pins in an aluminium plate, of steel, of ten times the plate's modulus, and rigid. They are free to rotate
and pushed down, mu = 0.4, L_p = 0.1. As the modulus grows, beta* falls and the clearance with it; L_p stays. A rigid
pin has 1/G_I = 0, so both loads are the same problem, and their tractions are equal in every bit. Below: int
|difference| over int N of an elastic pin's tractions (Poisson's ratio 0.3), between its two loads and to the rigid pin.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve
from fastpin.bodies.body import PinLoad
from fastpin.figures.style import Line, angle_axis
from fastpin.model import MATERIALS, Material, MaterialPair, Problem, angles
from fastpin.published.records import PaperFigure, Report, add_legend, grey, head, marked, panels, steps
from fastpin.published.tractions import ANGLE, QUANTITIES, traction_curve
from fastpin.solver.solving import solve
from fastpin.states.state import State

LOAD_PARAMETER = 0.1
FRICTION = 0.4
PLATE = MATERIALS["aluminium"]
PINS = {"steel": MATERIALS["steel"], "10 E": Material(10.0 * PLATE.E, 0.3), "rigid": Material.rigid()}
RATIOS = tuple(10.0 ** (k / 2) for k in range(13))
"""E_pin / E_plate"""
LOADS: tuple[PinLoad, PinLoad] = ("centre", "body")
PAIRS = ("centre to body", "centre to rigid", "body to rigid")
"""Pairs of states that the lower panels compare."""


def pushed_pin(pin: Material, pin_load: PinLoad, nodes: int) -> State:
    """Solve a pin pushed down by P = F, on the same nodes for all pins."""
    problem = Problem.from_load_parameter(MaterialPair(pin, PLATE), LOAD_PARAMETER, FRICTION, pin_load)
    return solve(problem, [{"P": 1.0}], nodes=nodes, arc=(angles.BOTTOM - 1.35, angles.BOTTOM + 1.35))[-1]


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
    """Draw pressure and shear above, the differences of both below."""
    figure, axes = panels(2, 2, height=2.7)
    head(
        figure,
        f"Aluminium plate, plane strain, friction coefficient {FRICTION:g}, load parameter {LOAD_PARAMETER:g}",
        "force F downwards; pin free to rotate",
    )
    colours = {name: index for index, name in enumerate(PINS)}
    for panel, quantity in zip(axes[0], "NT", strict=True):
        for curve in curves[:-1]:
            pin, load = str(curve.parameters["pin"]), str(curve.parameters["pin_load"])
            panel.plot(curve["angle_deg"], curve[quantity], **_pin_line(colours[pin], load))
        panel.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
        panel.set_xlabel(ANGLE)
        panel.set_ylabel(QUANTITIES[quantity])
        angle_axis(panel)
    axes[0, 0].set_ylim(bottom=0.0)
    differences = curves[-1]
    words = {"N": "pressure", "T": "shear traction"}
    pins = "above: steel pin", "above: pin ten times as stiff as the plate", "above: rigid pin"
    pairs = "centre load to body load", "centre load to rigid pin", "body load to rigid pin"
    for panel, quantity in zip(axes[1], "NT", strict=True):
        for colour, pair in enumerate(PAIRS, start=3):
            panel.plot(differences["E_pin/E_plate"], differences[f"{quantity}, {pair}"], **marked(colour, colour - 3))
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel("modulus of the pin over modulus of the plate")
        panel.set_title(f"difference of the {words[quantity]}", fontsize=9.0)
        panel.set_ylabel(f"∫|Δ{quantity}| / ∫N")
    add_legend(
        figure,
        [(name, _pin_line(index, "centre")) for index, name in enumerate(pins)],
        [("above: force at the centre", grey(0)), ("above: body force", grey(1))],
        [(f"below: {name}", marked(colour, colour - 3)) for colour, name in enumerate(pairs, start=3)],
    )
    return figure


def _pin_line(colour: int, pin_load: str) -> Line:
    return marked(colour, int(pin_load == "body")) | {"markevery": (0.05 + 0.05 * colour, 0.2)}


FIGURES = (
    PaperFigure(
        "rigid-pin", "Rigid pin in aluminium, mu = 0.4, L_p = 0.1: tractions, and how elastic pins tend to them",
        101, compute, draw,
    ),
)  # fmt: skip
