"""``fastpin run``, ``show``, ``plot`` and ``report`` of a case with a section [fatigue]."""

import csv
import json
from pathlib import Path

import pytest

import fastpin
from fastpin import cracks, damage
from fastpin.cli.main import main
from fastpin.model.doubts import doubts_given
from fastpin.report import json_schema
from tests.support.tiers import for_gate

jsonschema = pytest.importorskip("jsonschema")

CASE = """\
title = "A repeated Q"
pin.material = "Ti-6Al-4V"
plate.material = "2024-T3"
[contact]
hole_radius = 10e-3
clearance = 40e-6
friction = 0.4
[[load]]
P = 3e6
[[load]]
Q = [7e5, -7e5]
repeat = 3
[fatigue]
small_cycles = "haibach"
knee = 1e6
[solve]
nodes = 31
"""
HEAD = "fatigue over the whole history as a spectrum, Miner's rule modified by Haibach below the knee at 1e+06 cycles"


@pytest.fixture(scope="module")
@for_gate
def folder(tmp_path_factory):
    """A folder with a case and its stored result."""
    folder = tmp_path_factory.mktemp("fatigue")
    (folder / "case.toml").write_text(CASE, encoding="utf-8")
    assert main(["run", str(folder / "case.toml"), "-o", str(folder / "one.h5")]) == 0
    return folder


def fatigue_lines(capsys):
    return [line for line in capsys.readouterr().out.splitlines() if line.startswith("fatigue ")]


def test_run_and_show_print_the_ranked_bodies(folder, capsys):
    capsys.readouterr()
    assert main(["run", str(folder / "case.toml")]) == 0
    ran = fatigue_lines(capsys)
    assert main(["show", str(folder / "one.h5")]) == 0
    assert fatigue_lines(capsys) == ran
    assert ran[0] == HEAD
    case = fastpin.read_case(folder / "case.toml")
    spot = fastpin.load(folder / "one.h5").assessed_fatigue(case.fatigue)[0].hot_spot
    assert ran[1].startswith(f"fatigue of the plate, smith-watson-topper: life {spot.life:.4g} spectra, damage ")
    assert " % by load points " in ran[1]
    assert len(ran) == 2


def test_json_has_the_assessment(folder, capsys):
    capsys.readouterr()
    assert main(["show", str(folder / "one.h5"), "--json", "-"]) == 0
    document = json.loads(capsys.readouterr().out)
    jsonschema.validate(document, json_schema("run"))
    found = document["fatigue"]
    assert (found["small_cycles"], found["knee"], found["error"]) == ("haibach", 1e6, None)
    (body,) = found["bodies"]
    assert body["body"] == "plate"
    assert body["life"] * body["damage"] == pytest.approx(1.0)
    assert sum(each["damage"] for each in body["cycles"]) == pytest.approx(body["damage"], rel=1e-6)


def test_without_the_section_json_has_none(folder, capsys, tmp_path):
    plain = tmp_path / "plain.toml"
    plain.write_text(CASE.split("[fatigue]")[0] + "[solve]\nnodes = 61\n", encoding="utf-8")
    capsys.readouterr()
    assert main(["run", str(plain), "--json", "-"]) == 0
    document = json.loads(capsys.readouterr().out)
    jsonschema.validate(document, json_schema("run"))
    assert document["fatigue"] is None


def test_the_figure_follows_the_section(folder, capsys, tmp_path):
    numbers = tmp_path / "n.csv"
    capsys.readouterr()
    assert main(["plot", str(folder / "one.h5"), "fatigue", "-o", str(tmp_path / "f.png"), "--csv", str(numbers)]) == 0
    assert HEAD.removeprefix("fatigue over ") in capsys.readouterr().out
    with numbers.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    case = fastpin.read_case(folder / "case.toml")
    expected = fastpin.load(folder / "one.h5").assessed_fatigue(case.fatigue)[0].damage.max()
    assert max(float(row["damage by smith-watson-topper"]) for row in rows) == pytest.approx(expected, rel=1e-12)


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize("source", ["case.toml", "one.h5"])
def test_the_report_has_the_hot_spots(folder, source, capsys, tmp_path):
    page = tmp_path / "page.html"
    assert main(["report", str(folder / source), "-o", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    assert "Fatigue of the plate, smith-watson-topper: life " in text
    assert "s rule modified by Haibach below the knee at 1e+06 cycles" in text


def test_check_explains_the_section(folder, capsys):
    capsys.readouterr()
    assert main(["check", str(folder / "case.toml")]) == 0
    words = "smith-watson-topper, over the whole history as a spectrum, Miner's rule modified by Haibach"
    assert words in capsys.readouterr().out


def test_stresses_that_do_not_change_end_with_one_sentence(folder, capsys, tmp_path):
    still = tmp_path / "still.toml"
    loads = "[[load]]\nP = [3e6, 3e6]\n"
    still.write_text(CASE.split("[[load]]")[0] + loads + "[fatigue]\n[solve]\nnodes = 61\n", encoding="utf-8")
    capsys.readouterr()
    assert main(["run", str(still)]) != 0
    printed = capsys.readouterr()
    assert "fatigue: states: must have a turning point: their stresses do not change" in printed.err
    assert "fatigue: not known, states: must have a turning point" in printed.out


def test_an_unfinished_run_has_no_fatigue(folder, capsys, tmp_path):
    def interrupt(done, total):
        if done > 4.5:
            raise KeyboardInterrupt

    case, path = fastpin.read_case(folder / "case.toml"), tmp_path / "part.h5"
    how = {"nodes": 61, "arc": (-4.7, 1.5), "save_after": [3], "fatigue": case.fatigue}
    with pytest.raises(KeyboardInterrupt):
        fastpin.record(case.problem, case.history, path, progress=interrupt, **how)
    capsys.readouterr()
    assert main(["show", str(path)]) == 0
    assert "fatigue: not known, the history has not come to its end" in capsys.readouterr().out
    assert main(["resume", str(path)]) == 0
    assert HEAD in capsys.readouterr().out
    assert Path(path).exists()


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
        assert (
            main(["run", str(folder / "case.toml"), "-o", str(folder / "one.h5"), "--json", str(folder / "run")]) == 0
        )
    return folder


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_all_outputs_have_the_margins_of_fatigue_and_crack(asked, capsys):
    """run, show, JSON of both and the page have the same margins as Python."""
    result, case = fastpin.load(asked / "one.h5"), fastpin.read_case(asked / "case.toml")
    (reserve,) = result.assessed_reserves(case.fatigue)
    assert reserve.goal == ("life", 2e4)
    ran = json.loads((asked / "run").read_text(encoding="utf-8"))
    jsonschema.validate(ran, json_schema("run"))
    capsys.readouterr()
    assert main(["show", str(asked / "one.h5"), "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["margins"] == ran["margins"]
    rows = {row["subject"]: row for row in ran["margins"]}
    fatigue = rows["plate: smith-watson-topper, factor on all stresses"]
    assert (fatigue["value"], fatigue["allowable"], fatigue["unit"]) == (1.0, reserve.factor, "")
    assert (fatigue["name"], fatigue["body"], fatigue["load_point"]) == ("fatigue", "plate", reserve.largest)
    assert fatigue["margin"] == pytest.approx(reserve.factor - 1.0)
    assert fatigue["loads"]["Q"] == result[int(reserve.largest) - 1].load["Q"]
    grown = cracks.planned_growth(damage.cycle_states(result, result.cycles[-1]), case.crack)
    fracture = rows["plate: crack, fracture up to its last length"]
    assert fracture["margin"] == pytest.approx(35e6 / grown.K_max.max() - 1.0)
    assert rows["plate: crack, threshold"]["margin"] == pytest.approx(grown.threshold[0] / grown.delta_K[0] - 1.0)
    assert main(["show", str(asked / "one.h5")]) == 0
    lines = capsys.readouterr().out.splitlines()
    (line,) = (line for line in lines if line.startswith("  plate: smith-watson-topper, factor on all stresses"))
    assert f" {reserve.factor - 1.0:+.2f}" in line
    assert "for a life of 20000 spectra; at " in line
    assert sum(line.startswith("  plate: crack, ") for line in lines) == 3
    assert main(["report", str(asked / "one.h5"), "-o", str(asked / "page.html")]) == 0
    page = (asked / "page.html").read_text(encoding="utf-8")
    for subject in (*(name for name in rows if name.startswith("plate: ")), "for a life of 20000 spectra; at "):
        assert subject in page
    assert "plate, fatigue, Smith-Watson-Topper" not in page  # the row without a limit


def test_a_wrong_life_names_its_line(tmp_path, capsys):
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace("knee = 1e6", "knee = 1e6\nlife = 0.5"), encoding="utf-8")
    assert main(["check", str(path)]) != 0
    assert "line 16: life: must lie between 1 and 1e+18, not 0.5" in capsys.readouterr().err


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_result_in_memory_is_judged_by_the_case_file(asked):
    """A page of a result in memory has the sections of the case file that is given with it."""
    result = fastpin.load(asked / "one.h5")
    result.report(asked / "plain.html")
    result.report(asked / "judged.html", case=asked / "case.toml")
    plain, judged = ((asked / f"{name}.html").read_text(encoding="utf-8") for name in ("plain", "judged"))
    for words in ("plate: crack, fracture at its first length", "factor on all stresses", "Crack at 81.00 deg"):
        assert words in judged
        assert words not in plain
