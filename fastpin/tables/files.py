"""Load histories, and the samples of profiles, from CSV files."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import angle_at
from fastpin.model.checks import as_toml, choice, file_path, instance, whole_number
from fastpin.model.history import Block, LoadHistory
from fastpin.model.loads import LOADS
from fastpin.model.profile import ProfileKind
from fastpin.model.recorded import recorded_cycles
from fastpin.tables.columns import (
    COUNT,
    ColumnChoice,
    CsvColumn,
    chosen_columns,
    column_choice,
    known_places,
    named_columns,
    title_and_unit,
)
from fastpin.tables.load_units import IN_SI, Basis, LoadUnit, load_unit, plain_unit
from fastpin.tables.reader import Wanted, read_table

MAX_ROWS = 10_000_000
"""Most corners of a CSV file or of a repeated block. Two loads and a thickness took 1.7 GB while they were read."""

MOST_COUNTED = 10_000
"""Most rows of a CSV file whose rows are run through several times. Each is a block of the history."""

COLUMNS = ("angles", "values")
"""Names of the columns of a profile."""

MOST_SAMPLES = 20_001
"""Most rows: the samples of a profile, and the first one again."""


def history_from_csv(
    path: Path, choices: Mapping[str, ColumnChoice] | None = None, basis: Basis = IN_SI, skip: int = 0
) -> LoadHistory:
    """Read a history as :meth:`fastpin.LoadHistory.from_csv`. Its forces are per metre, or in N, as `basis` says."""
    return LoadHistory.of_blocks(
        replace(Block.plain(rows), count=n, cycle=True) if n else Block(rows, *recorded_cycles(rows))
        for rows, n in read_corners(path, choices, basis, skip)
    )


def read_corners(
    path: Path, choices: Mapping[str, ColumnChoice] | None, basis: Basis, skip: int = 0
) -> list[tuple[np.ndarray, int]]:
    """Read blocks of corners from a CSV file, shape (corners, loads), each with its count: 0 if the file has none.

    Empty cells are NaN. Each row has as many corners as a load has columns: one, or two. With counts it is a block.

    Parameters
    ----------
    path : Path
    choices : mapping of ColumnChoice or None
        The column of each load, and of counts. Other columns are not read. Without `choices` every column is a
        load.
    basis : Basis
        Decides which units forces and moments may have, and those of numbers without a unit.
    skip : int
        Lines at the beginning that are not read.

    Raises
    ------
    CaseFileError
        See :func:`fastpin.tables.reader.read_table`; also if a count is not whole and positive.
    InputError
        If there are counts, and no load has two columns.
    """
    chosen = choices or {}
    most = MOST_COUNTED if COUNT in chosen else MAX_ROWS
    columns, numbers = read_table(
        path,
        Wanted(
            find=(lambda titles: chosen_columns(titles, chosen)) if chosen else named_columns,
            places=known_places(chosen) if chosen else None,
            unit=lambda name, unit: load_unit(name, unit, basis),
            noun="load corners",
            most=most,
            too_many=f"more than {most:,} corners can't be read; repeat a shorter file in a case file",
            has_gaps=True,
            example="P = { column = 1 }",
            counts=COUNT if COUNT in chosen else "",
        ),
        skip,
    )
    names, rows = [column.name for column in columns], len(numbers[0])
    size = max(map(names.count, names))
    if COUNT in names and size == 1:
        raise InputError(COUNT, 'needs a load with two columns, such as P = { column = ["max", "min"] }')
    corners = np.full((size * rows, len(LOADS)), np.nan)
    for load in set(names) - {COUNT}:
        given = [column for name, column in zip(names, numbers, strict=True) if name == load]
        for place in range(size):
            corners[place::size, LOADS.index(load)] = given[place % len(given)]
    if COUNT not in names:
        return [(corners, 0)]
    counts = numbers[names.index(COUNT)].astype(int).tolist()
    return list(zip(np.split(corners, rows), counts, strict=True))


def read_samples(
    path: str | Path,
    quantity: ProfileKind = "gap",
    basis: Basis = IN_SI,
    columns: Mapping[str, Any] | None = None,
    skip: int = 0,
) -> tuple[np.ndarray, np.ndarray]:
    """Read angles, rad, and values, shape (n,) each, from a CSV file.

    `columns` chooses the columns of :data:`COLUMNS`. Without it the file has two columns with a header, each with a
    unit or without: degrees and the unit of the `basis` are meant then. The first `skip` lines are not read.

    Raises
    ------
    CaseFileError
        See :func:`fastpin.tables.reader.read_table`.
    InputError
        If `path`, `quantity`, `basis`, `columns` or `skip` can't be used.
    """
    place = file_path("path", path)
    instance("basis", basis, Basis, "a Basis")
    choice("quantity", quantity, get_args(ProfileKind))
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
            most=MOST_SAMPLES,
            too_many=f"more than {MOST_SAMPLES - 1:,} samples can't be read",
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
    """Return the way of angles to degrees, or of values to SI units. An empty unit is that of the basis."""
    if name == "angles":
        if unit not in ("deg", "rad", ""):
            raise InputError(name, f"an angle must be in deg or rad, not {as_toml(unit)}")
        return LoadUnit(0, math.degrees(1.0)) if unit == "rad" else LoadUnit()
    if not unit:
        return plain_unit({"gap": "displacement", "wear": "wear coefficient"}.get(quantity, ""), basis)
    if quantity == "friction" and unit not in ("-", "1"):
        raise InputError(name, f"friction has no unit; leave it out, not {as_toml(unit)}")
    if quantity == "wear" and unit != "1/Pa":
        raise InputError(name, f"a wear coefficient must be in 1/Pa, not {as_toml(unit)}")
    if quantity == "gap" and basis.how == "dimensionless":
        raise InputError(name, f"the gap of a problem with load_parameter has no unit; leave it out, not {unit}")
    return load_unit("ux", unit, basis) if quantity == "gap" else LoadUnit()
