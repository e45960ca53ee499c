"""Read the samples of a profile from a CSV file: angles from the bottom of the hole, and values."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import angle_at
from fastpin.model.checks import as_toml, file_path, whole_number
from fastpin.model.csv_columns import CsvColumn, chosen_columns, column_choice, known_places, title_and_unit
from fastpin.model.csv_table import Wanted, read_table
from fastpin.model.load_units import Basis, LoadUnit, load_unit

ProfileKind = Literal["gap", "friction", "wear"]
"""What the values of a file are."""

COLUMNS = ("angles", "values")
"""Names of the columns of a profile."""

MOST_ROWS = 20_001
"""Most rows: the samples of a profile, and the first one again."""


def read_samples(
    path: str | Path,
    quantity: ProfileKind = "gap",
    basis: Basis = "per metre",
    columns: Mapping[str, Any] | None = None,
    skip: int = 0,
) -> tuple[np.ndarray, np.ndarray]:
    """Read angles, rad, and values, shape (n,) each, from a CSV file.

    `columns` chooses the columns of :data:`COLUMNS`. Without it the file has two columns with a header, each with a
    unit or without: degrees and m are meant then. The first `skip` lines are not read.

    Raises
    ------
    CaseFileError
        See :func:`fastpin.model.csv_table.read_table`.
    InputError
        If `path`, `columns` or `skip` can't be used.
    """
    place = file_path("path", path)
    if columns is not None and (not isinstance(columns, Mapping) or not set(columns) <= set(COLUMNS)):
        example = '{"angles": {"column": 1}, "values": {"column": "R", "unit": "um"}}'
        raise InputError("columns", f"must map angles and values to columns, such as {example}, not {as_toml(columns)}")
    choices = {name: column_choice(name, given) for name, given in (columns or {}).items()}
    for name in COLUMNS if choices else ():
        if len(choices[name].columns if name in choices else ()) != 1:
            raise InputError(name, 'must be a column of the CSV file, such as { column = "angle" } or { column = 1 }')
    _, (angles, values) = read_table(
        place,
        Wanted(
            find=(lambda titles: chosen_columns(titles, choices)) if choices else _two_columns,
            places=known_places(choices) if choices else (0, 1),
            unit=lambda name, unit: _unit(name, unit, quantity, basis),
            noun="samples",
            most=MOST_ROWS,
            too_many=f"more than {MOST_ROWS - 1:,} samples can't be read",
            has_gaps=False,
            example="angles = { column = 1 }",
        ),
        whole_number("skip", skip, 0),
    )
    return angle_at(angles), values


def _two_columns(titles: list[str]) -> list[CsvColumn]:
    if len(titles) != 2:
        words = f"a profile has two columns, an angle and a value, not {len(titles)}"
        raise InputError("", f"{words}; choose them: angles = {{ column = 1 }}, values = {{ column = 2 }}")
    if not any(titles):
        words = "the first line must name the columns; columns without names have numbers"
        raise InputError("", f"{words}: angles = {{ column = 1 }}, values = {{ column = 2 }}")
    parts = [title_and_unit(title) for title in titles]
    return [CsvColumn(k, COLUMNS[k], titles[k], unit=unit) for k, (_, unit) in enumerate(parts)]


def _unit(name: str, unit: str, quantity: ProfileKind, basis: Basis) -> LoadUnit:
    """Return the way of angles to degrees, or of values to SI units."""
    if name == "angles":
        if unit not in ("deg", "rad"):
            raise InputError(name, f"an angle must be in deg or rad, not {as_toml(unit)}")
        return LoadUnit(0, math.degrees(1.0)) if unit == "rad" else LoadUnit()
    if quantity == "friction" and unit not in ("-", "1"):
        raise InputError(name, f"friction has no unit; leave it out, not {as_toml(unit)}")
    if quantity == "wear" and unit != "1/Pa":
        raise InputError(name, f"a wear coefficient must be in 1/Pa, not {as_toml(unit)}")
    if quantity == "gap" and basis == "dimensionless":
        raise InputError(name, f"the gap of a problem with load_parameter has no unit; leave it out, not {unit}")
    return load_unit("ux", unit, basis) if quantity == "gap" else LoadUnit()
