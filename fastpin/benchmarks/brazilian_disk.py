"""The Brazilian disk: a disk under two opposite forces, as the sum of two pins."""

from __future__ import annotations

import math

import numpy as np

from fastpin.benchmarks.rows import Outcome, Row
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.points import Points
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report, steps
from fastpin.solver.solving import solve

TITLE = "Brazilian disk: stresses on the diameter across the forces"
STATEMENT = (
    "Disk of diameter D under two opposite forces P. It is the sum of a pin that is pushed down and one that is pushed "
    "up: the forces at the centre cancel. The contact has a half-angle of 1 degree (L_p = 1000) in place of a point. "
    "Stresses in 2 P/(pi D) at x = c D."
)
SOURCES = (
    "Formulas of textbooks: sxx = [(1 - 4 c^2)/(1 + 4 c^2)]^2 and syy = 1 - 4/(1 + 4 c^2)^2; printed here "
    "to three digits",
)
PLACES = (0.05, 0.125, 0.25, 0.375)
"""c = x/D. The centre itself is left out: both pins have an infinite stress there."""
LOAD_PARAMETER = 1000.0
NODES = 201
WIDE = "differs: the contact has a width of two degrees"


def compute(progress: Report | None = None) -> Outcome:
    """Solve the pin under P and under -P, and add the stresses."""
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["steel"], "stress")
    problem = Problem.from_load_parameter(pair, LOAD_PARAMETER, 0.0, "centre")
    c = np.array(PLACES)
    places = Points.at_xy(2.0 * c, 0.0 * c)
    found = np.zeros((2, c.size))
    for force in steps((1.0, -1.0), progress):
        stress = solve(problem, [{"P": force}], nodes=NODES)[-1].stress(places, "pin")
        found += math.pi * np.array([stress.sxx, stress.syy])  # D = 2 R = 2, so 2 P/(pi D) is 1/pi
    square = 4.0 * c * c
    exact = np.array([((1.0 - square) / (1.0 + square)) ** 2, 1.0 - 4.0 / (1.0 + square) ** 2])
    return Outcome([
        Row(f"{name} at x = {place:g} D", "2 P/(pi D)", f"{known:.3f}", ours, WIDE)
        for name, line, values in zip(("sxx", "syy"), exact, found, strict=True)
        for place, known, ours in zip(PLACES, line, map(float, values), strict=True)
    ])  # fmt: skip
