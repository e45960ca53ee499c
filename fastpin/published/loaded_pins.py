"""The loaded pin of NASA TP-1862: a stress concentration."""

from __future__ import annotations

import math

from fastpin.model import MATERIALS, Material, MaterialPair, Problem
from fastpin.published.records import Benchmark, Outcome, Report, Row, steps
from fastpin.solver.solving import solve
from fastpin.verification.rows import NODES


def laminate_plate(progress: Report | None = None) -> Outcome:
    """Solve two pins. The hoop stress has its peak beside the contact edge, and is lower on the net section."""
    pins = {"rigid pin": Material.rigid(), "steel pin": MATERIALS["steel"]}
    unknown = "no mesh was seen, so the place of 0.87 is open"
    rows = []
    for words, pin in steps(list(pins.items()), progress):
        problem = Problem(MaterialPair(pin, Material(55e9, 0.31), "stress"), 3e-3, 0.0, 0.0, "body")
        state = solve(problem, [{"P": 1e5}], nodes=NODES)[-1]  # any force: the neat fit is linear in it
        peak = state.peak_hoop_stress()
        angle = 90.0 - abs(math.degrees(peak.angle))
        section = float(state.hoop_stress("plate", [0.0])[0])
        rows += [
            Row(f"largest hoop stress over P/(D t), {words}", "", "0.87", peak.value / peak.bearing_stress,
                f"differs: a narrow peak beside the contact edge; {unknown}"),
            Row(f"the same at the net section, {words}", "", "0.87", section / peak.bearing_stress,
                f"differs: the stress falls from the peak to this place; {unknown}"),
            Row(f"place of the largest hoop stress, {words}", "deg", "", angle, "comparison only"),
        ]  # fmt: skip
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
    laminate_plate,
)
