"""Joint files, and what the command makes of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from fastpin import CaseFileError, casefile, figures
from fastpin.assess.outputs import whole_document
from fastpin.cli.main import main
from fastpin.joints import JOINT_EXAMPLE, JointResult, parse_joint, solve_joint
from fastpin.model import FatigueAssessment
from fastpin.report import joints as report
from fastpin.report import json_schema
from fastpin.report.joint_document import JOINT
from tests.support.faults import faults_of
from tests.support.laps import SHEETS


def solved() -> JointResult:
    case = parse_joint(SHEETS)
    return solve_joint(case.joint, case.corners, nodes=case.nodes)


def test_the_example_is_a_lap_of_three_bolts() -> None:
    case = parse_joint(JOINT_EXAMPLE)
    assert [pin.name for pin in case.joint.pins] == ["A", "B", "C"]
    assert case.joint.load_names[0] == "strap.x"
    assert case.corners == [{"strap.x": 15e3}, {"strap.x": 1.5e3}]
    assert case.joint.pins[0].flexibility == pytest.approx(2.1288e-9, rel=1e-4)
    assert not case.joint.plates[0].is_infinite


def test_a_history_repeats() -> None:
    case = parse_joint(SHEETS.replace("nodes = 24", "nodes = 24\nrepeat = 3"))
    assert len(case.corners) == 6


def test_values_for_each_plate_and_parts_of_an_outline_are_read() -> None:
    text = SHEETS.replace("friction = 0.2", "friction = { sheet = 0.3 }\nflexibility = 1e-9").replace(
        "thickness = 2e-3",
        'thickness = 2e-3\nstart = [-0.02, -0.02]\nsupports = { bottom = "both" }\nparts = [{ name = "bottom", '
        "to = [0.04, -0.02] }, { to = [0.04, 0.02] }, { to = [-0.02, 0.02], through = [0.0, 0.025] }, "
        "{ to = [-0.02, -0.02] }]",
    )
    joint = parse_joint(text).joint
    assert joint.pins[0].value_in("friction", "sheet") == 0.3
    assert [part.name for part in joint.plates[0].outline] == ["bottom", "edge", "edge", "edge"]


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("thickness = 2e-3", "thick = 2e-3", 10, 'unknown key "thick" in [[plate]], did you mean "thickness"?'),
        ('"B.x" = 2e3', '"C.x" = 2e3', 23, 'unknown key "C.x" in [[load]]'),
        ("diameter = 5e-3", "diameter = -5e-3", 16, "diameter: must be positive, not -0.005"),
        ('plates = ["sheet"]', 'plates = ["skin"]', 0, 'plates: must be "sheet", not "skin"'),
        ("friction = 0.2", "friction = { skin = 0.2 }", 19, 'friction: must be "sheet", not "skin"'),
        ('["A", "B"]', '["A"]', 13, "name: must name 2 pins, as many as at has points, not 1"),
        ("friction = 0.2", 'heads = "free"', 19, 'heads: needs a pin that bends, flexibility = "beam"'),
        ("friction = 0.2", 'flexibility = "soft"', 19, 'must be "rigid", "tate-rosenfeld" or "beam", not "soft"'),
        ('material = "steel"', 'material = "stel"', 15, "material:"),
        ("[joint]", "[joints]", 4, "unknown section [joints]"),
        ("nodes = 24", "nodes = 2", 5, "nodes: must be a whole number from 16 to 720, not 2"),
        ("[20e-3, 0.0]", "[20e-3]", 14, "at: must be a point [x, y], not [0.02]"),
        ("[joint]", '[fatigue]\nover = "cycles"\n[joint]', 5, 'over: must be "history" or "cycle"'),
        (
            "[joint]",
            "[fatigue]\nlenght = 1e-4\n[joint]",
            5,
            'unknown key "lenght" in [fatigue], did you mean "length"?',
        ),
        ("[joint]", "[fatigue]\n[joint]", 4, "needs fatigue_strength"),
    ],
)
def test_a_fault_has_its_line(old: str, new: str, line: int, words: str) -> None:
    assert old in SHEETS
    found = faults_of(parse_joint, SHEETS.replace(old, new))
    assert any(words in sentence and (line in (0, where)) for where, sentence in found), found


def test_a_cycle_of_fatigue_needs_repeated_corners() -> None:
    asked = SHEETS.replace('"aluminium"', '"2024-T3"') + '[fatigue]\nover = "cycle"\n'
    sentence = "over: the history has no cycles: repeat = 2 in [joint] repeats its corners"
    assert faults_of(parse_joint, asked) == [(28, sentence)]
    assert parse_joint(asked.replace("[joint]", "[joint]\nrepeat = 2")).fatigue == FatigueAssessment(over="cycle")


def test_missing_blocks_are_told_together() -> None:
    words = [sentence for _, sentence in faults_of(parse_joint, "[joint]\n")]
    assert words == [f"[[{name}]] blocks are missing" for name in ("plate", "pin", "load")]


def test_a_joint_file_is_no_case_file() -> None:
    with pytest.raises(CaseFileError, match="is a joint file, not a case file; see fastpin joint"):
        casefile.parse_case(SHEETS)


def test_text_and_json_tell_the_same_numbers() -> None:
    judged = report.judged(solved())
    text, document = report.describe(judged), whole_document(JOINT, judged, {}, title="two bolts")
    assert "fatigue" not in text
    assert "2 pins, 1 plate, 24 nodes a contact" in text
    assert json.loads(json.dumps(document, allow_nan=False)) == document
    Draft202012Validator(json_schema("joint")).validate(document)
    first = document["states"][0]["contacts"][0]
    assert first["force"] == pytest.approx([4e3, 0.0], abs=0.1)
    assert first["share"] == pytest.approx(2.0 / 3.0, abs=1e-4)
    row = document["largest"][0]
    assert row["pressure"] == max(state["contacts"][0]["peak_pressure"] for state in document["states"])
    assert row["hoop"] == max(state["contacts"][0]["peak_hoop_stress"]["value"] for state in document["states"])
    assert f"{1e-6 * row['pressure']:.5g}" in text
    assert (report.UNRESOLVED in text) == any(not each["resolved"] for each in document["largest"])


def _words(text: str) -> str:
    """A text without the spaces that align its columns."""
    return " ".join(text.split())


def test_text_and_json_tell_the_same_lives_and_margins() -> None:
    case = parse_joint(SHEETS.replace('"aluminium"', '"2024-T3"').replace("4e3", "8e3") + "[fatigue]\n")
    judged = report.judged(solve_joint(case.joint, case.corners, nodes=24), case.fatigue)
    text, document = _words(report.describe(judged)), whole_document(JOINT, judged, {}, title="two bolts")
    Draft202012Validator(json_schema("joint")).validate(document)
    first, least = document["fatigue"]["bodies"][0], document["margins"][0]
    assert (first["pin"], first["plate"], first["body"]) == ("A", "sheet", "plate")
    assert first["life"] == min(each["life"] for each in document["fatigue"]["bodies"])
    assert f"A in sheet, hole, Smith-Watson-Topper life {first['life']:.4g} spectra" in text
    assert f"stresses reach {first['over_yield']:.3g} times the yield strength" in text
    assert first["over_yield"] == least["value"] / least["allowable"] == pytest.approx(1.0 / (1.0 + least["margin"]))
    assert least["smallest"]
    assert (
        f"A in sheet, plate: yield, von Mises {1e-6 * least['value']:.4g} MPa of 379 MPa {least['margin']:+.2f}" in text
    )
    spread = replace(judged.damages[0].found, shift=1.0, scatter=0.3)
    asked = judged._replace(how=FatigueAssessment(life=1e5), damages=[judged.damages[0]._replace(found=spread)])
    failing = f"{spread.failure_probability(1e5):.3g} of the specimens fail within 100000 spectra"
    words = f"life {first['life']:.4g} spectra, median life {10.0 * first['life']:.4g}, {failing} damage"
    assert words in _words(report.describe(asked))
    unfinished = report.judged(judged.result, case.fatigue, is_complete=False)
    assert "fatigue: not known, the history has not come to its end" in report.describe(unfinished)
    assert "The history has not come to its end: 2 load points of it." in report.describe(unfinished)
    assert [whole_document(JOINT, each, {})["complete"] for each in (judged, unfinished)] == [True, False]


def test_the_force_of_a_pin_is_negative_against_its_largest_one() -> None:
    result = solve_joint(parse_joint(SHEETS).joint, [{"A.x": 4e3}, {"A.x": -2e3, "B.y": -1e3}], nodes=16)
    text = _words(report.describe(report.judged(result)))
    assert "The force of a pin is negative where it points against its largest one." in text
    panel = figures.plot_shares(result).axes[0]
    np.testing.assert_allclose(panel.lines[0].get_ydata(), [4.0, -2.0], rtol=1e-5)
    np.testing.assert_allclose(panel.lines[1].get_ydata(), [0.0, 1.0], atol=1e-5)


def test_a_joint_without_a_stress_is_told_and_drawn() -> None:
    result = solve_joint(parse_joint(SHEETS).joint, [{"A.x": 0.0}], nodes=16)
    judged = report.judged(result)
    assert "never 0 0 0 - 1 0 0" in _words(report.describe(judged))
    document = whole_document(JOINT, judged, {}, title="")
    Draft202012Validator(json_schema("joint")).validate(document)
    assert document["largest"][0]["hoop_angle"] is None
    (legend,) = figures.plot_joint(result).legends
    assert legend.get_texts()[-1].get_text() == "load point 1, largest force: 0 N"
    assert figures.plot_shares(result).axes[0].get_ylim()[0] == 0.0


def test_figures_are_drawn(tmp_path: Path) -> None:
    result = solved()
    figures.plot_joint(result, tmp_path / "map.svg", width=3.0)
    figures.plot_shares(result, tmp_path / "shares.svg", width=3.0)
    assert "hoop stress" in (tmp_path / "map.svg").read_text() or (tmp_path / "map.svg").stat().st_size > 10_000
    with pytest.raises(Exception, match="state: must be a whole number from -2 to 1, not 7"):
        figures.plot_joint(result, state=7)


def test_the_command_solves_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "joint.toml").write_text(SHEETS)
    out = tmp_path / "out.json"
    assert main(["joint", str(tmp_path / "joint.toml"), "--json", str(out), "--nodes", "16"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("two bolts\n2 pins, 1 plate, 16 nodes a contact")
    assert json.loads(out.read_text())["nodes"] == 16


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--at", "3"], "--at: must be a whole number from 1 to 2, not 3"),
        (["--at", "1"], "--at: chooses the load point of"),
    ],
)
def test_the_command_refuses_a_load_point_that_is_not_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], words: str
) -> None:
    (tmp_path / "joint.toml").write_text(SHEETS)
    assert main(["joint", str(tmp_path / "joint.toml"), *options]) == 2
    assert words in capsys.readouterr().err


def test_the_command_prints_its_example_and_wants_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["joint", "--example"]) == 0
    assert capsys.readouterr().out == JOINT_EXAMPLE
    assert main(["joint"]) == 2
    assert "the joint file is missing; start with: fastpin joint --example" in capsys.readouterr().err


def test_the_command_refuses_a_case_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "case.toml").write_text(casefile.EXAMPLE)
    assert main(["joint", str(tmp_path / "case.toml")]) == 2
    assert "is a case file, not a joint file; see fastpin run" in capsys.readouterr().err


def test_curves_that_hide_one_another_are_one_with_both_names() -> None:
    case = parse_joint(SHEETS.replace('"B.x" = 2e3', '"B.x" = 4e3').replace('"A.x" = 1e3', '"A.x" = 1e3\n"B.x" = 1e3'))
    panel = figures.plot_shares(solve_joint(case.joint, case.corners, nodes=16)).axes[0]
    assert [text.get_text() for text in panel.figure.legends[0].get_texts()] == ["A, B"]
    assert len(panel.lines) == 1


def test_a_fault_of_a_plate_stands_on_the_line_of_the_plate() -> None:
    more = '[[plate]]\nname = "cover"\nmaterial = "aluminium"\nthickness = 1e-3\n\n[[pin]]'
    ((line, message),) = faults_of(parse_joint, SHEETS.replace("[[pin]]", more))
    assert (line, message.partition(":")[0]) == (12, "plate.cover.moves")
