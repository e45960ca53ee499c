"""Parts of the figures of tractions: the paper's pairs, a pin that is pushed down, curves and panels of N and T."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve
from fastpin.bodies.body import PinLoad
from fastpin.figures.style import Line, angle_axis
from fastpin.model import MATERIALS, MaterialPair, Problem, angles
from fastpin.published.records import add_legend, head, panels
from fastpin.reading.zones import ALL_ROUND, Interval, is_all_round
from fastpin.solver.solving import solve
from fastpin.states.state import State

PAIRS = {
    "Ti/Al": MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"]),
    "Ti/Ti": MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["Ti-6Al-4V"]),
    "Al/Ti": MaterialPair(MATERIALS["aluminium"], MATERIALS["Ti-6Al-4V"]),
}
"""Pin and plate. Ti-6Al-4V and aluminium in plane strain have the Dundurs parameters of the paper."""

NAMES = {
    "Ti/Al": "Ti-6Al-4V pin, aluminium plate",
    "Ti/Ti": "Ti-6Al-4V pin and plate",
    "Al/Ti": "aluminium pin, Ti-6Al-4V plate",
}
"""Words for the pairs."""

QUANTITIES = {"N": "pressure  $N\\,R/F$", "T": "shear traction  $T\\,R/F$"}
"""Words on the axes of both tractions."""

ANGLE = "angle from the bottom (deg)"
"""Words on the axis of angles."""


NEAR = 1e-12
"""Distance below which two angles are equal, rad."""


@dataclass
class Panel:
    """One panel: a quantity, "N" or "T", of some curves."""

    quantity: str
    curves: Sequence[Curve]
    title: str = ""


def pushed(
    pair: str, load_parameter: float, friction: float, nodes: int, pin_load: PinLoad = "body", **remote: float
) -> State:
    """Solve a pin pushed down by P = F, together with `remote` stresses in F/R that grow in proportion."""
    problem = Problem.from_load_parameter(PAIRS[pair], load_parameter, friction, pin_load)
    return solve(problem, [{"P": 1.0, **remote}], nodes=nodes)[-1]


def chosen(curves: Sequence[Curve], **parameters: float | str) -> list[Curve]:
    """Return the curves with these parameters."""
    return [curve for curve in curves if all(curve.parameters[name] == value for name, value in parameters.items())]


def values_of(curves: Sequence[Curve], parameter: str) -> list[Any]:
    """Return the different values of a parameter, in the order of the curves."""
    return list(dict.fromkeys(curve.parameters[parameter] for curve in curves))


def traction_figure(
    layout: Sequence[Sequence[Panel]],
    style: Callable[[Curve], Line],
    *legend: Sequence[tuple[str, Line]],
    heading: Sequence[str] = (),
) -> Figure:
    """Draw panels of tractions over the angle.

    Parameters
    ----------
    layout : sequence of rows of Panel
        The panels of a column share the angle axis. Panels of the same quantity in a row share its axis.
    style : callable
        ``style(curve)`` returns the line of a curve.
    legend : rows of (label, line)
    heading : sequence of str
        Lines above the panels: the parameters that all panels share.
    """
    figure, axes = panels(len(layout), len(layout[0]))
    head(figure, *heading)
    for column in axes.T:
        for panel in column[1:]:
            panel.sharex(column[0])
        column[-1].set_xlabel(ANGLE)
        angle_axis(column[-1])
    for row, contents in zip(axes, layout, strict=True):
        for panel, content in zip(row, contents, strict=True):
            panel.label_outer()
            if panel is not row[0] and content.quantity == contents[0].quantity:
                panel.sharey(row[0])
                panel.tick_params(labelleft=False)
            else:
                panel.tick_params(labelleft=True)
                panel.set_ylabel(QUANTITIES[content.quantity])
            for curve in content.curves:
                panel.plot(curve["angle_deg"], curve[content.quantity], **style(curve))
            panel.set_title(content.title, fontsize=9.0)
        for panel, content in zip(row, contents, strict=True):
            panel.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)
            if content.quantity == "N":
                panel.set_ylim(bottom=0.0)
    figure.align_ylabels(axes[:, 0])
    add_legend(figure, *legend)
    return figure


def traction_curve(state: State, force: float = 1.0, **parameters: float | str) -> Curve:
    """Return pressure and shear traction of a state from edge to edge.

    The tractions are refined (:attr:`fastpin.states.state.State.refined`): beside contact edges and stick-slip borders
    they go like a root of the distance, and the points gather there.

    Parameters
    ----------
    state : State
        Of a dimensionless problem, :meth:`fastpin.Problem.from_load_parameter`.
    force : float
        The pin's load F in the units of the problem. Tractions are divided by it.
    parameters
        The curve's parameters.

    Returns
    -------
    Curve
        Columns ``angle_deg`` (from the bottom, counter-clockwise), ``N`` and ``T`` in F/R; N and T are 0 at the edges.
        Several contacts are separated by NaN. A contact all round goes from the top to the top.
    """
    parts: list[np.ndarray] = []
    for patch, ends in zip(state.refined.tractions.patches, state.contact_in_runs, strict=True):
        drawn = _from_the_top(patch) if is_all_round(ends[1] - ends[0]) else _from_edge_to_edge(patch, ends)
        parts.append(drawn)
    parts.sort(key=lambda part: float(part[0, 0]))
    gap = np.full((1, 3), np.nan)
    rows = [row for part in parts for row in (gap, part)][1:]
    theta, pressure, shear = np.vstack(rows).T if rows else np.empty((3, 0))
    bound = state.friction_at(theta) * pressure
    shear = np.clip(shear, -bound, bound)
    columns = {"angle_deg": np.degrees(theta) + 90.0, "N": pressure / force, "T": shear / force}
    return Curve(dict(parameters), columns)


def _from_the_top(patch: np.ndarray) -> np.ndarray:
    """Return the rows of a contact all round, shape (k + 1, 3), from the top to the top."""
    rows = patch[:-1].copy()
    rows[:, 0] = ALL_ROUND[0] + np.mod(rows[:, 0] - ALL_ROUND[0], 2.0 * math.pi)
    rows = rows[np.argsort(rows[:, 0])]
    return np.vstack([rows, rows[0] + [2.0 * math.pi, 0.0, 0.0]])


def _from_edge_to_edge(patch: np.ndarray, ends: Interval) -> np.ndarray:
    """Return the rows of a contact, shape (m, 3), from edge to edge, beside the bottom of the hole.

    At an edge without a power law the patch ends at the open node beyond. There a root leads to the edge.
    """
    part = np.linspace(0.0, 1.0, 13)[:-1, None] ** 2  # of the way from the edge to the first node
    for side, end in zip((1, -1), ends, strict=True):
        rows = patch[::side]
        if side * (end - rows[0, 0]) > NEAR:
            inside = rows[side * (rows[:, 0] - end) > NEAR]
            beside = np.hstack([end + part * (inside[:1, 0:1] - end), np.sqrt(part) * inside[:1, 1:]])
            patch = np.vstack([beside, inside])[::side]
    moved = patch.copy()
    moved[:, 0] += angles.interval_near_bottom(*ends)[0] - ends[0]
    return moved
