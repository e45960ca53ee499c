"""Charts as text, JSON and CSV: their list with ranges and bounds, one value, the nodes of a chart, formulas."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fastpin.assess.outputs import Curve, Output, aligned, write_csv
from fastpin.charts import lookups
from fastpin.charts.groups import GROUPS, STORED, ChartTable, TableAxis, parameter_range, tables


def tables_of(chart: lookups.ChartQuantity) -> list[ChartTable]:
    """The tables that have a chart, in the order of their words."""
    found = [table for table in tables().values() if chart.name in table.group.quantities]
    return sorted(found, key=lambda table: table.group.words)


def bounds_of(table: ChartTable, chart: lookups.ChartQuantity) -> tuple[float, float]:
    """The middle and the largest bound of the cells of a table: parts of the value, or its unit."""
    bounds = table.bounds[..., table.group.quantities.index(chart.name)]
    return float(np.median(bounds)), float(bounds.max())


def bound_text(chart: lookups.ChartQuantity, bound: float) -> str:
    """An error bound as text: a percentage, an angle in degrees, or a number with its unit."""
    if STORED[chart.name].is_relative:
        return f"{100.0 * bound:.2g} %"
    return f"{math.degrees(bound):.2g} deg" if chart.unit == "rad" else f"{bound:.2g} {chart.unit}"


def chart_list() -> str:
    """Return the list of all charts, with the error bounds of their tables, and the ranges of the parameters."""
    rows = [("chart", "table", "usual bound", "largest bound")]
    for chart in lookups.CHARTS.values():
        for table in tables_of(chart):
            usual, largest = (bound_text(chart, bound) for bound in bounds_of(table, chart))
            rows.append((chart.name, table.group.words, usual, largest))
    width = max(map(len, lookups.CHARTS))
    words = [f"  {name:<{width}}  {chart.words}" for name, chart in lookups.CHARTS.items()]
    return "\n".join([*words, "", *aligned(rows, "llrr"), "", *_range_lines()])


def _range_lines() -> list[str]:
    """The ranges of the parameters, from the axes of the tables."""
    shown = ("like_body", "unlike_body", "held", "unlike_held")
    first, unlike, cycle, unlike_cycle = (GROUPS[name].axes for name in shown)
    return [
        f"first load of like bodies: load_parameter {_span(first[0])}, friction {_span(first[1])}, "
        f"kolosov {_span(first[2])}",
        f"first load of unlike bodies: load_parameter {_span(unlike[0])}, friction {_span(unlike[1])},",
        f"  alpha {_span(unlike[2])}, kolosov of pin and plate {_span(unlike[4])}",
        f"cycle of Q, like bodies: load_parameter {_span(cycle[0])}, friction {_span(cycle[1])}, "
        f"kolosov {_span(cycle[2])},",
        f"  load_ratio {_span(cycle[3])} times the friction",
        f"cycle of Q, unlike bodies: load_parameter {_span(unlike_cycle[0])}, friction {_span(unlike_cycle[1])},",
        f"  alpha {_span(unlike_cycle[2])}, kolosov of pin and plate {_span(unlike_cycle[4])}, "
        f"load_ratio {_span(unlike_cycle[5])} times the friction",
        "A parameter beyond its range is an error: there is no extrapolation.",
    ]


def _span(axis: TableAxis) -> str:
    """The range of the parameter of an axis, as text."""
    _, least, most = parameter_range(axis)
    return f"{least:.4g} to {most:.4g}"


def value_text(chart: lookups.ChartQuantity, found: lookups.ChartValue) -> str:
    """Return a value with its error, as text: angles in degrees."""
    value, error, unit = found.value, found.error, found.unit
    if unit == "rad":
        value, error, unit = math.degrees(value), math.degrees(error), "deg"
    if not error > 0.0:
        return f"{chart.name} = {value:.6g} {unit}".rstrip()
    places = min(max(1 - math.floor(math.log10(error)), 0), 12)
    return f"{chart.name} = {value:.{places}f} +- {error:.{places}f} {unit}".rstrip()


class Looked(NamedTuple):
    """Charts, the parameters that were given, and the value of the only chart at them, if it was looked up."""

    charts: dict[str, lookups.ChartQuantity]
    parameters: dict[str, Any]
    found: lookups.ChartValue | None


LOOKED = (
    Output(
        "charts", "map", words="the charts",
        parts=(
            Output("words", "text"),
            Output("unit", "text"),
            Output("parameters", "texts", lambda chart: list(chart.parameters)),
            Output("relative", "truth", lambda chart: STORED[chart.name].is_relative),
            Output(
                "bounds", "map", words="bounds of each table",
                of=lambda chart: {table.group.name: bounds_of(table, chart) for table in tables_of(chart)},
                parts=(Output("usual", of=lambda bounds: bounds[0]), Output("largest", of=lambda bounds: bounds[1])),
            ),
        ),
    ),
    Output("parameters", form={"type": "object", "description": "the parameters that were given"}),
    Output("value", of=lambda looked: None if looked.found is None else float(looked.found), optional=True),
    Output("error", of=lambda looked: None if looked.found is None else float(looked.found.error), optional=True),
)  # fmt: skip
"""Outputs of a look-up."""


def write_chart(chart: lookups.ChartQuantity, path: Path) -> None:
    """Write the nodes of a chart as CSV: parameters, value and error bound, in SI angles.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    curves = []
    for table in tables_of(chart):
        units = [np.linspace(0.0, 1.0, nodes) for nodes in table.group.shape]
        grid = [axis.ravel() for axis in np.meshgrid(*units, indexing="ij")]
        places = itertools.product(*(axis.coordinates() for axis in table.group.axes))
        rows = [table.group.parameters_at(np.array(place)) for place in places]
        numbers = [key for key in chart.parameters if isinstance(rows[0][key], float)]
        columns = {key: np.array([row[key] for row in rows]) for key in numbers}
        value, error = table.value_at(chart.name, grid, columns["load_parameter"])
        unit = f" ({chart.unit})" if chart.unit else ""
        columns |= {f"{chart.name}{unit}": value, f"error{unit}": np.broadcast_to(error, value.shape)}
        words = {"table": table.group.words.replace(",", ";"), "pin_load": table.group.fixed["pin_load"]}
        curves.append(Curve(words, columns))
    write_csv(curves, path)


def formula_text() -> str:
    """Return the formulas for a spreadsheet, with the error of each."""
    lines = [
        f"Cells: Lp, 0 to {lookups.MOST_LOAD_PARAMETER:g}, and mu, 0 to {lookups.MOST_FRICTION:g}.",
        "Like bodies with nu = 0.3 in plane strain, first load.",
        "Pressure and Kt are over the bearing stress P/(2 R); angles are in rad.",
        "",
        *lookups.HEAD,
    ]
    for formula in lookups.chart_formulas():
        chart = lookups.CHARTS[formula.quantity]
        load = "body load" if formula.pin_load == "body" else "load at the centre"
        lines += ["", f"{chart.words}; {load}; error at most {100.0 * formula.error:.2g} %", formula.cell]
    return "\n".join(lines)
