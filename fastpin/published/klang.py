"""Klang's problem: a pin in a hole with clearance and friction, plane stress, like bodies.

The printed pressures are 18 nodes of a mesh, 3 degrees apart: the mesh of the test has 30 elements on a quarter of the
hole. 1 bar is N R/P = 1/312.5. The printed bars are multiples of 0.3125 bar, so the source had N R/P to three digits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from fastpin.bodies import Plate, Ring
from fastpin.bodies.body import PinLoad, PlateBody
from fastpin.model import Material, MaterialPair, Problem
from fastpin.model.angles import BOTTOM
from fastpin.model.options import Method
from fastpin.published.records import Benchmark, Outcome, Report, Row, steps
from fastpin.solver.solving import solve
from fastpin.states.state import State
from fastpin.verification.rows import NODES, half_width

PUBLISHED = (
    "178.13", "178.13", "177.50", "176.88", "175.94", "174.70", "173.12", "171.25", "169.06", "166.56", "163.43",
    "159.37", "154.06", "147.81", "140.31", "130.94", "111.69", "105.93",
)  # fmt: skip
"""Pressures, bar, every 3 degrees from the bottom."""
MISPRINT = 48.0
"""Angle of 111.69, degrees. 119.69 is a multiple of the last digit and lies on the curve of its neighbours."""
CORRECTED = 119.69
LAST_DIGIT = 0.3125
"""A unit of the third digit of N R/P, bar."""
BAR = 1e5
STICK = 26.2
"""Half-angle of Klang's stick zone, degrees."""
OPEN = "open, see docs/benchmarks.md"


class Variant(NamedTuple):
    """One way to solve the problem."""

    words: str
    pin_load: PinLoad = "body"
    method: Method = "path"
    nu: float = 0.3
    plate: PlateBody = Plate()


FIRST = "body force, exact path"
VARIANTS = (
    Variant(FIRST),
    Variant("body force, one increment", method="increment"),
    Variant("body force, nu 0, exact path", nu=0.0),
    Variant("force on the axis, exact path", "centre"),
    Variant("force on the axis, one increment", "centre", "increment"),
    Variant("force on the axis, one increment, plate clamped at 1 m", "centre", "increment", plate=Ring(1.0, "held")),
)


def solved(variant: Variant) -> State:
    """Solve the problem in one way."""
    steel = Material(210e9, variant.nu)
    pair = MaterialPair(steel, steel, "stress")
    problem = Problem(pair, 60e-3, 1e-5, 0.4, variant.pin_load, plate_body=variant.plate)
    increments = 1 if variant.method == "increment" else None
    return solve(problem, [{"P": 1.875e6}], nodes=NODES, method=variant.method, increments=increments)[-1]


def pressures(state: State, angles: np.ndarray) -> np.ndarray:
    """Return the pressure at `angles` from the bottom, degrees, in bar. It is linear between nodes."""
    return np.interp(np.radians(angles) + BOTTOM, state.theta, state.pressure) / BAR


def stick_half_angle(state: State) -> float:
    """Return half the angle of the widest stick zone, degrees."""
    return math.degrees(max(map(half_width, state.stick)))


def compute(progress: Report | None = None) -> Outcome:
    """Solve the problem in several ways. The rows are the pressures of the first one, and key numbers of all."""
    angles = 3.0 * np.arange(len(PUBLISHED))
    states = {variant.words: solved(variant) for variant in steps(VARIANTS, progress)}
    rows = [
        Row(f"pressure at {angle:g} deg, {FIRST}", "bar", printed, ours,
            "misprint of 119.69, which agrees" if angle == MISPRINT else OPEN, LAST_DIGIT)
        for angle, printed, ours in zip(angles, PUBLISHED, pressures(states[FIRST], angles), strict=True)
    ]  # fmt: skip
    for words, state in states.items():
        rows += _key_rows(words, state)
    return Outcome(rows)


def _key_rows(words: str, state: State) -> Iterator[Row]:
    """The rows of contact, stick zone and largest pressure of one way."""
    ((start, stop),) = state.contact
    contact = math.degrees(0.5 * (stop - start))
    yield Row(f"half-angle of contact, {words}", "deg", "60", contact)
    yield Row(f"half-angle of stick, {words}", "deg", f"{STICK:g}", stick_half_angle(state), OPEN)
    yield Row(f"largest pressure, {words}", "bar", PUBLISHED[0], state.peak_pressure / BAR, OPEN, LAST_DIGIT)


BENCHMARK = Benchmark(
    "klang",
    "Klang's problem (Code_Aster SSNV127): pin with clearance and friction",
    "Steel pin in a steel plate, plane stress: E 210 GPa, nu 0.3, R 60 mm, clearance 0.01 mm, friction 0.4, P 1.875e6 "
    "N/m. The test loads the axis of the pin, in one increment, and clamps the plate at a radius of 1 m. The printed "
    "pressures are three digits of N R/P: one unit is 0.3125 bar.",
    [
        "M. Klang, analytical solution, as quoted in Code_Aster, V6.04.127, and in the test ssnv127a.comm",
        "mesh and load of the test: ssnv127a.datg and ssnv127a.comm (github.com/ralic/Code_Aster)",
    ],
    compute,
)
