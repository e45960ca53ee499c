"""Texts of anybody inside stored files: titles, names of materials, errors and hosts of results."""

from __future__ import annotations

import csv
import xml.etree.ElementTree as ET
from pathlib import Path

import h5py
import pytest

from fastpin.casefile import parse_case
from fastpin.cli.main import main
from fastpin.errors import printable
from fastpin.storage import record
from tests.support.case_texts import PRESSED

CASE = f"""{PRESSED}[[load]]
Q = [1e5, -1e5]
"""

HOSTILE = {
    "escape": "a\x1b[31mb",
    "direction": "a\u202eb",
    "markup": "<script>alert(1)</script>&<b",
    "line end": "a\nb",
    "control": "a\x08\x07\x9bb",
    "surrogate": "a\ud800b",
}

PLACES = ("solver@title", "problem/pin@name", "@error", "@host")
"""Attributes of a result that hold texts."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The bytes of a good result."""
    path, case = tmp_path_factory.mktemp("whole") / "a.h5", parse_case(CASE)
    record(case.problem, case.history, path, nodes=41)
    return path.read_bytes()


@pytest.mark.parametrize("text", HOSTILE.values(), ids=list(HOSTILE))
def test_texts_of_a_result_harm_neither_terminal_nor_pages(
    text: str, whole: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.h5"
    path.write_bytes(whole)
    with h5py.File(path, "r+") as file:
        for place in PLACES:
            part, _, name = place.partition("@")
            file[part or "/"].attrs[name] = text.encode(
                "utf-8", "surrogatepass"
            )  # h5py reads wrong bytes as surrogates
    outputs = {"show": None, "report": tmp_path / "a.html", "plot": tmp_path / "a.svg"}
    for command, output in outputs.items():
        words = [
            command,
            str(path),
            *(["tractions"] if command == "plot" else []),
            *(["-o", str(output)] if output else []),
        ]
        assert main(words) == 0
        shown = "".join(capsys.readouterr())
        assert all(printable(line) == line for line in shown.split("\n"))
        assert "Traceback" not in shown
        if output is not None and output.exists():
            written = output.read_text(encoding="utf-8")
            assert not any(sign in written for sign in "\x1b\x08\x07\x9b\u202e")
            assert "<script>alert" not in written
            if command == "plot":
                ET.fromstring(written)


def test_the_table_of_a_sweep_has_no_formulas(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = "=HYPERLINK(1)"
    (tmp_path / "mine.toml").write_text(f'["{name}"]\nE = 1e11\nnu = 0.3\n')
    (tmp_path / "case.toml").write_text(f'materials = "mine.toml"\n{CASE}[solve]\nnodes = 41\n')
    (tmp_path / "plan.toml").write_text(f'case = "case.toml"\n[grid]\npin.material = ["steel", "{name}"]\n')
    table = tmp_path / "table.csv"
    assert (
        main(
            [
                "sweep",
                str(tmp_path / "plan.toml"),
                "-o",
                str(tmp_path / "runs"),
                "--workers",
                "1",
                "--table",
                str(table),
            ]
        )
        == 0
    )
    with table.open(newline="", encoding="utf-8") as file:
        cells = [cell for row in csv.reader(file) for cell in row]
    assert f"'{name}" in cells
    assert not any(cell.startswith(("=", "@", "\t", "\r")) for cell in cells)
    capsys.readouterr()
