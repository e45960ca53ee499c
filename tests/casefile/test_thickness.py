"""Loads in N: a case with a thickness is the case with loads in N/m, printed in N."""

import json
import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import CaseFileError, InputError
from fastpin.casefile import EXAMPLE, case_text, parse_case
from fastpin.model import LOADS
from fastpin.model.doubts import doubts
from fastpin.model.units import named_loads
from fastpin.report import describe, state_table
from fastpin.report.summary import document
from fastpin.studies import parse_plan, read_plan
from fastpin.studies.plan import Plan
from tests.support.commands import printed, said
from tests.support.faults import fault_of
from tests.support.refusals import refused
from tests.support.samples import PAIR
from tests.support.tiers import seeds

T = 2.0**-8  # m: a division by it is exact


def thick(text: str, thickness: object = T) -> str:
    return text.replace("friction = 0.4 ", f"thickness = {thickness}\nfriction = 0.4 ", 1)


THICK = thick(EXAMPLE)


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


def given_decimals(seed: int) -> tuple[str, list[str]]:
    """A thickness and three forces as a user writes them: up to four digits."""
    rng = np.random.default_rng(seed)
    forces = [f"{rng.integers(1, 10_000)}e{rng.integers(-2, 3)}" for _ in range(3)]
    return f"{rng.integers(1, 1000)}e-{rng.integers(3, 5)}", forces


def with_decimals(thickness: str, forces: list[str]) -> str:
    text = thick(EXAMPLE, thickness)
    loads = f"[[load]]\nP = [{forces[0]}, {forces[1]}]\nQ = [0.0, {forces[2]}]\n"
    spring = f'rotation = "spring"\nhub_stiffness = {forces[0]}'
    text = text.replace('rotation = "free"', spring).replace('pin_load = "body"', 'pin_load = "centre"')
    return text[: text.index("[[load]]\nP")] + loads


def test_given_decimals_are_divided_once_and_survive_the_writer() -> None:
    for seed in seeds(200):
        thickness, forces = given_decimals(seed)
        case = parse_case(with_decimals(thickness, forces))
        values = case.history.values()
        for value, force in zip([values[0, 0], values[1, 0], values[1, 1]], forces, strict=True):
            assert value == float(force) / float(thickness)
            nearest = float(Fraction(force) / Fraction(thickness))
            assert abs(value - nearest) <= math.ulp(nearest)  # two roundings of the input may move the last bit
        text = case_text(case)
        again = parse_case(text)
        assert again == case or again.problem == case.problem
        assert again.history.values().tobytes() == values.tobytes()
        assert again.problem.thickness == float(thickness)
        assert case_text(again) == text
        assert f"P = [{float(forces[0])!r}, {float(forces[1])!r}]" in text  # in N, as given
        assert f"hub_stiffness = {float(forces[0])!r}" in text


def test_loads_per_thickness_that_no_force_gives_are_written_to_the_last_digit() -> None:
    rng = np.random.default_rng(1)
    problem = fastpin.Problem(PAIR, 0.01, 2e-5, 0.4, thickness=0.007)
    loads = rng.uniform(1e5, 1e6, 400)
    case = fastpin.model.Case(problem, fastpin.LoadHistory.from_array(loads[:, None], ["P"]), fastpin.SolveOptions())
    again = parse_case(case_text(case)).history.values()[:, 0]
    assert not np.array_equal(again, loads)
    assert np.all(np.abs(again - loads) <= np.spacing(loads))


@pytest.mark.parametrize("keep", ["all", "corners"])
def test_states_have_the_loads_as_given(keep: str, titanium_in_aluminium: fastpin.MaterialPair) -> None:
    problem = fastpin.Problem(titanium_in_aluminium, 0.01, 2e-5, 0.4, thickness=0.01)
    whole = fastpin.LoadHistory([{"P": 5e3, "sxx": 1.1e7}]) + fastpin.LoadHistory(
        [{"Q": 1.1e3}, {"Q": -1.1e3}]
    ).repeated(3)
    result = fastpin.solve(problem, whole.per_thickness(0.01), nodes=31, keep=keep, between=2 if keep == "all" else 0)
    after = [state for state in result if state.step > 0]
    assert {state.load["P"] for state in after} == {5e5}
    assert {state.load["sxx"] for state in after} == {1.1e7}
    assert {state.load["Q"] for state in after if state.fraction == 1.0} == {1.1e3 / 0.01, -1.1e3 / 0.01}
    assert named_loads(problem, result[-1].load) == "P = 5 kN, Q = -1.1 kN, sxx = 11 MPa"


def test_reactions_stand_beside_loads_as_given(titanium_in_aluminium: fastpin.MaterialPair) -> None:
    problem = fastpin.Problem(titanium_in_aluminium, 0.01, 2e-5, 0.4, "centre", "fixed", drive="ux", thickness=0.01)
    history = fastpin.LoadHistory([{"P": 5e3}, {"ux": 3e-6}, {"ux": -3e-6}]).per_thickness(0.01)
    result = fastpin.solve(problem, history, nodes=31)
    assert [state.load["P"] for state in result] == [5e5] * 3
    assert [state.load["ux"] for state in result] == [0.0, 3e-6, -3e-6]
    assert all(state.load["Q"] == pytest.approx(state.resultants["Q"], rel=1e-6) for state in result[1:])
    assert result[1].load["Q"] > 0.0 > result[2].load["Q"]


def test_a_spring_is_divided_too() -> None:
    spring = 'rotation = "spring"\nhub_stiffness = 1e4'
    text = EXAMPLE.replace('rotation = "free"', spring).replace('pin_load = "body"', 'pin_load = "centre"')
    assert parse_case(thick(text)).problem.hub_stiffness == 1e4 / T
    assert "of stiffness 10 kN m/rad at" in describe(parse_case(thick(text)))
    assert "of stiffness 10 kN/rad at" in describe(parse_case(text))


@pytest.mark.gate
def test_printed_texts_are_in_newtons_and_results_per_metre(tmp_path: Path) -> None:
    path, stored = tmp_path / "case.toml", tmp_path / "a.h5"
    path.write_text(THICK.replace("2.42e6", "9453.125").replace("7.26e5", "2.8359375e3"))
    plain, case = parse_case(EXAMPLE), fastpin.read_case(path)
    assert np.array_equal(plain.history.values(), case.history.values())
    result = fastpin.solve(case.problem, case.history, nodes=61)
    expected = fastpin.solve(plain.problem, plain.history, nodes=61)
    for state, other in zip(result, expected, strict=True):
        assert state.pressure.tobytes() == other.pressure.tobytes()
        assert state.dissipation == other.dissipation
    words = describe(case)
    assert "thickness 3.90625 mm" in words
    assert words.splitlines()[-4].split()[:3] == ["1", "9.4531", "0"]
    head, units, first = state_table(case.problem, list(result)).splitlines()[:3]
    assert dict(zip(head.replace("load point", "point").split(), ["", *units.split()], strict=False))["P"] == "kN"
    assert units.split()[-1] == "mJ"
    assert float(first.split()[-2]) == pytest.approx(T * 1e3 * result[0].dissipation, rel=1e-3)
    assert named_loads(case.problem, result[0].load) == "P = 9.4531 kN"
    assert named_loads(plain.problem, result[0].load) == "P = 2.42 MN/m"
    found = document(case, result)
    assert (found["problem"]["thickness"], found["units"]["force"]) == (T, "N")
    assert found["states"][0]["load"]["P"] == 9453.125
    json.dumps(found)
    ran, shown = printed("run", path, "--nodes", "61", "-o", stored), printed("show", stored)
    assert ran.splitlines()[:6] == shown.splitlines()[:6]
    kept = fastpin.load(stored)
    assert kept.problem == case.problem
    assert kept[0].load["P"] == 2.42e6
    assert said("check", path).err == ""


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
    assert fault_of(parse_case, thick(EXAMPLE, json.dumps(value)))[1] == f"thickness: {sentence}"
    history = fastpin.LoadHistory([{"P": 1.0}])
    for use in (
        lambda: fastpin.Problem(PAIR, 0.01, 0.0, 0.4, thickness=value),
        lambda: history.per_thickness(value),
    ):
        assert str(refused(use)) == f"thickness: {sentence}"


def test_a_dimensionless_problem_has_none() -> None:
    sentence = "thickness: has no meaning in a dimensionless problem, whose loads are in units of F"
    text = THICK.replace("hole_radius = 10e-3 ", "").replace("clearance = 20e-6 ", "load_parameter = 0.1")
    assert fault_of(parse_case, text.replace("2.42e6", "1.0").replace("7.26e5", "0.3"))[1] == sentence
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


def rows_of(plan: Plan, heat: float) -> list[dict[str, object]]:
    """A finished run for each point. Each dissipates `heat` per metre."""
    rows = []
    for point in plan.points:
        fields = dict.fromkeys(plan.fields) | point.values
        rows.append({"id": point.id, "status": "done", "dimensionless": 0, "dissipation": heat, **fields})
    return rows


def test_each_run_counts_with_its_own_thickness(tmp_path: Path) -> None:
    outcomes = '[outcomes]\nlost = { quantity = "dissipation" }\n'
    (tmp_path / "case.toml").write_text(THICK)
    (tmp_path / "plan.toml").write_text(f'case = "case.toml"\n[grid]\ncontact.thickness = [0.25, 0.5]\n{outcomes}')
    plan = read_plan(tmp_path / "plan.toml")
    rows = [row | {"lost": 8.0} for row in rows_of(plan, 4.0)]
    head, names, *cells = fastpin.report.sweep.text(plan, rows).splitlines()
    assert (head.split()[2], names.split()[1]) == ("lost", "J")
    assert [line.split()[2] for line in cells] == ["2", "4"]
    chart = fastpin.report.sweep.chart(plan, rows, "dissipation")
    assert (chart.label, chart.parts[0][1].tolist()) == ("dissipation (J)", [1.0, 2.0])
    fastpin.report.sweep.write_csv(plan, rows, tmp_path / "a.csv")
    assert "lost J, " in (tmp_path / "a.csv").read_text()


def test_doubts_speak_of_newtons() -> None:
    def doubted(load: float, thickness: float = 5e-3) -> list[str]:
        problem = fastpin.Problem(PAIR, 0.01, 2e-5, 0.4, thickness=thickness)
        return [str(doubt) for doubt in doubts(problem, fastpin.LoadHistory([{"P": load}]).per_thickness(thickness))]

    assert doubted(12.1e3) == []
    assert doubted(120.0) == []  # 1.2 MPa
    assert doubted(12.1) == ["P: 12.1 N is a bearing stress of 0.121 MPa only; forces are in N: 1 kN is 1e3"]
    assert doubted(2.42e6) == ["P: 2.42e6 N strains the bodies by 2, far beyond linear elasticity; forces are in N"]
    assert doubted(12.1e6, 5.0)[0] == "thickness: 5 m is more than 50 hole radii; lengths are in m: 5 mm is 5e-3"


@pytest.mark.parametrize(("force", "is_doubted"), [(20e3, True), (40e3, True), (80e3, False)])
@pytest.mark.parametrize("body", [fastpin.Material(70e9, 0.33), fastpin.Material(210e9, 0.3)])
def test_forces_without_a_thickness_are_doubted_below_3_MPa(
    body: fastpin.Material, force: float, is_doubted: bool
) -> None:
    """20 kN in a hole of 16 mm, meant as N, is 1.25 MPa. Nobody designs a metal joint for that."""
    problem = fastpin.Problem(fastpin.MaterialPair(body, body), 8e-3, 2e-5, 0.4)
    found = doubts(problem, fastpin.LoadHistory([{"P": force}]))
    assert [doubt.field for doubt in found] == (["P"] if is_doubted else [])


def test_a_soft_joint_carries_small_forces() -> None:
    rubber = fastpin.Material(5e6, 0.45)
    problem = fastpin.Problem(fastpin.MaterialPair(rubber, rubber), 8e-3, 2e-5, 0.4)
    assert doubts(problem, fastpin.LoadHistory([{"P": 2e2}])) == []


def test_errors_speak_of_newtons(titanium_in_aluminium: fastpin.MaterialPair) -> None:
    problem = fastpin.Problem(titanium_in_aluminium, 0.01, 2e-5, 0.0, "centre", thickness=0.5)
    with pytest.raises(InputError, match=r"1e-50 times R/beta\* = \S+ N, or all zero"):
        fastpin.solve(problem, fastpin.LoadHistory([{"P": 1e-60}]))
    with pytest.raises(
        fastpin.NoEquilibriumError, match=r"^step 2, at 0 % \(P = 5 kN\): without friction nothing holds"
    ):
        fastpin.solve(problem, fastpin.LoadHistory([{"P": 1e4}, {"M": 1.0}]), nodes=31)


def test_a_session_can_change_a_problem_with_a_thickness() -> None:
    session = fastpin.Session(fastpin.Problem(PAIR, 0.01, 2e-5, 0.4, thickness=5e-3), nodes=51)
    session.advance({"P": 2.42e6})
    assert "P = 12.1 kN" in repr(session)
    session.change(friction=0.3)
    assert session.problem.thickness == 5e-3
