"""Read the samples of a profile from a CSV file: angles from the bottom of the hole, and values."""

from __future__ import annotations

import csv
from io import StringIO
from pathlib import Path
from typing import Literal

import numpy as np

from fastpin.errors import CaseFileError, InputError
from fastpin.model.angles import angle_at
from fastpin.model.checks import as_toml, file_path, number, why_unreadable
from fastpin.model.csv_columns import title_and_unit
from fastpin.model.inputs import open_input
from fastpin.model.load_units import Basis, LoadUnit, load_unit

ProfileKind = Literal["gap", "friction", "wear"]
"""What the values of a file are."""


MOST_BYTES = 2_000_000
"""Most bytes of a file. 20,000 samples with all digits have 0.9 MB."""

MOST_ROWS = 20_001
"""Most rows: the samples of a profile, and the first one again."""

MOST_FAULTS = 20
"""Most faulty lines of a CSV file that an error lists."""


def read_samples(
    path: str | Path, quantity: ProfileKind = "gap", basis: Basis = "per metre"
) -> tuple[np.ndarray, np.ndarray]:
    """Read angles, rad, and values, shape (n,) each, from a CSV file with two columns.

    The first line names the columns, each with a unit or without: degrees and m are meant then. Cells are separated by
    commas, semicolons or tabs. Decimal commas are understood if the cells are not separated by commas.

    Raises
    ------
    CaseFileError
        If the file can't be read, is larger than :data:`MOST_BYTES`, or has faults. It lists them with their lines.
    InputError
        If `path` is no path.
    """
    place = file_path("path", path)
    try:
        with open_input(place) as file:
            raw = file.read(MOST_BYTES + 1)
        if len(raw) > MOST_BYTES:
            raise CaseFileError(str(place), [(0, f"is larger than {MOST_BYTES:,} bytes")])
        text = raw.decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise CaseFileError(str(place), [(0, why_unreadable(error))]) from None
    return _samples(text, str(place), quantity, basis)


def _samples(text: str, name: str, quantity: ProfileKind, basis: Basis) -> tuple[np.ndarray, np.ndarray]:
    lines = [
        (line_number, line)
        for line_number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise CaseFileError(name, [(0, "holds no samples")])
    if len(lines) > MOST_ROWS + 1:
        raise CaseFileError(name, [(lines[MOST_ROWS + 1][0], f"more than {MOST_ROWS - 1:,} samples can't be read")])
    (first, head), *rest = lines
    separator = next((sign for sign in "\t;" if sign in head), ",")
    try:
        units = _units(_cells(head, separator), quantity, basis)
    except InputError as error:
        raise CaseFileError(name, [(first, str(error) if error.field else error.reason)]) from None
    faults, rows = [], []
    for line_number, line in rest:
        try:
            cells = _cells(line, separator)
            row = []
            for title, cell in zip(units, cells, strict=True):
                text = cell if separator == "," else cell.replace(",", ".")
                if not _is_number(text):
                    raise InputError(title, f"must be a number, not {as_toml(cell)}")
                row.append(number(title, float(text)))
            rows.append(row)
        except InputError as error:
            faults.append((line_number, str(error)))
        except ValueError:
            faults.append((line_number, f"must have two numbers, an angle and a value, not {as_toml(line.strip())}"))
        if len(faults) >= MOST_FAULTS:
            break
    if faults or not rows:
        raise CaseFileError(name, faults or [(0, "holds no samples")])
    numbers, (angle, value) = np.array(rows), units.values()
    degrees = numbers[:, 0] if angle is None else np.degrees(numbers[:, 0])
    return angle_at(degrees), numbers[:, 1] * (10.0**value.power * value.factor if value else 1.0)


def _units(cells: list[str], quantity: ProfileKind, basis: Basis) -> dict[str, LoadUnit | None]:
    """The units of the two columns by their titles. The unit of angles is None for degrees."""
    if len(cells) != 2:
        raise InputError("", f"a profile has two columns, an angle and a value, not {len(cells)}")
    if all(_is_number(cell) for cell in cells):
        raise InputError("", "the first line must name the columns")
    (angle, angle_unit), (title, unit) = (title_and_unit(cell.strip()) for cell in cells)
    if angle_unit not in ("", "deg", "rad"):
        raise InputError(angle, f"an angle must be in deg or rad, not {as_toml(angle_unit)}")
    if quantity == "friction" and unit not in ("", "-", "1"):
        raise InputError(title, f"friction has no unit; leave it out, not {as_toml(unit)}")
    if quantity == "wear" and unit not in ("", "1/Pa"):
        raise InputError(title, f"a wear coefficient must be in 1/Pa, not {as_toml(unit)}")
    found = None
    if quantity == "gap" and unit:
        if basis == "dimensionless":
            raise InputError(title, f"the gap of a problem with load_parameter has no unit; leave it out, not {unit}")
        try:
            found = load_unit("ux", unit, basis)
        except InputError as error:
            raise InputError(title, error.reason) from None
    names = (angle or "angle", title or quantity)
    keys = names if names[0] != names[1] else ("angle", quantity)
    return dict(zip(keys, (None if angle_unit != "rad" else LoadUnit(), found), strict=True))


def _cells(line: str, separator: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader(StringIO(line), delimiter=separator, skipinitialspace=True))]
    except (csv.Error, StopIteration):
        return []


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text
