"""The command wear."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from jsonschema import Draft202012Validator

import fastpin
from fastpin.casefile import parse_case
from fastpin.casefile.writer import case_text
from fastpin.cli.main import main
from fastpin.report import json_schema, wear
from fastpin.solver.errors import Interrupted
from tests.support.live_pages import recorded

CASE = """
title = "Worn pin"
[pin]
material = "Ti-6Al-4V"
[plate]
material = "aluminium"
[contact]
hole_radius = 0.01
clearance = 2e-5
friction = 0.4
pin_load = "body"
[[load]]
P = 2e6
[[load]]
P = [1e6, 2e6]
Q = [-4e5, 4e5]
repeat = 12
[wear]
pin = 1e-12
plate = [{ constant = 1e-12 }, { zone = 1e-12, start = -20, stop = 20 }]
tolerance = 0
[solve]
nodes = 31
arc = [-3.1, 0.0]
"""


@pytest.fixture(autouse=True)
def _inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(CASE)


def test_the_command_prints_the_chosen_cycles(capsys):
    assert main(["wear", "case.toml", "--json", "life.json"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("Worn pin\n")
    assert "12 cycles, 12 of them solved; debris is not modelled" in text
    document = json.loads(Path("life.json").read_text())
    assert not list(Draft202012Validator(json_schema("wear")).iter_errors(document))
    case = fastpin.read_case("case.toml")
    assert case.wear is not None
    given = {"pin": case.wear.pin, "plate": case.wear.plate, "tolerance": 0.0}
    found = fastpin.wear(case.problem, case.history, nodes=31, arc=(-3.1, 0.0), **given)
    assert document["cycles"][-1]["pin_depth"] == found[-1].pin_depth.tolist()
    assert document["cycles"][-1]["cycle"] == 12
    assert max(document["plate_coefficient"]) == 2e-12


def test_check_describes_the_wear_and_doubts_its_coefficients(capsys):
    assert main(["check", "case.toml"]) == 0
    line = "wear     Archard's law, 12 cycles; in 1/Pa: pin 1e-12, plate 1e-12; 1e-12 more from -20 to 20 deg"
    assert line in capsys.readouterr().out.splitlines()
    Path("case.toml").write_text(CASE.replace("pin = 1e-12", "pin = 1e-6"))
    assert main(["check", "case.toml"]) == 0
    assert "fastpin: warning: coefficient: 1e-06 1/Pa is more than any surface wears" in capsys.readouterr().err


def test_options_take_the_place_of_the_case(capsys):
    words = ["--cycles", "20", "--coefficient", "1e-13", "--at", "3,9", "--law", "energy", "--tolerance", "0.05"]
    assert main(["wear", "case.toml", *words, "--nodes", "41", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [each["cycle"] for each in document["cycles"]] == [0, 3, 9, 20]
    assert document["law"] == "energy"
    assert len(document["angles"]) == 41
    assert set(document["pin_coefficient"]) == {5e-14}


@pytest.mark.parametrize(("cycles", "stored"), [("5", [0, 2, 5]), ("1", [0, 1])])
def test_fewer_cycles_leave_out_the_chosen_ones_beyond(cycles, stored, capsys):
    Path("case.toml").write_text(CASE.replace("tolerance = 0", "tolerance = 0\nat = [2, 5, 7]"))
    assert main(["wear", "case.toml", "--cycles", cycles, "--json"]) == 0
    assert [each["cycle"] for each in json.loads(capsys.readouterr().out)["cycles"]] == stored
    assert main(["wear", "case.toml", "--cycles", "some"]) == 2
    assert "--cycles: must be a number" in capsys.readouterr().err


@pytest.mark.gate
def test_a_file_is_begun_continued_and_kept(capsys):
    assert main(["wear", "case.toml", "-o", "life.h5"]) == 0
    first = capsys.readouterr().out
    assert main(["wear", "case.toml", "-o", "life.h5"]) == 2
    assert "exists already; overwrite=True (--overwrite) replaces it" in capsys.readouterr().err
    assert main(["wear", "case.toml", "-o", "life.h5", "--resume"]) == 2
    assert "holds a finished life of wear" in capsys.readouterr().err
    assert main(["wear", "case.toml", "-o", "life.h5", "--overwrite"]) == 0
    assert capsys.readouterr().out == first
    assert main(["resume", "life.h5"]) == 2
    assert "belongs to a life of wear" in capsys.readouterr().err


@pytest.mark.gate
def test_a_stored_life_is_shown(capsys):
    assert main(["wear", "case.toml", "-o", "life.h5", "--json", "life.json"]) == 0
    printed = capsys.readouterr().out
    assert main(["show", "life.h5", "--json", "shown.json"]) == 0
    assert capsys.readouterr().out == printed
    assert Path("shown.json").read_text() == Path("life.json").read_text()
    for option in ("--plot", "--cycles=a.png"):
        assert main(["show", "life.h5", option]) == 2
        words = f"{option.partition('=')[0]}: is for the result of a run; fastpin plot life.h5 draws this life of wear"
        assert capsys.readouterr().err == f"fastpin: {words}\n"


def test_an_unfinished_life_says_so(capsys):
    Path("case.toml").write_text(CASE.replace("plate = [{ constant = 1e-12 }, {", "plate = [{ constant = 1e-5 }, {"))
    assert main(["wear", "case.toml", "-o", "life.h5"]) == 1
    doubt, error = (line.removeprefix("fastpin: ") for line in capsys.readouterr().err.splitlines())
    assert doubt.startswith("warning: coefficient: 1e-05 1/Pa is more than any surface wears")
    assert main(["show", "life.h5"]) == 0
    *_, reached, note = capsys.readouterr().out.splitlines()
    assert reached == "unfinished: 0 of 12 cycles; debris is not modelled"
    assert note == f"note: the life is unfinished: {error}"
    assert main(["show", "life.h5", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["error"] == error
    with h5py.File("life.h5", "r+") as file:
        file.attrs["error"] = str(Interrupted())
    assert main(["show", "life.h5"]) == 0
    assert capsys.readouterr().out.endswith("; continue with: fastpin wear CASE -o life.h5 --resume\n")


@pytest.mark.gate
def test_a_page_of_the_life_is_written_at_once_or_from_its_file(capsys):
    assert main(["wear", "case.toml", "-o", "life.h5", "--record", "page.html"]) == 0
    assert main(["show", "life.h5", "--record", "other.html"]) == 0
    page = Path("page.html").read_text()
    assert Path("other.html").read_text() == page
    found = recorded(page)
    assert [each["cycle"] for each in found["life"]["cycles"]] == [0, 1, 2, 3, 4, 5, 6, 8, 10, 12]
    assert (found["case"]["title"], found["sentence"]) == ("Worn pin", "")
    capsys.readouterr()
    assert main(["live", "life.h5"]) == 2
    assert (
        "is a stored result (HDF5), not text; fastpin show prints it, with --record as a page"
        in capsys.readouterr().err
    )


FAULTS = {
    '--record: must be the name of a page, which ends in .html, not "page.pdf"': ["--record", "page.pdf"],
    "--cycles: must be a whole number, not 2.5": ["--cycles", "2.5"],
    "--coefficient: must not be negative, not -1": ["--coefficient", "-1"],
    "--resume: needs --output FILE": ["--resume"],
    "--overwrite: needs --output FILE": ["--overwrite"],
    '--law: must be "archard" or "energy", not "x"': ["--law", "x"],
}


@pytest.mark.parametrize("message", FAULTS)
def test_wrong_options_are_told_in_one_sentence(message, capsys):
    assert main(["wear", "case.toml", *FAULTS[message]]) == 2
    assert capsys.readouterr().err.splitlines() == [f"fastpin: {message}"]


def test_a_case_without_wear_needs_a_coefficient(capsys):
    Path("plain.toml").write_text(CASE.replace("[wear]", "#").replace("\npin = 1e", "\n#").replace("\nplate = [", "\n#")
                                  .replace("\ntolerance", "\n#"))  # fmt: skip
    assert main(["wear", "plain.toml"]) == 2
    assert "--coefficient: is needed: the case file has no section [wear]" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("pin = 1e-12", "pin = -1", "pin: must not be negative, not -1"),
        ("tolerance = 0", "tolerance = 2", "tolerance: must lie between 0 and 0.1, not 2"),
        ("tolerance = 0", "cycle = 2", 'unknown key "cycle" in [wear]'),
        ("pin = 1e-12", 'pin = "one"', "pin: "),
    ],
)
def test_faults_of_the_section_are_told_with_their_lines(old, new, message, capsys):
    Path("case.toml").write_text(CASE.replace(old, new))
    assert main(["wear", "case.toml"]) == 2
    error = capsys.readouterr().err
    line = 1 + CASE[: CASE.index(old)].count("\n")
    assert f"case.toml, line {line}: " in error
    assert message in error


def test_the_section_comes_back_from_the_writer():
    case = parse_case(CASE)
    again = parse_case(case_text(case))
    assert again.wear is not None
    assert case.wear is not None
    assert again.wear.cycles == case.wear.cycles == 12
    theta = np.linspace(-3.0, 0.0, 50)
    assert np.array_equal(*(each.wear.coefficients(0.01, theta) for each in (case, again)))


def test_without_a_cycle_there_is_a_document_all_the_same():
    document = wear.document(None, "no cycle", "interrupted")
    assert not list(Draft202012Validator(json_schema("wear")).iter_errors(document))
