"""The checks of an installation as a table, for ``fastpin verify``."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from fastpin.assess.table import aligned
from fastpin.verification.rows import Check


def table(checks: Sequence[Check]) -> str:
    """Return the checks as a table, grouped by topic. Of several checks of one case, the first one names the case."""
    head = ("", "", "reference", "ours", "difference", "tolerance", "", "")
    rows: list[tuple[str, ...]] = [head]
    above = ("", "")
    for check in checks:
        same = (check.topic, check.case) == above
        rows.append(("" if same else check.case, *_cells(check)))
        above = check.topic, check.case
    first, *lines = aligned(rows, "llrrrrll")
    units = "Dimensionless (R = F = beta* = 1): N and T in F/R, angles in rad, moments in F R, energies in F^2 beta*."
    text = [units, "", first]
    for topic, group in groupby(zip(checks, lines, strict=True), lambda pair: pair[0].topic):
        text += ["", topic, *(line for _, line in group)]
    return "\n".join(text)


def _cells(check: Check) -> tuple[str, ...]:
    """Return the cells of a check below the head, without its case."""
    if check.message:
        return (f"FAILED: {check.message}",)
    values = [_number(value, "#.7g") for value in (check.reference, check.ours)]
    errors = [_number(value, ".1e") for value in (check.difference, check.tolerance)]
    return check.quantity, *values, *errors, check.unit, "ok" if check.passed else "FAILED"


def _number(value: float | None, form: str) -> str:
    if value is None:
        return ""
    return format(value, form) if value else "0"
