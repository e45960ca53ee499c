"""Fretting of half-planes: Hertz's contact in partial slip, by Cattaneo and Mindlin."""

from __future__ import annotations

import math

from fastpin.benchmarks.rows import Outcome, Row
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report
from fastpin.solver.solving import solve
from fastpin.verification import closed_forms
from fastpin.verification.rows import NODES, half_width

TITLE = "Cattaneo and Mindlin: stick zone and largest shear of a Hertzian contact"
STATEMENT = (
    "Like bodies, plane strain, friction 0.5, pin held against rotation, P and then Q = 0.6 mu P, at L_p = 10,000: the "
    "contact has a half-angle of 0.32 degrees, nearly a half-plane."
)
SOURCES = (
    "C. Cattaneo (1938) and R. D. Mindlin (1949), formulas of textbooks: c/a = sqrt(1 - Q/(mu P)), largest shear mu p0 "
    "sqrt(Q/(mu P)); H. Hertz (1882): p0 = 2 P/(pi a); printed here to four digits",
)
LOAD_PARAMETER, FRICTION, RATIO = 1e4, 0.5, 0.6
CURVED = "differs: the contact is curved"
"""Measured: the difference of the shear falls like the contact angle, 3.6e-3 at L_p = 1,000, and more nodes keep it."""


def compute(progress: Report | None = None) -> Outcome:
    """Solve P, then Q."""
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["steel"])
    problem = Problem.from_load_parameter(pair, LOAD_PARAMETER, FRICTION, "centre", "fixed")
    pushed, moved = solve(problem, [{"P": 1.0}, {"Q": RATIO * FRICTION}], nodes=NODES)
    if progress is not None:
        progress(1.0)
    half = float(closed_forms.hertz_half_angle(LOAD_PARAMETER))
    peak = float(closed_forms.hertz_peak_pressure(LOAD_PARAMETER))
    stick = max(map(half_width, moved.stick)) / half_width(moved.contact[0])
    ratio = float(closed_forms.cattaneo_mindlin_stick_ratio(RATIO))
    shear = abs(moved.peak_shear) / (FRICTION * moved.peak_pressure)
    return Outcome([
        Row("largest pressure under P", "P/R", f"{peak:.2f}", pushed.peak_pressure, CURVED),
        Row("half-angle of contact under P", "deg", f"{math.degrees(half):.4f}",
            math.degrees(half_width(pushed.contact[0])), CURVED),
        Row("stick zone over contact", "", f"{ratio:.4f}", stick, CURVED),
        Row("largest shear over mu p0", "", f"{math.sqrt(RATIO):.4f}", shear, CURVED),
    ])  # fmt: skip
