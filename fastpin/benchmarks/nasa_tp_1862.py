"""NASA TP-1862: the tensile stress concentration of a frictionless pin in a quasi-isotropic laminate."""

from __future__ import annotations

import math

from fastpin.benchmarks.rows import Benchmark, Outcome, Row
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report, steps
from fastpin.solver.solving import solve
from fastpin.verification.rows import NODES

PUBLISHED = "0.87"
RADIUS, P = 3e-3, 1e5
"""Any values: the neat fit is linear in the load."""
PLATE = Material(55e9, 0.31)
PINS = {"rigid pin": Material.rigid(), "steel pin": MATERIALS["steel"]}
PEAK = "differs: a narrow peak beside the contact edge; no mesh was seen, so the place of 0.87 is open"
SECTION = "differs: the stress falls from the peak to this place; no mesh was seen, so the place of 0.87 is open"


def compute(progress: Report | None = None) -> Outcome:
    """Solve two pins. The hoop stress has its peak beside the contact edge, and is lower on the net section."""
    rows = []
    for words, pin in steps(list(PINS.items()), progress):
        problem = Problem(MaterialPair(pin, PLATE, "stress"), RADIUS, 0.0, 0.0, "body")
        state = solve(problem, [{"P": P}], nodes=NODES)[-1]
        peak = state.peak_hoop_stress()
        angle = 90.0 - abs(math.degrees(peak.angle))
        section = float(state.hoop_stress("plate", [0.0])[0])
        rows += [
            Row(f"largest hoop stress over P/(D t), {words}", "", PUBLISHED, peak.value / peak.bearing_stress, PEAK),
            Row(f"the same at the net section, {words}", "", PUBLISHED, section / peak.bearing_stress, SECTION),
            Row(f"place of the largest hoop stress, {words}", "deg", "", angle, "comparison only"),
        ]
    return Outcome(rows)


BENCHMARK = Benchmark(
    "nasa-tp-1862",
    "NASA TP-1862: neat frictionless pin in a quasi-isotropic plate",
    "Frictionless pin without clearance in an infinite quasi-isotropic plate, plane stress. The stress concentration "
    "is the tensile hoop stress over P/(D t). The moduli were not seen: ours are a rigid pin, and steel in a plate "
    "with E 55 GPa, nu 0.31.",
    [
        "J. H. Crews, C. S. Hong and I. S. Raju, Stress-concentration factors for finite orthotropic laminates with a "
        "pin-loaded hole, NASA TP-1862 (1981); the number is in its abstract (core.ac.uk/works/24901338)"
    ],
    compute,
)
