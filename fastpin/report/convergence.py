"""A convergence study as text tables, CSV and JSON.

Angles are in degrees from the bottom of the hole, widths in degrees. All other values are in SI units, with the
thickness of the problem if it has one, or in the units of a dimensionless problem. Only the text tables use SI
prefixes.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from fastpin.assess import outputs
from fastpin.model.options import METHODS
from fastpin.model.problem import Problem
from fastpin.model.units import DEGREE, Unit, named_loads, printed_loads, units
from fastpin.states.quantities import bar_in_degrees, in_degrees, quantity
from fastpin.storage.files import replacing
from fastpin.studies.convergence import Convergence, QuantitySeries, Study
from fastpin.studies.extrapolate import Verdict

MOST_DECIMALS = 9
"""Most decimals of a value in the text tables. A value that needs more is written with an exponent."""


@dataclass(frozen=True)
class ReportedSeries:
    """One quantity at one corner, on all grids or for all numbers of increments, in the units of reports.

    Attributes
    ----------
    corner : int
        From 1.
    name, label : str
        The quantity's name, see :data:`fastpin.states.quantities.QUANTITIES`, and its heading in tables. An outcome has
        the name that the user chose for both.
    unit : Unit
        Degrees for angles and widths. The values are in it already.
    values : tuple of float
        One for each grid or number of increments. NaN where a value can't be compared with the last one. Angles are
        next to the last one, so they may lie outside of -180 to 180.
    verdict, order, limit, bar, scatter
        Of the sequence, see :class:`fastpin.studies.extrapolate.Estimate`.
    reference : float
        The size to which differences are relative, see :class:`fastpin.studies.convergence.QuantitySeries`.
    path : float
        The value of the path solver on the same grid, for a study of increments; else NaN.
    negligible : float
        Differences up to this size are rounding.
    is_outcome : bool
        Whether the user chose it.
    """

    corner: int
    name: str
    label: str
    unit: Unit
    values: tuple[float, ...]
    verdict: Verdict
    order: float
    limit: float
    bar: float
    scatter: float
    reference: float
    path: float
    negligible: float
    is_outcome: bool

    @classmethod
    def of(cls, series: QuantitySeries, problem: Problem) -> ReportedSeries:
        """Convert a series of a study of `problem`, which is in SI units and rad."""
        name, outcome, estimate, last = series.name, series.outcome, series.estimate, series.values[-1]
        reported: Callable[[float], float]
        reported_bar: Callable[[float], float]
        if outcome is None:
            label, unit = quantity(name).label, units(problem).get(quantity(name).kind, DEGREE)
            reported, reported_bar = partial(in_degrees, name), partial(bar_in_degrees, name)
        else:
            label, unit = name, outcome.unit_in(units(problem))
            reported, reported_bar = outcome.reported, outcome.reported_bar
        reported_last = reported(last)

        def in_report_units(value: float) -> float:  # an angle stays next to the last one, also across 180 degrees
            return unit.factor * (reported_last + reported_bar(value - last))

        return cls(
            series.corner, name, label, unit.printed, tuple(map(in_report_units, series.values)), estimate.verdict,
            estimate.order, in_report_units(estimate.limit), unit.factor * reported_bar(estimate.bar), estimate.scatter,
            unit.factor * reported_bar(series.reference), in_report_units(series.path),
            unit.factor * reported_bar(outputs.ROUNDING * series.size), outcome is not None,
        )  # fmt: skip

    @property
    def words(self) -> str:
        """The verdict in words: "order 1.89", or "converged, scatter 1e-6"."""
        if self.verdict == "observed":
            return f"order {self.order:.2f}"
        if self.verdict == "to rounding":
            return "converged to rounding"
        return self.verdict if math.isnan(self.scatter) else f"{self.verdict}, scatter {one_digit(self.scatter)}"


def one_digit(value: float) -> str:
    """Return a number with one digit, such as 0.02 or 1e-6."""
    head, e, power = f"{value:.0e}".partition("e")
    return f"{head}e{int(power)}" if e and value < 1e-3 and value > 0.0 else f"{value:.1g}"


def reported_series(study: Study, problem: Problem, corner: int) -> list[ReportedSeries]:
    """Return the series of a study at one corner, in the units of reports. Corners count from 1."""
    return [ReportedSeries.of(series, problem) for series in study.series if series.corner == corner]


def text(convergence: Convergence) -> str:
    """Return the text tables of a study. Each corner has one for the path solver, and one for the increment solver."""
    parts = []
    for corner, load in convergence.loads.items():
        parts.append(f"corner {corner}: {named_loads(convergence.problem, load)}")
        for study in convergence.studies:
            rows = reported_series(study, convergence.problem, corner)
            head, _, *lines = outputs.table(series_columns(study, rows)).splitlines()  # units have a column, not a line
            parts += [heading(study, convergence), "\n".join([head, *lines]), ""]
    legend = "bar: error bar of the last value; scatter: range of the last three values, relative to the value"
    legend += "\n(of places: to the width of the contact)"
    if len(convergence.studies) > 1:
        legend += "; path: the path solver on the same grid, within: whether the bar reaches it"
    parts.append(legend)
    return "\n".join(parts)


def heading(study: Study, convergence: Convergence) -> str:
    """Return the heading of the table of a study: its solver and its nodes."""
    if study.method == "increment":
        return f"increment solver, {study.nodes} nodes; increments a step:"
    where = "the circle" if convergence.grid.closed else "one arc"
    return f"path solver; nodes on {where}:"


def series_columns(study: Study, rows: Sequence[ReportedSeries]) -> list[outputs.Column]:
    """Return the columns of the table of a study: values, verdict, limit and error bar of each quantity."""
    cells = [_cells(row, study.method == "increment") for row in rows]
    names = ["quantity", "unit", *map(str, study.counts), "verdict", "limit", "bar", "path", "within"]
    return [(name, "", [row[k] for row in cells]) for k, name in enumerate(names[: len(cells[0])])]


def _cells(row: ReportedSeries, with_path: bool) -> list[str]:
    zero = row.verdict == "to rounding" and abs(row.limit) <= row.negligible
    factor, unit = row.unit.scale([0.0] if zero else [row.values[-1]])
    if row.verdict == "to rounding":
        decimals = None
    else:
        size = row.bar if math.isfinite(row.bar) else 1e-4 * abs(row.values[-1])
        decimals = max(1 - math.floor(math.log10(factor * size)), 0) if size > 0.0 else 3

    def number(value: float) -> str:
        if zero:
            return "0"
        if math.isnan(value):
            return "-"
        if decimals is None:
            return f"{factor * value:.7g}"
        if decimals <= MOST_DECIMALS or value == 0.0:
            return f"{factor * value:z.{min(decimals, MOST_DECIMALS)}f}"
        digits = decimals + math.floor(math.log10(abs(factor * value)))
        return f"{factor * value:.{min(max(digits, 0), MOST_DECIMALS)}e}"

    bar = "-" if decimals is None or math.isnan(row.bar) else f"{factor * row.bar:.2g}"
    limit = "-" if row.verdict == "to rounding" else number(row.limit)
    cells = [row.label, unit, *map(number, row.values), row.words, limit, bar]
    if with_path:
        is_known = not (math.isnan(row.path) or math.isnan(row.bar))
        is_within = abs(row.path - row.values[-1]) <= row.bar + row.negligible
        cells += [number(row.path), ("yes" if is_within else "no") if is_known else "-"]
    return cells


SERIES = (
    outputs.Output("corner", "whole"),
    outputs.Output("quantity", "text", lambda row: row.name),
    outputs.Output("unit", "text", lambda row: row.unit.name),
    outputs.Output("values", form=outputs.list_of(outputs.UNKNOWN)),
    outputs.Output("verdict", "text"),
    *outputs.numbers("order limit bar scatter path", optional=True),
)
"""Outputs of a :class:`ReportedSeries`."""

COLUMNS = ("corner", "solver", "nodes", "increments", "quantity", "unit", "value", *(each.name for each in SERIES[4:]))
"""Columns of the CSV file. Each value has a line."""


def _with_series(convergence: Convergence) -> Iterator[tuple[Study, list[ReportedSeries]]]:
    """Yield the studies, each with its series at all corners."""
    for study in convergence.studies:
        corners = (reported_series(study, convergence.problem, corner) for corner in convergence.loads)
        yield study, [row for rows in corners for row in rows]


CONVERGENCE = (
    outputs.Output("complete", "truth"),
    outputs.Output("arc", form=outputs.list_of(outputs.NUMBER, 2)),
    outputs.UNITS,
    outputs.Output(
        "loads", form=outputs.map_of(outputs.map_of(outputs.NUMBER, "loads"), "loads at each corner"),
        of=lambda found: {corner: printed_loads(found.problem, load) for corner, load in found.loads.items()},
    ),
    outputs.Output("unread", form=outputs.map_of(outputs.TEXT, "why a quantity could not be read")),
    outputs.Output(
        "studies", "list", _with_series,
        parts=(
            outputs.Output("solver", "text", lambda each: each[0].method, allowed=METHODS),
            outputs.Output(
                "nodes", of=lambda each: each[0].counts if each[0].of_grids else each[0].nodes,
                form={"type": ["array", "integer", "null"], "items": outputs.WHOLE},
            ),
            outputs.Output(
                "increments", of=lambda each: None if each[0].of_grids else each[0].counts,
                form={"type": ["array", "integer", "null"], "items": outputs.WHOLE},
            ),
            outputs.Output("quantities", "list", lambda each: each[1], parts=SERIES),
        ),
    ),
)  # fmt: skip
"""Outputs of a convergence study."""


def write_csv(convergence: Convergence, path: Path) -> None:
    """Write all values as CSV, one a line. Unknown values are empty cells.

    Verdict, order, limit, error bar and scatter belong to the whole sequence of values. ``scatter`` is relative.
    ``path`` is the value of the path solver on the grid of the increment solver.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for study, rows in _with_series(convergence):
            for row in rows:
                cells = {"solver": study.method} | outputs.document(SERIES, row, {})
                for count, value in zip(study.counts, cells.pop("values"), strict=True):
                    grid = (count, "") if study.of_grids else (study.nodes, count)
                    whole = cells | dict(zip(("nodes", "increments", "value"), (*grid, value), strict=True))
                    unknown = {name for name, cell in whole.items() if isinstance(cell, float) and math.isnan(cell)}
                    writer.writerow(
                        {name: "" if name in unknown else outputs.csv_cell(whole[name]) for name in COLUMNS}
                    )
