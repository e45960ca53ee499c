"""The growth of a crack as a curve and as a table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from fastpin import cracks
from fastpin.cracks import CrackFate
from fastpin.model.angles import from_bottom
from fastpin.model.growth import Nasgro, Walker, law_entries
from fastpin.model.points import owner_of
from fastpin.model.units import units
from fastpin.report.curves import Curve
from fastpin.report.table import table
from fastpin.states.margins import over_yield_words

ROWS = 13
"""Most lengths of a table, in equal steps of their logarithm."""


def growth_curve(growth: cracks.Growth) -> Curve:
    """Return length, stress intensities, range, threshold, rate and cycles of a crack, by its length."""
    unit = units(growth.problem)
    length, intensity, rate = (unit[kind].name for kind in ("length", "stress intensity", "crack growth"))
    rate = rate.replace("cycle", growth.per)
    return Curve(
        {"mouth [deg]": from_bottom(growth.crack.theta), "body": growth.crack.body},
        {
            f"length [{length}]": growth.length,
            f"K_I largest [{intensity}]": growth.K_max,
            f"K_I smallest [{intensity}]": growth.K_min,
            f"K_II [{intensity}]": growth.K_II,
            f"range [{intensity}]": growth.delta_K,
            f"threshold [{intensity}]": growth.threshold,
            f"rate [{rate}]": growth.rate,
            growth.passes: growth.cycles,
        },
    )


def growth_line(growth: cracks.Growth, over: Mapping[str, float] | None = None) -> str:
    """Return a line of text: the place of a crack, and what becomes of it.

    `over` has the bodies that yield, see :func:`fastpin.states.margins.over_yield`: their lives are marked.
    """
    mark = over_yield_words(over or {}, owner_of(growth.problem, growth.crack.body))
    where = " in the plate round the bush" if growth.crack.body == "seat" else ""
    line = f"crack{where} at {from_bottom(growth.crack.theta):z.2f} deg from the bottom: {growth.words}"
    if growth.fate == CrackFate.NONE or math.isnan(growth.error):
        return line + mark
    of = "length" if growth.fate == CrackFate.STOPS else "life"
    if not growth.error < 1.0:
        return f"{line}; the error of this {of} is not known{mark}"
    power = math.floor(math.log10(max(growth.error, 1e-9)))
    return f"{line}; numerical error of this {of} below {math.ceil(growth.error / 10.0**power):g}e{power:03d}{mark}"


def document(growth: cracks.Growth) -> dict[str, Any]:
    """Return a growth as a JSON-ready dict. A life without end is infinite, and a length that is not known is NaN."""
    length, law = units(growth.problem)["length"].factor, growth.law
    values = {
        "first": growth.length[0],
        "last": growth.length[-1],
        "arrest": growth.arrest,
        "fracture": growth.fracture,
    }
    return {
        "angle_of_mouth": from_bottom(growth.crack.theta),
        "direction": math.degrees(growth.crack.angle),
        "body": growth.crack.body,
        "law": law_entries(law) if isinstance(law, Walker | Nasgro) else None,
        "repeated": growth.per,
        "fate": growth.fate.words,
        "life": growth.life,
        "error": growth.error,
        **{name: length * float(value) for name, value in values.items()},
        "words": growth.words,
        "doubts": [str(doubt) for doubt in growth.doubts],
    }


def growth_table(growth: cracks.Growth) -> str:
    """Return some lengths of a crack with its stress intensities, threshold, rate and cycles, as text."""
    unit = units(growth.problem)
    rows = np.geomspace(growth.length[0], growth.length[-1], ROWS)
    at = np.unique(np.abs(np.log(growth.length[:, None] / rows)).argmin(axis=0))
    columns = [
        ("length", "length", growth.length),
        ("K_I largest", "stress intensity", growth.K_max),
        ("smallest", "stress intensity", growth.K_min),
        ("K_II", "stress intensity", growth.K_II),
        ("range", "stress intensity", growth.delta_K),
        ("threshold", "stress intensity", growth.threshold),
        ("growth", "crack growth", growth.rate),
        (growth.passes, "life", growth.cycles),
    ]
    cells = []
    for name, kind, values in columns:
        factor, label = unit[kind].scale([float(value) for _, same, each in columns if same == kind for value in each])
        texts = [f"{factor * value:.4g}" for value in values[at].tolist()]
        label = "" if kind == "life" else label.replace("cycle", growth.per)
        cells.append((name, label, ["never" if text == "inf" else text for text in texts]))
    return table(cells)
