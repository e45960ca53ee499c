"""What a convergence study found, for people and other programs: tables, CSV, JSON.

Angles are in degrees from the bottom of the hole, widths in degrees; all else is in SI or in the units of a
dimensionless problem, in the text with a prefix.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fastpin.model.problem import Problem
from fastpin.model.units import named_loads, scaled, units
from fastpin.report.summary import plain
from fastpin.report.table import table
from fastpin.states.quantities import bar_in_degrees, in_degrees, quantity
from fastpin.storage.files import replacing
from fastpin.studies.convergence import ROUNDING, Convergence, QuantitySeries, Study
from fastpin.studies.extrapolate import Verdict
from fastpin.version import __version__

COLUMNS = (
    "corner", "solver", "nodes", "increments", "quantity", "unit", "value", "verdict", "order", "limit", "bar", "path",
)  # fmt: skip
"""Columns of the CSV file, a line for each value. Order, limit and error bar are those of the whole sequence; ``path``
is what the path solver gives on the grid of the increment solver."""


@dataclass(frozen=True)
class ReportedSeries:
    """A series in the units in which it is reported; see :class:`fastpin.convergence.Series`."""

    corner: int
    name: str
    label: str
    unit: str
    values: tuple[float, ...]
    verdict: Verdict
    order: float
    limit: float
    bar: float
    path: float
    negligible: float

    @classmethod
    def of(cls, series: QuantitySeries, problem: Problem) -> ReportedSeries:
        """A series of a problem."""
        kind, estimate, last = quantity(series.name).kind, series.estimate, series.values[-1]
        reported_series = in_degrees(series.name, last)

        def shown(value: float) -> float:  # next to the last value, also across 180 degrees
            return reported_series + bar_in_degrees(series.name, value - last)

        return cls(
            series.corner, series.name, quantity(series.name).label, units(problem).get(kind, "deg"),
            tuple(map(shown, series.values)), estimate.verdict, estimate.order, shown(estimate.limit),
            bar_in_degrees(series.name, estimate.bar), shown(series.path),
            bar_in_degrees(series.name, ROUNDING * series.size),
        )  # fmt: skip


def reported_series(study: Study, problem: Problem, corner: int) -> list[ReportedSeries]:
    """The series of a study at one corner."""
    return [ReportedSeries.of(series, problem) for series in study.series if series.corner == corner]


def text(convergence: Convergence) -> str:
    """For each corner a table of the path solver, and one of the increment solver."""
    parts = []
    for corner, load in convergence.loads.items():
        parts.append(f"corner {corner}: {named_loads(convergence.problem, load)}")
        for study in convergence.studies:
            parts += [
                _heading(study, convergence),
                _table(study, reported_series(study, convergence.problem, corner)),
                "",
            ]
    legend = "bar: error bar of the last value"
    if len(convergence.studies) > 1:
        legend += "; path: the path solver on the same grid, within: whether the bar reaches it"
    parts.append(legend)
    return "\n".join(parts)


def _heading(study: Study, convergence: Convergence) -> str:
    if study.method == "increment":
        return f"increment solver, {study.nodes} nodes; increments a step:"
    where = "the circle" if convergence.grid.closed else "one arc"
    return f"path solver; nodes on {where}:"


def _table(study: Study, rows: Sequence[ReportedSeries]) -> str:
    cells = [_cells(row, study.method == "increment") for row in rows]
    names = ["quantity", "unit", *map(str, study.counts), "order", "limit", "bar", "path", "within"]
    columns = [(name, "", [row[k] for row in cells]) for k, name in enumerate(names[: len(cells[0])])]
    lines = table(columns).splitlines()
    return "\n".join([lines[0], *lines[2:]])  # units have a column


def _cells(row: ReportedSeries, with_path: bool) -> list[str]:
    zero = row.verdict == "to rounding" and abs(row.limit) <= row.negligible
    factor, unit = scaled([0.0] if zero else [row.values[-1]], row.unit) if row.unit != "deg" else (1.0, "deg")
    if row.verdict == "to rounding":
        decimals = None
    else:
        size = row.bar if math.isfinite(row.bar) else 1e-4 * abs(row.values[-1])
        decimals = min(max(1 - math.floor(math.log10(factor * size)), 0), 9) if size > 0.0 else 3

    def number(value: float) -> str:
        if zero:
            return "0"
        if math.isnan(value):
            return "-"
        return f"{factor * value:.7g}" if decimals is None else f"{factor * value:z.{decimals}f}"

    order = f"{row.order:.2f}" if row.verdict == "observed" else row.verdict
    bar = "-" if decimals is None or math.isnan(row.bar) else f"{factor * row.bar:.2g}"
    limit = "-" if row.verdict == "to rounding" else number(row.limit)
    cells = [row.label, unit, *map(number, row.values), order, limit, bar]
    if with_path:
        cells += [number(row.path), _within(row)]
    return cells


def _within(row: ReportedSeries) -> str:
    """Whether the path's value lies within the error bar of the increments' last."""
    if math.isnan(row.path) or math.isnan(row.bar):
        return "-"
    return "yes" if abs(row.path - row.values[-1]) <= row.bar + row.negligible else "no"


def write_csv(convergence: Convergence, path: Path) -> None:
    """Write all values as CSV, one a line; what is not known is empty."""
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for study in convergence.studies:
            for corner in convergence.loads:
                for row in reported_series(study, convergence.problem, corner):
                    for count, value in zip(study.counts, row.values, strict=True):
                        grid = (count, "") if study.method == "path" else (study.nodes, count)
                        known = [value, row.verdict, row.order, row.limit, row.bar, row.path]
                        head = [corner, study.method, *grid, row.name, row.unit]
                        writer.writerow([*head, *("" if _missing(each) else each for each in known)])


def _missing(value: object) -> bool:
    return isinstance(value, float) and math.isnan(value)


def document(convergence: Convergence, title: str = "") -> dict[str, Any]:
    """The study as a dict that goes to JSON as it is; what is not known becomes None."""
    grid = convergence.grid
    return plain(
        {
            "fastpin": __version__,
            "title": title,
            "complete": convergence.complete,
            "arc": [float(grid.theta[0]), 2.0 * math.pi + grid.theta[0] if grid.closed else float(grid.theta[-1])],
            "loads": convergence.loads,
            "studies": [
                {
                    "solver": study.method,
                    "nodes": study.counts if study.method == "path" else study.nodes,
                    "increments": study.counts if study.method == "increment" else None,
                    "quantities": [
                        {
                            "corner": row.corner, "quantity": row.name, "unit": row.unit, "values": row.values,
                            "verdict": row.verdict, "order": row.order, "limit": row.limit, "bar": row.bar,
                            "path": row.path,
                        }
                        for corner in convergence.loads
                        for row in reported_series(study, convergence.problem, corner)
                    ],
                }
                for study in convergence.studies
            ],
        }
    )  # fmt: skip
