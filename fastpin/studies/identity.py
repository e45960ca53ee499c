"""What makes two runs the same: the input of a run in one form, and an id made of it and the solver's version.

The order of keys, comments, names of materials and the way a number is written make no difference; every bit of a
number does.
"""

from __future__ import annotations

import hashlib
import json
import math
from typing import Any

import numpy as np

from fastpin.model.case import Case
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS
from fastpin.model.materials import Material
from fastpin.model.options import SolveOptions
from fastpin.version import __version__

ID_LENGTH = 16


def canonical(case: Case) -> dict[str, Any]:
    """All that a run's result depends on, apart from the solver's version, as a dict that goes to JSON exactly.

    SI units, or those of the paper for a dimensionless problem. The load history is there as its number of corners,
    its last corner (the loads that were ever given) and the SHA-256 of all its numbers.
    """
    problem, pair = case.problem, case.problem.pair
    return {
        "pin": _material(pair.pin),
        "plate": _material(pair.plate),
        "plane": pair.plane,
        "hole_radius": problem.hole_radius,
        "clearance": _number(problem.clearance),
        "friction": _number(problem.friction),
        "pin_load": problem.pin_load,
        "rotation": problem.rotation,
        "hub_radius": problem.hub_radius,
        "dimensionless": problem.dimensionless,
        "loads": _loads(case.history),
        "solve": _options(case.options),
    }


def run_id(document: dict[str, Any], version: str = __version__) -> str:
    """The id of a run: 16 hexadecimal digits of the SHA-256 of its canonical input and the solver's version."""
    text = canonical_json({"input": document, "fastpin": version})
    return hashlib.sha256(text.encode()).hexdigest()[:ID_LENGTH]


def canonical_json(document: dict[str, Any]) -> str:
    """JSON with sorted keys; a number has the fewest digits that give it back exactly."""
    return json.dumps(document, sort_keys=True, separators=(",", ":"), allow_nan=False)


def _number(value: float) -> float:
    return float(value) + 0.0  # -0 is 0


def _material(material: Material) -> dict[str, Any]:
    return {"E": "inf" if math.isinf(material.E) else material.E, "nu": _number(material.nu)}


def _loads(history: LoadHistory) -> dict[str, Any]:
    """The loads; one that was never given is not a load of zero."""
    digest, last = hashlib.sha256(), np.full(len(LOADS), np.nan)
    for block in history.blocks:
        if block.cycle:
            digest.update(f"{block.count} times {len(block.given)}".encode())
        if block.lengths:
            digest.update(f"cycles {block.lengths}".encode() + block.ends.astype("<i8").tobytes())
        for _ in range(min(block.count, 2)):  # the second time as ever after
            values = LoadHistory.from_array(block.given).values(initial=last) + 0.0  # -0 is 0
            values[np.isnan(values)] = np.nan  # there are many bit patterns of nan
            digest.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
            last = values[-1]
    named = {name: float(value) for name, value in zip(LOADS, last, strict=True) if not math.isnan(value)}
    return {"corners": len(history), "last": named, "sha256": digest.hexdigest()}


def _options(options: SolveOptions) -> dict[str, Any]:
    given = options.keywords()
    del given["shortcut"], given["error_bars"]  # the states are the same with and without
    if options.method == "path":
        del given["increments"]
    return given
