"""The checks of an installation as a table, for ``fastpin verify``."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from fastpin.verification.rows import Check

UNITS = "Dimensionless (R = F = beta* = 1): N and T in F/R, angles in rad, moments in F R, energies in F^2 beta*."
"""The first line of the table."""


def table(checks: Sequence[Check]) -> str:
    """Return the checks as a table, grouped by topic. Of several checks of one case, the first one names the case."""
    head = ("", "", "reference", "ours", "difference", "tolerance", "", "")
    rows = [_cells(check) for check in checks]
    widths = [
        max(map(len, column)) for column in zip(head, *(row for row in rows if len(row) == len(head)), strict=True)
    ]
    lines = [UNITS, "", _line(head, widths)]
    for topic, group in groupby(zip(checks, rows, strict=True), lambda pair: pair[0].topic):
        lines += ["", topic]
        previous_case = ""
        for check, row in group:
            lines.append(_line(("" if check.case == previous_case else row[0], *row[1:]), widths))
            previous_case = check.case
    return "\n".join(lines)


def _cells(check: Check) -> tuple[str, ...]:
    if check.message:
        return check.case, f"FAILED: {check.message}"
    values = [_number(value, "#.7g") for value in (check.reference, check.ours)]
    errors = [_number(value, ".1e") for value in (check.difference, check.tolerance)]
    return check.case, check.quantity, *values, *errors, check.unit, "ok" if check.passed else "FAILED"


def _number(value: float | None, form: str) -> str:
    if value is None:
        return ""
    return format(value, form) if value else "0"


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    """Pad cells to the widths of their columns: words to the left, numbers to the right."""
    sides = (str.ljust, str.ljust, str.rjust, str.rjust, str.rjust, str.rjust, str.ljust, str.ljust)
    padded = [side(cell, width) for side, cell, width in zip(sides, cells, widths, strict=False)]
    return "  " + "  ".join(padded).rstrip()
