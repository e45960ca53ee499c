"""``fastpin verify``: the table of all checks, and whether they have passed."""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
import time
from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

from fastpin import __version__
from fastpin.terminal import EXIT_FAILED, EXIT_OK, bar, check_outputs, write_files, write_text

if TYPE_CHECKING:
    from fastpin.verify import Check

UNITS = "Dimensionless (R = F = beta* = 1): N and T in F/R, angles in rad, moments in F R, energies in F^2 beta*."


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    verify = commands.add_parser(
        "verify", help="check this installation against closed forms and finite elements", allow_abbrev=False
    )
    verify.add_argument(
        "--json",
        metavar="FILE",
        nargs="?",
        const="-",
        help="write the checks as JSON; without FILE, or with -, to standard output instead of the table",
    )
    verify.set_defaults(command=_verify)


def _verify(options: argparse.Namespace) -> int:
    check_outputs({"--json": options.json}, None)

    from fastpin.layout import versions
    from fastpin.pool import cores
    from fastpin.report import plain
    from fastpin.verify import TOPICS, verify

    began = time.perf_counter()
    with bar(sum(len(cases) for _, cases in TOPICS.values()), "check {n} of {total}") as shown:
        checks = verify(lambda done, _: shown.update(done - shown.n))
    seconds = time.perf_counter() - began
    count = sum(check.passed for check in checks)
    code = EXIT_OK if count == len(checks) else EXIT_FAILED
    if options.json != "-":
        libraries = ", ".join(f"{name} {version}" for name, version in versions().items())
        print(table(checks))
        print(f"\n{count} of {len(checks)} within tolerance, {seconds:.0f} s; {libraries}; {cores()} cores")
    if options.json is not None:
        document = {
            "fastpin": __version__,
            "versions": versions(),
            "cores": cores(),
            "seconds": seconds,
            "passed": code == EXIT_OK,
            "checks": [{**dataclasses.asdict(check), "passed": check.passed} for check in checks],
        }
        text = json.dumps(plain(document), indent=2, allow_nan=False) + "\n"
        if options.json == "-":
            sys.stdout.write(text)
        else:
            code = write_files([(options.json, lambda path: write_text(path, text))]) or code
    return code


def table(checks: Sequence[Check]) -> str:
    """Lines of text, grouped by topic."""
    head = ("", "", "reference", "ours", "difference", "tolerance", "", "")
    rows = [_cells(check) for check in checks]
    widths = [
        max(map(len, column)) for column in zip(head, *(row for row in rows if len(row) == len(head)), strict=True)
    ]
    lines = [UNITS, "", _line(head, widths)]
    for topic, group in groupby(zip(checks, rows, strict=True), lambda pair: pair[0].topic):
        lines += ["", topic]
        before = ""
        for check, row in group:
            lines.append(_line(("" if check.case == before else row[0], *row[1:]), widths))
            before = check.case
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
    """Words to the left, numbers to the right."""
    sides = (str.ljust, str.ljust, str.rjust, str.rjust, str.rjust, str.rjust, str.ljust, str.ljust)
    padded = [side(cell, width) for side, cell, width in zip(sides, cells, widths, strict=False)]
    return "  " + "  ".join(padded).rstrip()
