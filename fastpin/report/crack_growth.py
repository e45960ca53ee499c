"""The growth of a crack as a curve and as a table."""

from __future__ import annotations

import numpy as np

from fastpin.cracks import Growth
from fastpin.model.angles import from_bottom
from fastpin.model.units import units
from fastpin.report.curves import Curve
from fastpin.report.table import table

ROWS = 13
"""Most lengths of a table, in equal steps of their logarithm."""


def growth_curve(found: Growth) -> Curve:
    """Return length, stress intensities, range, threshold, rate and cycles of a crack, by its length."""
    unit = units(found.problem)
    length, intensity, rate = (unit[kind].name for kind in ("length", "stress intensity", "crack growth"))
    return Curve(
        {"mouth [deg]": from_bottom(found.crack.theta), "body": found.crack.body},
        {
            f"length [{length}]": found.length,
            f"K_I largest [{intensity}]": found.K_max,
            f"K_I smallest [{intensity}]": found.K_min,
            f"K_II [{intensity}]": found.K_II,
            f"range [{intensity}]": found.delta_K,
            f"threshold [{intensity}]": found.threshold,
            f"rate [{rate}]": found.rate,
            "cycles": found.cycles,
        },
    )


def growth_table(found: Growth) -> str:
    """Return some lengths of a crack with its stress intensities, threshold, rate and cycles, as text."""
    unit = units(found.problem)
    at = np.unique(np.linspace(0, found.length.size - 1, ROWS).round().astype(int))
    columns = [
        ("length", "length", found.length),
        ("K_I largest", "stress intensity", found.K_max),
        ("smallest", "stress intensity", found.K_min),
        ("K_II", "stress intensity", found.K_II),
        ("range", "stress intensity", found.delta_K),
        ("threshold", "stress intensity", found.threshold),
        ("growth", "crack growth", found.rate),
        ("cycles", "life", found.cycles),
    ]
    cells = []
    for name, kind, values in columns:
        factor, label = unit[kind].scale([float(value) for _, same, each in columns if same == kind for value in each])
        texts = [f"{factor * value:.4g}" for value in values[at].tolist()]
        cells.append((name, "" if kind == "life" else label, ["never" if text == "inf" else text for text in texts]))
    return table(cells)
