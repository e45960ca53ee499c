"""What a sweep found, as a table, a CSV file, or the numbers of a figure."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, closest
from fastpin.model.loads import LOAD_KIND
from fastpin.model.units import scaled as with_prefix
from fastpin.model.units import units
from fastpin.report.table import table
from fastpin.storage.files import check_writable, replacing
from fastpin.studies.index import DONE, FAILED
from fastpin.studies.outcome import KEY_FIGURES
from fastpin.studies.plan import Plan
from fastpin.version import __version__

Row = dict[str, Any]

MOST_PANELS = 12
"""Most maps in one figure."""

MOST_CURVES = 20
"""Most curves in one figure."""

_KIND = {"hole_radius": "length", "clearance": "length", "hub_radius": "length", "E": "traction"} | LOAD_KIND
"""Kinds of the keys of a case that have a unit."""

_SHOWN = {
    "peak_pressure": "peak N",
    "peak_pressure_angle": "at",
    "peak_shear": "peak T",
    "contact_start": "contact from",
    "contact_stop": "to",
    "stick_width": "stick",
    "rotation": "rotation",
    "dissipation": "dissipated",
    "max_pressure": "max N",
    "max_shear": "max |T|",
}
"""Columns of the printed table and their names in it; a CSV file has all."""


def text(plan: Plan, rows: Sequence[Row]) -> str:
    """The table to be read: varied fields, the most important key figures of the last state, reasons of failures.

    `rows` are those of :func:`fastpin.sweep.rows`. The middle of a long table is left out.
    """
    unit = _units(plan, rows)
    columns = [("run", "", [row["id"] for row in rows])]
    for name in plan.fields:
        columns.append(_column(name, [row[name] for row in rows], unit.get(_KIND.get(_key(name), ""), "")))
    for name, heading in _SHOWN.items():
        columns.append(_column(heading, [row.get(name) for row in rows], _unit(name, unit)))
    columns.append(("status", "", [row["status"] for row in rows]))
    return table(columns)


def write_csv(plan: Plan, rows: Sequence[Row], path: Path) -> None:
    """All fields and key figures in a CSV file, in SI units or those of the paper, which a comment line names."""
    check_writable(path)
    unit = _units(plan, rows)
    named = [(name, _unit(name, unit)) for name in KEY_FIGURES]
    names = ["id", *plan.fields, *KEY_FIGURES, "seconds", "started", "host", "status", "reason"]
    out = io.StringIO()
    out.write(f"# fastpin {__version__}{f', {plan.title}' if plan.title else ''}\n")
    out.write(f"# units: {', '.join(f'{name} {label}' for name, label in named if label)}, seconds s\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(names)
    for row in rows:
        cells = (row.get(name) for name in names)
        writer.writerow([json.dumps(cell) if isinstance(cell, list) else cell for cell in cells])
    with replacing(path) as temporary:
        temporary.write_text(out.getvalue(), encoding="utf-8")


@dataclass(frozen=True)
class Axis:
    """An axis of a figure: its sorted values, what it is called, and whether they are spaced by a factor."""

    label: str
    values: np.ndarray
    log: bool


@dataclass(frozen=True)
class Chart:
    """The numbers of a figure.

    Attributes
    ----------
    title, label : str
        Of the figure, and of the value with its unit.
    x : Axis
    y : Axis or None
        None for curves.
    parts : list of (str, ndarray, ndarray of bool)
        For each map or curve: its name, one field a line; the values, shape (len(y), len(x)) or (len(x),), nan where
        there is none; and where a run has failed.
    missing : int
        Number of points without a value.
    """

    title: str
    label: str
    x: Axis
    y: Axis | None
    parts: list[tuple[str, np.ndarray, np.ndarray]]
    missing: int


def check_axes(plan: Plan, value: str, x: str | None, y: str | None) -> tuple[str, str | None, list[str]]:
    """The fields of a figure's x and y axis (None for curves), and those that tell its maps or curves apart.

    Fields that are not given are chosen: the first two that are numbers and vary, or the one.

    Raises
    ------
    InputError
        Naming "value", "x", "y" or "plot", if there is nothing of that name or the figure would have too many parts.
    """
    if value not in (*KEY_FIGURES, "seconds"):
        hint = closest(value, tuple(KEY_FIGURES)) or f"; there are {', '.join(KEY_FIGURES)}, seconds"
        raise InputError("value", f"there is no key figure {value!r}{hint}")
    values = {name: _different([point.values.get(name) for point in plan.points]) for name in plan.fields}
    numeric = [name for name, found in values.items() if all(_is_number(item) for item in found)]
    for option, name in (("x", x), ("y", y)):
        if name is not None and name not in plan.fields:
            hint = closest(name, tuple(plan.fields)) or f"; there are {', '.join(plan.fields)}"
            raise InputError(option, f"the plan does not vary {name!r}{hint}")
        if name is not None and name not in numeric:
            raise InputError(option, f"the values of {name} are not all numbers, which an axis needs")
    if y is not None and y == x:
        raise InputError("y", f"must be another field than that of the x axis, {x}")
    free = [name for name in numeric if len(values[name]) > 1 and name not in (x, y)]
    if x is None:
        if not free:
            raise InputError("plot", "a figure needs a field with several numbers")
        x = free.pop(0)
        y = free.pop(0) if y is None and free else y
    others = [name for name, found in values.items() if len(found) > 1 and name not in (x, y)]
    parts = len(_different([[point.values.get(name) for name in others] for point in plan.points]))
    most, what = (MOST_CURVES, "curves") if y is None else (MOST_PANELS, "maps")
    if parts > most:
        raise InputError("plot", f"the figure would have {parts} {what}, at most {most} fit; choose other axes")
    return x, y, others


def chart(plan: Plan, rows: Sequence[Row], value: str, x: str | None = None, y: str | None = None) -> Chart:
    """The numbers of a figure of one key figure over one or two fields; other fields make several maps or curves.

    Parameters
    ----------
    plan : Plan
    rows : sequence of dict
        Those of :func:`fastpin.sweep.rows`.
    value : str
        A key figure.
    x, y : str, optional
        Fields of the axes, see :func:`check_axes`. With `x` alone: curves.
    """
    x, y, others = check_axes(plan, value, x, y)
    unit = _units(plan, rows)
    found = [row.get(value) for row in rows if row["status"] == DONE and row.get(value) is not None]
    factor, label = _scaled([number for number in found if number is not None], _unit(value, unit))
    axes = [_axis(plan, rows, name, unit) for name in (y, x) if name is not None]
    shape = tuple(len(axis.values) for axis, _ in axes)
    parts: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for row in rows:
        name = "\n".join(f"{other} = {_brief(row[other])}" for other in others if row[other] is not None)
        numbers, failed = parts.setdefault(name, (np.full(shape, np.nan), np.zeros(shape, dtype=bool)))
        place = tuple(places[row[field]] for (_, places), field in zip(axes, (y, x) if y else (x,), strict=True))
        failed[place] = row["status"] == FAILED
        if row["status"] == DONE and row.get(value) is not None:
            numbers[place] = factor * row[value]
    return Chart(
        plan.title,
        f"{value.replace('_', ' ')}{f'  [{label}]' if label else ''}",
        axes[-1][0],
        axes[0][0] if y else None,
        [(name, *arrays) for name, arrays in parts.items()],
        len(rows) - len(found),
    )


def _axis(plan: Plan, rows: Sequence[Row], name: str, unit: dict[str, str]) -> tuple[Axis, dict[Any, int]]:
    """An axis, and the place of each value on it."""
    values = sorted({row[name] for row in rows})
    factor, label = _scaled(values, unit.get(_KIND.get(_key(name), ""), ""))
    axis = Axis(
        f"{name}{f'  [{label}]' if label else ''}", factor * np.array(values, float), plan.fields[name] == "log"
    )
    return axis, {value: place for place, value in enumerate(values)}


def _column(name: str, values: Sequence[Any], unit: str) -> tuple[str, str, list[str]]:
    """A column of the printed table: numbers with the prefix that suits them, all else as it was written."""
    if not all(value is None or _is_number(value) for value in values):
        return name, unit, ["-" if value is None else _brief(value).strip('"') for value in values]
    factor, label = _scaled([value for value in values if value is not None], unit)
    return name, label, ["-" if value is None else f"{value * factor:.5g}" for value in values]


def _units(plan: Plan, rows: Sequence[Row]) -> dict[str, str]:
    """The unit of every kind of quantity; no units where some runs are dimensionless and others are not."""
    if len({row["dimensionless"] for row in rows if "dimensionless" in row}) > 1:
        return {}
    return {**units(plan.case(plan.points[0]).problem), "angle": "deg"}


def _scaled(values: Sequence[float], unit: str) -> tuple[float, str]:
    """A factor and a unit that suits the values; numbers and degrees stay as they are."""
    return with_prefix(values, unit) if unit not in ("", "deg") else (1.0, unit)


def _unit(value: str, unit: dict[str, str]) -> str:
    return "s" if value == "seconds" else unit.get(KEY_FIGURES[value], "")


def _key(field: str) -> str:
    return field.rsplit(".", 1)[-1]


def _brief(value: Any) -> str:
    """A value as text, numbers with six digits."""
    if isinstance(value, list):
        return f"[{', '.join(map(_brief, value))}]"
    return f"{value:.6g}" if _is_number(value) else as_toml(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _different(values: Sequence[Any]) -> list[Any]:
    return list({json.dumps(value): value for value in values}.values())
