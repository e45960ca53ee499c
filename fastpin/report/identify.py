"""What a measured loop tells, as text, CSV and JSON."""

from __future__ import annotations

import math

from fastpin.assess import outputs
from fastpin.assess.outputs import Curve, Output, aligned
from fastpin.model.loads import LOAD_KIND
from fastpin.model.units import units
from fastpin.studies.identification import FittedValue, Identified

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


def _shown(found: Identified, name: str, *values: float) -> list[float]:
    """Values of an estimate, or of the loop's displacement or force, in their unit."""
    factor = units(found.problem)[kind_of(found, name)].factor
    return [factor * value for value in values]


IDENTIFIED = (
    outputs.UNITS,
    Output("displacement", "text", lambda found: found.names[0]),
    Output("force", "text", lambda found: found.names[1]),
    Output("samples", "whole", lambda found: found.loop.time.size),
    Output("turning_points", "whole", lambda found: len(found.loop.ends) - 2),
    Output("least_reversal", of=lambda found: _shown(found, "displacement", found.loop.width)[0]),
    Output(
        "noise", of=lambda found: found,
        parts=(
            Output("displacement", of=lambda found: _shown(found, "displacement", found.loop.noise[0])[0]),
            Output("force", of=lambda found: _shown(found, "force", found.loop.noise[1])[0]),
        ),
    ),
    Output("scatter"),
    Output(
        "estimates", "map",
        lambda found: {name: FittedValue(*_shown(found, name, *each)) for name, each in found.estimates.items()},
        "an identified value and its interval of 95 %; null: no bound",
        parts=(Output("value", words="null: not told", optional=True), *outputs.numbers("low high", optional=True)),
    ),
    Output(
        "correlations", of=lambda found: [[*pair, each] for pair, each in found.correlations.items()],
        form=outputs.list_of({"type": "array", "prefixItems": [outputs.TEXT, outputs.TEXT, outputs.NUMBER]}),
    ),
    Output(
        "energies",
        of=lambda found: [
            dict(zip(ENERGIES, each, strict=True))
            for each in (units(found.problem)["energy"].factor * found.energies).tolist()
        ],
        form=outputs.list_of(outputs.object_of(dict.fromkeys(ENERGIES, outputs.NUMBER)))
    ),
    Output("notes", "texts", lambda found: list(found.notes)),
)  # fmt: skip
"""Outputs of what a loop tells."""


def loop_curve(found: Identified) -> Curve:
    """Return the measured and the computed loop, a row for each sample."""
    unit, loop = units(found.problem), found.loop
    columns = {}
    for name, measured, computed in zip(found.names, (loop.displacement, loop.force), found.computed, strict=True):
        each = unit[LOAD_KIND[name]]
        columns[f"{name} [{each.name}]"] = each.factor * measured
        columns[f"{name} computed [{each.name}]"] = each.factor * computed
    return Curve({}, columns)
