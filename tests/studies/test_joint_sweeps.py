"""Sweeps and tolerance studies of joint files: fields of pins and plates, outcomes, failures, and stored results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin.errors import CaseFileError
from fastpin.joints import BaseJoint, JointFile, parse_joint, solve_joint
from fastpin.pages import write_sweep_report
from fastpin.report import sweep as report
from fastpin.storage import load_joint
from fastpin.studies import parse_plan, parse_tolerances, read_outcomes, sweep
from fastpin.studies.plan import Plan
from scripts.inline import Inline
from tests.support.faults import faults_of
from tests.support.laps import SHEETS

PLAN = """
case = "joint.toml"
[grid]
pin.B.clearance = [5e-6, 40e-6]
"pin.*.friction" = [0.3]
[outcomes]
first = { joint = "share", pin = "A" }
second = { joint = "share", pin = "B", take = "last" }
by_pass = { joint = "bypass", pin = "A" }
largest = { joint = "hoop" }
where = { joint = "hoop_at" }
slip = { joint = "slip", pin = "B" }
"""


def plan_of(text: str, folder: Path, case: str = SHEETS) -> Plan:
    (folder / "joint.toml").write_text(case, encoding="utf-8")
    return parse_plan(text, folder=folder)


def base(text: str = SHEETS) -> BaseJoint:
    return BaseJoint(text, "joint.toml", Path())


def varied(values: dict[str, Any], text: str = SHEETS) -> JointFile:
    found, case = base(text).vary(values)
    assert not found.faults
    assert case is not None
    return case


def test_fields_name_one_pin_or_all() -> None:
    pins = varied({"pin.B.clearance": 1e-6, "pin.*.clearance": 2e-6}).joint.pins
    assert [pin.clearance for pin in pins] == [2e-6, 1e-6]
    (sheet,) = varied({"plate.sheet.thickness": 4e-3, "plate.*.E": 60e9}).joint.plates
    assert (sheet.thickness, sheet.material.E) == (4e-3, 60e9)
    assert sheet.material.nu == parse_joint(SHEETS).joint.plates[0].material.nu


def test_a_key_of_one_plate_and_of_a_table() -> None:
    case = varied({"pin.A.clearance.sheet": 3e-6})
    assert [pin.clearance for pin in case.joint.pins] == [{"sheet": 3e-6}, 5e-6]


def test_loads_and_options_are_fields() -> None:
    case = varied({"load.1.B.x": 5e3, "loads": 2.0, "loads.A.x": 0.5, "joint.nodes": 32})
    assert case.corners == [{"A.x": 4e3, "B.x": 10e3}, {"A.x": 1e3}]
    assert case.nodes == 32


def test_equal_joints_have_equal_ids_and_others_have_not() -> None:
    same = varied({"pin.A.clearance": 5e-6})
    assert BaseJoint.identity(same, False) == BaseJoint.identity(parse_joint(SHEETS), True)
    renamed = parse_joint(SHEETS.replace('title = "two bolts"', 'title = "other"'))
    assert BaseJoint.identity(renamed, False) == BaseJoint.identity(parse_joint(SHEETS), False)
    other = varied({"pin.A.clearance": np.nextafter(5e-6, 1.0)})
    assert BaseJoint.identity(other, False) != BaseJoint.identity(same, False)
    json.dumps(BaseJoint.identity(varied({"pin.A.clearance": -0.0}), False), allow_nan=False)


def test_words_and_units_of_fields() -> None:
    words = {
        "pin.B.clearance": ("clearance of B", "length"),
        "pin.*.friction": ("friction coefficient of all pins", ""),
        "pin.A.clearance.sheet": ("clearance of A in sheet", "length"),
        "pin.A.clamp.force": ("clamp force of A", "force"),
        "plate.sheet.E": ("modulus of sheet", "modulus"),
        "load.2.A.x": ("A.x in load 2", "force"),
        "load.1.sheet.sxx": ("sheet.sxx in load 1", "traction"),
        "loads.A.x": ("factor of A.x", ""),
        "joint.nodes": ("nodes", ""),
    }
    assert {name: (BaseJoint.words(name), BaseJoint.kind(name)) for name in words} == words


def test_a_sweep_of_a_joint_has_its_outcomes(tmp_path: Path) -> None:
    plan = plan_of(PLAN, tmp_path)
    summary = sweep.run(plan, tmp_path / "out", Inline())
    assert (summary.done, summary.failed) == (2, [])
    rows = sweep.rows(plan, tmp_path / "out")
    case = plan.case(plan.points[1])
    result = solve_joint(case.joint, case.corners, nodes=case.nodes)
    row = rows[1]
    shares = [state.shares("sheet") for state in result]
    assert (row["first"], row["second"]) == (shares[0]["A"], shares[1]["B"])
    assert row["by_pass"] == result[0].force("B", "sheet")[0]
    hoops = {pin: max(state[pin, "sheet"].peak_hoop_stress().value for state in result) for pin in "AB"}
    assert row["largest"] == max(hoops.values())
    assert row["where"] == "AB".index(max(hoops, key=hoops.__getitem__))
    assert row["max_pressure"] == max(float(c.peak_pressure) for s in result for c in s.contacts if c.in_contact)
    assert (row["states"], row["nodes"], row["peak_pressure"]) == (2, 24, None)
    stored = load_joint(tmp_path / "out/results" / f"{plan.points[1].id}.h5")
    assert all(np.array_equal(one.forces, other.forces) for one, other in zip(stored, result, strict=True))
    text = report.text(plan, rows)
    assert "A in sheet" in text
    assert "um" in text
    assert sweep.run(plan, tmp_path / "out", Inline()).ended == 0
    report.write_csv(plan, rows, tmp_path / "a.csv")
    head = (tmp_path / "a.csv").read_text().splitlines()[2].split(",")
    assert {"first", "states", "nodes", "max_pressure", "dissipation", "residual"} < {*head}
    assert not {"peak_pressure", "stick_width", "Kt"} & {*head}  # a joint has no such number


def test_outcomes_come_from_another_file_too(tmp_path: Path) -> None:
    plan = plan_of(PLAN, tmp_path)
    (tmp_path / "more.toml").write_text('[outcomes]\nforce = { joint = "force", pin = "B" }\n')
    found = read_outcomes(tmp_path / "more.toml", plan.base.beside(plan.fields))
    assert [*plan.with_outcomes(found).outcomes][-1] == "force"
    (tmp_path / "more.toml").write_text('[outcomes]\nforce = { joint = "force", pin = "C" }\n')
    with pytest.raises(CaseFileError, match='pin: must be "A" or "B", not "C"'):
        read_outcomes(tmp_path / "more.toml", plan.base.beside(plan.fields))


def test_results_in_files_and_outcomes_that_are_added_later(tmp_path: Path) -> None:
    plan = plan_of(PLAN.replace("5e-6, 40e-6", "40e-6"), tmp_path)
    sweep.run(plan, tmp_path / "out", Inline())
    later = plan.with_outcomes({"pressure": {"joint": "pressure", "take": "smallest"}})
    assert sweep.run(later, tmp_path / "out", Inline(), files=True).read == 1
    (path,) = (tmp_path / "out/results").glob("*.h5")
    (row,) = sweep.rows(later, tmp_path / "out")
    states = list(load_joint(path))
    pressures = [[float(c.peak_pressure) if c.in_contact else 0.0 for c in state.contacts] for state in states]
    assert row["pressure"] == min(max(each) for each in pressures)


def test_a_failed_run_has_its_reason_and_the_rest_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = plan_of('case = "joint.toml"\n[grid]\npin.A.clearance = [1e-6, 2e-6]\n', tmp_path)
    assert [*plan.outcomes] == ["share_A", "share_B", "hoop", "hoop_at", "slip", "margin"]
    solve, seen = fastpin.joints.solve_joint, []

    def failing(*arguments: Any, **options: Any) -> Any:
        seen.append(arguments)
        if len(seen) == 1:
            raise fastpin.SolveError("lost its way")
        return solve(*arguments, **options)

    monkeypatch.setattr(fastpin.joints, "solve_joint", failing)
    summary = sweep.run(plan, tmp_path / "out", Inline())
    assert (summary.done, [reason for _, reason in summary.failed]) == (1, ["lost its way"])
    assert sweep.run(plan, tmp_path / "out", Inline(), retry=True).done == 2


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("pin.C.clearance = [1e-6]", '"pin.C.clearance": there is no pin C; there are A, B, and * for all'),
        ("pin.A = [1]", '"pin.A": a field is written pin.NAME.key, such as pin.A.clamp'),
        ("pin.A.name = ['x']", '"pin.A.name": [[pin]] has no key "name" to vary'),
        (
            "pin.A.clearence = [1]",
            '"pin.A.clearence": [[pin]] has no key "clearence" to vary',
        ),
        ("load.3.A.x = [1]", '"load.3.A.x": the file has 2 [[load]] blocks, counted from 1'),
        ("load.1.A.z = [1]", '"load.1.A.z": the loads are sheet.sxx'),
        ("contact.friction = [1]", '"contact.friction": there is no section [contact] in a joint file'),
        ("fatigue.over = ['cycle']", '"fatigue.over": no run of a sweep asks for it'),
        ("joint.node = [1]", '"joint.node": [joint] has plane, nodes, harmonics, repeat'),
        ("loads.C.x = [1]", '"loads.C.x": is no factor'),
        ("pin.A.friction = [-1]", "pin.A.friction: in sheet: must not be negative, not -1"),
        ("pin.B.at = [[1e-3, 0.0]]", "pin.B.at: the holes of A and B in sheet are 0.001 m apart"),
        ("plate.sheet.thickness = ['x']", 'plate.sheet.thickness: must be a number, not "x"'),
        ("loads = ['x']", 'loads: must be a number, not "x"'),
    ],
)
def test_wrong_fields_are_refused_on_their_line(field: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "joint.toml").write_text(SHEETS, encoding="utf-8")
    ((line, message),) = faults_of(parse_plan, f'case = "joint.toml"\n[grid]\n{field}', folder=tmp_path)
    assert line == 3
    assert message.startswith(words)


@pytest.mark.parametrize(
    ("outcome", "words"),
    [
        ('{ joint = "share" }', "x: pin is missing: share is a number of one pin, of A, B"),
        ('{ joint = "share", pin = "C" }', 'x: pin: must be "A" or "B", not "C"'),
        ('{ joint = "hop" }', 'x: joint: must be "share"'),
        ('{ joint = "hoop", plate = "strap" }', 'x: plate: must be "sheet"'),
        ('{ joint = "margin", take = "last" }', "x: take: has no effect on margin"),
        ('{ joint = "life" }', 'x: joint: "life" needs a section [fatigue]'),
        ('{ quantity = "dx" }', "x: quantity: is for one pin"),
    ],
)
def test_wrong_outcomes_are_refused_on_their_line(outcome: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "joint.toml").write_text(SHEETS, encoding="utf-8")
    text = f'case = "joint.toml"\n[grid]\npin.A.clearance = [1e-6]\n[outcomes]\nx = {outcome}'
    ((line, message),) = faults_of(parse_plan, text, folder=tmp_path)
    assert line == 5
    assert message.startswith(words)


def test_outcomes_of_joints_are_for_joints() -> None:
    text = '[grid]\ncontact.friction = [0.1]\n[outcomes]\nx = { joint = "hoop" }'
    assert faults_of(parse_plan, text) == [(4, "x: joint: is for a plan whose case is a joint file")]


def test_faults_of_the_joint_file_have_its_lines(tmp_path: Path) -> None:
    (tmp_path / "joint.toml").write_text(SHEETS.replace("friction = 0.2", 'friction = "high"'), encoding="utf-8")
    text = 'case = "joint.toml"\n[grid]\npin.B.clearance = [1e-6]'
    expected = (1, 'joint.toml, line 19: friction: must be a number, not "high"')
    assert faults_of(parse_plan, text, folder=tmp_path) == [expected]


def test_tolerances_of_clearances_and_holes(tmp_path: Path) -> None:
    (tmp_path / "joint.toml").write_text(SHEETS, encoding="utf-8")
    text = """
    case = "joint.toml"
    corners = false
    samples = 2
    [tolerances]
    pin.A.clearance = { from = 4e-6, to = 6e-6 }
    "pin.*.diameter" = { from = 4.9e-3, to = 5.1e-3 }
    plate.sheet.E = { from = 60e9, to = 80e9 }
    """
    study = parse_tolerances(text, folder=tmp_path)
    assert [each.nominal for each in study.limits.values()] == [5e-6, 5e-3, 69e9]
    assert [*study.plan.outcomes] == ["share_A", "share_B", "hoop", "slip", "margin"]
    sweep.run(study.plan, tmp_path / "out", Inline())
    effects = study.effects(tmp_path / "out")
    assert 0.0 < effects["share_A"].nominal < 1.0
    assert effects["hoop"].percentiles.keys() == {5, 50, 95}


def test_limits_need_one_nominal_value(tmp_path: Path) -> None:
    unlike = SHEETS.replace("clearance = 5e-6", "clearance = { sheet = 5e-6 }")
    (tmp_path / "joint.toml").write_text(unlike, encoding="utf-8")
    start = 'case = "joint.toml"\n[tolerances]\n'
    text = f"{start}pin.A.clearance.sheet = {{ from = 4e-6, to = 6e-6 }}\nloads.B.x = {{ from = 0.9, to = 1.1 }}"
    assert [each.nominal for each in parse_tolerances(text, folder=tmp_path).limits.values()] == [5e-6, 1.0]
    text = f"{start}pin.A.clearance = {{ from = 4e-6, to = 6e-6 }}\nloads.B.y = {{ from = 0.9, to = 1.1 }}"
    (_, first), (_, second) = faults_of(parse_tolerances, text, folder=tmp_path)
    assert first.startswith("pin.A.clearance: the case has no number for it")
    assert second.startswith("loads.B.y: the case has no such load")


@pytest.mark.gate
def test_the_page_of_a_sweep_of_a_joint(tmp_path: Path) -> None:
    plan = plan_of(PLAN, tmp_path)
    sweep.run(plan, tmp_path / "out", Inline())
    write_sweep_report(tmp_path / "out", tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "a joint of several pins and plates" in page
    assert "clearance of B" in page
    assert "bypass" in page
