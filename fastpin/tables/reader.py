"""Read columns of numbers from a CSV file, as programs, spreadsheets, test rigs and testers write them."""

from __future__ import annotations

import codecs
import csv
import math
import re
from array import array
from collections.abc import Callable, Iterator
from io import TextIOWrapper
from itertools import chain, islice
from pathlib import Path
from typing import NamedTuple, NoReturn, TextIO, TypeAlias

import numpy as np

from fastpin.errors import CaseFileError, InputError
from fastpin.model.checks import as_toml, count, number, why_unreadable
from fastpin.model.inputs import open_input
from fastpin.tables.columns import CsvColumn, with_unit_row
from fastpin.tables.load_units import LoadUnit, is_unit, unit_name

MOST_FAULTS = 20
"""Most faulty lines of a CSV file that an error lists."""

LONGEST_LINE = 1_000_000
"""Most characters of a line. A pipe of the shell may have no end of a line."""

MOST_AROUND, MOST_OF_A_ROW = 10_000_000, 400
"""Most characters of a CSV file: so many, and as many for each row. A corner of all loads needs some 250.

A file of blank lines and comments is refused soon in this way, and any file before 4 GB.
"""

SHORTEST_LINE = 100
"""Characters that a line counts at least: reading a line takes as long as some 100 characters."""

MOST_HEAD = 60
"""Lines in which the header, or the first row of numbers, is looked for. A tester's preamble has some 10 to 40."""

MOST_COUNT = 1e8
"""Largest count of a row: the corners of a history are at most so many."""

BATCH = 5_000
"""Lines that are read at once. Larger batches are no faster."""

THOUSANDS = r"[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?"
"""A number whose commas may separate thousands."""

CP1252 = "fastpin.cp1252"
"""The handler of bytes that are no UTF-8: they are letters of Windows' cp1252, such as the µ of older spreadsheets."""


Line: TypeAlias = tuple[int, str]
"""A line and its number."""

Splits: TypeAlias = list[tuple[str, list[str]]]
"""The separators that a line may have, each with the cells of the line."""


def _as_cp1252(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeDecodeError) or not error.encoding.startswith("utf-8"):
        raise error
    try:
        return error.object[error.start : error.end].decode("cp1252"), error.end
    except UnicodeDecodeError:
        raise error from None


codecs.register_error(CP1252, _as_cp1252)


class Wanted(NamedTuple):
    """The columns that are read, and what their rows are.

    Attributes
    ----------
    find : callable
        Returns the columns from the titles of all columns. An :class:`InputError` says why there are none.
    places : tuple of int or None
        Places of the columns in a line, if all of them are known by number. A file without a header has empty titles.
    unit : callable
        Returns the way to SI units from the name of a column and a unit, which is empty where the file says none. An
        :class:`InputError` names allowed units.
    noun : str
        The rows in messages, such as "load corners".
    most : int
        Most rows.
    too_many : str
        The message for more.
    has_gaps : bool
        Whether a cell may be empty.
    example : str
        A column that is chosen by its number.
    counts : str
        Name of the column whose numbers are counts: whole and positive.
    """

    find: Callable[[list[str]], list[CsvColumn]]
    places: tuple[int, ...] | None
    unit: Callable[[str, str], LoadUnit]
    noun: str
    most: int
    too_many: str
    has_gaps: bool
    example: str
    counts: str = ""


def read_table(path: Path, wanted: Wanted, skip: int = 0) -> tuple[list[CsvColumn], list[np.ndarray]]:
    """Read the wanted columns, and their numbers in SI units, shape (rows,) each. Empty cells are NaN.

    The first `skip` lines are not read. A preamble needs no `skip`: the header is the first line that has the wanted
    columns, and columns with numbers begin with the first row of numbers.

    Raises
    ------
    CaseFileError
        With the first :data:`MOST_FAULTS` faulty lines, or with the fault of the header. Also if the file can't be
        read, has too many rows, or too many characters for its rows.
    """
    try:
        with open_input(path) as raw:
            is_wide = raw.peek(2)[:2] in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
            encoding = "utf-16" if is_wide else "utf-8-sig"
            with TextIOWrapper(raw, encoding, errors=CP1252, newline="") as file:
                table = _Reading(str(path), wanted)
                lines = table.lines(file, skip)
                lines = chain(table.read_head(list(islice(lines, MOST_HEAD))), lines)
                table.read_rows(islice(lines, MOST_HEAD))  # they show the kind of the numbers
                while table.read_rows(islice(lines, BATCH)):
                    pass
                return table.columns, table.numbers()
    except (OSError, UnicodeError, csv.Error) as error:
        raise CaseFileError(str(path), [(0, why_unreadable(error))]) from None


class _Reading:
    """The rows of a file so far."""

    def __init__(self, name: str, wanted: Wanted) -> None:
        self.columns: list[CsvColumn] = []
        self._name, self._wanted = name, wanted
        self._units: list[LoadUnit] = []
        self._numbers: list[array[float]] = []  # they grow in place, and become the result without a copy
        self._faults: list[tuple[int, str]] = []
        self._separator, self._is_separator_given = "", False
        self._width = self._seen = self._empty_rows = 0
        # The first lines with a decimal point, a decimal comma, and a comma that may separate thousands.
        self._point_line = self._comma_line = self._thousands_line = 0
        self._commas_are_sure = False

    def lines(self, file: TextIO, skip: int) -> Iterator[Line]:
        """Yield the lines with their numbers, without comments and blank lines. Too many of them are refused."""
        size = 0
        for line_number, line in enumerate(iter(lambda: file.readline(LONGEST_LINE + 1), ""), start=1):
            size += max(len(line), SHORTEST_LINE)
            if len(line) > LONGEST_LINE:
                self._refuse(line_number, f"the line is longer than {LONGEST_LINE:,} characters")
            if size > MOST_AROUND + MOST_OF_A_ROW * self._seen:
                self._refuse(
                    line_number, f"the lines up to here are too long or too many for their {self._wanted.noun}"
                )
            excel = re.fullmatch(r'"?sep=(.)"?\s*', line, re.IGNORECASE) if line_number == 1 else None
            if excel:
                self._separator, self._is_separator_given = excel[1], True
            elif line_number > skip and (bare := line.lstrip()) and bare[0] != "#":
                if self._seen >= self._wanted.most:
                    self._refuse(line_number, self._wanted.too_many)
                self._seen += 1
                yield line_number, line

    def read_head(self, head: list[Line]) -> list[Line]:
        """Find the columns in the first lines, and return the lines of rows among them."""
        if not head:
            self._refuse(0, f"holds no {self._wanted.noun}")
        splits = [self._splits(line) for _, line in head]
        places = self._wanted.places
        # A row has numbers alone; or, with times and words in further columns, numbers at the known places.
        least = max(places or [0])
        known = [(k, *each) for k, tried in enumerate(splits) for each in tried if least < len(each[1])]
        rows = [each for each in known if _are_numbers(each[2])]
        if not rows and places is not None:
            rows = [each for each in known if _are_numbers([each[2][place] for place in places])]
        first, separator, cells = rows[0] if rows else (len(head), "", [])
        found = self._numbered if places is not None else self._named
        begin = found(head, splits, first, separator, len(cells))
        self._numbers = [array("d") for _ in self.columns]
        self._seen -= begin
        return head[begin:]

    def _named(self, head: list[Line], splits: list[Splits], first: int, separator: str, width: int) -> int:
        """Take the first line that has all columns as header. Return the place of the line behind header and units."""
        faults: list[tuple[bool, int, str]] = []
        for place, (line_number, _) in enumerate(head):
            for sign, cells in splits[place]:
                while len(cells) > 1 and not cells[-1]:
                    cells.pop()
                try:
                    self._set(cells, self._wanted.find(cells), sign)
                except InputError as error:
                    is_near = place < first and len(cells) == width and not _has_unit(cells)
                    faults.append((is_near, line_number, str(error) if error.field else error.reason))
                else:
                    return place + 1 + any(self._has_units(*each) for each in head[place + 1 : place + 2])
        if first == 0:
            words = "the first line must name the columns, and not begin with #; columns without names have numbers"
            self._refuse(head[0][0], f"{words}: {self._wanted.example}")
        # The columns that are meant stand in the last line that has as many cells as the numbers.
        near = [fault for fault in faults if fault[0]] or faults[:1]
        _, line_number, words = max(near, key=lambda fault: fault[1])
        line = dict(head)[line_number]
        if "\t" in line and ";" in line:
            words = "the header has tabs and semicolons; separate the cells by one of them"
        return self._refuse(line_number, words)

    def _numbered(self, head: list[Line], splits: list[Splits], first: int, separator: str, width: int) -> int:
        """Take up to two lines before the row `first` as header and units, if they have as many cells."""
        if not width:  # the first line is the header, and no line behind it is in order
            first, (separator, cells) = 1, splits[0][0]
            width = len(cells)
        lines = zip(head[max(first - 2, 0) : first], splits[max(first - 2, 0) : first], strict=True)
        before = {
            line_number: cells
            for (line_number, _), tried in lines
            for sign, cells in tried
            if sign == separator and len(cells) == width
        }
        has_units = bool(before) and _has_unit([*before.values()][-1])
        titles = [*before.items()][: len(before) - has_units][-1:]
        line_number = titles[0][0] if titles else head[min(first, len(head) - 1)][0]
        is_sure = separator != "," or self._is_separator_given or bool(titles)
        if not is_sure and re.fullmatch(r"\s*[+-]?\d+,\d+\s*", head[first][1]):
            words = "the comma may separate columns or be a decimal comma; write a first line sep=, or sep=;"
            self._refuse(line_number, words)
        try:
            cells = titles[0][1] if titles else [""] * width
            self._set(cells, self._wanted.find(cells), separator)
        except InputError as error:
            self._refuse(line_number, str(error) if error.field else error.reason)
        if has_units:
            self._has_units(*head[first - 1])
        return first

    def _splits(self, line: str) -> Splits:
        """Return the separators that a line may have, each with the cells of the line."""
        outside_quotes = re.sub(r'"[^"]*"', "", line)
        signs = [self._separator] if self._is_separator_given else [sign for sign in "\t;" if sign in outside_quotes]
        found = [(sign, _cells(line, sign)) for sign in signs or [","]]
        if not signs and re.search(r"\S\s+\S", line):
            wide = re.split(r"\s{2,}", line.strip())
            words = re.findall(r'"[^"]*"|[^\s"\[(]+(?: ?[\[(][^\])]{0,30}[\])])?', line)
            found += [(" ", [cell.strip('"') for cell in cells]) for cells in (wide, words) if len(cells) > 1]
        return found

    def _set(self, titles: list[str], columns: list[CsvColumn], separator: str) -> None:
        """Set the columns and the ways to SI units. An :class:`InputError` names a wrong unit."""
        units = []
        for column in columns:
            try:
                unit = self._wanted.unit(column.name, column.unit)
                zero = unit.zero if column.zero is None else column.zero
                if math.isnan(zero):
                    words = f"a column in {column.unit} needs its zero, the temperature at which the clearance is given"
                    raise InputError(column.name, f"{words}, such as zero = 20")
                zero *= 10.0**unit.power
                units.append(unit._replace(factor=column.scale * unit.factor, zero=zero))
            except InputError as error:
                raise InputError(column.name, f"{error.reason}{column.named}") from None
        self.columns, self._units, self._separator, self._width = columns, units, separator, len(titles)

    def _has_units(self, line_number: int, line: str) -> bool:
        """Whether the line below the header has units of the columns, which are then set."""
        cells = _cells(line, self._separator)
        if len(cells) < self._width or not _has_unit([cells[column.place] for column in self.columns]):
            return False
        try:
            self._set(cells[: self._width], with_unit_row(self.columns, cells), self._separator)
        except InputError as error:
            self._refuse(line_number, str(error))
        return True

    def read_rows(self, lines: Iterator[Line]) -> bool:
        """Read some rows, and return whether there were any. Many faults end the reading."""
        rows = list(lines)
        if rows and not self._read_plain([line for _, line in rows]):
            for line_number, line in rows:
                self._read_row(line_number, line)
                if len(self._faults) >= MOST_FAULTS:
                    self._faults.append((line_number, "that is enough; what follows was not read"))
                    raise CaseFileError(self._name, self._faults)
        return bool(rows)

    def _read_plain(self, lines: list[str]) -> bool:
        """Read rows of a known form column by column, several times as fast. Return False if a row has another form."""
        text = "".join(lines)
        has_commas = "," in text and self._separator != ","
        is_known = self._commas_are_sure and "." not in text if has_commas else self._point_line or "." not in text
        if not is_known or self._wanted.counts or '"' in text or "_" in text:
            return False
        sign, comma = None if self._separator == " " else self._separator, "," if has_commas else "."
        rows = [line.rstrip("\r\n").replace(comma, ".").split(sign) for line in lines]
        if {len(row) for row in rows} != {self._width}:
            return False
        cells, numbers = list(zip(*rows, strict=True)), []
        try:
            for column, unit in zip(self.columns, self._units, strict=True):
                end = f"e{unit.power}" if unit.power else ""
                values = np.array([float(cell + end) for cell in cells[column.place]])
                numbers.append((values - unit.zero) * unit.factor)
        except ValueError:
            return False
        if not np.isfinite(numbers).all():
            return False
        for kept, read in zip(self._numbers, numbers, strict=True):
            kept.frombytes(read.tobytes())
        self._empty_rows = 0
        return True

    def _read_row(self, line_number: int, line: str) -> None:
        cells = _cells(line, self._separator)
        # Spreadsheets write separators behind the cells of the header.
        if len(cells) != self._width and (len(cells) < self._width or any(cells[self._width :])):
            first = "header" if any(column.title for column in self.columns) else "first row"
            words = f"the line has {len(cells)} cell{'s' * (len(cells) != 1)}, the {first} has {self._width}"
            if self._separator == "," and len(cells) == 2 * self._width:
                words += "; with decimal commas the cells must be separated by semicolons or tabs"
            self._faults.append((line_number, words))
            return
        is_blank = not any(cells)
        self._empty_rows = self._empty_rows + 1 if is_blank else 0
        for kept, column, unit in zip(self._numbers, self.columns, self._units, strict=True):
            cell, value = cells[column.place], math.nan
            try:
                is_count = column.name == self._wanted.counts
                if cell or not (is_blank or (self._wanted.has_gaps and not is_count)):
                    text = self._with_point(line_number, column.name, cell)
                    if unit.power:  # the exponent is moved in the text: 1.005 kN are exactly 1005 N
                        digits, _, exponent = text.lower().partition("e")
                        text = f"{digits}e{int(exponent or 0) + unit.power}"
                    value = number(column.name, (float(text) - unit.zero) * unit.factor)
                    if "_" in cell:
                        raise ValueError
                    value = count(column.name, value, MOST_COUNT) if is_count else value
            except InputError as error:
                self._faults.append((line_number, f"{error}{column.named}"))
            except ValueError:
                words = f"{column.name}: must be a number, not {as_toml(cell)}{column.named}"
                self._faults.append((line_number, words))
            kept.append(value)

    def _with_point(self, line_number: int, name: str, cell: str) -> str:
        """The text of a number with a decimal point. The cell may have a decimal comma, as all or none of the file."""
        if "," not in cell:
            if "." in cell:
                self._point_line = self._point_line or line_number
        elif self._separator == "," and not self._comma_line and re.fullmatch(THOUSANDS, cell):  # in quotes
            self._thousands_line = self._thousands_line or line_number
            if "." in cell or cell.count(",") > 1:
                self._point_line = self._point_line or line_number
            return cell.replace(",", "")
        elif cell.count(",") > 1 or "." in cell:
            raise InputError(name, f"thousands must not be separated: write 1234.5, not {as_toml(cell)}")
        else:
            self._comma_line = self._comma_line or line_number
            self._commas_are_sure |= self._separator == ";" or not re.fullmatch(THOUSANDS, cell)
        if self._point_line and self._comma_line:
            first, last = sorted((self._point_line, self._comma_line))
            signs = ("comma", "point") if last == self._comma_line else ("point", "comma")
            words = f"a number has a decimal {signs[0]}, and one in line {first} a decimal {signs[1]}"
            raise CaseFileError(self._name, [(line_number, f"{words}; write one of them in the whole file")])
        return cell.replace(",", ".")

    def numbers(self) -> list[np.ndarray]:
        """The numbers of each column, without the empty rows at the end."""
        if line := (not self._commas_are_sure and self._comma_line) or (not self._point_line and self._thousands_line):
            words = "the comma of each number may be a decimal comma or separate thousands; write decimal points"
            self._faults.append((line, words))
        if self._faults:
            raise CaseFileError(self._name, self._faults)
        for kept in self._numbers:
            del kept[len(kept) - self._empty_rows :]
        if not self._numbers[0]:
            self._refuse(0, f"holds no {self._wanted.noun}")
        return [np.frombuffer(kept) for kept in self._numbers]

    def _refuse(self, line_number: int, words: str) -> NoReturn:
        raise CaseFileError(self._name, [(line_number, words)])


def _cells(line: str, separator: str) -> list[str]:
    """Return the cells of a line, without blanks around them."""
    blank = separator != "\t"
    return [
        cell.strip() for cell in next(csv.reader([line.strip(" \r\n")], delimiter=separator, skipinitialspace=blank))
    ]


def _has_unit(cells: list[str]) -> bool:
    return any(is_unit(unit_name(cell)) for cell in cells)


def _are_numbers(cells: list[str]) -> bool:
    """Whether cells are numbers, or some of them and empty cells."""
    try:
        return bool([float(cell.replace(",", "")) for cell in cells if cell])
    except ValueError:
        return False
