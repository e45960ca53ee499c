"""Stress-life curves of alloys with scatter, as constants of fatigue by name."""

from __future__ import annotations

import csv
import functools
import math
from pathlib import Path
from typing import Any

KSI = 6.894757293168361e6
"""Pa in a ksi."""


@functools.cache
def stress_life_curves() -> dict[str, dict[str, Any]]:
    """Return fields of :class:`fastpin.model.FatigueConstants` by the names of curves, such as "2024-T3 sheet, Kt 1".

    They are those of figures of MIL-HDBK-5J, read from a public transcription: compare a curve with the print before
    relying on a life. Curves of specimens whose number is not printed have no ``curve_samples``.
    """
    with Path(__file__).with_name("stress_life.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {
        row["name"]: {
            "curve_a": float(row["A"]) + float(row["B"]) * math.log10(KSI),
            "curve_b": float(row["B"]),
            "curve_c": float(row["C"]) * KSI,
            "curve_m": float(row["m"]),
            "curve_kt": float(row["Kt"]),
            "curve_scatter": float(row["scatter"]),
            "source": row["source"],
        }
        | ({"curve_samples": int(row["samples"])} if row["samples"] else {})
        for row in rows
    }
