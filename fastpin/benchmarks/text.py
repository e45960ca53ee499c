"""Benchmarks as text, as curves for CSV files, and as a document for JSON."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap
from typing import Any

import numpy as np

from fastpin.benchmarks.rows import Row
from fastpin.report.curves import Curve
from fastpin.report.table import aligned


def table(title: str, statement: str, sources: Sequence[str], rows: Sequence[Row]) -> str:
    """Return a benchmark as text: its statement, its sources, and a line for each row with its verdict.

    fastpin's numbers have one digit more than the published ones.
    """
    words = [statement, *(f"source: {source}" for source in sources)]
    lines = [f"  {line}" for paragraph in words for line in wrap(paragraph, 118, break_on_hyphens=False)]
    cells = [("quantity", "unit", "published", "fastpin", "difference", "verdict")]
    for row in rows:
        places = row.places + 1 if row.published else 2
        ours = f"{round(row.ours, places) + 0.0:.{places}f}"  # + 0.0 makes 0 of -0
        difference = "" if row.difference is None else f"{row.difference:+.{places}f}"
        cells.append((row.quantity, row.unit, row.published or "-", ours, difference, row.verdict))
    return "\n".join([title, *lines, *aligned(cells, "llrrrl")])


def row_curves(rows: Sequence[Row]) -> list[Curve]:
    """Return a curve of one point for each row, for a CSV file."""
    return [
        Curve(
            {"quantity": row.quantity, "unit": row.unit, "published": row.published, "verdict": row.verdict},
            {"fastpin": np.array([row.ours]), "difference": np.array([row.difference], dtype=float)},
        )
        for row in rows
    ]


def document(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Return the rows as a list for JSON."""
    return [
        {
            "quantity": row.quantity,
            "unit": row.unit,
            "published": row.published or None,
            "fastpin": row.ours,
            "difference": row.difference,
            "agrees": row.agrees,
            "verdict": row.verdict,
        }
        for row in rows
    ]
