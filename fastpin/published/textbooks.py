"""Formulas of textbooks: the Brazilian disk, and open holes of laminates."""

from __future__ import annotations

import math

import numpy as np

from fastpin.model import MATERIALS, Laminate, MaterialPair, Ply, Points, Problem, angles
from fastpin.published.records import Benchmark, Outcome, Report, Row, steps
from fastpin.solver.solving import solve

STEEL = MATERIALS["steel"]

GRAPHITE = Ply(181e9, 10.3e9, 7.17e9, 0.28, 1e-3)
GLASS = Ply(47.4e9, 16.2e9, 7e9, 0.26, 1e-3)
"""Plies of open holes, of any thickness."""

TOUCH = 1.0
"""A force on the pin, N/m: a load history needs one. It changes pressures and stresses by some 10 Pa."""


def disk(progress: Report | None = None) -> Outcome:
    """Solve the pin under P and under -P, and add the stresses. At the centre each of them has an infinite stress."""
    problem = Problem.from_load_parameter(MaterialPair(STEEL, STEEL, "stress"), 1000.0, 0.0, "centre")
    c = np.array([0.05, 0.125, 0.25, 0.375])  # x/D
    points = Points.at_xy(2.0 * c, 0.0 * c)
    ours = np.zeros((2, c.size))
    for force in steps((1.0, -1.0), progress):
        stress = solve(problem, [{"P": force}], nodes=201)[-1].stress(points, "pin")
        ours += math.pi * np.array([stress.sxx, stress.syy])  # D = 2 R = 2, so 2 P/(pi D) is 1/pi
    square = 4.0 * c * c
    exact = np.array([((1.0 - square) / (1.0 + square)) ** 2, 1.0 - 4.0 / (1.0 + square) ** 2])
    return Outcome([
        Row(f"{name} at x = {c[k]:g} D", "2 P/(pi D)", f"{exact[i, k]:.3f}", float(ours[i, k]),
            "differs: the contact has a width of two degrees")
        for i, name in enumerate(("sxx", "syy"))
        for k in range(c.size)
    ])  # fmt: skip


ROOTS = {
    "[0], graphite/epoxy": ("[0]", GRAPHITE, (0.8566, 4.8936)),
    "[90], graphite/epoxy": ("[90]", GRAPHITE, (0.2043, 1.1674)),
    "[0/90], graphite/epoxy": ("[0/90]s", GRAPHITE, (0.2747, 3.6403)),
    "[+-45], graphite/epoxy": ("[+-45]s", GRAPHITE, (0.5109, 0.5109)),
    "[0], glass/epoxy": ("[0]", GLASS, (0.7139, 2.3960)),
    "[90], glass/epoxy": ("[90]", GLASS, (0.4174, 1.4007)),
    "[0/90], glass/epoxy": ("[0/90]s", GLASS, (0.4965, 2.0142)),
}
"""Layups, plies and the imaginary parts of the two roots that are printed. [0/90] and [+-45] are stretched only."""


def open_hole_of_laminates(progress: Report | None = None) -> Outcome:
    """Solve a loose pin and then the remote stress. The pin hardly touches, so a few nodes do."""
    plates = {words: Laminate.from_layup(layup, ply, axis=0.0) for words, (layup, ply, _) in ROOTS.items()}
    printed = {words: f"{1.0 + sum(roots):.3f}" for words, (_, _, roots) in ROOTS.items()}
    plates["moduli of CR-125596"] = Laminate.from_moduli(10e9, 5e9, 3e9, 0.3, axis=0.0)
    printed["moduli of CR-125596"] = "3.3583"
    rows, stress = [], 1e6
    for words, plate in steps(list(plates.items()), progress):
        problem = Problem(MaterialPair(STEEL, plate, "stress"), 10e-3, 1e-4, 0.3, "body")
        state = solve(problem, [{"P": TOUCH}, {"sxx": stress}], nodes=101)[-1]
        (top,) = state.hoop_stress("plate", [-angles.BOTTOM]) / stress
        rows.append(Row(f"hoop stress over sxx, top of the hole, {words}", "", printed[words], float(top)))
    return Outcome(rows)


BENCHMARKS = (
    Benchmark(
        "brazilian-disk",
        "Brazilian disk: stresses on the diameter across the forces",
        "Disk of diameter D under two opposite forces P. It is the sum of a pin that is pushed down and one that is "
        "pushed up: the forces at the centre cancel. The contact has a half-angle of 1 degree (L_p = 1000) in place of "
        "a point. Stresses in 2 P/(pi D) at x = c D.",
        [
            "Formulas of textbooks: sxx = [(1 - 4 c^2)/(1 + 4 c^2)]^2 and syy = 1 - 4/(1 + 4 c^2)^2; printed here to "
            "three digits"
        ],
        disk,
    ),
    Benchmark(
        "lekhnitskii",
        "Lekhnitskii: hoop stress at an open hole of a laminate under remote tension",
        "Infinite laminate under sxx along its axis 1, with a loose pin that touches it with no more than 1 N/m. "
        "Graphite/epoxy: E1 181, E2 10.3, G12 7.17 GPa, nu12 0.28. Glass/epoxy: 47.4, 16.2, 7 GPa, 0.26. The third "
        "plate has E1 10, E2 5, G12 3 and nu12 0.3.",
        [
            "D. S. Sharma (2011), roots of the characteristic equation to four digits, as a public program quotes them "
            "in its tests (class Sharma); the stress concentration is 1 and the sum of their imaginary parts, "
            "Lekhnitskii's formula; printed here to three digits, as a sum of two rounded roots",
            "NASA CR-125596, example 5.3.1, as the documentation of the program Panelyze quotes it: 3.3583",
        ],
        open_hole_of_laminates,
    ),
)
