"""Loads in N: a case with a thickness is the case with loads in N/m, printed in N."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin.casefile.reader import EXAMPLE, parse_case
from fastpin.cli.main import main
from fastpin.errors import CaseFileError, InputError
from fastpin.model.doubts import doubts
from fastpin.model.loads import LOADS
from fastpin.model.units import named_loads
from fastpin.report.case import describe
from fastpin.report.states import state_table
from fastpin.report.summary import document
from fastpin.studies.plan import parse_plan, read_plan
from tests.support.samples import PAIR

T = 2.0**-8  # m: a division by it is exact
THICK = EXAMPLE.replace("friction = 0.4 ", f"thickness = {T}\nfriction = 0.4 ", 1)


def thick(text: str) -> str:
    return text.replace("friction = 0.4 ", f"thickness = {T}\nfriction = 0.4 ", 1)


def test_loads_are_divided_wherever_they_come_from(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("P,M,sxx\n100,3,1e6\n,2,\n")
    blocks = """
[[load]]
P = [1e4, 2e4]
sxx = 1e7
[[load]]
mean = { P = 2e4 }
amplitude = { Q = 1e3, M = 5.0 }
points = 4
repeat = 3
[[load]]
csv = "a.csv"
"""
    text = EXAMPLE[: EXAMPLE.index("[[load]]\nP")].replace('pin_load = "body"', 'pin_load = "centre"') + blocks
    plain, case = parse_case(text, folder=tmp_path), parse_case(thick(text), folder=tmp_path)
    divisor = np.array([T if name in ("P", "Q", "M") else 1.0 for name in LOADS])
    assert np.array_equal(case.history.values(), plain.history.values() / divisor)
    assert case.history.longest_cycle == plain.history.longest_cycle == 4
    assert case.problem.thickness == T
    again = plain.history.per_thickness(T)
    assert np.array_equal(again.values(), case.history.values())


def test_a_spring_is_divided_too() -> None:
    spring = 'rotation = "spring"\nhub_stiffness = 1e4'
    text = EXAMPLE.replace('rotation = "free"', spring).replace('pin_load = "body"', 'pin_load = "centre"')
    assert parse_case(thick(text)).problem.hub_stiffness == 1e4 / T
    assert "of stiffness 10 kN m/rad at" in describe(parse_case(thick(text)))
    assert "of stiffness 10 kN/rad at" in describe(parse_case(text))


def test_printed_texts_are_in_newtons_and_files_per_metre(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, stored = tmp_path / "case.toml", tmp_path / "a.h5"
    path.write_text(THICK.replace("2.42e6", "9453.125").replace("7.26e5", "2.8359375e3"))
    plain, case = parse_case(EXAMPLE), fastpin.read_case(path)
    assert np.array_equal(plain.history.values(), case.history.values())
    result = fastpin.solve(case.problem, case.history, nodes=61)
    expected = fastpin.solve(plain.problem, plain.history, nodes=61)
    for state, other in zip(result, expected, strict=True):
        assert state.pressure.tobytes() == other.pressure.tobytes()
        assert state.dissipation == other.dissipation
    said = describe(case)
    assert "thickness 3.90625 mm" in said
    assert said.splitlines()[-4].split()[:3] == ["1", "9.4531", "0"]
    head, units, first = state_table(case.problem, list(result)).splitlines()[:3]
    assert dict(zip(head.replace("load point", "point").split(), ["", *units.split()], strict=False))["P"] == "kN"
    assert units.split()[-1] == "mJ"
    assert float(first.split()[-2]) == pytest.approx(T * 1e3 * result[0].dissipation, rel=1e-3)
    assert named_loads(case.problem, result[0].load) == "P = 9.4531 kN"
    assert named_loads(plain.problem, result[0].load) == "P = 2.42 MN/m"
    found = document(case, result)
    assert (found["problem"]["thickness"], found["units"]["force"]) == (T, "N/m")
    assert found["states"][0]["load"]["P"] == 2.42e6
    json.dumps(found)
    assert main(["run", str(path), "--nodes", "61", "-o", str(stored)]) == 0
    printed = capsys.readouterr().out.splitlines()[:6]
    assert main(["show", str(stored)]) == 0
    assert capsys.readouterr().out.splitlines()[:6] == printed
    kept = fastpin.load(stored)
    assert kept.problem == case.problem
    assert kept[0].load["P"] == 2.42e6
    assert main(["check", str(path)]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        (0.0, "must be positive, not 0"),
        (-5e-3, "must be positive, not -0.005"),
        ("thin", 'must be a number, not "thin"'),
        (1e31, "must lie between 1e-30 and 1e+30, not 1e+31"),
    ],
)
def test_a_wrong_thickness_gets_one_sentence(value: object, sentence: str) -> None:
    with pytest.raises(CaseFileError) as caught:
        parse_case(EXAMPLE.replace("friction = 0.4 ", f"thickness = {json.dumps(value)}\nfriction = 0.4 ", 1))
    assert [text for _, text in caught.value.problems] == [f"thickness: {sentence}"]
    with pytest.raises(InputError) as error:
        fastpin.Problem(PAIR, 0.01, 0.0, 0.4, thickness=value)
    assert str(error.value) == f"thickness: {sentence}"
    with pytest.raises(InputError) as error:
        fastpin.LoadHistory([{"P": 1.0}]).per_thickness(value)
    assert str(error.value) == f"thickness: {sentence}"


def test_a_dimensionless_problem_has_none() -> None:
    sentence = "thickness: has no meaning in a dimensionless problem, whose loads are in units of F"
    text = THICK.replace("hole_radius = 10e-3 ", "").replace("clearance = 20e-6 ", "load_parameter = 0.1")
    with pytest.raises(CaseFileError) as caught:
        parse_case(text.replace("2.42e6", "1.0").replace("7.26e5", "0.3"))
    assert [found for _, found in caught.value.problems] == [sentence]
    with pytest.raises(InputError, match=f"^{sentence}$"):
        fastpin.Problem(PAIR, 1.0, 0.1, 0.4, dimensionless=True, thickness=1.0)


def test_plans_vary_it(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(THICK)
    grid = "contact.thickness = [0.25, 0.5]\nload.1.P = [1e5]\n"
    (tmp_path / "plan.toml").write_text(f'case = "case.toml"\n[grid]\n{grid}')
    plan = read_plan(tmp_path / "plan.toml")
    assert [plan.case(point).history.values()[0, 0] for point in plan.points] == [4e5, 2e5]
    rows = [{"id": point.id, "status": "waiting", **point.values} for point in plan.points]
    head = fastpin.report.sweep.text(plan, rows).splitlines()[:2]
    assert head[0].split()[1:3] == ["contact.thickness", "load.1.P"]
    assert head[1].split()[:2] == ["mm", "kN"]
    with pytest.raises(CaseFileError, match=r"contact.thickness: the base case gives loads in N/m;"):
        parse_plan("[grid]\ncontact.thickness = [0.25, 0.5]\n")


def test_doubts_speak_of_newtons() -> None:
    def said(load: float, thickness: float = 5e-3) -> list[str]:
        problem = fastpin.Problem(PAIR, 0.01, 2e-5, 0.4, thickness=thickness)
        return [str(doubt) for doubt in doubts(problem, fastpin.LoadHistory([{"P": load}]).per_thickness(thickness))]

    assert said(12.1e3) == []
    assert said(12.1) == ["P: 12.1 N is a bearing stress of 0.121 MPa only; forces are in N: 1 kN is 1e3"]
    assert said(2.42e6) == ["P: 2.42e6 N strains the bodies by 2, far beyond linear elasticity; forces are in N"]
    assert said(12.1e6, 5.0)[0] == "thickness: 5 m is more than 50 hole radii; lengths are in m: 5 mm is 5e-3"


def test_a_session_can_change_a_problem_with_a_thickness() -> None:
    session = fastpin.Session(fastpin.Problem(PAIR, 0.01, 2e-5, 0.4, thickness=5e-3), nodes=51)
    session.advance({"P": 2.42e6})
    assert "P = 12.1 kN" in repr(session)
    session.change(friction=0.3)
    assert session.problem.thickness == 5e-3
