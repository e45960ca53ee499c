"""Contact, stick zone and peak pressure of a body-loaded pin over the load parameter.

With a fixed clearance, a growing load passes through all load parameters. The state at the load P belongs to
L_p = clearance / (P beta*), with tractions in P/R. Each grid serves a quarter of a decade only. The smallest contact
then still fills two thirds of the grid.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes

from fastpin.kernels.status import STICK
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report, steps
from fastpin.paper.tractions import BOTTOM, PAIRS
from fastpin.report.curves import Curve
from fastpin.solver.solving import solve
from fastpin.states.state import State

LIMITS = np.geomspace(2.2, 0.005, 12)
"""Load parameters at which one history ends and the next one begins, decreasing."""
POINTS = 8
"""States of each history."""
LEAST_STICKING = 9
"""Fewest nodes of a stick zone whose width is measured."""


def swept(cases: Sequence[tuple[str, float]], nodes: int, progress: Report | None) -> list[Curve]:
    """Return half-angles and peak pressure over L_p, one curve for each pair and coefficient of friction."""
    curves = []
    for pair, friction in steps(cases, progress):
        rows: list[tuple[float, ...]] = []
        for first, last in pairwise(LIMITS):
            problem = Problem.from_load_parameter(PAIRS[pair], last, friction, "body")
            loads = list(np.geomspace(last / first, 1.0, POINTS + 1)[1:-1])
            rows += [_measured(state) for state in solve(problem, [{"P": 1.0}], nodes=nodes, between=loads)]
        columns = dict(zip(("L_p", "epsilon_deg", "rho_deg", "N_max"), np.array(rows).T, strict=True))
        curves.append(Curve({"pair": pair, "mu": friction}, columns))
    return curves


def _measured(state: State) -> tuple[float, float, float, float]:
    """Return L_p, the half-angles of the contact and of the stick zone at the bottom in degrees, peak pressure in F/R.

    The half-angle of the stick zone is NaN with fewer nodes than :data:`LEAST_STICKING`.
    """
    ((start, stop),) = state.contact
    rho = math.nan
    for left, right in state.stick:
        inside = (state.theta > left) & (state.theta < right) & (state.status == STICK)
        if left < BOTTOM < right and np.count_nonzero(inside) >= LEAST_STICKING:
            rho = 0.5 * (right - left)
    force = state.load["P"]
    parameter = state.problem.load_parameter(force)
    return parameter, math.degrees(0.5 * (stop - start)), math.degrees(rho), state.peak_pressure / force


def load_parameter_axis(panel: Axes) -> None:
    """Make the x axis of a panel a logarithmic axis of L_p with plain numbers."""
    panel.set_xscale("log")
    panel.set_xticks([0.01, 0.1, 1.0], labels=["0.01", "0.1", "1"])
    panel.set_xlabel("$L_p$")
