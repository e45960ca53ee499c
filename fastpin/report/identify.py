"""What a measured loop tells, as text, CSV and JSON."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from fastpin.assess.outputs import Curve, aligned, json_ready, unit_names, write_csv
from fastpin.model.loads import LOAD_KIND
from fastpin.model.units import units
from fastpin.studies.identification import FittedValue, Identified
from fastpin.version import __version__

TOLD = 0.9
"""Least correlation that the text names."""

ENERGIES = ("measured", "deviation", "computed")
"""Keys of the energy of a cycle."""


def kind_of(found: Identified, name: str) -> str:
    """Return the kind of quantity of an estimate, a key of :func:`fastpin.model.units.units`."""
    if name.startswith("displacement"):
        return LOAD_KIND[found.names[0]]
    if name.startswith("force"):
        return LOAD_KIND[found.names[1]]
    rig = "stiffness" if found.names[0] == "rotation" else "rig stiffness"
    return {"stiffness": rig, "clearance": "displacement"}.get(name, "ratio")


def text(found: Identified) -> str:
    """Return the estimates with their intervals, the fit, the energies and sentences, as text."""
    unit, loop, names = units(found.problem), found.loop, found.names
    moves, forces = (unit[LOAD_KIND[name]] for name in names)
    turns, whole = len(loop.ends) - 2, len(found.energies)
    lines = [
        f"{loop.time.size:,} samples of {names[0]} and {names[1]}: {turns} turning point{'s' * (turns > 1)} "
        f"(reversals above {moves.text(loop.width, 3)}), {whole} whole cycle{'s' * (whole != 1)}",
        f"noise {moves.text(loop.noise[0], 3)} and {forces.text(loop.noise[1], 3)}; the samples lie "
        f"{found.scatter:.2f} times their noise from the computed loop",
        "",
    ]
    rows: list[tuple[str, ...]] = [("", "value", "95 %: from", "to", "")]
    for name, each in found.estimates.items():
        factor, label = unit[kind_of(found, name)].scale([end for end in each if math.isfinite(end)])
        numbers = [f"{factor * end:.4g}".replace("nan", "not told").replace("inf", "no bound") for end in each]
        rows.append((name.replace("_", " "), *numbers, label))
    lines += aligned(rows, "lrrrl")
    told = [(pair, each) for pair, each in found.correlations.items() if abs(each) > TOLD]
    lines += [f"correlation of {one} and {other}: {each:z.2f}".replace("_", " ") for (one, other), each in told]
    factor, label = unit["energy"].scale(found.energies.ravel().tolist())
    for cycle, (measured, deviation, computed) in enumerate((factor * found.energies).tolist(), start=1):
        lines.append(
            f"cycle {cycle}: energy {measured:.4g} +- {deviation:.3g} {label}, computed {computed:.4g} {label}"
        )
    return "\n".join([*lines, *(f"note: {note}" for note in found.notes)])


def document(found: Identified, title: str) -> dict[str, Any]:
    """Return what a loop tells as a JSON-ready dict. A value that it does not tell is None."""
    unit = units(found.problem)

    def shown(name: str, each: FittedValue) -> dict[str, float]:
        factor = unit[kind_of(found, name)].factor
        return {end: factor * value for end, value in each._asdict().items()}

    moves, forces = (unit[LOAD_KIND[name]].factor for name in found.names)
    loop, energies = found.loop, unit["energy"].factor * found.energies
    return json_ready(
        {
            "fastpin": __version__,
            "title": title,
            "units": unit_names(found.problem),
            "displacement": found.names[0],
            "force": found.names[1],
            "samples": loop.time.size,
            "turning_points": len(loop.ends) - 2,
            "least_reversal": moves * loop.width,
            "noise": {"displacement": moves * loop.noise[0], "force": forces * loop.noise[1]},
            "scatter": found.scatter,
            "estimates": {name: shown(name, each) for name, each in found.estimates.items()},
            "correlations": [[*pair, each] for pair, each in found.correlations.items()],
            "energies": [dict(zip(ENERGIES, each, strict=True)) for each in energies.tolist()],
            "notes": list(found.notes),
        }
    )


def write_loop(found: Identified, path: Path) -> None:
    """Write the measured and the computed loop as CSV, a line for each sample."""
    unit, loop = units(found.problem), found.loop
    columns = {}
    for name, measured, computed in zip(found.names, (loop.displacement, loop.force), found.computed, strict=True):
        each = unit[LOAD_KIND[name]]
        columns[f"{name} [{each.name}]"] = each.factor * measured
        columns[f"{name} computed [{each.name}]"] = each.factor * computed
    write_csv([Curve({}, columns)], path)
