"""Kirsch's plate: an open hole under remote tension."""

from __future__ import annotations

from fastpin.benchmarks.rows import Outcome, Row
from fastpin.model.angles import BOTTOM
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report
from fastpin.solver.solving import solve

TITLE = "Kirsch: hoop stress at an open hole under remote tension"
STATEMENT = "Infinite steel plate under sxx, with a loose pin that touches it with no more than 1 N/m. Plane strain."
SOURCES = ("G. Kirsch, 1898: the stress concentration is 3 beside the load axis and -1 on it",)
STRESS, TOUCH = 1e6, 1.0
"""Remote stress, Pa, and force of the touching pin, N/m: it changes the hoop stress by some 10 Pa."""
NODES = 101
"""The pin hardly touches, and the formula of the open hole needs no nodes."""


def compute(progress: Report | None = None) -> Outcome:
    """Solve a loose pin and then the remote stress."""
    problem = Problem(MaterialPair(MATERIALS["steel"], MATERIALS["steel"]), 10e-3, 1e-4, 0.3, "body")
    state = solve(problem, [{"P": TOUCH}, {"sxx": STRESS}], nodes=NODES)[-1]
    top, side = state.hoop_stress("plate", [-BOTTOM, 0.0]) / STRESS
    if progress is not None:
        progress(1.0)
    return Outcome([
        Row("hoop stress over sxx, top of the hole", "", "3.0000", float(top)),
        Row("hoop stress over sxx, side of the hole", "", "-1.0000", float(side)),
    ])  # fmt: skip
