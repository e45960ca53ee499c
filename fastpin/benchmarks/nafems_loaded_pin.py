"""The loaded pin of NAFEMS R0094 in two dimensions. Its results were not seen: our numbers stand alone."""

from __future__ import annotations

import math

from fastpin.benchmarks.rows import Benchmark, Outcome, Row
from fastpin.casefile.lug import parse_lug
from fastpin.elasticity.plates import plate_compliance
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.paper.curves import Report
from fastpin.solver.solving import solve
from fastpin.verification.rows import NODES, half_width

OUTLINE = """
[plate]
nu = 0.3
plane = "stress"
hole_radius = 50e-3
[outline]
start = [-100e-3, 0.0]
[[part]]
name = "round end"
through = [0.0, -100e-3]
to = [100e-3, 0.0]
[[part]]
name = "right side"
to = [100e-3, 200e-3]
[[part]]
name = "held end"
to = [-100e-3, 200e-3]
[[part]]
name = "left side"
to = [-100e-3, 0.0]
[[support]]
parts = ["held end"]
hold = "both"
"""
"""The strip as a lug file, turned by a right angle: the force points down, away from the held end."""


def compute(progress: Report | None = None) -> Outcome:
    """Solve the strip in plane stress."""
    report = None if progress is None else lambda done, total: progress(done / total)
    strip = plate_compliance(parse_lug(OUTLINE).lug, None, report).compliance
    pair = MaterialPair(Material(210e9, 0.3), Material(70e9, 0.3), "stress")
    problem = Problem(pair, 50e-3, 0.0, 0.1, "centre", plate_body=strip)
    state = solve(problem, [{"P": 100e3 / 10e-3}], nodes=NODES)[-1]
    alone = "comparison only: no published number was seen"
    return Outcome([
        Row("largest pressure", "MPa", "", state.peak_pressure / 1e6, alone),
        Row("half-angle of contact", "deg", "", math.degrees(half_width(state.contact[0])), alone),
        Row("largest hoop stress of the sheet", "MPa", "", state.peak_hoop_stress().value / 1e6, alone),
    ])  # fmt: skip


BENCHMARK = Benchmark(
    "nafems-loaded-pin",
    "NAFEMS R0094, benchmark 4: loaded pin in a strip with a round end",
    "Steel pin (E 210 GPa, nu 0.3) in a sheet of E 70 GPa, nu 0.3, inner radius 50 mm, outer radius 100 mm, held 200 "
    "mm from the centre, 10 mm thick; 100 kN on the pin, friction 0.1. The benchmark is three-dimensional, with a pin "
    "20 mm long; fastpin is two-dimensional, in plane stress, and takes the fit as neat.",
    [
        "A. Konter, Advanced finite element contact benchmarks, NAFEMS R0094 (2006), as quoted in the verification "
        "manual of OptiStruct, OS-V: 0230 3D Loaded Pin; its results are plots, which were not seen"
    ],
    compute,
)
