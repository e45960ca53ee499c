"""The onset of sliding: Q/(mu P) at which no node sticks any more. The paper only names it.

Similar materials, centre load, rotation held; P first, then Q. Solid: the first +Q. Dashed: -Q after +Q, for the
smallest amplitude Q with which the whole contact slides at -Q. Beyond the end of a curve some nodes stick up to
Q = 1.5 P and more. The contact then follows the load round the hole, and as it grows it sticks again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure

from fastpin.assess.outputs import Curve
from fastpin.figures.style import Line, line
from fastpin.model.problem import Problem
from fastpin.published.records import PaperFigure, Report, add_legend, grey, head, legend_below, marked, panels, steps
from fastpin.published.tractions import PAIRS
from fastpin.solver.solving import solve
from fastpin.states.state import State

LARGEST = 1.5
"""Largest Q/P at which sliding is searched for."""

LOAD_PARAMETERS = tuple(0.05 * 200.0 ** (k / 16) for k in range(17))
SHOWN_FRICTION = (0.1, 0.3, 0.55, 0.8)
FRICTION = tuple(0.05 + 0.95 * k / 8 for k in range(9))
SHOWN_LOAD_PARAMETERS = (0.5, 1.0, 2.0)


def stick_width(state: State) -> float:
    """Return the sum of the widths of all stick zones, rad; 0 if the whole contact slips."""
    return sum(stop - start for start, stop in state.stick)


def forward_onset(problem: Problem, largest: float, nodes: int) -> float:
    """Return the Q at which the whole contact first slides, from 0 to `largest`; NaN if some node always sticks.

    The last stick zone shrinks, and it may grow again before it is gone. The search closes in on the first state
    without a stick zone, or else on the state with the smallest one.
    """
    begin, end = 0.0, largest
    grid, width = None, np.ones(1)
    for _ in range(3):
        corners = [{"P": 1.0}, {"Q": begin}, {"Q": end}]
        result = solve(problem, corners, nodes=nodes, grid=grid, between=32)
        grid, states = result.grid, result[-34:]  # from `begin` to `end`
        width = np.array([stick_width(state) for state in states])
        if np.any(width == 0.0):
            low = high = int(np.argmax(width == 0.0))
        else:
            low = int(np.argmin(width))
            high = min(low + 1, width.size - 1)
        begin, end = (states[k].load["Q"] for k in (max(low - 1, 0), high))
    return end if np.any(width == 0.0) else math.nan


def reverse_onset(problem: Problem, largest: float, nodes: int) -> float:
    """Return the smallest amplitude Q with which the whole contact slides at -Q, after +Q; NaN if above `largest`.

    The contact can't slide below Q = mu P, so the search begins there.
    """

    def slides_back(amplitude: float) -> bool:
        corners = [{"P": 1.0}, {"Q": amplitude}, {"Q": -amplitude}]
        return stick_width(solve(problem, corners, nodes=nodes)[-1]) == 0.0

    amplitudes = np.linspace(problem.uniform_friction, largest, 9).tolist()
    bounds = next((pair for pair in pairwise(amplitudes) if slides_back(pair[1])), None)
    if bounds is None:
        return math.nan
    low, high = bounds
    for _ in range(5):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if slides_back(middle) else (middle, high)
    return 0.5 * (low + high)


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Onsets in Q/(mu P), against L_p for some coefficients of friction, and against mu for some L_p."""
    lines: list[tuple[str, float, Sequence[float]]] = [("mu", mu, LOAD_PARAMETERS) for mu in SHOWN_FRICTION]
    lines += [("L_p", load_parameter, FRICTION) for load_parameter in SHOWN_LOAD_PARAMETERS]
    cases = [(name, fixed, value) for name, fixed, values in lines for value in values]
    onsets: dict[tuple[str, float], list[tuple[float, float, float]]] = {}
    for name, fixed, value in steps(cases, progress):
        load_parameter, friction = (value, fixed) if name == "mu" else (fixed, value)
        problem = Problem.from_load_parameter(PAIRS["Ti/Ti"], load_parameter, friction, "centre", "fixed")
        forward = forward_onset(problem, LARGEST, nodes)
        back = reverse_onset(problem, LARGEST if math.isnan(forward) else forward, nodes)
        onsets.setdefault((name, fixed), []).append((value, forward / friction, back / friction))
    curves = []
    for (name, fixed), rows in onsets.items():
        value, forward_ratio, back_ratio = np.array(rows).T
        other = "L_p" if name == "mu" else "mu"
        curves.append(Curve({name: fixed}, {other: value, "eta_s_forward": forward_ratio, "eta_s_back": back_ratio}))
    return curves


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw the onsets against L_p on the left, against mu on the right. No colour and no mark has two meanings."""
    figure, axes = panels(1, 2, height=3.4)
    head(
        figure,
        "Like bodies (Ti-6Al-4V), plane strain; pin that can't rotate, P at its centre, then Q",
        f"Beyond the end of a curve some places stick up to Q = {LARGEST:g} P",
    )
    styles = (marked(k) | {"linestyle": "-", "markevery": 1} for k in range(len(curves)))
    for panel, name, title, other in (
        (axes[0, 0], "mu", "friction coefficient", "L_p"),
        (axes[0, 1], "L_p", "load parameter", "mu"),
    ):
        entries: list[tuple[str, Line]] = []
        for curve in (curve for curve in curves if name in curve.parameters):
            style = next(styles)
            panel.plot(curve[other], curve["eta_s_forward"], **style)
            panel.plot(curve[other], curve["eta_s_back"], **{**style, "linestyle": line(0, 1)["linestyle"]})
            entries.append((f"{curve.parameters[name]:g}", style))
        panel.axhline(1.0, color="0.6", linewidth=0.7, zorder=0)
        panel.set_ylim(0.9, 6.0 if name == "mu" else 2.2)
        panel.set_ylabel("onset of sliding  $Q/(μP)$")
        legend_below(panel, entries, len(entries), title)
    axes[0, 0].set_xscale("log")
    axes[0, 0].set_xticks([0.1, 1.0, 10.0], labels=["0.1", "1", "10"])
    axes[0, 0].set_xlabel("load parameter  $L_p$ = clearance/(P β*)")
    axes[0, 1].set_xlabel("friction coefficient  μ")
    add_legend(figure, [("first push, at +Q", grey(0)), ("way back, at −Q after +Q", grey(1))])
    return figure


FIGURES = (
    PaperFigure(
        "sliding-onset",
        "Onset of full sliding against load parameter and friction, on the first way and on the way back",
        61, compute, draw,
    ),
)  # fmt: skip
