"""Read load corners from a CSV file, as programs, spreadsheets and test rigs write them."""

from __future__ import annotations

import csv
import math
import re
from array import array
from collections.abc import Iterator, Mapping
from io import TextIOWrapper
from pathlib import Path
from typing import NoReturn, TextIO

import numpy as np

from fastpin.errors import CaseFileError, InputError
from fastpin.model.checks import as_toml, number, why_unreadable
from fastpin.model.csv_columns import ColumnChoice, CsvColumn, chosen_columns, named_columns, with_unit_row
from fastpin.model.inputs import open_input
from fastpin.model.load_units import Basis, is_unit, unit_name
from fastpin.model.loads import LOADS
from fastpin.model.profile_csv import MOST_FAULTS

LONGEST_LINE = 1_000_000
"""Most characters of a line. A pipe of the shell may have no end of a line."""

MAX_ROWS = 10_000_000
"""Most corners of a CSV file or of a repeated block. They are held in memory: 0.7 GB."""

MOST_AROUND, MOST_OF_A_CORNER = 10_000_000, 400
"""Most characters of a CSV file: so many, and as many for each corner. A corner of all loads needs some 250.

A file of blank lines and comments is refused soon in this way, and any file before 4 GB.
"""

SHORTEST_LINE = 100
"""Characters that a line counts at least: reading a line takes as long as some 100 characters."""


def read_corners(path: Path, choices: Mapping[str, ColumnChoice] | None, basis: Basis) -> np.ndarray:
    """Read the corners of a CSV file, shape (corners, loads). Empty cells are NaN.

    Parameters
    ----------
    path : Path
    choices : mapping of ColumnChoice or None
        The column of each load. Other columns are not read. Without `choices` every column is a load.
    basis : {"per metre", "with thickness", "dimensionless"}
        Decides which units forces and moments may have.

    Raises
    ------
    CaseFileError
        With the first :data:`MOST_FAULTS` faulty lines, or with the fault of the header. Also if the file can't be
        read, has more than :data:`MAX_ROWS` corners, or too many characters for its corners.
    """
    try:
        with TextIOWrapper(open_input(path), encoding="utf-8-sig", newline="") as file:
            rows, is_head = _Rows(str(path), basis), True
            lines = (each for each in _lines(file, str(path), rows.numbers) if not _is_skipped(each[1]))
            for line_number, line in lines:
                rows.read_header(line_number, line, choices)
                break
            for line_number, line in lines:
                if not is_head or not rows.read_units(line_number, line):
                    rows.read(line_number, line)
                is_head = False
                if len(rows.faults) >= MOST_FAULTS:
                    rows.faults.append((line_number, "that is enough; what follows was not read"))
                    break
            return rows.table()
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise CaseFileError(str(path), [(0, why_unreadable(error))]) from None


class _Rows:
    """The rows of a file so far.

    Attributes
    ----------
    numbers : array
        The loads of all corners. It grows in place, and becomes the table without a copy.
    faults : list of (int, str)
        Line and sentence of each fault.
    """

    def __init__(self, name: str, basis: Basis) -> None:
        self.numbers = array("d")
        self.faults: list[tuple[int, str]] = []
        self._name = name
        self._basis = basis
        self._columns: list[CsvColumn] = []
        self._read: list[tuple[int, int, int, float]] = []  # cell, load, power of ten and factor of each column
        self._empty_row = array("d", [math.nan] * len(LOADS))
        self._width = 0
        self._separator = ","
        self._empty_rows = 0
        self._point_line = self._comma_line = 0
        self._commas_are_sure = False

    def read_header(self, line_number: int, line: str, choices: Mapping[str, ColumnChoice] | None) -> None:
        """Read the names of the columns. Cells are separated by the tabs, semicolons or commas of the header."""
        outside_quotes = re.sub(r'"[^"]*"', "", line)
        found = [sign for sign in "\t;" if sign in outside_quotes]
        if len(found) > 1:
            self._refuse(line_number, "the header has tabs and semicolons; separate the cells by one of them")
        self._separator = found[0] if found else ","
        cells = self._cells(line)
        while len(cells) > 1 and not cells[-1].strip():
            cells.pop()
        self._width = len(cells)
        if all(_is_number(cell) for cell in cells):
            self._refuse(line_number, "the first line must name the columns, and not begin with #")
        try:
            self._set_columns(named_columns(cells) if choices is None else chosen_columns(cells, choices))
        except InputError as error:
            self._refuse(line_number, str(error) if error.field else error.reason)

    def read_units(self, line_number: int, line: str) -> bool:
        """Read the units of the line below the header, and return whether it has any."""
        cells = self._cells(line)
        given = [cells[column.place].strip() for column in self._columns if column.place < len(cells)]
        if len(cells) < self._width or not any(is_unit(unit_name(cell)) for cell in given):
            return False
        try:
            self._set_columns(with_unit_row(self._columns, cells))
        except InputError as error:
            self._refuse(line_number, str(error))
        return True

    def read(self, line_number: int, line: str) -> None:
        """Read a corner."""
        # A line without quotes is split here: csv.reader takes longer. float() takes blanks around a number.
        cells = line.split(self._separator) if '"' not in line else self._cells(line)
        # Spreadsheets write separators behind the cells of the header.
        if len(cells) != self._width and (len(cells) < self._width or any(map(str.strip, cells[self._width :]))):
            words = f"the line has {len(cells)} cell{'s' * (len(cells) != 1)}, the header has {self._width}"
            if self._separator == "," and len(cells) == 2 * self._width:
                words += "; with decimal commas the cells must be separated by semicolons or tabs"
            self.faults.append((line_number, words))
            return
        numbers = self.numbers
        numbers.extend(self._empty_row)
        is_empty = True
        for place, load, power, factor in self._read:
            cell = cells[place]
            if not cell or cell.isspace():
                continue
            is_empty = False
            try:
                text = cell if self._separator == "," else self._with_point(line_number, LOADS[load], cell)
                if power:  # the exponent is moved in the text: 1.005 kN are exactly 1005 N
                    digits, _, exponent = text.strip().lower().partition("e")
                    text = f"{digits}e{int(exponent or 0) + power}"
                value = float(text) * factor
                if "_" in cell:
                    raise ValueError
                numbers[load] = value if value - value == 0.0 else number(LOADS[load], value)
            except CaseFileError:  # the whole file is refused
                raise
            except InputError as error:
                self._add(line_number, place, str(error))
            except ValueError:
                words = f"{LOADS[load]}: must be a number, not {as_toml(cell.strip())}"
                self._add(line_number, place, words)
        is_blank = is_empty and not any(cell.strip() for cell in cells)
        self._empty_rows = self._empty_rows + 1 if is_blank else 0

    def table(self) -> np.ndarray:
        """The corners, shape (corners, loads), without the empty lines at the end."""
        if not self._commas_are_sure and self._comma_line and self._separator == "\t":
            words = "the comma of each number may be a decimal comma or separate thousands; write decimal points"
            self.faults.append((self._comma_line, words))
        if self.faults:
            raise CaseFileError(self._name, self.faults)
        del self.numbers[len(self.numbers) - self._empty_rows * len(LOADS) :]
        if not self.numbers:
            self._refuse(0, "holds no load corners")
        return np.frombuffer(self.numbers).reshape(-1, len(LOADS))

    def _set_columns(self, columns: list[CsvColumn]) -> None:
        self._columns = columns
        self._read = []
        for column in columns:
            unit = column.conversion(self._basis)
            self._read.append((column.place, LOADS.index(column.load) - len(LOADS), unit.power, unit.factor))

    def _cells(self, line: str) -> list[str]:
        return next(csv.reader([line], delimiter=self._separator, skipinitialspace=self._separator != "\t"))

    def _with_point(self, line_number: int, field: str, cell: str) -> str:
        """The text of a number with a decimal point. The cell may have a decimal comma, as all or none of the file."""
        if "," not in cell:
            if "." in cell:
                self._point_line = self._point_line or line_number
        elif cell.count(",") > 1 or "." in cell:
            raise InputError(field, f"thousands must not be separated: write 1234.5, not {as_toml(cell.strip())}")
        else:
            self._comma_line = self._comma_line or line_number
            thousands = re.fullmatch(r"[+-]?[1-9]\d{0,2},\d{3}", cell.strip())  # 1,234: the comma may separate them
            self._commas_are_sure = self._commas_are_sure or not thousands
        if self._point_line and self._comma_line:
            first, last = sorted((self._point_line, self._comma_line))
            words = (
                f"a number has a decimal {'comma' if last == self._comma_line else 'point'}, and one in line {first} "
            )
            words += (
                f"a decimal {'point' if last == self._comma_line else 'comma'}; write one of them in the whole file"
            )
            self._refuse(line_number, words)
        return cell.replace(",", ".")

    def _add(self, line_number: int, place: int, words: str) -> None:
        """Add a fault of a cell. It ends with the column, if this is not simply the name of the load."""
        column = next(column for column in self._columns if column.place == place)
        self.faults.append((line_number, f"{words}{column.named}"))

    def _refuse(self, line_number: int, words: str) -> NoReturn:
        raise CaseFileError(self._name, [(line_number, words)])


def _is_number(text: str) -> bool:
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


def _lines(file: TextIO, name: str, numbers: array[float]) -> Iterator[tuple[int, str]]:
    """Yield the lines with their numbers, as long as the `numbers` that were read from them allow more."""
    size = allowed = 0
    for line_number, line in enumerate(iter(lambda: file.readline(LONGEST_LINE + 1), ""), start=1):
        size += max(len(line), SHORTEST_LINE)
        fault = ""
        if size > allowed:
            corners = len(numbers) // len(LOADS)
            allowed = MOST_AROUND + MOST_OF_A_CORNER * corners
            if size > allowed:
                fault = f"the lines up to here are too long or too many for {corners:,} corners"
        if len(line) > LONGEST_LINE:
            fault = f"the line is longer than {LONGEST_LINE:,} characters"
        elif len(numbers) >= len(LOADS) * MAX_ROWS and not _is_skipped(line):
            fault = f"more than {MAX_ROWS:,} corners can't be read; repeat a shorter file in a case file"
        if fault:
            raise CaseFileError(name, [(line_number, fault)])
        yield line_number, line


def _is_skipped(line: str) -> bool:
    """Whether a line is blank or a comment."""
    return not line.strip() or line.lstrip().startswith("#")
