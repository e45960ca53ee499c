"""Loaded pins of NASA TP-1862, a stress concentration, and of NAFEMS R0094, whose results were not seen."""

from __future__ import annotations

import math

from fastpin.casefile.lug import parse_lug
from fastpin.lugs.plates import plate_compliance
from fastpin.model import MATERIALS, Material, MaterialPair, Problem
from fastpin.published.records import Benchmark, Outcome, Report, Row, steps
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


def strip(progress: Report | None = None) -> Outcome:
    """Solve the strip in plane stress."""
    report = None if progress is None else lambda done, total: progress(done / total)
    sheet = plate_compliance(parse_lug(OUTLINE).lug, None, report).compliance
    pair = MaterialPair(Material(210e9, 0.3), Material(70e9, 0.3), "stress")
    problem = Problem(pair, 50e-3, 0.0, 0.1, "centre", plate_body=sheet)
    state = solve(problem, [{"P": 100e3 / 10e-3}], nodes=NODES)[-1]
    alone = "comparison only: no published number was seen"
    return Outcome([
        Row("largest pressure", "MPa", "", state.peak_pressure / 1e6, alone),
        Row("half-angle of contact", "deg", "", math.degrees(half_width(state.contact[0])), alone),
        Row("largest hoop stress of the sheet", "MPa", "", state.peak_hoop_stress().value / 1e6, alone),
    ])  # fmt: skip


NAFEMS = Benchmark(
    "nafems-loaded-pin",
    "NAFEMS R0094, benchmark 4: loaded pin in a strip with a round end",
    "Steel pin (E 210 GPa, nu 0.3) in a sheet of E 70 GPa, nu 0.3, inner radius 50 mm, outer radius 100 mm, held 200 "
    "mm from the centre, 10 mm thick; 100 kN on the pin, friction 0.1. The benchmark is three-dimensional, with a pin "
    "20 mm long; fastpin is two-dimensional, in plane stress, and takes the fit as neat.",
    [
        "A. Konter, Advanced finite element contact benchmarks, NAFEMS R0094 (2006), as quoted in the verification "
        "manual of OptiStruct, OS-V: 0230 3D Loaded Pin; its results are plots, which were not seen"
    ],
    strip,
)


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


NASA = Benchmark(
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

BENCHMARKS = (NASA, NAFEMS)
