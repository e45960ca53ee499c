"""Tables of text."""

from __future__ import annotations

from collections.abc import Collection, Sequence
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
    """Rows that repeat the rows before them. The row `first` begins the repeats of the `period` rows before it."""

    first: int
    period: int
    times: int


def visible_rows(count: int) -> list[int]:
    """Return the indices of the rows to print of `count`: all, or of a long table the first and the last ones."""
    half = MAX_ROWS // 2
    return list(range(count)) if count <= MAX_ROWS else [*range(half), *range(count - half, count)]


def table(columns: Sequence[Column], hidden: int = 0, own: Collection[str] | None = None) -> str:
    """Return a table as text, with at most :data:`MAX_ROWS` lines below its head.

    Parameters
    ----------
    columns : sequence of (str, str, list of str)
        Name, unit and cells of each column.
    hidden : int
        Number of rows that `columns` lack in their middle. The table counts them among the rows it leaves out.
    own : collection of str, optional
        Names of columns in which each row has a number of its own. Rows that repeat earlier ones in all other columns
        become one line, which names them by the cells of the first column. By default all rows are printed.
    """
    if hidden and len(columns[0][2]) > MAX_ROWS:  # the rows that are missing lie between the first and the last ones
        hidden += len(columns[0][2]) - MAX_ROWS
        columns = [(name, unit, [cells[row] for row in visible_rows(len(cells))]) for name, unit, cells in columns]
    count = len(columns[0][2])
    middle = count // 2 if hidden else count
    repeats = [] if own is None else _repeats(columns, own, middle)
    lines: list[int | Repeat] = []
    begin = 0
    for repeat in repeats:
        lines += [*range(begin, repeat.first), repeat]
        begin = repeat.first + repeat.times * repeat.period
    lines += range(begin, count)
    cut = sum(_end(line) <= middle for line in lines) if hidden else len(lines) // 2
    if len(lines) > MAX_ROWS:
        lines, left_out, cut = _shortened(lines)
        hidden += left_out
    return _text(columns, lines, cut, hidden)


def _end(line: int | Repeat) -> int:
    """The row after a line."""
    return line + 1 if isinstance(line, int) else line.first + line.times * line.period


def _shortened(lines: list[int | Repeat]) -> tuple[list[int | Repeat], int, int]:
    """The first and the last lines, the number of rows between them, and the number of the first lines."""
    half = MAX_ROWS // 2
    last = lines[-half]
    begin = last if isinstance(last, int) else last.first
    return [*lines[:half], *lines[-half:]], begin - _end(lines[half - 1]), half


def _text(columns: Sequence[Column], lines: Sequence[int | Repeat], cut: int, hidden: int) -> str:
    """The table. The number of `hidden` rows stands before line `cut`."""
    rows = [line for line in lines if isinstance(line, int)]
    widths = [max(len(name), len(unit), *(len(cells[row]) for row in rows), 0) for name, unit, cells in columns]

    def joined(words: Sequence[str]) -> str:
        return "  ".join(word.rjust(width) for word, width in zip(words, widths, strict=True)).rstrip()

    text = [joined([name for name, _, _ in columns]), joined([unit for _, unit, _ in columns])]
    for place, line in enumerate(lines):
        if hidden and place == cut:
            text.append(f"... {hidden:,} more ...")
        if isinstance(line, int):
            text.append(joined([cells[line] for _, _, cells in columns]))
        else:
            text.append(_repeat_line(columns[0], line))
    return "\n".join(text)


def _repeat_line(names: Column, repeat: Repeat) -> str:
    heading, _, cells = names
    last = cells[_end(repeat) - 1]
    before = cells[repeat.first - repeat.period], cells[repeat.first - 1]
    plural = f"{heading}s {before[0]} to {before[1]}" if repeat.period > 1 else f"{heading} {before[1]}"
    times = "once" if repeat.times == 1 else f"{repeat.times:,} times"
    return f"... {cells[repeat.first]} to {last}: repeat {plural}, {times} ..."


def _repeats(columns: Sequence[Column], own: Collection[str], middle: int) -> list[Repeat]:
    """Find the rows that repeat earlier ones, in order. The repeats keep to one side of row `middle`."""
    numbers: dict[tuple[str, ...], int] = {}
    keys = zip(*(cells for name, _, cells in columns if name not in own), strict=True)
    rows = np.array([numbers.setdefault(key, len(numbers)) for key in keys], dtype=np.int64)
    found = []
    for begin, stop in ((0, middle), (middle, len(rows))):
        row = begin
        while row < stop:
            repeat = _repeat_at(rows[row:stop])
            if repeat is None:
                row += 1
            else:
                found.append(repeat._replace(first=row + repeat.first))
                row = _end(found[-1])
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
