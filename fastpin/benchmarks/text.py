"""Benchmarks as text, as curves for CSV files, and as a document for JSON."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap
from typing import Any

import numpy as np

from fastpin.benchmarks.rows import Row
from fastpin.report.curves import Curve

WIDTH = 118
"""Most characters in a line of words."""


def table(title: str, statement: str, sources: Sequence[str], rows: Sequence[Row]) -> str:
    """Return a benchmark as text: its statement, its sources, and a line for each row with its verdict."""
    lines = [title, *_paragraph(statement)]
    for source in sources:
        lines += _paragraph(f"source: {source}")
    head = ("quantity", "unit", "published", "fastpin", "difference", "verdict")
    cells = [head, *(_cells(row) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    sides = (str.ljust, str.ljust, str.rjust, str.rjust, str.rjust, str.ljust)
    for line in cells:
        padded = (side(cell, width) for side, cell, width in zip(sides, line, widths, strict=True))
        lines.append("  " + "  ".join(padded).rstrip())
    return "\n".join(lines)


def _paragraph(words: str) -> list[str]:
    return [f"  {line}" for line in wrap(words, WIDTH, break_on_hyphens=False)]


def _cells(row: Row) -> tuple[str, ...]:
    """Return the cells of a row. fastpin's number has one digit more than the published one."""
    places = len(row.published.partition(".")[2]) + 1 if row.published else 2
    difference = "" if row.difference is None else f"{row.difference:+.{places}f}"
    ours = f"{round(row.ours, places) + 0.0:.{places}f}"  # + 0.0 makes 0 of -0
    return row.quantity, row.unit, row.published or "-", ours, difference, row.verdict


def row_curves(rows: Sequence[Row]) -> list[Curve]:
    """Return a curve of one point for each row, for a CSV file."""
    return [
        Curve(
            {"quantity": row.quantity, "unit": row.unit, "published": row.published, "verdict": row.verdict},
            {"fastpin": np.array([row.ours]), "difference": np.array([_or_nan(row.difference)])},
        )
        for row in rows
    ]


def _or_nan(value: float | None) -> float:
    return np.nan if value is None else value


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
