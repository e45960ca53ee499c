"""A small life of wear: a pin with partial slip whose plate has constants of fatigue."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import fastpin
from fastpin.model.fatigue import FatigueConstants
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.wear_result import WearResult

CONSTANTS = FatigueConstants(
    fatigue_strength=714e6, strength_exponent=-0.078, fatigue_ductility=0.166, ductility_exponent=-0.538
)
"""Constants of fatigue of an aluminium alloy."""

JOINT = Problem(
    MaterialPair(MATERIALS["steel"], replace(MATERIALS["2024-T3"], fatigue=CONSTANTS)),
    hole_radius=0.01, clearance=2e-5, friction=0.5, pin_load="centre", rotation="fixed",
)  # fmt: skip

HISTORY = LoadHistory([{"P": 2e6}]) + LoadHistory([{"Q": 8e5}, {"Q": -8e5}]).repeated(2)


def sample_life(path: Path | None = None, problem: Problem = JOINT, **changes: Any) -> WearResult:
    """A life of 60 cycles with the profiles after 0, 2, 20 and 60 cycles, perhaps written to a file."""
    given = {"cycles": 60, "at": [2, 20], "pin": 2e-12, "plate": 8e-12, "nodes": 41, "arc": (-3.0, -0.1)}
    return fastpin.wear(problem, HISTORY, output=path, **{"title": "Worn lug", **given, **changes})
