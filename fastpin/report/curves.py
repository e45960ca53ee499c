"""Curves of figures, and their CSV files."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.storage.files import replacing


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve of a figure.

    Attributes
    ----------
    parameters : dict
        The values that differ between the curves of a figure: L_p, mu, the pair, the load.
    columns : dict of ndarray
        The numbers, all of one length, by a name with its unit. NaN breaks the curve.
    """

    parameters: dict[str, Any]
    columns: dict[str, np.ndarray] = field(repr=False)

    def __getitem__(self, column: str) -> np.ndarray:
        return self.columns[column]


def write_csv(curves: Sequence[Curve], path: Path, remarks: Sequence[str] = ()) -> None:
    """Write curves as CSV, one below the other. Each line has the curve's parameters, then a row of its columns.

    NaN is an empty cell. A comma in a text becomes a semicolon, for programs that do not know quotes. `remarks` become
    lines that begin with #.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    names = list(dict.fromkeys(name for curve in curves for name in (*curve.parameters, *curve.columns)))
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {remark}\n" for remark in remarks)
        writer = csv.DictWriter(file, names, restval="", lineterminator="\n")
        writer.writeheader()
        for curve in curves:
            parameters = {name: _parameter(value) for name, value in curve.parameters.items()}
            rows = zip(*curve.columns.values(), strict=True)
            for row in rows:
                writer.writerow({**parameters, **dict(zip(curve.columns, map(_cell, row), strict=True))})


def csv_cell(value: Any) -> Any:
    """Return the value of a cell. A text that a spreadsheet would take for a formula begins with an apostrophe."""
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r")) else value


def _parameter(value: float | str) -> float | str:
    if isinstance(value, str):
        return csv_cell(value.replace(",", ";"))
    return "" if math.isnan(value) else value


def _cell(value: Any) -> str:
    if isinstance(value, str):
        return csv_cell(value)
    return "" if math.isnan(value) else f"{value:.9g}"
