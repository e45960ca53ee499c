"""``fastpin run``, ``show``, ``plot``, ``report`` and ``check`` of a case with a section [strength]."""

import csv
import json
from pathlib import Path

import pytest

import fastpin
from fastpin import assess, damage
from fastpin.report import json_schema
from tests.support.case_texts import STEEL_IN_LAMINATE
from tests.support.commands import printed, said

jsonschema = pytest.importorskip("jsonschema")

pytestmark = pytest.mark.usefixtures("case")

CASE = f"""{STEEL_IN_LAMINATE}[[load]]
P = [2e3, 1e3, 0]
[solve]
nodes = 31
[strength]
criterion = "tsai-wu"
distance = 0.5e-3
failure = true
"""
HEAD = "strength ratio {:.4g} by tsai-wu 500 um from the edge, the least of 3 kept states, at load point 1; at "


@pytest.mark.gate
def test_a_case_with_a_strength_has_its_ratio_and_its_load_at_failure():
    """tests/whole/test_agreement.py holds the outputs against each other."""
    case = fastpin.read_case("case.toml")
    states = fastpin.solve(case.problem, case.history, nodes=31)
    found = damage.joint_strength(states[0], "tsai-wu", distance=0.5e-3)
    assert found.least_ratio < damage.joint_strength(states[1], "tsai-wu", distance=0.5e-3).least_ratio
    shown = printed("run", "case.toml").splitlines()
    lines = [each for each in shown if each.startswith(("load at failure", "strength"))]
    assert f"1 of {found.least_ratio:.3g}" in next(each for each in shown if "plate: first ply by tsai-wu" in each)
    assert lines[0].startswith(HEAD.format(found.least_ratio))
    assert f"ply of {found.ply_angle:g} deg by {found.ply_mode}, {found.joint_mode}" in lines[0]
    options = {"over": "history", "nodes": 31}
    failure = assess.failure_load(case.problem, case.history, "tsai-wu", distance=0.5e-3, **options)
    assert lines[1].startswith(f"load at failure: {failure.factor:.4g} times all loads; load point 1; at ")
    said("run", "case.toml", "-o", "case.h5", "--json", "case.json")
    document = json.loads(Path("case.json").read_text())
    jsonschema.validate(document, json_schema("run"))
    told = document["strength"]
    assert (told["load_point"], told["states"], told["distance"]) == (1.0, 3, 0.5e-3)
    assert told["ratio"] == pytest.approx(found.least_ratio, rel=1e-12)
    assert told["failure"]["factor"] == pytest.approx(failure.factor, rel=1e-9)
    assert told["failure"]["load"]["P"] == pytest.approx(2e3 * failure.factor)  # N: with a thickness
    assert fastpin.storage.StoredResult("case.h5").case.strength == case.strength
    assert "tsai-wu 500 um from the edge, with the load at failure" in printed("check", "case.toml")
    said("report", "case.h5", "-o", "page.html")
    page = Path("page.html").read_text()
    assert lines[1][1:] in page
    states.report("memory.html", case="case.toml")
    assert lines[1][1:] in Path("memory.html").read_text()
    (row,) = [row for row in document["margins"] if "first ply" in row["subject"]]
    assert row["margin"] == pytest.approx(found.least_ratio - 1.0)
    assert row["load_point"] == 1.0


@pytest.mark.gate
def test_a_figure_takes_the_section_unless_options_replace_it():
    said("run", "case.toml", "-o", "case.h5")
    state = fastpin.load("case.h5")[0]
    for words, criterion, distance in (
        ([], "tsai-wu", 0.5e-3),
        (["--criterion", "yamada-sun"], "yamada-sun", 0.5e-3),
        (["--depth", "1e-3"], "tsai-wu", 1e-3),
    ):
        said("plot", "case.h5", "strength", "--states", "1", "--csv", "one.csv", *words)
        ratios = [float(row["strength ratio"]) for row in csv.DictReader(Path("one.csv").read_text().splitlines())]
        least = damage.joint_strength(state, criterion, distance=distance).least_ratio
        assert min(ratios) == pytest.approx(least, rel=1e-7)


@pytest.mark.gate
def test_states_without_a_force_have_no_curve():
    curve = CASE.replace("distance = 0.5e-3", "tension = 0.5e-3\ncompression = 1e-3")
    Path("case.toml").write_text(curve)
    words = "by tsai-wu on the characteristic curve of 500 um in tension and 1 mm in compr"
    assert words in printed("run", "case.toml", "-o", "case.h5")
    said("plot", "case.h5", "strength", "--states", "1")
    Path("case.toml").write_text(curve.replace("[2e3, 1e3, 0]", "0"))
    assert "note: no strength is assessed: tension: needs a force on the pin" in said("run", "case.toml").err


def test_a_failure_that_is_not_found_has_a_reason():
    Path("case.toml").write_text(CASE.replace("P = [2e3, 1e3, 0]", "P = [0, 0, 0]"))
    assert "strength by tsai-wu 500 um from the edge: no stress" in printed("run", "case.toml", "--json", "case.json")
    told = json.loads(Path("case.json").read_text())["strength"]
    assert told["ratio"] is None
    assert told["error"].startswith("history: must stress the laminate")


def test_json_of_another_case_has_none():
    Path("case.toml").write_text(CASE[: CASE.index("[strength]")])
    assert json.loads(printed("run", "case.toml", "--json"))["strength"] is None
