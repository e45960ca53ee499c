"""Small lives of wear, with partial slip and a plate that has constants of fatigue."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import fastpin
from fastpin import MATERIALS, LoadHistory, MaterialPair, Problem, casefile
from fastpin.model import FatigueConstants, InitialGap, Profile
from fastpin.wear_lives import WearResult

CONSTANTS = FatigueConstants(
    fatigue_strength=714e6, strength_exponent=-0.078, fatigue_ductility=0.166, ductility_exponent=-0.538
)
"""Constants of fatigue of an aluminium alloy."""

JOINT = Problem(
    MaterialPair(MATERIALS["steel"], replace(MATERIALS["2024-T3"], fatigue=CONSTANTS)),
    hole_radius=0.01, clearance=2e-5, friction=0.5, pin_load="centre", rotation="fixed",
    gap=InitialGap(Profile.ellipse(1e-6)),
)  # fmt: skip

HISTORY = LoadHistory([{"P": 2e6}]) + LoadHistory([{"Q": 8e5}, {"Q": -8e5}]).repeated(2)


def sample_life(path: Path | None = None, problem: Problem = JOINT, **changes: Any) -> WearResult:
    """A life of 60 cycles with the profiles after 0, 2, 20 and 60 cycles, perhaps written to a file."""
    given = {"cycles": 60, "at": [2, 20], "pin": 2e-12, "plate": 8e-12, "nodes": 41, "arc": (-3.0, -0.1)}
    return fastpin.wear(problem, HISTORY, output=path, **{"title": "Worn lug", **given, **changes})


FRETTING = """
title = "Fretting"
pin.material = "Ti-6Al-4V"
plate.material = "2024-T3"
[contact]
hole_radius = 0.01
clearance = 5e-5
friction = 0.4
pin_load = "body"
thickness = 5e-3
[[load]]
P = 1e4
[[load]]
P = [5e3, 1e4]
Q = [-2e3, 2e3]
repeat = 3000
[wear]
pin = 3e-12
plate = 12e-12
tolerance = 0.05
at = [3, 10, 100, 1000]
[solve]
nodes = 41
"""
"""The case of the life."""


def fretting(cycles: int = 3000, at: tuple[int, ...] = (3, 10, 100, 1000), nodes: int = 41) -> WearResult:
    """Follow the life."""
    case = casefile.parse_case(FRETTING)
    law = {"pin": case.wear.pin, "plate": case.wear.plate, "tolerance": case.wear.tolerance}
    return fastpin.wear(case.problem, case.history, cycles=cycles, at=at, nodes=nodes, **law)
