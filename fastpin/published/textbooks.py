"""Formulas of textbooks: partial slip of half-planes, the Brazilian disk, Kirsch's plate, and a shrink fit."""

from __future__ import annotations

import math

import numpy as np

from fastpin.bodies import Ring
from fastpin.model import MATERIALS, Laminate, Material, MaterialPair, Ply, Points, Problem, angles
from fastpin.published.records import Benchmark, Outcome, Report, Row, steps
from fastpin.solver.solving import solve
from fastpin.verification import closed_forms
from fastpin.verification.rows import NODES, half_width

STEEL = MATERIALS["steel"]

GRAPHITE = Ply(181e9, 10.3e9, 7.17e9, 0.28, 1e-3)
GLASS = Ply(47.4e9, 16.2e9, 7e9, 0.26, 1e-3)
"""Plies of open holes, of any thickness."""

TOUCH = 1.0
"""A force on the pin, N/m: a load history needs one. It changes pressures and stresses by some 10 Pa."""


def partial_slip(progress: Report | None = None) -> Outcome:
    """Solve P, then Q.

    The largest shear differs because the contact is curved: the difference falls like the contact angle, it is 3.6e-3
    at L_p = 1,000, and more nodes keep it.
    """
    load_parameter, friction, ratio, why = 1e4, 0.5, 0.6, "differs: the contact is curved"
    problem = Problem.from_load_parameter(MaterialPair(STEEL, STEEL), load_parameter, friction, "centre", "fixed")
    pushed, moved = solve(problem, [{"P": 1.0}, {"Q": ratio * friction}], nodes=NODES)
    if progress is not None:
        progress(1.0)
    half = math.degrees(float(closed_forms.hertz_half_angle(load_parameter)))
    peak = float(closed_forms.hertz_peak_pressure(load_parameter))
    stick = float(closed_forms.cattaneo_mindlin_stick_ratio(ratio))
    contact = half_width(moved.contact[0])
    shear = abs(moved.peak_shear) / (friction * moved.peak_pressure)
    angle = math.degrees(half_width(pushed.contact[0]))
    return Outcome([
        Row("largest pressure under P", "P/R", f"{peak:.2f}", pushed.peak_pressure, why),
        Row("half-angle of contact under P", "deg", f"{half:.4f}", angle, why),
        Row("stick zone over contact", "", f"{stick:.4f}", max(map(half_width, moved.stick)) / contact, why),
        Row("largest shear over mu p0", "", f"{math.sqrt(ratio):.4f}", shear, why),
    ])  # fmt: skip


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


def open_hole(progress: Report | None = None) -> Outcome:
    """Solve a loose pin and then the remote stress. The pin hardly touches, so a few nodes do."""
    stress = 1e6
    problem = Problem(MaterialPair(STEEL, STEEL), 10e-3, 1e-4, 0.3, "body")
    state = solve(problem, [{"P": TOUCH}, {"sxx": stress}], nodes=101)[-1]
    top, side = state.hoop_stress("plate", [-angles.BOTTOM, 0.0]) / stress
    if progress is not None:
        progress(1.0)
    return Outcome([
        Row("hoop stress over sxx, top of the hole", "", "3.0000", float(top)),
        Row("hoop stress over sxx, side of the hole", "", "-1.0000", float(side)),
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
    """Solve a loose pin and then the remote stress, as for an isotropic plate."""
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


def shrink_fit(progress: Report | None = None) -> Outcome:
    """Solve the fit. The pressure is uniform, and linear elements follow it exactly."""
    inner, outer, interference = 20e-3, 40e-3, 20e-6
    pin, ring = Material(210e9, 0.3), Material(70e9, 0.33)
    wall = ((outer * outer + inner * inner) / (outer * outer - inner * inner) + ring.nu) / ring.E
    pressure = interference / (inner * (wall + (1.0 - pin.nu) / pin.E))
    pair = MaterialPair(pin, ring, "stress")
    problem = Problem(pair, inner, -interference, 0.2, "body", plate_body=Ring(outer, "uniform"))
    state = solve(problem, [{"P": TOUCH}], nodes=101)[-1]
    if progress is not None:
        progress(1.0)
    mean = float(state.grid.weights @ state.pressure / state.grid.weights.sum())
    return Outcome([Row("pressure", "MPa", f"{pressure / 1e6:.5f}", mean / 1e6)])


BENCHMARKS = (
    Benchmark(
        "fretting-half-plane",
        "Cattaneo and Mindlin: stick zone and largest shear of a Hertzian contact",
        "Like bodies, plane strain, friction 0.5, pin held against rotation, P and then Q = 0.6 mu P, at L_p = 10,000: "
        "the contact has a half-angle of 0.32 degrees, nearly a half-plane.",
        [
            "C. Cattaneo (1938) and R. D. Mindlin (1949), formulas of textbooks: c/a = sqrt(1 - Q/(mu P)), largest "
            "shear mu p0 sqrt(Q/(mu P)); H. Hertz (1882): p0 = 2 P/(pi a); printed here to four digits"
        ],
        partial_slip,
    ),
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
        "kirsch",
        "Kirsch: hoop stress at an open hole under remote tension",
        "Infinite steel plate under sxx, with a loose pin that touches it with no more than 1 N/m. Plane strain.",
        ["G. Kirsch, 1898: the stress concentration is 3 beside the load axis and -1 on it"],
        open_hole,
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
    Benchmark(
        "shrink-fit",
        "Lame: pressure of a shrink fit",
        "Steel pin (E 210 GPa, nu 0.3), radius 20 mm, interference 20 um (radial), in an aluminium ring (E 70 GPa, nu "
        "0.33) of outer radius 40 mm, plane stress.",
        [
            "Lame's formula of textbooks: p = delta/(a [((b^2 + a^2)/(b^2 - a^2) + nu)/E + (1 - nu_pin)/E_pin]); "
            "printed here to seven digits"
        ],
        shrink_fit,
    ),
)
