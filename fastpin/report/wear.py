"""A life of wear as text and JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from fastpin.model.angles import from_bottom
from fastpin.model.units import units
from fastpin.report.summary import json_ready, unit_names
from fastpin.report.table import Column
from fastpin.report.table import table as text_table
from fastpin.solver.wear_result import WearResult, WornCycle
from fastpin.version import __version__


def table(result: WearResult) -> str:
    """Return the chosen cycles as a table."""
    unit = units(result.problem)
    columns: list[Column] = [("cycle", "", [f"{each.cycle:,}" for each in result])]
    kinds = {
        "depth": ("displacement", [each.depth for each in result]),
        "volume": ("work per stress", [each.volume for each in result]),
        "energy/cycle": ("energy", [each.energy_per_cycle for each in result]),
        "peak p": ("traction", [float(each.pressure.max()) for each in result]),
    }
    for name, (kind, values) in kinds.items():
        factor, label = unit[kind].scale(values)
        columns.append((name, label, [f"{factor * value:.5g}" for value in values]))
    shares = ["-" if np.isnan(each.pin_share) else f"{100.0 * each.pin_share:.3g}" for each in result]
    columns.append(("of the pin", "%", shares))
    columns.append(("solved", "", [f"{each.solved:,}" for each in result]))
    return text_table(columns)


def document(result: WearResult | None, title: str = "", error: str | None = None) -> dict[str, Any]:
    """Return a life of wear as a JSON-ready dict. Angles are in degrees from the bottom of the hole.

    `error` is the reason why it is incomplete. Without a result no cycle was reached.
    """
    found: dict[str, Any] = {"fastpin": __version__, "title": title, "error": error}
    if result is None:
        empty: dict[str, Any] = {key: [] for key in ("angles", "pin_coefficient", "plate_coefficient", "cycles")}
        rest = {"complete": False, "units": {}, "law": "", "tolerance": 0.0, "statistics": {}}
        return found | rest | empty
    unit = units(result.problem)
    pin, plate = unit["wear coefficient"].factor * result.coefficients
    found |= {
        "complete": result.complete,
        "units": unit_names(result.problem),
        "law": result.law,
        "tolerance": result.tolerance,
        "angles": [from_bottom(angle) for angle in result.theta.tolist()],
        "pin_coefficient": pin.tolist(),
        "plate_coefficient": plate.tolist(),
        "statistics": result.statistics,
        "cycles": [_cycle(result, each, tau) for each, tau in zip(result, result.tau.tolist(), strict=True)],
    }
    ready: dict[str, Any] = json_ready(found)
    return ready


def _cycle(result: WearResult, cycle: WornCycle, tau: float) -> dict[str, Any]:
    unit = units(result.problem)
    area, energy, length = (unit[kind].factor for kind in ("work per stress", "energy", "displacement"))
    pin, plate = cycle.volumes
    return {
        "cycle": cycle.cycle,
        "next_jump": cycle.next_jump,
        "solved": cycle.solved,
        "tau": unit["wear coefficient"].factor * tau,
        "depth": length * cycle.depth,
        "volume": area * cycle.volume,
        "pin_volume": area * pin,
        "plate_volume": area * plate,
        "energy_per_cycle": energy * cycle.energy_per_cycle,
        "dissipation": energy * cycle.dissipation,
        "removed": energy * cycle.removed,
        "peak_pressure": unit["traction"].factor * float(cycle.pressure.max()),
        "pin_depth": (length * cycle.pin_depth).tolist(),
        "plate_depth": (length * cycle.plate_depth).tolist(),
        "pressure": (unit["traction"].factor * cycle.pressure).tolist(),
    }
