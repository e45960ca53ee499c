"""Outcomes of stress, slip and fatigue: their values, their reasons, and the commands that show them."""

import csv
import math
import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import CaseFileError, Result, converge
from fastpin.model import FatigueConstants
from fastpin.model.angles import from_bottom
from fastpin.model.units import units
from fastpin.studies import parse_plan
from fastpin.studies.outcome_tables import outcomes_from
from fastpin.studies.outcomes import CYCLE_QUANTITIES, OutcomeValue, StudyOutcome, value_of
from tests.support import fatigue
from tests.support.case_texts import FATIGUED
from tests.support.commands import printed, said
from tests.support.faults import faults_of

CONSTANTS = replace(fatigue.CONSTANTS, threshold_range=None, limit_range=None)
CYCLE = fastpin.LoadHistory([{"P": 4e5, "Q": 2e5, "syy": 2e7}, {"P": 4e5, "Q": -2e5, "syy": 2e6}])
HISTORY = fastpin.LoadHistory([{"P": 4e5}]) + CYCLE.repeated(3)
CRITERIA = ("smith_watson_topper", "fatemi_socie", "findley", "crossland", "dang_van")


def problem(constants: FatigueConstants | None = CONSTANTS, **contact: Any) -> fastpin.Problem:
    """A steel pin in a sheet."""
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.Material(70e9, 0.33, "", constants), plane="stress")
    given = {"hole_radius": 2.4e-3, "clearance": 20e-6, "friction": 0.4} | contact
    return fastpin.Problem(pair, **given)


@pytest.fixture(scope="module")
def result() -> Result:
    return fastpin.solve(problem(), HISTORY, nodes=61, slip_sums=True)


def test_outcomes_at_the_seat_of_a_bush(result: Result) -> None:
    bush = fastpin.bodies.Bushing(fastpin.Material(103e9, 0.34, "", CONSTANTS), 3e-3, 5e-6)
    history = fastpin.LoadHistory([{"P": 4e5}, {"P": 1e5}]).repeated(2)
    bushed = fastpin.solve(problem(plate_body=bush), history, nodes=61)
    for criterion in CRITERIA:
        found = bushed.fatigue(criterion.replace("_", "-"), "seat").hot_spot
        assert value_of(outcome(f"{criterion}_seat"), bushed).value == found.parameter
        assert value_of(outcome(f"{criterion}_angle_seat"), bushed).value == found.theta
        if f"{criterion}_life_seat" in CYCLE_QUANTITIES:
            assert value_of(outcome(f"{criterion}_life_seat"), bushed).value == found.life
        assert found.parameter != bushed.fatigue(criterion.replace("_", "-")).hot_spot.parameter
    reason = value_of(outcome("findley_seat"), result).reason
    assert reason == 'body: "seat" is the edge of the plate round a bush; this plate has no bush'


def outcome(name: str) -> StudyOutcome:
    return outcomes_from({"it": {"cycle": name}})["it"]


def read(name: str, result: Result) -> OutcomeValue:
    """A quantity of the last cycle as a worker reads it."""
    return value_of(pickle.loads(pickle.dumps(outcome(name))), result)


# -- values ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CRITERIA)
def test_a_criterion_is_read_at_the_hot_spot_of_the_last_cycle(name: str, result: Result) -> None:
    spot = result.fatigue(name.replace("_", "-")).hot_spot
    assert read(name, result).value == spot.parameter > 0.0
    assert read(f"{name}_angle", result).value == spot.theta
    assert outcome(f"{name}_angle").reported(spot.theta) == from_bottom(spot.theta)
    if name in ("smith_watson_topper", "fatemi_socie"):
        assert read(f"{name}_life", result).value == spot.life
    else:
        assert f"{name}_life" not in CYCLE_QUANTITIES


def test_slip_and_friction_energy_are_the_largest_of_a_node(result: Result) -> None:
    cycle = result.cycle()
    energy = cycle.friction_energy
    assert read("largest_slip_range", result).value == cycle.slip_range.max() > 0.0
    assert read("largest_slip_range_angle", result).value == cycle.largest_slip_range_angle
    assert read("largest_friction_energy", result).value == energy.max() > 0.0
    away = read("largest_friction_energy_angle", result).value - cycle.theta[np.argmax(energy)]
    assert np.cos(away) == pytest.approx(1.0, abs=1e-12)


def test_slip_that_is_rounding_is_no_slip() -> None:
    pulses = fastpin.LoadHistory([{"P": 4e5, "syy": 5e7}, {"P": 4e4, "syy": 5e6}]).repeated(3)
    stuck = fastpin.solve(problem(friction=0.7), fastpin.LoadHistory([{"P": 1e4}]) + pulses, nodes=61)
    noisy = replace(stuck, states=[*stuck[:-1], replace(stuck[-1], slip=stuck[-1].slip + 1e-19)])
    assert 0.0 < noisy.cycle().largest_slip_range < 1e-18
    assert read("largest_slip_range", noisy)[1:3] == (0.0, None)
    assert read("largest_slip_range_angle", noisy)[1:3] == (None, None)


@pytest.mark.parametrize("name", ["peak_hoop", "kt_bearing", "kt_gross"])
def test_hoop_stress_and_concentrations_are_taken_over_any_span(name: str, result: Result) -> None:
    fields = {"peak_hoop": "value"}
    every = [getattr(state.peak_hoop_stress(), fields.get(name, name)) for state in result]
    expected = {
        ("last", "history"): every[-1],
        ("largest", "history"): np.nanmax(every),
        ("smallest", "cycle"): min(every[-3:]),
        ("largest", "cycle"): max(every[-3:]),
        ("range", "cycle"): max(every[-3:]) - min(every[-3:]),
    }
    for (take, over), number in expected.items():
        given = outcomes_from({"it": {"quantity": name, "take": take, "over": over}})["it"]
        assert value_of(given, result).value == number, (take, over)


def test_units_of_the_parameters_follow_the_problem() -> None:
    paper = units(fastpin.Problem.from_load_parameter(problem(None).pair, 0.5, 0.5))
    si = units(problem())
    expected = {
        "smith_watson_topper": ("Pa", "F^2 beta*/R^2"),
        "fatemi_socie": ("rad", "F beta*/R"),
        "findley": ("Pa", "F/R"),
        "smith_watson_topper_life": ("cycles", "cycles"),
        "dang_van_angle": ("deg", "deg"),
        "largest_slip_range": ("m", "F beta*"),
    }
    for name, both in expected.items():
        assert (outcome(name).unit_in(si).name, outcome(name).unit_in(paper).name) == both, name


# -- reasons -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("fatemi_socie", "fatigue: fatemi-socie needs normal_stress_factor, yield_strength of the plate's material"),
        ("findley_angle", "fatigue: findley needs bending_limit, torsion_limit of the plate's material"),
        ("dang_van", "fatigue: dang-van needs bending_limit, torsion_limit of the plate's material"),
        ("smith_watson_topper_life", "the plate's material has no constants for a life by smith-watson-topper"),
        (
            "largest_friction_energy",
            "the friction energy of nodes is not counted; slip_sums = true in [solve] counts it",
        ),
    ],
)
def test_what_is_missing_is_named(name: str, reason: str) -> None:
    bare = fastpin.solve(problem(None), HISTORY, nodes=61)
    assert read(name, bare)[:3] == (outcome(name).definition, None, reason)
    assert read("smith_watson_topper", bare).value > 0.0  # it needs no constants


def test_limits_that_contradict_each_other_are_a_reason() -> None:
    wrong = fastpin.solve(problem(FatigueConstants(bending_limit=1e8, torsion_limit=2e8)), HISTORY, nodes=61)
    assert "torsion_limit" in read("findley", wrong).reason


def test_a_rigid_plate_has_no_hot_spot() -> None:
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.Material.rigid())
    rigid = fastpin.solve(fastpin.Problem(pair, 2.4e-3, 2e-5, 0.4), HISTORY, nodes=61)
    assert read("smith_watson_topper", rigid).reason == "body: the plate is rigid: its stress is not determined"


def test_criteria_need_all_corners_of_the_last_cycle(result: Result) -> None:
    ends = fastpin.solve(problem(), HISTORY, nodes=61, keep="cycles", slip_sums=True)
    reason = 'not all corners of the last cycle are kept; keep = "corners" keeps them'
    assert read("smith_watson_topper", ends).reason == reason
    for name in ("largest_friction_energy", "largest_slip_range"):  # slip sums count between kept states, too
        assert read(name, ends).value == pytest.approx(read(name, result).value, rel=1e-12)
    unsummed = fastpin.solve(problem(), HISTORY, nodes=61, keep="cycles")
    assert read("largest_slip_range", unsummed).reason == reason


def test_an_infinite_life_is_no_number(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    found = result.fatigue("smith-watson-topper")
    relieved = replace(found, parameter=0.0 * found.parameter, life=np.full_like(found.parameter, np.inf))
    monkeypatch.setattr(Result, "fatigue", lambda *_: relieved)
    same = replace(result)
    assert read("smith_watson_topper", same).value == 0.0
    assert read("smith_watson_topper_life", same)[1:3] == (None, None)


# -- studies -----------------------------------------------------------------------------------------------------

CASE = """
pin.material = "steel"
plate.material = "2024-T3"
[contact]
plane = "stress"
hole_radius = 2.4e-3
clearance = 20e-6
friction = 0.4
[[load]]
P = 4e5
[[load]]
Q = [2e5, -2e5]
syy = [2e7, 2e6]
repeat = 2
[solve]
nodes = 61
slip_sums = true
"""
PLAN = """
case = "case.toml"
[grid]
contact.friction = [0.2, 0.4, 0.6]
[outcomes]
life = { cycle = "smith_watson_topper_life" }
place = { cycle = "smith_watson_topper_angle" }
energy = { cycle = "largest_friction_energy" }
kt = { quantity = "kt_bearing", take = "largest", over = "cycle" }
torsion = { cycle = "findley" }
"""


@pytest.fixture
def plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "plan.toml").write_text(PLAN)
    return tmp_path / "plan.toml"


@pytest.mark.gate
def test_a_sweep_ranks_designs_by_life(plan: Path) -> None:
    out = said("sweep", plan, "--table", "a.csv", "--plot", "a.png", "--workers", "1", code=1).out
    reason = "fatigue: findley needs bending_limit, torsion_limit of the plate's material"
    assert "outcome torsion can't be read in 3 runs" in out
    assert reason in out
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")
    lines = Path("a.csv").read_text().splitlines()
    assert "life cycles, place deg, energy J/m^2" in lines[1]
    rows = list(csv.DictReader(lines[2:]))
    case = fastpin.read_case("case.toml")
    for row in rows:
        changed = fastpin.Problem(case.problem.pair, 2.4e-3, 20e-6, float(row["contact.friction"]))
        alone = fastpin.solve(changed, case.history, **case.options.keywords())
        spot = alone.fatigue("smith-watson-topper").hot_spot
        assert float(row["life"]) == pytest.approx(spot.life, rel=1e-12)
        assert float(row["place"]) == pytest.approx(from_bottom(spot.theta), abs=1e-9)
        assert float(row["kt"]) == max(state.peak_hoop_stress().kt_bearing for state in alone.cycle().states)
    assert len({row["life"] for row in rows}) == 3


@pytest.mark.gate
def test_a_convergence_study_gives_a_life_an_error_bar(plan: Path) -> None:
    names = ("smith_watson_topper", "smith_watson_topper_life", "largest_friction_energy", "crossland_angle")
    study = converge(problem(), HISTORY, (51, 101, 201), outcomes={name: {"cycle": name} for name in names})
    found = {series.name: series for series in study.studies[0].series if series.outcome}
    assert study.unread == {}
    for name in names:
        assert math.isfinite(found[name].estimate.bar), name
        assert found[name].estimate.bar < 0.2 * abs(found[name].values[-1]), name
    plan.write_text(PLAN.replace('torsion = { cycle = "findley" }', ""))
    words = printed("converge", "case.toml", "--nodes", "51,101,201", "--outcomes", plan)
    lines = [line.split() for line in words.splitlines()]
    assert [line[1] for line in lines if line[:1] in (["place"], ["energy"])] == ["deg", "J/m^2"]


# -- the section [fatigue] -------------------------------------------------------------------------------------------

SECTION_PLAN = """\
case = "case.toml"
[grid]
contact.friction = [0.2, 0.4]
[outcomes]
life = { fatigue = "life" }
damage = { fatigue = "damage" }
place = { fatigue = "angle" }
plain = { fatigue = "damage", small_cycles = "elementary" }
never = { fatigue = "life", small_cycles = "original", knee = 1 }
nowhere = { fatigue = "angle", small_cycles = "original", knee = 1 }
cycle = { fatigue = "life", over = "cycle" }
"""


@pytest.mark.gate
def test_outcomes_of_the_section(tmp_path):
    (tmp_path / "case.toml").write_text(FATIGUED, encoding="utf-8")
    plan = parse_plan(SECTION_PLAN, folder=tmp_path)
    assert [plan.outcomes[name].unit for name in ("life", "never")] == ["spectra", "spectra"]
    assert plan.outcomes["cycle"].kind == "life"
    for point in plan.points:
        case = plan.case(point)
        result = fastpin.solve(case.problem, case.history, **case.options.keywords())
        values = {name: value_of(outcome, result) for name, outcome in plan.outcomes.items()}
        spot = result.assessed_fatigue(case.fatigue)[0].hot_spot
        assert values["life"].value == spot.life
        assert values["damage"].value == spot.damage
        assert values["place"].value == spot.theta
        assert values["plain"].value > values["damage"].value  # Haibach's line lies below the curve
        assert values["never"] == (plan.outcomes["never"].definition, None, None, None)
        assert values["nowhere"].value is None
        assert values["cycle"].value == result.assessed_fatigue(case.fatigue.changed(over="cycle"))[0].hot_spot.life


def test_keys_of_the_section_change_no_run(tmp_path):
    (tmp_path / "case.toml").write_text(FATIGUED, encoding="utf-8")
    words = 'an outcome such as { fatigue = "life" } may have knee beside it'
    with pytest.raises(CaseFileError, match=f'"fatigue.knee": changes no run of a sweep; {words}'):
        parse_plan('case = "case.toml"\n[grid]\nfatigue.knee = [1e5, 1e6]\n', folder=tmp_path)
    without = FATIGUED.replace('small_cycles = "haibach"\nknee = 1e6\n', "").replace("[fatigue]\n", "")
    plan = parse_plan(SECTION_PLAN, folder=tmp_path)
    (tmp_path / "case.toml").write_text(without, encoding="utf-8")
    other = parse_plan(SECTION_PLAN, folder=tmp_path)
    assert [point.id for point in plan.points] == [point.id for point in other.points]


def test_faults_of_an_outcome(tmp_path):
    text = '[outcomes]\na = { fatigue = "knee" }\nb = { fatigue = "life", small_cycles = "haibach" }\n'
    found = faults_of(parse_plan, "[grid]\ncontact.friction = [0.2]\n" + text)
    assert [fault for _, fault in found] == [
        'a: fatigue: must be "life", "median_life", "damage", "angle" or "failure_probability", not "knee"',
        'b: knee: must be given with small_cycles = "haibach": the cycles at the knee, such as 1e6',
    ]
