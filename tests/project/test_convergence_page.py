"""The study in docs/convergence.md shows the values that ``fastpin converge`` finds today."""

import re
from pathlib import Path

import pytest

from fastpin.cli.main import main

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "convergence.md").read_text(encoding="utf-8")
COLUMNS = 3
"""Columns of the table that are computed again: 101, 201 and 401 nodes. Finer grids take too long for a test."""


def values(line: str) -> list[str]:
    """The name of a row of the table, and its values on the coarsest grids. Two blanks part the cells."""
    cells = re.split(r" {2,}", line.strip())
    return [cells[0], *cells[2 : 2 + COLUMNS]]


@pytest.mark.gate
def test_the_study_of_the_built_in_case_has_its_values(capsys: pytest.CaptureFixture[str]) -> None:
    start = PAGE.index("corner 3: P = 2.42 MN/m")
    shown = [values(line) for line in PAGE[start : PAGE.index("increment solver", start)].splitlines()[3:] if line]
    assert len(shown) == 8
    assert main(["converge", "--nodes", "101,201,401", "--corner", "3"]) == 0
    found = {row[0]: row[1:] for row in map(values, capsys.readouterr().out.splitlines()) if len(row) == 1 + COLUMNS}
    for name, *row in shown:
        for old, new in zip(row, found[name], strict=True):
            digits = min(len(text.partition(".")[2]) for text in (old, new))
            assert abs(float(old) - float(new)) <= 1.01 * 10.0**-digits, name
