"""Tables of text."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

MAX_ROWS = 40
"""Most lines of a printed table, below its head."""

LEAST_REPEATED = 3
"""Least rows that one line replaces: of fewer rows the table is as short."""

LONGEST_PERIOD = 1_000
"""Most rows of a period that is looked for: a table of more rows is cut before it repeats itself."""

Column = tuple[str, str, list[str]]
"""A column of a table: its name, its unit and its cells."""


class Repeat(NamedTuple):
    """A line for rows that repeat the rows before: `times` times the `period` rows that end before the row `first`."""

    first: int
    period: int
    times: int

    @property
    def end(self) -> int:
        """The row after the repeats."""
        return self.first + self.times * self.period


class LeftOut(NamedTuple):
    """A line for so many `rows` that are not printed."""

    rows: int


TableLine = int | Repeat | LeftOut
"""A line of a table: the number of a row from 0, or a line for several rows."""


def visible_rows(count: int) -> list[int]:
    """Return the indices of the rows to print of `count`: all, or of a long table the first and the last ones."""
    return printed_rows(cut_lines(count))


def printed_rows(lines: Iterable[TableLine]) -> list[int]:
    """Return the rows that have a line of their own."""
    return [line for line in lines if isinstance(line, int)]


def cut_lines(count: int, hidden: int = 0) -> list[TableLine]:
    """Return the lines of a table of `count` rows, and of `hidden` rows that are missing in their middle.

    Of more than :data:`MAX_ROWS` rows the first and the last ones are printed.
    """
    first = last = MAX_ROWS // 2
    if count <= MAX_ROWS:
        first, last = (count // 2, count - count // 2) if hidden else (count, 0)
    left_out = hidden + count - first - last
    return [*range(first), *([LeftOut(left_out)] if left_out else []), *range(count - last, count)]


def folded_lines(rows: np.ndarray) -> list[TableLine]:
    """Return the lines of a table whose repeated rows become one line. There are at most :data:`MAX_ROWS` lines.

    Parameters
    ----------
    rows : ndarray of int, shape (rows,)
        Equal numbers for equal rows, see :func:`row_numbers`.
    """
    lines: list[int | Repeat] = []
    begin = 0
    for repeat in repeats(rows):
        lines += [*range(begin, repeat.first), repeat]
        begin = repeat.end
    lines += range(begin, len(rows))
    if len(lines) <= MAX_ROWS:
        return [*lines]
    first, last = lines[: MAX_ROWS // 2], lines[-MAX_ROWS // 2 :]
    begin = last[0].first if isinstance(last[0], Repeat) else last[0]
    return [*first, LeftOut(begin - _end(first[-1])), *last]


def _end(line: int | Repeat) -> int:
    return line.end if isinstance(line, Repeat) else line + 1


def with_rows(lines: Iterable[TableLine], rows: Collection[int]) -> list[TableLine]:
    """Return the lines of a table in which these rows are not left out. Repeated rows stay one line."""
    found: list[TableLine] = []
    at = 0
    for line in lines:
        if isinstance(line, LeftOut):
            end = at + line.rows
            for row in sorted(row for row in rows if at <= row < end):
                found += [LeftOut(row - at), row] if row > at else [row]
                at = row + 1
            found += [LeftOut(end - at)] if end > at else []
            at = end
        else:
            found.append(line)
            at = _end(line)
    return found


def row_numbers(keys: Iterable[Hashable]) -> np.ndarray:
    """Return a number for each key, shape (rows,). Equal keys have equal numbers."""
    numbers: dict[Hashable, int] = {}
    return np.array([numbers.setdefault(key, len(numbers)) for key in keys], dtype=np.int64)


def table(columns: Sequence[Column], hidden: int = 0) -> str:
    """Return a table as text, with at most :data:`MAX_ROWS` lines below its head.

    Parameters
    ----------
    columns : sequence of (str, str, list of str)
        Name, unit and cells of each column.
    hidden : int
        Number of rows that `columns` lack in their middle. The table counts them among the rows it leaves out.
    """
    names = columns[0][2]
    lines = cut_lines(len(names), hidden)
    return table_of_lines(columns_at(columns, printed_rows(lines)), lines, names)


def columns_at(columns: Sequence[Column], rows: Sequence[int]) -> list[Column]:
    """Return columns with the cells of these rows only."""
    return [(name, unit, [cells[row] for row in rows]) for name, unit, cells in columns]


def table_of_lines(columns: Sequence[Column], lines: Sequence[TableLine], names: Sequence[str]) -> str:
    """Return a table as text.

    Parameters
    ----------
    columns : sequence of (str, str, list of str)
        Name and unit of each column, and its cells for each printed row.
    lines : sequence of int, Repeat or LeftOut
        The lines of the table.
    names : sequence of str
        The cells of the first column for all rows. Lines for several rows name the rows by them.
    """
    widths = [max(len(name), len(unit), *map(len, cells), 0) for name, unit, cells in columns]

    def joined(words: Sequence[str]) -> str:
        return "  ".join(word.rjust(width) for word, width in zip(words, widths, strict=True)).rstrip()

    text = [joined([name for name, _, _ in columns]), joined([unit for _, unit, _ in columns])]
    rows = zip(*(cells for _, _, cells in columns), strict=True)
    for line in lines:
        text.append(
            joined(next(rows)) if isinstance(line, int) else f"... {line_words(columns[0][0], names, line)} ..."
        )
    return "\n".join(text)


def aligned(rows: Sequence[Sequence[str]], sides: str) -> list[str]:
    """Return a line for each row of cells, indented by two, with aligned columns.

    Parameters
    ----------
    rows : sequence of sequences of str
        A row with fewer cells than columns does not count in the widths of the columns.
    sides : str
        "l" or "r" for each column: its cells stand to the left or to the right.
    """
    full = [row for row in rows if len(row) == len(sides)]
    pads = [
        (str.ljust if side == "l" else str.rjust, max(map(len, column)))
        for side, column in zip(sides, zip(*full, strict=True), strict=True)
    ]
    return [
        "  " + "  ".join(pad(cell, width) for cell, (pad, width) in zip(row, pads, strict=False)).rstrip()
        for row in rows
    ]


def line_words(heading: str, names: Sequence[str], line: Repeat | LeftOut) -> str:
    """Return the words of a line for several rows. `heading` is the name of the first column, `names` its cells."""
    return f"{line.rows:,} more" if isinstance(line, LeftOut) else _repeat_words(heading, names, line)


def _repeat_words(heading: str, names: Sequence[str], repeat: Repeat) -> str:
    last = names[repeat.end - 1]
    before = names[repeat.first - repeat.period], names[repeat.first - 1]
    plural = f"{heading}s {before[0]} to {before[1]}" if repeat.period > 1 else f"{heading} {before[1]}"
    times = "once" if repeat.times == 1 else f"{repeat.times:,} times"
    return f"{names[repeat.first]} to {last}: repeat {plural}, {times}"


def repeats(rows: np.ndarray) -> list[Repeat]:
    """Find the rows that repeat the rows before them, in order.

    Parameters
    ----------
    rows : ndarray of int, shape (rows,)
        Equal numbers for equal rows.
    """
    found = []
    row = 0
    while row < len(rows):
        repeat = _repeat_at(rows[row:])
        if repeat is None:
            row += 1
        else:
            found.append(repeat._replace(first=row + repeat.first))
            row = found[-1].end
    return found


def _repeat_at(rows: np.ndarray) -> Repeat | None:
    """The longest repeats of a period that begins with the first of some rows. None if they are too few."""
    found, longest = None, LEAST_REPEATED - 1
    for period in (np.flatnonzero(rows[1 : LONGEST_PERIOD + 1] == rows[0]) + 1).tolist():
        if not np.array_equal(rows[:period], rows[period : 2 * period]):
            continue
        same = rows[:-period] == rows[period:]
        times = (len(same) if same.all() else int(np.argmin(same))) // period
        if times * period > longest:
            found, longest = Repeat(period, period, times), times * period
    return found
