"""Cells of CSV files that hold text."""

from __future__ import annotations

from typing import TypeVar

T = TypeVar("T")


def csv_cell(value: T) -> T | str:
    """Return the value of a cell. A text that a spreadsheet would take for a formula begins with an apostrophe."""
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r")) else value
