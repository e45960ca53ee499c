"""Figures 5 and 8: contact, stick zone and peak pressure of a body-loaded pin over the load parameter.

*Figure 5*: half-angles of contact and stick of a Ti-6Al-4V pin in aluminium. The caption leaves the coefficients of
friction and the range of L_p open. Where slip begins inside the contact, rho is the half-angle of the stick zone at the
bottom. The narrowest is 0.2 degrees (mu = 0.1). With few nodes, rho is left out where fewer than nine nodes stick.

*Figure 8*: peak pressure and relative size of the stick zone of three pairs. The caption leaves the coefficients of
friction and the range of L_p open. The text names the materials, and compares mu = 0.1 and 0.7: for Ti-6Al-4V in
aluminium at L_p = 0.01, 0.7 should give less than half the peak pressure of 0.1. Here it gives 0.70 of it.

With a fixed clearance, a growing load passes through all load parameters. The state at the load P belongs to
L_p = clearance / (P beta*), with tractions in P/R. One history on one grid gives a whole curve, so no change of the
grid shows in it. The nodes gather at the bottom, where the stick zones are narrow.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve
from fastpin.figures.style import line
from fastpin.kernels.status import STICK
from fastpin.model import Grid, Problem, angles
from fastpin.published.records import PaperFigure, Report, add_legend, grey, head, marked, panels, steps
from fastpin.published.tractions import NAMES, PAIRS, values_of
from fastpin.solver.solving import solve
from fastpin.states.state import State

NODES_RATIO = 1.75
"""Nodes of the grid over the nodes that are asked for.

With 700 nodes, angles differ by 0.003 deg (median) from their values with 1,900 nodes, and peak pressures by 1e-6.
"""

REACH = math.radians(93.0)
"""Half the width of the grid: the contacts of these figures are narrower than +-90 deg."""

NARROW_SLIP = {("Ti/Ti", 0.3): (27, 30), ("Ti/Ti", 0.7): (51, 55), ("Al/Ti", 0.3): (20, 27), ("Al/Ti", 0.7): (48, 55)}
"""Half-angles of contacts whose slip zones have fewer than seven nodes, degrees: from and to, by pair and friction.

The nodes gather there too. Otherwise the slip zones at the edges, 0.2 deg wide and more, are misread by 0.1 deg.
"""


def gathered_grid(nodes: int, reach: float = REACH, slip: tuple[float, float] | None = None) -> Grid:
    """Return an arc of about `nodes` nodes that gather at the bottom, with one of them there.

    `reach` is the distance of its ends from the bottom, rad. The interval `slip` of angles from the bottom, degrees,
    gets more nodes, in addition to `nodes`.

    The spacing over the angle x from the bottom, degrees, is 0.03 up to x = 0.45. Then it grows like x/15 up to about
    0.15, and from there slowly: it is 0.3 at x = 30. A common factor gives the number of nodes. The narrowest stick
    zone, 0.2 degrees on either side, then has 15 nodes.

    In the interval `slip` the spacing is 0.025 degrees for 700 nodes, and grows by 1/5 of the distance away from it.
    With 0.05 the slip zones with fewer than ten nodes were misread: the curve of Al/Ti and mu = 0.3 had a bend at
    L_p = 2. With 0.025 their widths differ from those with 0.0125 by 0.007 degrees.
    """
    x = np.r_[0.0, np.geomspace(0.2 * 0.45, math.degrees(reach), 2000)]
    spacing = np.maximum(0.03, np.minimum(x / 15.0, 0.15 * (1.0 + x / 30.0)))
    half = nodes // 2
    spacing *= _count(x, spacing)[-1] / half
    if slip is not None:
        away = np.maximum(np.maximum(slip[0] - x, x - slip[1]), 0.0)
        spacing = np.minimum(spacing, 700.0 / nodes * (0.025 + away / 5.0))
    below = _count(x, spacing)
    side = np.radians(np.interp(np.linspace(0.0, below[-1], round(below[-1]) + 1), below, x))
    return Grid(np.r_[angles.BOTTOM - side[:0:-1], angles.BOTTOM + side])


def _count(x: np.ndarray, spacing: np.ndarray) -> np.ndarray:
    """Return the number of nodes below each x, shape (n,)."""
    return np.r_[0.0, np.cumsum(0.5 * np.diff(x) * (1.0 / spacing[1:] + 1.0 / spacing[:-1]))]


def swept(cases: Sequence[tuple[str, float]], nodes: int, progress: Report | None) -> list[Curve]:
    """Return half-angles and peak pressure over L_p, one curve for each pair and coefficient of friction."""
    names = "L_p", "epsilon_deg", "rho_deg", "N_max"
    return [
        Curve({"pair": pair, "mu": friction}, dict(zip(names, _rows(pair, friction, nodes).T, strict=True)))
        for pair, friction in steps(cases, progress)
    ]


@functools.lru_cache(maxsize=32)
def _rows(pair: str, friction: float, nodes: int) -> np.ndarray:
    """Return the numbers of a curve, shape (89, 4). Figures 5 and 8 have curves in common."""
    largest, smallest = 2.2, 0.005  # load parameters
    problem = Problem.from_load_parameter(PAIRS[pair], smallest, friction, "body")
    loads = smallest / np.geomspace(largest, smallest, 89)[:-1]
    grid = gathered_grid(round(NODES_RATIO * nodes), slip=NARROW_SLIP.get((pair, friction)))
    return np.array([_measured(state) for state in solve(problem, [{"P": 1.0}], grid=grid, between=loads.tolist())])


def _measured(state: State) -> tuple[float, float, float, float]:
    """Return L_p, the half-angles of the contact and of the stick zone at the bottom in degrees, peak pressure in F/R.

    The half-angle of a stick zone with fewer than nine nodes is NaN.
    """
    ((start, stop),) = state.contact
    rho = math.nan
    for left, right in state.stick:
        inside = (state.theta > left) & (state.theta < right) & (state.status == STICK)
        if left < angles.BOTTOM < right and np.count_nonzero(inside) >= 9:
            rho = 0.5 * (right - left)
    force = state.load["P"]
    parameter = state.problem.load_parameter(force)
    return parameter, math.degrees(0.5 * (stop - start)), math.degrees(rho), state.peak_pressure / force


def load_parameter_axis(panel: Axes) -> None:
    """Make the x axis of a panel a logarithmic axis of L_p with plain numbers."""
    panel.set_xscale("log")
    panel.set_xticks([0.01, 0.1, 1.0], labels=["0.01", "0.1", "1"])
    panel.set_xlabel("load parameter  $L_p$ = clearance/(F β*)")


def compute_half_angles(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Return the half-angles of figure 5, one curve for each coefficient of friction."""
    return swept([("Ti/Al", friction) for friction in (0.1, 0.2, 0.3, 0.5, 0.7)], nodes, progress)


def draw_half_angles(curves: Sequence[Curve]) -> Figure:
    """Draw contact half-angles left and stick half-angles right, with one scale."""
    figure, axes = panels(1, 2, height=2.9)
    head(figure, f"{NAMES['Ti/Al']}, plane strain; body force F on the pin, downwards")
    contact, stick = axes[0]
    stick.sharey(contact)
    styles = (0, 1, 2, 3, 5)  # the dashes of 4 look like those of 1
    lines = [line(k, k) for k in styles[: len(curves)]]
    for curve, style in zip(curves, lines, strict=True):
        contact.plot(curve["L_p"], curve["epsilon_deg"], **style)
        stick.plot(curve["L_p"], curve["rho_deg"], **style)
    contact.set_ylabel("half-angle of the contact  ε  (deg)")
    stick.set_ylabel("half-angle of the stick zone  ρ  (deg)")
    contact.set_ylim(0.0, 90.0)
    contact.set_yticks(range(0, 91, 15))
    for panel in axes[0]:
        load_parameter_axis(panel)
    arrow = {"arrowstyle": "-", "linewidth": 0.7}
    stick.annotate("the whole contact\nsticks: ρ = ε", (0.5, 39.5), (0.55, 60.0), fontsize=8.0, arrowprops=arrow)
    names = [f"friction coefficient {curve.parameters['mu']:g}" for curve in curves]
    add_legend(figure, list(zip(names, lines, strict=True)))
    return figure


def compute_peaks(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Return peak pressure and half-angles of figure 8, one curve for each pair and coefficient of friction."""
    curves = swept([(pair, friction) for pair in PAIRS for friction in (0.1, 0.3, 0.7)], nodes, progress)
    for curve in curves:
        rho, epsilon = np.radians(curve["rho_deg"]), np.radians(curve["epsilon_deg"])
        curve.columns["tan_ratio"] = np.tan(0.5 * rho) / np.tan(0.5 * epsilon)
    return curves


def draw_peaks(curves: Sequence[Curve]) -> Figure:
    """Draw peak pressure left and the ratio of half-angles right. Colours show the pair, dashes the friction."""
    figure, axes = panels(1, 2, height=3.3)
    head(figure, "Plane strain; body force F downwards; ρ and ε: half-angles of stick zone and contact")
    pairs, friction = values_of(curves, "pair"), values_of(curves, "mu")
    peak, ratio = axes[0]
    for curve in curves:
        colour, dashes = pairs.index(curve.parameters["pair"]), friction.index(curve.parameters["mu"])
        style = marked(colour, dashes) | {"markevery": (5 * colour, 15)}
        peak.plot(curve["L_p"], curve["N_max"], **style)
        ratio.plot(curve["L_p"], curve["tan_ratio"], **style)
    peak.set_ylabel("peak pressure  $N_{max}\\,R/F$")
    peak.set_yscale("log")
    peak.set_yticks([0.4, 0.5, 0.7, 1.0, 1.5, 2.0], labels=["0.4", "0.5", "0.7", "1", "1.5", "2"])
    peak.set_yticks([], minor=True)
    ratio.set_ylabel("tan(ρ/2) / tan(ε/2)")
    ratio.set_ylim(0.0, 1.03)
    for panel in axes[0]:
        load_parameter_axis(panel)
    bodies = [(NAMES[pair], marked(colour)) for colour, pair in enumerate(pairs)]
    add_legend(figure, bodies, [(f"friction coefficient {mu:g}", grey(dashes)) for dashes, mu in enumerate(friction)])
    return figure


FIGURES = (
    PaperFigure(
        "5", "Contact and stick half-angles in body force loading (Ti-6Al-4V on aluminium)",
        201, compute_half_angles, draw_half_angles,
    ),
    PaperFigure(
        "8", "Peak pressures and tan(rho/2)/tan(epsilon/2) in body force loading", 201, compute_peaks, draw_peaks
    ),
)  # fmt: skip
