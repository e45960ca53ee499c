"""Tables of text."""

from __future__ import annotations

from collections.abc import Sequence

Column = tuple[str, str, list[str]]
"""A column of a table: its name, its unit and its cells."""

MAX_ROWS = 40
"""Most rows of a printed table."""


def visible_rows(count: int) -> list[int]:
    """Return the indices of the rows to print of `count`: all, or of a long table the first and the last ones."""
    half = MAX_ROWS // 2
    return list(range(count)) if count <= MAX_ROWS else [*range(half), *range(count - half, count)]


def table(columns: Sequence[Column], hidden: int = 0) -> str:
    """Return a table as text, with at most :data:`MAX_ROWS` rows.

    Parameters
    ----------
    columns : sequence of Column
        Name, unit and cells of each column.
    hidden : int
        Number of rows that `columns` lack in their middle. The table counts them among the rows it leaves out.
    """
    count = len(columns[0][2])
    middle = min(count, MAX_ROWS) // 2
    hidden += max(count - MAX_ROWS, 0)
    if count > MAX_ROWS:
        columns = [(name, unit, [cells[k] for k in visible_rows(count)]) for name, unit, cells in columns]
    widths = [max(len(cell) for cell in (name, unit, *cells)) for name, unit, cells in columns]
    lines = [[name for name, _, _ in columns], [unit for _, unit, _ in columns]]
    lines += [[cells[k] for _, _, cells in columns] for k in range(len(columns[0][2]))]
    text = ["  ".join(cell.rjust(width) for cell, width in zip(line, widths, strict=True)).rstrip() for line in lines]
    if hidden:
        text.insert(2 + middle, f"... {hidden:,} more ...")
    return "\n".join(text)
