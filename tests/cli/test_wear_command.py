"""The command wear."""

import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from jsonschema import Draft202012Validator

import fastpin
from fastpin import Interrupted
from fastpin.assess import wear
from fastpin.casefile import case_text, parse_case
from fastpin.report import json_schema
from tests.support.commands import printed, refused, said
from tests.support.live_pages import recorded

pytestmark = pytest.mark.usefixtures("case")

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


def test_the_command_prints_the_chosen_cycles():
    text = printed("wear", "case.toml", "--json", "life.json")
    assert text.startswith("Worn pin\n")
    assert "12 cycles, 12 of them solved; debris is not modelled" in text
    document = json.loads(Path("life.json").read_text())
    assert not list(Draft202012Validator(json_schema("wear")).iter_errors(document))
    case = fastpin.read_case("case.toml")
    given = {"pin": case.wear.pin, "plate": case.wear.plate, "tolerance": 0.0}
    found = fastpin.wear(case.problem, case.history, nodes=31, arc=(-3.1, 0.0), **given)
    assert document["cycles"][-1]["pin_depth"] == found[-1].pin_depth.tolist()
    assert document["cycles"][-1]["cycle"] == 12
    assert max(document["plate_coefficient"]) == 2e-12


def test_check_describes_the_wear_and_doubts_its_coefficients():
    line = "wear     Archard's law, 12 cycles; in 1/Pa: pin 1e-12, plate 1e-12; 1e-12 more from -20 to 20 deg"
    assert line in printed("check", "case.toml").splitlines()
    Path("case.toml").write_text(CASE.replace("pin = 1e-12", "pin = 1e-6"))
    assert "fastpin: warning: coefficient: 1e-06 1/Pa is more than any surface wears" in said("check", "case.toml").err


@pytest.mark.gate
def test_a_stored_life_keeps_how_its_fatigue_is_assessed():
    life = "fatigue_strength = 1.1e9, strength_exponent = -0.12, fatigue_ductility = 0.22, ductility_exponent = -0.6"
    constants = f'material = "aluminium"\nfatigue = {{ {life} }}'
    text = CASE.replace('material = "aluminium"', constants).replace("repeat = 12", "repeat = 2")
    Path("case.toml").write_text(f'{text}[fatigue]\nbodies = "plate"\nlife = 100\n')
    said("wear", "case.toml", "-o", "life.h5")
    assert fastpin.storage.StoredResult("life.h5").case.fatigue == fastpin.read_case("case.toml").fatigue


def test_options_take_the_place_of_the_case():
    words = ["--cycles", "20", "--coefficient", "1e-13", "--at", "3,9", "--law", "energy", "--tolerance", "0.05"]
    document = json.loads(printed("wear", "case.toml", *words, "--nodes", "41", "--json"))
    assert [each["cycle"] for each in document["cycles"]] == [0, 3, 9, 20]
    assert document["law"] == "energy"
    assert len(document["angles"]) == 41
    assert set(document["pin_coefficient"]) == {5e-14}


@pytest.mark.parametrize(("cycles", "stored"), [("5", [0, 2, 5]), ("1", [0, 1])])
def test_fewer_cycles_leave_out_the_chosen_ones_beyond(cycles, stored):
    Path("case.toml").write_text(CASE.replace("tolerance = 0", "tolerance = 0\nat = [2, 5, 7]"))
    document = json.loads(printed("wear", "case.toml", "--cycles", cycles, "--json"))
    assert [each["cycle"] for each in document["cycles"]] == stored


@pytest.mark.gate
def test_a_file_is_begun_continued_and_kept():
    first = printed("wear", "case.toml", "-o", "life.h5")
    assert "exists already; overwrite=True (--overwrite) replaces it" in refused("wear", "case.toml", "-o", "life.h5")
    assert "holds a finished life of wear" in refused("wear", "case.toml", "-o", "life.h5", "--resume")
    assert printed("wear", "case.toml", "-o", "life.h5", "--overwrite") == first
    assert "belongs to a life of wear" in refused("resume", "life.h5")


@pytest.mark.gate
def test_a_stored_life_is_shown():
    first = printed("wear", "case.toml", "-o", "life.h5", "--json", "life.json")
    assert printed("show", "life.h5", "--json", "shown.json") == first
    assert Path("shown.json").read_text() == Path("life.json").read_text()
    for option in ("--plot", "--cycles=a.png"):
        words = f"{option.partition('=')[0]}: is for the result of a run; fastpin plot life.h5 draws this life of wear"
        assert refused("show", "life.h5", option) == f"fastpin: {words}\n"


def test_an_unfinished_life_says_so():
    Path("case.toml").write_text(CASE.replace("plate = [{ constant = 1e-12 }, {", "plate = [{ constant = 1e-5 }, {"))
    words = said("wear", "case.toml", "-o", "life.h5", code=1).err
    doubt, error = (line.removeprefix("fastpin: ") for line in words.splitlines())
    assert doubt.startswith("warning: coefficient: 1e-05 1/Pa is more than any surface wears")
    *_, reached, note = printed("show", "life.h5").splitlines()
    assert reached == "unfinished: 0 of 12 cycles; debris is not modelled"
    assert note == f"note: the life is unfinished: {error}"
    assert json.loads(printed("show", "life.h5", "--json"))["error"] == error
    with h5py.File("life.h5", "r+") as file:
        file.attrs["error"] = str(Interrupted())
    assert printed("show", "life.h5").endswith("; continue with: fastpin wear CASE -o life.h5 --resume\n")


@pytest.mark.gate
def test_a_page_of_the_life_is_written_at_once_or_from_its_file():
    said("wear", "case.toml", "-o", "life.h5", "--record", "page.html")
    said("show", "life.h5", "--record", "other.html")
    page = Path("page.html").read_text()
    assert Path("other.html").read_text() == page
    found = recorded(page)
    assert [each["cycle"] for each in found["life"]["cycles"]] == [0, 1, 2, 3, 4, 5, 6, 8, 10, 12]
    assert (found["case"]["title"], found["sentence"]) == ("Worn pin", "")
    words = "is a stored result (HDF5), not text; fastpin show prints it"
    assert words in refused("live", "life.h5")


FAULTS = {
    '--record: must be the name of a page, which ends in .html, not "page.pdf"': ["--record", "page.pdf"],
    "--cycles: must be a whole number, not 2.5": ["--cycles", "2.5"],
    '--cycles: must be a number, not "some"': ["--cycles", "some"],
    "--coefficient: must not be negative, not -1": ["--coefficient", "-1"],
    "--resume: needs --output FILE": ["--resume"],
    "--overwrite: needs --output FILE": ["--overwrite"],
    '--law: must be "archard" or "energy", not "x"': ["--law", "x"],
}


@pytest.mark.parametrize("message", FAULTS)
def test_wrong_options_are_told_in_one_sentence(message):
    assert refused("wear", "case.toml", *FAULTS[message]) == f"fastpin: {message}\n"


def test_a_case_without_wear_needs_a_coefficient():
    Path("plain.toml").write_text(CASE.replace("[wear]", "#").replace("\npin = 1e", "\n#").replace("\nplate = [", "\n#")
                                  .replace("\ntolerance", "\n#"))  # fmt: skip
    assert "--coefficient: is needed: the case file has no section [wear]" in refused("wear", "plain.toml")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("pin = 1e-12", "pin = -1", "pin: must not be negative, not -1"),
        ("tolerance = 0", "tolerance = 2", "tolerance: must lie between 0 and 0.1, not 2"),
        ("tolerance = 0", "cycle = 2", 'unknown key "cycle" in [wear]'),
        ("pin = 1e-12", 'pin = "one"', "pin: "),
    ],
)
def test_faults_of_the_section_are_told_with_their_lines(old, new, message):
    Path("case.toml").write_text(CASE.replace(old, new))
    error = refused("wear", "case.toml")
    line = 1 + CASE[: CASE.index(old)].count("\n")
    assert f"case.toml, line {line}: " in error
    assert message in error


def test_the_section_comes_back_from_the_writer():
    case = parse_case(CASE)
    again = parse_case(case_text(case))
    assert again.wear.cycles == case.wear.cycles == 12
    theta = np.linspace(-3.0, 0.0, 50)
    assert np.array_equal(*(each.wear.coefficients(0.01, theta) for each in (case, again)))


def test_without_a_cycle_there_is_a_document_all_the_same():
    document = wear.document(None, "no cycle", "interrupted")
    assert not list(Draft202012Validator(json_schema("wear")).iter_errors(document))
