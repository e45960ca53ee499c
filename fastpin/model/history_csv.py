"""Read load corners from a CSV file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fastpin.errors import InputError
from fastpin.model.csv_columns import COUNT, ColumnChoice, chosen_columns, known_places, named_columns
from fastpin.model.csv_table import Wanted, read_table
from fastpin.model.load_units import Basis, LoadUnit, load_unit
from fastpin.model.loads import LOADS

MAX_ROWS = 10_000_000
"""Most corners of a CSV file or of a repeated block. Two loads and a thickness took 1.7 GB while they were read."""

MOST_COUNTED = 10_000
"""Most rows of a CSV file whose rows are run through several times. Each is a block of the history."""


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
    basis : {"per metre", "with thickness", "dimensionless"}
        Decides which units forces and moments may have.
    skip : int
        Lines at the beginning that are not read.

    Raises
    ------
    CaseFileError
        See :func:`fastpin.model.csv_table.read_table`; also if a count is not whole and positive.
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
            unit=lambda name, unit: LoadUnit() if name == COUNT else load_unit(name, unit, basis),
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
