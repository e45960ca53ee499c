"""Read load corners from a CSV file."""

from __future__ import annotations

import csv
import math
import re
from array import array
from collections.abc import Iterator
from typing import TextIO

import numpy as np

from fastpin.errors import CaseFileError, InputError
from fastpin.model.checks import as_toml, number
from fastpin.model.loads import LOADS, load_index

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

MOST_FAULTS = 20
"""Most faulty lines of a CSV file that an error lists."""


def read_corners(file: TextIO, name: str) -> np.ndarray:
    """Read the corners of the open CSV file `name`, shape (corners, loads). Empty cells are NaN.

    Raises
    ------
    CaseFileError
        With the first :data:`MOST_FAULTS` faulty lines, or with the fault of the header. Also if the file has more than
        :data:`MAX_ROWS` corners, or too many characters for its corners.
    """
    faults: list[tuple[int, str]] = []
    header: list[int] | None = None
    numbers = array("d")  # grows in place, and becomes the table without a copy
    empty_row = array("d", [math.nan] * len(LOADS))
    for line_number, line in _lines(file, name, numbers):
        if _is_skipped(line):
            continue
        cells = next(csv.reader([line], skipinitialspace=True))
        if header is None:
            if len(cells) == 1 and (separator := re.search(r"[;\t]", line)):
                name_of = {";": "semicolons", "\t": "tabs"}[separator[0]]
                raise CaseFileError(name, [(line_number, f"cells must be separated by commas, not {name_of}")])
            try:
                header = [load_index(cell.strip(), f"column {k}") for k, cell in enumerate(cells, start=1)]
            except InputError as error:
                raise CaseFileError(name, [(line_number, str(error))]) from None
            if len(set(header)) < len(header):
                raise CaseFileError(name, [(line_number, "a load is named twice")])
            continue
        if len(cells) != len(header):
            faults.append(
                (line_number, f"the line has {len(cells)} cell{'s' * (len(cells) > 1)}, the header has {len(header)}")
            )
        else:
            numbers.extend(empty_row)
            for index, cell in zip(header, cells, strict=True):
                if cell and not cell.isspace():
                    try:
                        numbers[index - len(LOADS)] = number(LOADS[index], float(cell.replace("_", "x")))
                    except InputError as error:
                        faults.append((line_number, str(error)))
                    except ValueError:
                        faults.append((line_number, f"{LOADS[index]}: must be a number, not {as_toml(cell.strip())}"))
        if len(faults) >= MOST_FAULTS:
            faults.append((line_number, "that is enough; what follows was not read"))
            break
    if faults:
        raise CaseFileError(name, faults)
    if not numbers:
        raise CaseFileError(name, [(0, "holds no load corners")])
    return np.frombuffer(numbers).reshape(-1, len(LOADS))


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
