"""The command ``converge``: what it prints, its exit codes and its files."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

from fastpin import MaterialPair, studies
from fastpin.casefile import EXAMPLE
from fastpin.report.convergence import COLUMNS
from fastpin.studies import convergence
from fastpin.studies.convergence import Convergence, StudyInterrupted
from tests.support.commands import printed, refusal, said
from tests.support.outcomes import FILE
from tests.support.studies import small_problem, small_study

CASE = EXAMPLE


@pytest.fixture(scope="module")
def study(similar: MaterialPair) -> Convergence:
    return small_study(small_problem(similar))


OUTPUTS = ["--csv", "a.csv", "--json", "a.json", "--plot", "a.png"]


@pytest.mark.gate
def test_the_command_prints_and_writes(case: Path) -> None:
    out = printed("converge", case, "--nodes", "51,101,151", "--increments", "4,8,16", "--corner", "2", *OUTPUTS)
    assert "corner 2: P = 2.42 MN/m, Q = 726 kN/m" in out
    lines = [line.split() for line in out.splitlines()]
    assert ["quantity", "unit", "51", "101", "151", "verdict", "limit", "bar"] in lines
    assert ["quantity", "unit", "4", "8", "16", "verdict", "limit", "bar", "path", "within"] in lines
    assert ["P", "MN/m", "2.42", "2.42", "2.42", "converged", "to", "rounding", "-", "-"] in lines
    rows = list(csv.DictReader(Path("a.csv").read_text().splitlines()))
    assert tuple(rows[0]) == COLUMNS
    solvers = {(row["solver"], row["nodes"], row["increments"]) for row in rows}
    assert solvers == {("path", count, "") for count in ("51", "101", "151")} | {
        ("increment", "151", count) for count in ("4", "8", "16")
    }
    peaks = [row for row in rows if row["quantity"] == "peak_pressure"]
    assert [row["unit"] for row in peaks] == ["Pa"] * 6
    assert all(1.2e8 < float(row["value"]) < 1.6e8 for row in peaks)
    assert peaks[-1]["path"] == peaks[2]["value"]
    start = next(row for row in rows if row["quantity"] == "contact_1_start")
    assert (start["unit"], round(float(start["value"]))) == ("deg", -49)
    document = json.loads(Path("a.json").read_text())
    assert document["complete"] is True
    assert document["studies"][1]["quantities"][0]["path"] == float(peaks[-1]["path"])
    assert document["studies"][1]["quantities"][0]["scatter"] == float(peaks[-1]["scatter"]) > 0.0
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.gate
def test_outcomes_are_studied_too(case: Path) -> None:
    Path("mine.py").write_text(FILE)
    nodes = ["--nodes", "51,101,201", "--corner", "2"]
    captured = said("converge", case, *nodes, "--outcomes", "mine.py", *OUTPUTS, code=1)
    reason = "ZeroDivisionError: division by zero (mine.py, line 20)"
    assert captured.err == f"fastpin: outcome broken can't be read with 51 nodes: {reason}\n"
    lines = [line.split() for line in captured.out.splitlines()]
    assert ["broken", "-", "-", "-", "not", "comparable", "-", "-"] in lines
    largest = next(line for line in lines if line[:1] == ["largest_pressure"])
    peak = next(line for line in lines if line[:2] == ["peak", "N"])
    assert largest[1] == "MPa"
    assert largest != peak  # the peak is larger at the first corner
    table = csv.DictReader(Path("a.csv").read_text().splitlines())
    rows = [row for row in table if row["quantity"] in ("largest_pressure", "broken")]
    assert [row["unit"] for row in rows] == ["Pa"] * 3 + [""] * 3
    assert [row["value"] for row in rows[3:]] == [""] * 3
    document = json.loads(Path("a.json").read_text())
    assert document["unread"] == {"broken": f"51 nodes: {reason}"}
    assert document["studies"][0]["quantities"][-3]["quantity"] == "largest_pressure"
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")


def test_json_goes_to_standard_output_alone(case: Path) -> None:
    document = json.loads(printed("converge", case, "--nodes", "51,61,71", "--corner", "1", "--json"))
    assert document["loads"]["1"]["P"] == 2.42e6


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--nodes", "101,x"], "--nodes: must be whole numbers with commas"),
        (["--nodes", "101,201"], "--nodes: must be at least 3 numbers"),
        (["--nodes", "11,101,201"], "--nodes: must be a whole number from 51 to 20000, not 11"),
        (["--increments", "4,2,8"], "--increments: must increase"),
        (["--increment-nodes", "101"], "--increment-nodes: is for the increment solver"),
        (["--corner", "9"], "--corner: must be one of the history, 1 to 4, not 9"),
        (["--outcomes", "case.json"], "case.json: must end in .py or .toml to be a file of outcomes"),
        (["--plot", "a.docx"], "--plot: must be the name of a figure, which ends in"),
        (["--csv", "a.csv", "--json", "a.csv"], "writes the same file as"),
        (["--csv", "no/such/place.csv"], "does not exist"),
        (["--csv", "a.toml"], "won't overwrite a.toml: by its name it is a case file"),
    ],
)
def test_options_are_checked_before_the_work(arguments, words, case, monkeypatch, tmp_path):
    monkeypatch.setattr(convergence, "solve", None)
    assert words in refusal("converge", case, *arguments)
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


@pytest.mark.gate
def test_an_interrupted_command_hands_out_what_there_is(case, study, monkeypatch):
    kept: list[Convergence | None] = [replace(study, studies=study.studies[:1], complete=False), None]

    def interrupted(*_: object) -> Convergence:
        raise StudyInterrupted(kept.pop(0))

    monkeypatch.setattr(studies, "converge", interrupted)
    captured = said("converge", case, "--csv", "a.csv", code=130)
    assert "path solver; nodes on one arc:" in captured.out
    assert "interrupted; kept: corner 1, 2, 3 with 51, 101, 201 nodes" in captured.err
    assert Path("a.csv").exists()
    assert "interrupted; less than three grids were finished" in said("converge", case, code=130).err
