"""The system memory of section 5.3 in numbers: a contact remembers the first direction of Q.

Two pins see the same cycles of +-Q under the same P. One is first pushed to +Q, the other to -Q. In a half-plane
contact their states agree from the first reversal on. Here their states at the same load stay different. The difference
of the steady states at +Q is the memory. Similar materials, mu = 0.55, held pin with a centre load (as in figures 11
to 13).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from docs.beyond.curves import curves_of
from fastpin.assess.outputs import Curve
from fastpin.model import Grid, LoadHistory, Problem, angles
from fastpin.published.fretting import FRICTION
from fastpin.published.records import PaperFigure, Report, add_legend, grey, head, marked, panels, steps
from fastpin.published.tractions import PAIRS
from fastpin.solver import Result, solve
from fastpin.states.state import State

LEAST_NODES = 61
LOAD_PARAMETERS = tuple(0.01 * 2000.0 ** (k / 16) for k in range(17))
AMPLITUDES = (0.25, 0.5, 0.75, 1.0, 1.25)
CYCLES = 3


def cycles(problem: Problem, amplitude: float, nodes: int) -> Result:
    """Solve P, then cycles of +Q and -Q, on a grid that is its own mirror image."""
    history = LoadHistory.cycles({"P": 1.0}, {"Q": amplitude}, CYCLES)
    coarse = solve(problem, history[:3], nodes=LEAST_NODES)
    half = 1.05 * max(abs(end - angles.BOTTOM) for state in coarse for part in state.contact for end in part) + 0.02
    return solve(problem, history, grid=Grid.arc(angles.BOTTOM - half, angles.BOTTOM + half, nodes + 1 - nodes % 2))


def size(values: np.ndarray, state: State) -> float:
    """Return the integral of |values| over the angle."""
    return float(state.grid.weights @ np.abs(values))


def compute(nodes: int, progress: Report | None = None) -> list[Curve]:
    """Memory and transients against L_p, one curve for each amplitude Q/(mu P).

    Only the history that begins with +Q is solved. Its mirror image begins with -Q (tested), so the state at -Q of the
    first is the mirror image of the state at +Q of the other. Differences are integrals of absolute values: of the
    shear over int mu N, of the pressure over int N.
    """
    cases = [(ratio, load_parameter) for ratio in AMPLITUDES for load_parameter in LOAD_PARAMETERS]
    rows = []
    for ratio, load_parameter in steps(cases, progress):
        problem = Problem.from_load_parameter(PAIRS["Ti/Ti"], load_parameter, FRICTION, "centre", "fixed")
        states = cycles(problem, ratio * FRICTION, nodes)  # P, +Q, -Q, +Q, ... +Q
        steady, back = states[-1], states[-2]
        normal = size(steady.pressure, steady)
        rubbing = FRICTION * normal
        numbers = [
            load_parameter,
            size(steady.shear + back.shear[::-1], steady) / rubbing,  # mirrored: -T(-theta)
            size(steady.pressure - back.pressure[::-1], steady) / normal,
            size(states[1].shear - steady.shear, steady) / rubbing,
            size(states[2].shear - back.shear, steady) / rubbing,
            size(states[3].shear - steady.shear, steady) / rubbing,
        ]
        rows.append(({"mu": FRICTION, "eta": ratio}, numbers))
    names = ("L_p", "memory_T", "memory_N", "first_forward_T", "first_reverse_T", "second_forward_T")
    return curves_of(names, rows)


def draw(curves: Sequence[Curve]) -> Figure:
    """Draw the memory on the left, and the distance of the first half cycles from the steady ones on the right."""
    figure, axes = panels(1, 2, height=3.0)
    head(
        figure,
        f"Like bodies (Ti-6Al-4V), plane strain, friction coefficient {FRICTION:g}",
        "P at the centre of a pin that can't rotate, then cycles of ±Q",
    )
    memory, transient = axes[0]
    for index, curve in enumerate(curves):
        memory.plot(curve["L_p"], 100.0 * curve["memory_T"], **marked(index))
        transient.plot(curve["L_p"], 100.0 * curve["first_forward_T"], **marked(index))
        transient.plot(curve["L_p"], 100.0 * curve["first_reverse_T"], **marked(index, 1, 1.0))
    for panel in (memory, transient):
        panel.set_xscale("log")
        panel.set_xticks([0.01, 0.1, 1.0, 10.0], labels=["0.01", "0.1", "1", "10"])
        panel.set_xlabel("load parameter  $L_p$ = clearance/(P β*)")
        panel.set_ylabel("∫|ΔT| / ∫μN  (%)")
        panel.set_ylim(bottom=0.0)
    memory.set_title("shear: cycles begun with +Q against −Q", fontsize=8.5)
    transient.set_title("shear: first cycle against the steady cycle", fontsize=8.5)
    add_legend(
        figure,
        [(f"Q/(μP) = {curve.parameters['eta']:g}", marked(index)) for index, curve in enumerate(curves)],
        [("first +Q (right panel)", grey(0)), ("first −Q (right panel)", grey(1, 1.0))],
    )
    return figure


FIGURES = (
    PaperFigure(
        "memory", "System memory: what the first direction of Q leaves behind, against load parameter and amplitude",
        LEAST_NODES, compute, draw,
    ),
)  # fmt: skip
