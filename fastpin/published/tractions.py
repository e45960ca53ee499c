"""Parts of the figures of tractions: the paper's pairs, a pin that is pushed down, and panels of N and T."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.figure import Figure

from fastpin.bodies.body import PinLoad
from fastpin.figures.style import Line, angle_axis
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.published.drawing import add_legend, head, panels
from fastpin.report.curves import Curve
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
