"""Interference fits under a force: the loads at which they slip and open, and their tractions on the way.

Like bodies, nu = 0.3, plane strain. Above: the load P over R N0 at which the contact opens (solid) and at which the
first node slips (dashed), against the coefficient of friction. N0 is the pressure before the load; the curves do not
depend on the interference. The solver gives both loads on two grids, and the limit of fine grids is extrapolated.
Circles: the closed form of the slip. Grey lines: closed forms of the opening without friction and of a bonded contact.
Below: pressure and shear round the hole for mu = 0.3 and a load at the centre.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from docs.beyond.curves import curves_of
from fastpin.assess.outputs import Curve
from fastpin.bodies.body import PinLoad
from fastpin.figures.style import line
from fastpin.kernels.status import OPEN, STICK
from fastpin.model import Grid, Problem
from fastpin.published.records import PaperFigure, Report, add_legend, head, panels, steps
from fastpin.published.tractions import ANGLE, traction_curve
from fastpin.solver.solving import solve
from fastpin.states.state import State
from fastpin.verification import comparisons, interference
from fastpin.verification.finite_elements import LIKE

FRICTION = tuple(np.r_[0.0, 0.02, 0.05, 0.1:1.51:0.1].round(2).tolist())
SHOWN_FRICTION = 0.3
STAGES = (0.0, 3.204, 3.6029, 4.5)
"""Loads P/(R N0) of the lower panels: none, first slip, opening, and an open top."""


OPENS, SLIPS = line(5), line(4, 1)
"""Lines of both events. The lower panels have other colours."""


def slips(state: State) -> bool:
    """Return whether a node does not stick."""
    return bool(np.any(state.status != STICK))


def opens(state: State) -> bool:
    """Return whether a node is open."""
    return bool(np.any(state.status == OPEN))


def fitted(friction: float, pin_load: PinLoad = "centre") -> Problem:
    """Return an interference fit of like bodies with N0 = F/R. The curves do not depend on the interference."""
    return Problem.from_load_parameter(LIKE, -0.25, friction, pin_load)


def extrapolated(problem: Problem, happened: Callable[[State], bool], about: tuple[float, float], nodes: int) -> float:
    """Return the load of an event over R N0 in the limit of fine grids. Its error falls with the square of the spacing.

    `about` are two values of P/(R N0) between which the event happens. `nodes` is the number of nodes of the finer
    grid. The coarser one has half as many, and both have a node at the top.
    """
    unit = interference.uniform_pressure(problem) * problem.hole_radius
    bounds = about[0] * unit, about[1] * unit
    coarse, fine = (
        comparisons.event_load(problem, "P", bounds, happened, count) / unit for count in (nodes // 2, nodes // 2 * 2)
    )
    return (4.0 * fine - coarse) / 3.0


def events(friction: float, pin_load: PinLoad, nodes: int) -> tuple[float, float, float]:
    """Return P/(R N0) at the opening and at the first slip, and the closed form of the slip."""
    problem = fitted(friction, pin_load)
    unit = interference.uniform_pressure(problem) * problem.hole_radius
    bonded = interference.bonded_opening_load(problem) / unit
    opening = extrapolated(problem, opens, (0.95 * math.pi, 1.05 * bonded), nodes)
    if friction == 0.0:
        return opening, math.nan, math.nan
    exact = interference.first_slip_load(problem) / unit
    return opening, extrapolated(problem, slips, (0.9 * exact, 1.1 * exact), nodes), exact


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Loads of both events against friction, one curve for each load of the pin; then tractions round the hole."""
    pin_loads: tuple[PinLoad, PinLoad] = ("centre", "body")
    cases = [(pin_load, friction) for pin_load in pin_loads for friction in FRICTION]
    rows = [
        ({"pin_load": pin_load}, (friction, *events(friction, pin_load, nodes)))
        for pin_load, friction in steps(cases, progress)
    ]
    curves = curves_of(("mu", "P_opens", "P_slips", "P_slips_closed_form"), rows)
    problem = fitted(SHOWN_FRICTION)
    states = solve(problem, [{"P": stage} for stage in STAGES], grid=Grid.circle(nodes))
    for stage, state in zip(STAGES, states, strict=True):
        curves.append(traction_curve(state, pin_load="centre", mu=SHOWN_FRICTION, P=stage))
    return curves


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw the loads of both events against friction above, one panel for each load of the pin; tractions below."""
    figure, axes = panels(2, 2, height=2.7)
    head(
        figure,
        "Interference fit of like bodies (ν = 0.3), plane strain; N0: pressure without the load P",
        f"above: circles are the closed form; below: force at the centre, friction coefficient {SHOWN_FRICTION:g}",
    )
    of_events = [curve for curve in curves if "P_opens" in curve.columns]
    for panel, curve in zip(axes[0], of_events, strict=True):
        _draw_events(panel, curve)
    axes[0, 1].sharey(axes[0, 0])
    stages = curves[len(of_events) :]
    for panel, quantity in zip(axes[1], "NT", strict=True):
        for k, curve in enumerate(stages):
            panel.plot(curve["angle_deg"], curve[quantity], **line(k, k))
        panel.set_xlim(-180.0, 180.0)
        panel.set_xticks(range(-180, 181, 60))
        panel.set_xlabel(ANGLE)
        panel.set_ylabel({"N": "pressure  $N/N_0$", "T": "shear traction  $T/N_0$"}[quantity])
    events = [("above: the top opens", OPENS), ("above: the first place slips", SLIPS)]
    loads = [(f"below: $P/(R\\,N_0)$ = {curve.parameters['P']:.3g}", line(k, k)) for k, curve in enumerate(stages)]
    add_legend(figure, events, loads)
    return figure


def _draw_events(panel: Axes, curve: Curve) -> None:
    """Draw the loads of slip and opening for one load of the pin, and the limits of little and much friction."""
    pin_load = str(curve.parameters["pin_load"])
    panel.plot(curve["mu"], curve["P_opens"], **OPENS)
    panel.plot(curve["mu"], curve["P_slips"], **SLIPS)
    dots = {"linestyle": "none", "marker": "o", "markersize": 3.5, "color": SLIPS["color"]}
    panel.plot(curve["mu"], curve["P_slips_closed_form"], markerfacecolor="white", markeredgewidth=0.9, **dots)
    problem = fitted(SHOWN_FRICTION, "body" if pin_load == "body" else "centre")
    bonded = interference.bonded_opening_load(problem) / interference.uniform_pressure(problem)
    limits = (bonded, "bonded", 0.06, "bottom"), (math.pi, "opens without friction: π", -0.06, "top")
    for load, words, shift, side in limits:
        panel.axhline(load, color="0.35", linewidth=0.8, zorder=0)
        panel.annotate(words, (FRICTION[-1], load + shift), ha="right", va=side, fontsize=8.0)
    panel.set_xlim(0.0, FRICTION[-1])
    panel.set_ylim(0.0, 5.2)
    panel.set_title({"centre": "force at the centre of the pin", "body": "body force"}[pin_load], fontsize=9.0)
    panel.set_xlabel("friction coefficient  μ")
    panel.set_ylabel("load  $P/(R\\,N_0)$")


FIGURES = (
    PaperFigure(
        "interference",
        "Interference fit of like bodies: loads of first slip and of opening against friction; tractions at mu = 0.3",
        101, compute, draw,
    ),
)  # fmt: skip
