"""A shrink fit: the pressure of a solid pin in a ring, by Lame's formulas."""

from __future__ import annotations

from fastpin.benchmarks.rows import Outcome, Row
from fastpin.bodies import Ring
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report
from fastpin.solver.solving import solve

TITLE = "Lame: pressure of a shrink fit"
STATEMENT = (
    "Steel pin (E 210 GPa, nu 0.3), radius 20 mm, interference 20 um (radial), in an aluminium ring (E 70 GPa, nu "
    "0.33) of outer radius 40 mm, plane stress."
)
SOURCES = (
    "Lame's formula of textbooks: p = delta/(a [((b^2 + a^2)/(b^2 - a^2) + nu)/E + (1 - nu_pin)/E_pin]); printed here "
    "to seven digits",
)
INNER, OUTER, INTERFERENCE = 20e-3, 40e-3, 20e-6
PIN, RING = Material(210e9, 0.3), Material(70e9, 0.33)
TOUCH = 1.0
"""A force on the pin, N/m: a load history needs one. It changes the pressure by some 10 Pa."""
NODES = 101
"""The pressure is uniform, and linear elements follow it exactly."""


def formula() -> float:
    """Return the pressure of the formula, Pa."""
    a, b = INNER, OUTER
    ring = ((b * b + a * a) / (b * b - a * a) + RING.nu) / RING.E
    return INTERFERENCE / (a * (ring + (1.0 - PIN.nu) / PIN.E))


def compute(progress: Report | None = None) -> Outcome:
    """Solve the fit."""
    pair = MaterialPair(PIN, RING, "stress")
    problem = Problem(pair, INNER, -INTERFERENCE, 0.2, "body", plate_body=Ring(OUTER, "uniform"))
    state = solve(problem, [{"P": TOUCH}], nodes=NODES)[-1]
    if progress is not None:
        progress(1.0)
    mean = float(state.grid.weights @ state.pressure / state.grid.weights.sum())
    return Outcome([Row("pressure", "MPa", f"{formula() / 1e6:.5f}", mean / 1e6)])
