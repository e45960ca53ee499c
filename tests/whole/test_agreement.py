"""Text, table, JSON, CSV, page, live page and outcomes of a case say the same, from memory and from its file."""

import csv
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import fastpin
from fastpin import MaterialPair, assess, live
from fastpin.assess.wear import cycle_columns, cycles_curve, scar_curves
from fastpin.model import FatigueAssessment
from fastpin.model.case import beside_of
from fastpin.model.units import units
from fastpin.pages.sections import asked
from fastpin.pages.source import margins
from fastpin.pages.wear import damage, numbers, overview
from fastpin.states.quantities import QUANTITIES
from fastpin.studies import parse_plan
from fastpin.studies.outcome_tables import outcomes_from
from fastpin.studies.outcomes import value_of
from tests.support.case_texts import STEEL_IN_LAMINATE
from tests.support.commands import said
from tests.support.fatigue import CONSTANTS
from tests.support.html import words_of
from tests.support.live_pages import recorded
from tests.support.lives import HISTORY, JOINT, sample_life
from tests.support.tiers import some_gate

HEAD = """
pin.material = "steel"
[plate]
E = 70e9
nu = 0.33
yield_strength = 379e6
growth = { law = "walker", C = 1e-10, m = 3, exponent = 0.5, threshold_range = 1e6, toughness = 3e7 }
[plate.fatigue]
fatigue_strength = 1100e6
strength_exponent = -0.124
fatigue_ductility = 0.22
ductility_exponent = -0.59
shear_fatigue_strength = 640e6
shear_strength_exponent = -0.124
shear_fatigue_ductility = 0.38
shear_ductility_exponent = -0.59
yield_strength = 379e6
normal_stress_factor = 1.0
bending_limit = 140e6
torsion_limit = 85e6
[contact]
hole_radius = 10e-3
clearance = 20e-6
friction = 0.3
[solve]
nodes = 41
"""
THICK = HEAD.replace("[solve]", "thickness = 5e-3\n[solve]")
STEP, TURN = "[[load]]\nP = 2e6\n", "[[load]]\nP = [3e6, 3e5]\n"
TURNS = "[[load]]\nP = [3e6, 3e5, 15e5, 3e5]\n"
CYCLES = "[[load]]\nP = [3e6, 3e5]\nrepeat = 2\n"
IN_N = "[[load]]\nP = [15e3, 15e2, 75e2, 15e2]\n"
CRACK = "[crack]\nfirst = 1e-4\nlast = 1e-3\ntheta = 66\n"
STRENGTH = f"""{STEEL_IN_LAMINATE}[[load]]
P = [2e3, 1e3]
[solve]
nodes = 41
[strength]
criterion = "tsai-wu"
distance = 0.5e-3
"""
CASES = {
    "state": HEAD + STEP,
    "states": THICK + IN_N,
    "cycle": HEAD + "slip_sums = true\n" + CYCLES,
    "margin": THICK + IN_N + '[fatigue]\nlife = 1e5\nsmall_cycles = "haibach"\nknee = 1e6\n',
    "fatigue of a history": HEAD + TURNS + '[fatigue]\ncriterion = ["smith-watson-topper", "fatemi-socie"]\n',
    "fatigue of a cycle": HEAD + CYCLES + '[fatigue]\ncriterion = "fatemi-socie"\nover = "cycle"\n',
    "crack in a cycle": HEAD + CYCLES + CRACK,
    "crack in a spectrum": THICK + IN_N + CRACK,
    "crack under two corners": HEAD + TURN + CRACK,
    "strength": STRENGTH,
}
"""Cases of a run by the noun that they are about."""

OUTCOMES = {
    "cycle": {
        "loss": ('{ cycle = "dissipation" }', ("cycle", "dissipation"), "J/m"),
        "slip": ('{ cycle = "largest_slip_range" }', ("cycle", "largest_slip_range"), "m"),
        "regime": ('{ cycle = "regime" }', ("cycle", "regime"), ""),
    },
    "margin": {"margin": ('{ margin = "fatigue" }', ("margins", "fatigue"), "")},
    "fatigue of a history": {
        "life": ('{ fatigue = "life" }', ("fatigue", "bodies", 0, "life"), "spectra"),
        "angle": ('{ fatigue = "angle" }', ("fatigue", "bodies", 0, "angle"), "deg"),
    },
    "fatigue of a cycle": {
        "life": ('{ fatigue = "life" }', ("fatigue", "bodies", 0, "life"), "cycles"),
        "damage": ('{ fatigue = "damage" }', ("fatigue", "bodies", 0, "damage"), ""),
    },
    "crack in a cycle": {
        "life": ('{ crack = "life" }', ("crack", "life"), "cycles"),
        "fate": ('{ crack = "fate" }', ("crack", "fate"), ""),
        "theta": ('{ crack = "theta" }', ("crack", "angle_of_mouth"), "deg"),
        "fracture": ('{ margin = "fracture" }', ("margins", "fracture"), ""),
    },
    "crack in a spectrum": {"life": ('{ crack = "life" }', ("crack", "life"), "spectra")},
    "strength": {
        "ratio": ('{ strength = "ratio" }', ("strength", "ratio"), ""),
        "angle": ('{ strength = "angle" }', ("strength", "angle"), "deg"),
        "margin": ('{ margin = "ply" }', ("margins", "ply"), ""),
    },
}
"""Outcomes of each case by name: the table of a plan, the place in JSON, and the unit."""


class Told(NamedTuple):
    """A case that is solved: its case file, the result, its stored file, and what ``fastpin run`` says."""

    name: str
    path: Path
    result: fastpin.Result
    stored: Path
    out: str
    err: str


@pytest.fixture(
    scope="module", params=some_gate(CASES, "fatigue of a history", "fatigue of a cycle", "crack in a spectrum")
)
def told(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Told:
    path = tmp_path_factory.mktemp("agreement") / "case.toml"
    path.write_text(CASES[request.param])
    case = fastpin.read_case(path)
    result = fastpin.solve(case.problem, case.history, **case.options.keywords())
    stored = path.with_suffix(".h5")
    fastpin.save(result, stored, sections=beside_of(case))
    return Told(request.param, path, result, stored, *said("run", path))


@pytest.fixture(scope="module")
def document(told: Told) -> dict[str, Any]:
    """The JSON of ``fastpin run``."""
    return json.loads(said("run", told.path, "--json", "-").out)


def judged(text: str) -> list[str]:
    """The lines of a text on fatigue, crack and strength, which a page has as sentences."""
    return [line for line in text.splitlines() if re.match(r"fatigue|crack|strength|load at failure", line)]


def test_the_text_of_a_file_is_that_of_memory(told: Told) -> None:
    shown = said("show", told.stored)
    timed = ("solver", "path solver", "note: ")
    for mine, theirs in ((told.out, shown.out), (told.err, shown.err)):
        mine, theirs = ([line for line in each.splitlines() if not line.startswith(timed)] for each in (mine, theirs))
        assert mine == theirs


def test_the_json_of_a_file_is_that_of_memory(told: Told, document: dict[str, Any]) -> None:
    shown = json.loads(said("show", told.stored, "--json", "-").out)
    assert shown | dict.fromkeys(("statistics", "solver")) == document | dict.fromkeys(("statistics", "solver"))


@pytest.mark.usefixtures("undrawn")
def test_a_page_says_what_the_text_says(
    told: Told, document: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fastpin.pages.result.SECTIONS", (margins, *map(asked, ("fatigue", "crack", "strength"))))
    page = words_of(told.stored, tmp_path / "page.html")
    for line in judged(told.out):
        assert f"{line[0].upper()}{line[1:]}." in page
    for row in document["margins"]:
        if row["margin"] is not None:
            assert re.search(re.escape(row["subject"]) + rf".*?{re.escape(format(row['margin'], '+.2f'))}", page)


def test_the_live_page_has_the_numbers_of_json(told: Told, document: dict[str, Any]) -> None:
    unit, found = (
        units(told.result.problem),
        recorded(live.record_page(fastpin.read_case(told.path), told.result.states)),
    )
    for picture, state in zip(found["add"], document["states"], strict=True):
        assert all(picture[name] == state[name] for name in ("contact", "stick", "slip"))
        for name in ("peak_pressure", "peak_pressure_angle", "peak_shear", "dx", "dy", "rotation", "dissipation"):
            kind = QUANTITIES[name].kind
            factor = unit[kind].factor if kind in unit else 1.0  # angles are in degrees on both
            assert state[name] == (None if picture[name] is None else pytest.approx(factor * picture[name]))


def test_outcomes_have_the_numbers_and_units_of_json(told: Told, document: dict[str, Any]) -> None:
    tables = OUTCOMES.get(told.name, {})
    lines = [f"{name} = {table}" for name, (table, *_) in tables.items()]
    text = 'case = "case.toml"\n[grid]\ncontact.friction = [0.3]\n[outcomes]\n' + "\n".join(lines)
    plan = parse_plan(text, folder=told.path.parent)
    for name, (_, place, unit) in tables.items():
        outcome, expected = plan.outcomes[name], document
        for step in place:
            expected = expected[step] if place[0] != "margins" or step == "margins" else least(expected, step)
        value = value_of(outcome, told.result).value
        assert outcome.unit_in(units(told.result.problem)).name == unit
        assert (outcome.classes[value] if outcome.classes else outcome.reported(value)) == pytest.approx(expected)


def least(margins: list[dict[str, Any]], name: str) -> float:
    """The smallest margin of a name."""
    return min(row["margin"] for row in margins if row["name"] == name)


@pytest.mark.gate
def test_a_crack_that_is_not_followed_is_told_everywhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fastpin.pages.result.SECTIONS", (asked("crack"),))
    (tmp_path / "case.toml").write_text(CASES["crack under two corners"])
    case, reason = fastpin.read_case(tmp_path / "case.toml"), "has no cycle that has ended, and less than three corners"
    result = fastpin.solve(case.problem, case.history, nodes=41)
    fastpin.save(result, tmp_path / "case.h5", sections=beside_of(case))
    assert f"note: no crack is followed: history: {reason}" in said("show", tmp_path / "case.h5").err
    assert f"history: {reason}" in said("crack", tmp_path / "case.h5", code=2).err
    assert f"No crack is followed: history {reason}" in words_of(tmp_path / "case.h5", tmp_path / "page.html")
    outcome = outcomes_from({"life": {"crack": "life"}}, beside_of(case))["life"]
    assert value_of(outcome, result).reason.startswith(f"history: {reason}")


@pytest.mark.gate
def test_the_command_crack_says_what_run_says(told: Told, document: dict[str, Any], tmp_path: Path) -> None:
    if document["crack"] is None:
        return
    table = tmp_path / "crack.csv"
    found = json.loads(said("crack", told.stored, "--json", "-", "--csv", table).out)
    assert found["crack"] == document["crack"]
    assert [row["margin"] for row in found["margins"]] == [
        row["margin"] for row in document["margins"] if "crack" in row["subject"]
    ]
    with table.open(encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-1]
    passes = {"cycle": "cycles", "spectrum": "spectra"}[document["crack"]["repeated"]]
    assert float(last[passes]) == pytest.approx(document["crack"]["life"])
    assert float(last["mouth [deg]"]) == pytest.approx(document["crack"]["angle_of_mouth"])


# -- a life of wear ----------------------------------------------------------------------------------------------

WORN = replace(JOINT, pair=MaterialPair(JOINT.pair.pin, replace(JOINT.pair.plate, fatigue=CONSTANTS)))
HOW = {"cycles": 60, "at": [2, 20], "pin": 2e-12, "plate": 8e-12}
FATIGUE = FatigueAssessment("fatemi-socie")


@pytest.fixture(scope="module")
def life(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a life of wear whose case has a section [fatigue]."""
    path = tmp_path_factory.mktemp("agreement") / "life.h5"
    sample_life(path, WORN, fatigue=FATIGUE)
    return path


@pytest.fixture(scope="module")
def cycles(life: Path) -> list[dict[str, Any]]:
    """The cycles in the JSON of the file."""
    found: list[dict[str, Any]] = json.loads(said("show", life, "--json", "-").out)["cycles"]
    return found


def test_table_and_csv_of_a_life_have_the_numbers_of_json(life: Path, cycles: list[dict[str, Any]]) -> None:
    result = fastpin.storage.load_wear(life)
    unit, curve = units(WORN), cycles_curve(result)
    columns = {name: cells for name, _, cells in cycle_columns(result)}
    for key, kind, head, short in (
        ("depth", "displacement", "depth", "depth"),
        ("energy_per_cycle", "energy", "energy per cycle", "energy/cycle"),
        ("largest_pressure", "traction", "largest pressure", "largest p"),
    ):
        values = [each[key] for each in cycles]
        assert curve[f"{head} [{unit[kind].name}]"].tolist() == values
        factor, _ = unit[kind].scale(values)
        assert columns[short] == [f"{factor * value:.5g}" for value in values]
    for one, each in zip(scar_curves(result), cycles, strict=True):
        assert sorted(one["pressure [Pa]"]) == sorted(each["pressure"])
        assert each["largest_pressure"] >= max(each["pressure"])


@pytest.mark.gate
def test_the_live_page_of_a_life_has_the_numbers_of_json(life: Path, cycles: list[dict[str, Any]]) -> None:
    found = recorded(live.record_life(fastpin.storage.load_wear(life)))["life"]["quantities"]
    shown, unit = {each["name"]: each for each in found}, units(WORN)
    for key, name in (
        ("depth", "largest depth"),
        ("volume", "worn volume"),
        ("energy_per_cycle", "dissipated in a cycle"),
        ("largest_pressure", "largest pressure"),
    ):
        factor = unit[shown[name]["kind"]].factor
        assert [factor * value for value in shown[name]["values"]] == [each[key] for each in cycles]


@pytest.mark.gate
def test_the_live_page_of_a_life_has_the_criteria_of_the_case(life: Path) -> None:
    result, both = fastpin.storage.load_wear(life), ("fatemi-socie", "smith-watson-topper")
    found = recorded(live.record_life(result, fatigue=FatigueAssessment(both)))["life"]["damage"]
    assert found["words"] == [f"plate, {name}: {result.fatigue(name).words}" for name in both]
    assert list(found["values"]) == [f"plate, {name}" for name in both]


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_the_page_of_a_life_has_the_table_and_the_criterion_of_the_case(
    life: Path, cycles: list[dict[str, Any]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fastpin.pages.result.WEAR_SECTIONS", (overview, numbers, damage))
    page, result = words_of(life, tmp_path / "page.html"), fastpin.storage.load_wear(life)
    for line in result.summary().splitlines()[2:]:
        assert all(cell in page for cell in line.split())
    assert f"Energy per cycle: {units(WORN)['energy'].text(cycles[-1]['energy_per_cycle'], 4)}" in page
    assert f"Damage of the plate, Fatemi-Socie: {result.fatigue('fatemi-socie').words}." in page


def test_outcomes_of_a_life_have_the_numbers_of_json() -> None:
    result = fastpin.solve(WORN, HISTORY, nodes=41, arc=(-3.0, -0.1))
    last = assess.wear.document(result.wear(**HOW))["cycles"][-1]
    names = ("depth", "volume", "energy_per_cycle", "largest_pressure")
    tables = {name: {"wear": name, **HOW} for name in names}
    found = outcomes_from(tables | {"old": {"wear": "dissipation", **HOW}}, {"fatigue": FATIGUE})
    for name in names:
        assert value_of(found[name], result).value == pytest.approx(last[name], rel=1e-12, abs=0.0)
    assert found["old"].definition == found["energy_per_cycle"].definition
    assert '"criterion": "fatemi-socie"' in found["depth"].definition
