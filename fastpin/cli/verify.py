"""``fastpin verify``: the table of all checks, and whether they have passed."""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from functools import partial
from itertools import groupby
from typing import TYPE_CHECKING

from fastpin import assess, report, storage, verification
from fastpin.cli.progress import Bar, progress_to
from fastpin.cli.terminal import EXIT_FAILED, EXIT_OK, check_outputs, write_outputs
from fastpin.runtime.threads import cores

if TYPE_CHECKING:  # it imports NumPy
    from fastpin.verification.rows import Check


def run(options: argparse.Namespace) -> int:
    """Check the installation, and print or write the checks. The exit code is 1 if a check fails."""
    check_outputs({"--json": options.json})
    began = time.perf_counter()
    with Bar(0, "check {n} of {total}") as progress_bar:
        checks = verification.verify(progress_to(progress_bar))
    seconds = time.perf_counter() - began
    count = sum(check.passed for check in checks)
    code = EXIT_OK if count == len(checks) else EXIT_FAILED
    libraries = ", ".join(f"{name} {version}" for name, version in storage.versions().items())
    end = f"{count} of {len(checks)} within tolerance, {seconds:.0f} s; {libraries}; {cores()} cores"
    found = {"versions": storage.versions(), "cores": cores(), "seconds": seconds, "passed": code == EXIT_OK}
    document = partial(assess.outputs.whole_document, report.schema.CHECKS, found | {"checks": checks}, {})
    lines = [*check_table(checks).split("\n"), "", end]
    return write_outputs([], options.json, document, lambda: lines) or code


def check_table(checks: Sequence[Check]) -> str:
    """Return the checks as a table, grouped by topic. Of several checks of one case, the first one names the case."""
    head = ("", "", "reference", "ours", "difference", "tolerance", "", "")
    rows: list[tuple[str, ...]] = [head]
    above = ("", "")
    for check in checks:
        same = (check.topic, check.case) == above
        rows.append(("" if same else check.case, *_cells(check)))
        above = check.topic, check.case
    first, *lines = assess.outputs.aligned(rows, "llrrrrll")
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
