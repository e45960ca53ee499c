"""``fastpin run``, ``show``, ``plot`` and ``report`` of a case with a section [fatigue]."""

import csv
import json
from pathlib import Path

import pytest

import fastpin
from fastpin import cracks, damage
from fastpin.model.doubts import doubts_given
from fastpin.report import json_schema
from tests.support.case_texts import FATIGUED as CASE
from tests.support.commands import printed, refused, said
from tests.support.tiers import for_gate

jsonschema = pytest.importorskip("jsonschema")

HEAD = "fatigue over the whole history as a spectrum, Miner's rule modified by Haibach below the knee at 1e+06 cycles"


@pytest.fixture(scope="module")
@for_gate
def folder(tmp_path_factory):
    """A folder with a case and its stored result."""
    folder = tmp_path_factory.mktemp("fatigue")
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    said("run", folder / "case.toml", "-o", folder / "one.h5")
    return folder


def test_the_ranked_bodies_are_printed(folder):
    ran = [line for line in printed("show", folder / "one.h5").splitlines() if line.startswith("fatigue ")]
    assert ran[0] == HEAD
    case = fastpin.read_case(folder / "case.toml")
    spot = fastpin.load(folder / "one.h5").assessed_fatigue(case.fatigue)[0].hot_spot
    assert ran[1].startswith(f"fatigue of the plate, Smith-Watson-Topper: life {spot.life:.4g} spectra, damage ")
    assert " % by load points " in ran[1]
    assert len(ran) == 2


def test_equal_cycles_are_told_once():
    case = CASE.split("[[load]]")[0] + "[[load]]\nsyy = [100e6, 10e6]\nrepeat = 3\n[fatigue]\n[solve]\nnodes = 31\n"
    Path("case.toml").write_text(case, encoding="utf-8")
    assert "; 100 % by load points 2 and 1 (3 times)" in printed("run", "case.toml")


def test_json_has_the_assessment(folder):
    document = json.loads(printed("show", folder / "one.h5", "--json", "-"))
    jsonschema.validate(document, json_schema("run"))
    found = document["fatigue"]
    assert (found["small_cycles"], found["knee"], found["error"]) == ("haibach", 1e6, None)
    (body,) = found["bodies"]
    assert body["body"] == "plate"
    assert body["life"] * body["damage"] == pytest.approx(1.0)
    assert sum(each["damage"] for each in body["cycles"]) == pytest.approx(body["damage"], rel=1e-6)


@pytest.mark.gate
def test_without_the_section_json_has_none():
    Path("plain.toml").write_text(CASE.split("[fatigue]")[0] + "[solve]\nnodes = 61\n", encoding="utf-8")
    document = json.loads(printed("run", "plain.toml", "--json", "-"))
    jsonschema.validate(document, json_schema("run"))
    assert document["fatigue"] is None


def test_the_figure_follows_the_section(folder):
    words = printed("plot", folder / "one.h5", "fatigue", "-o", "f.png", "--csv", "n.csv")
    assert HEAD.removeprefix("fatigue over ") in words
    rows = list(csv.DictReader(Path("n.csv").read_text(encoding="utf-8").splitlines()))
    case = fastpin.read_case(folder / "case.toml")
    expected = fastpin.load(folder / "one.h5").assessed_fatigue(case.fatigue)[0].damage.max()
    assert max(float(row["damage by smith-watson-topper"]) for row in rows) == pytest.approx(expected, rel=1e-12)


def test_check_explains_the_section(folder):
    words = "Smith-Watson-Topper, over the whole history as a spectrum, Miner's rule modified by Haibach"
    assert words in printed("check", folder / "case.toml")


@pytest.mark.gate
def test_stresses_that_do_not_change_end_with_one_sentence():
    loads = "[[load]]\nP = [3e6, 3e6]\n"
    Path("still.toml").write_text(CASE.split("[[load]]")[0] + loads + "[fatigue]\n[solve]\nnodes = 61\n")
    words = said("run", "still.toml", code=1)
    assert "fatigue: states: must have a turning point: their stresses do not change" in words.err
    assert "fatigue: not known, states: must have a turning point" in words.out


def test_an_unfinished_run_has_no_fatigue(folder):
    def interrupt(done, total):
        if done > 4.5:
            raise KeyboardInterrupt

    case = fastpin.read_case(folder / "case.toml")
    how = {"nodes": 61, "arc": (-4.7, 1.5), "save_after": [3], "fatigue": case.fatigue}
    with pytest.raises(KeyboardInterrupt):
        fastpin.record(case.problem, case.history, "part.h5", progress=interrupt, **how)
    assert "fatigue: not known, the history has not come to its end" in printed("show", "part.h5")
    assert HEAD in printed("resume", "part.h5")


ASKED = (
    CASE.replace("knee = 1e6", "knee = 1e6\nlife = 2e4")
    + """\
[crack]
first = 0.1e-3
last = 2e-3
theta = 81
law = { law = "walker", C = 5e-11, m = 3, threshold_range = 0.5e6, toughness = 35e6 }
"""
)


@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """A folder with a case that asks for a life and has a crack, and its stored result."""
    folder = tmp_path_factory.mktemp("margins")
    (folder / "case.toml").write_text(ASKED, encoding="utf-8")
    with doubts_given():
        said("run", folder / "case.toml", "-o", folder / "one.h5", "--json", folder / "run")
    return folder


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_all_outputs_have_the_margins_of_fatigue_and_crack(asked):
    """Text, JSON and the page have the same margins as Python."""
    result, case = fastpin.load(asked / "one.h5"), fastpin.read_case(asked / "case.toml")
    (reserve,) = result.assessed_reserves(case.fatigue)
    assert reserve.goal == ("life", 2e4)
    ran = json.loads((asked / "run").read_text(encoding="utf-8"))
    jsonschema.validate(ran, json_schema("run"))
    rows = {row["subject"]: row for row in ran["margins"]}
    fatigue = rows["plate: Smith-Watson-Topper, factor on all stresses"]
    assert (fatigue["value"], fatigue["allowable"], fatigue["unit"]) == (1.0, reserve.factor, "")
    assert (fatigue["name"], fatigue["body"], fatigue["load_point"]) == ("fatigue", "plate", reserve.largest)
    assert fatigue["margin"] == pytest.approx(reserve.factor - 1.0)
    assert fatigue["loads"]["Q"] == result[int(reserve.largest) - 1].load["Q"]
    grown = cracks.planned_growth(damage.cycle_states(result, result.cycles[-1]), case.crack)
    fracture = rows["plate: crack, fracture up to its last length"]
    assert fracture["margin"] == pytest.approx(35e6 / grown.K_max.max() - 1.0)
    assert rows["plate: crack, threshold"]["margin"] == pytest.approx(grown.threshold[0] / grown.delta_K[0] - 1.0)
    lines = printed("show", asked / "one.h5").splitlines()
    (line,) = (line for line in lines if line.startswith("  plate: Smith-Watson-Topper, factor on all stresses"))
    assert f" {reserve.factor - 1.0:+.2f}" in line
    assert "for a life of 20000 spectra; at " in line
    assert sum(line.startswith("  plate: crack, ") for line in lines) == 3
    said("report", asked / "one.h5", "-o", "page.html")
    page = Path("page.html").read_text(encoding="utf-8")
    for subject in (*(name for name in rows if name.startswith("plate: ")), "for a life of 20000 spectra; at "):
        assert subject in page
    assert "plate, fatigue, Smith-Watson-Topper" not in page  # the row without a limit


def test_a_wrong_life_names_its_line():
    Path("case.toml").write_text(CASE.replace("knee = 1e6", "knee = 1e6\nlife = 0.5"))
    assert "line 16: life: must lie between 1 and 1e+18, not 0.5" in refused("check", "case.toml")


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_result_in_memory_is_judged_by_the_case_file(asked):
    """A page of a result in memory has the sections of the case file that is given with it."""
    result = fastpin.load(asked / "one.h5")
    result.report("plain.html")
    result.report("judged.html", case=asked / "case.toml")
    plain, judged = (Path(f"{name}.html").read_text(encoding="utf-8") for name in ("plain", "judged"))
    for words in ("plate: crack, fracture at its first length", "factor on all stresses", "Crack at 81.00 deg"):
        assert words in judged
        assert words not in plain
