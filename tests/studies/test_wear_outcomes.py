"""Outcomes of wear: the numbers of a life on a profile that wears, their faults, and their failures."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
import fastpin.wear_lives
from fastpin import CaseFileError, Result
from fastpin.assess.wear import RACE_OUTCOMES, WEAR_OUTCOMES
from fastpin.damage import Race
from fastpin.studies import parse_plan, sweep
from fastpin.studies.outcome_tables import outcomes_from
from fastpin.studies.outcomes import value_of
from fastpin.studies.plan import Plan
from scripts.inline import Inline
from tests.support.faults import faults_of
from tests.support.outcomes import value

HOW: dict[str, Any] = {"cycles": 3000, "pin": 1e-15, "plate": 3e-15, "at": [1000]}

CASE = """
[pin]
material = "Ti-6Al-4V"
[plate]
material = "2024-T3"
[contact]
hole_radius = 5e-3
clearance = 5e-5
friction = 0.6
pin_load = "centre"
rotation = "fixed"
hub_radius = 5e-3
[[load]]
P = 1e6
[[load]]
rotation = [6e-3, -6e-3]
repeat = 1
[solve]
nodes = 41
"""

PLAN = """
case = "case.toml"
[grid]
load.2.rotation = [[6e-3, -6e-3], [2e-2, -2e-2]]
[outcomes]
volume = { wear = "volume", cycles = 20, pin = 1e-15, plate = 3e-15 }
deep = { wear = "depth", cycles = 300, coefficient = 1e-10 }
"""
"""Partial slip, and gross sliding that wears too much."""


@pytest.fixture
def plan(tmp_path: Path) -> Plan:
    (tmp_path / "case.toml").write_text(CASE)
    return parse_plan(PLAN, folder=tmp_path)


@pytest.fixture(scope="module")
def result() -> Result:
    pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["2024-T3"])
    problem = fastpin.Problem(pair, hole_radius=5e-3, clearance=5e-5, friction=0.6, pin_load="centre", rotation="fixed")
    history = fastpin.LoadHistory([{"P": 1e6}]) + fastpin.LoadHistory([{"Q": 8e5}, {"Q": -8e5}]).repeated(2)
    return fastpin.solve(problem, history, nodes=41)


@pytest.mark.gate
def test_the_numbers_are_those_of_the_life(result: Result) -> None:
    life = fastpin.wear(result.problem, result.history, nodes=41, **HOW)
    found, last = life.fatigue(), life[-1]
    expected = {
        "volume": last.volume,
        "depth": last.depth,
        "pin_share": 0.25,
        "energy_per_cycle": last.energy_per_cycle,
        "largest_pressure": last.largest_pressure,
        "life": None,
        "damage": found.damage[-1].max(),
        "race": Race.OPEN,
    }
    assert tuple(expected) == (*WEAR_OUTCOMES, *RACE_OUTCOMES)
    assert last.volume > 0.0
    assert 0.0 < found.damage[-1].max() < 1.0
    for quantity, number in expected.items():
        found = value({"wear": quantity, **HOW}, result)
        assert found == (None if number is None else pytest.approx(number, rel=1e-12))


@pytest.mark.gate
def test_a_crack_has_a_life_and_wins(result: Result) -> None:
    how = HOW | {"cycles": 300_000, "at": [10_000, 30_000, 100_000]}
    found = fastpin.wear(result.problem, result.history, nodes=41, **how).fatigue()
    assert math.isfinite(found.life)
    assert value({"wear": "life", **how}, result) == found.life
    assert value({"wear": "race", **how}, result) == Race.CRACK
    (outcome,) = outcomes_from({"it": {"wear": "race", **how}}).values()
    assert outcome.classes == {0: "no crack in any case", 1: "wear wins", 2: "a crack wins"}


@pytest.mark.gate
def test_outcomes_share_a_life_and_its_damage(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    counts = {"wear": 0, "fatigue": 0}
    follow, damage = Result.wear, fastpin.wear_lives.WearResult.fatigue

    def wear(self: Result, **how: Any) -> Any:
        counts["wear"] += 1
        return follow(self, **how)

    def fatigue(self: Any, *given: Any) -> Any:
        counts["fatigue"] += 1
        return damage(self, *given)

    monkeypatch.setattr(Result, "wear", wear)
    monkeypatch.setattr(fastpin.wear_lives.WearResult, "fatigue", fatigue)
    how = HOW | {"cycles": 2000}
    for quantity in (*WEAR_OUTCOMES, *RACE_OUTCOMES):
        value({"wear": quantity, **how}, result)
    assert counts == {"wear": 1, "fatigue": 1}
    assert value_of(outcomes_from({"it": {"wear": "depth", **how, "pin": 2e-15}})["it"], result).value
    assert counts["wear"] == 2


def test_a_coefficient_along_the_rim_is_written_as_in_a_case(result: Result) -> None:
    zone = [{"constant": 1e-15}, {"zone": 4e-15, "start": -20.0, "stop": 20.0}]
    profile = fastpin.model.Profile.constant(1e-15) + fastpin.model.Profile.zone(
        4e-15, *np.radians([-110.0, -70.0]).tolist()
    )
    life = fastpin.wear(result.problem, result.history, nodes=41, cycles=1000, plate=profile, at=[])
    given = {"wear": "volume", "cycles": 1000, "plate": zone, "at": []}
    assert value(given, result) == pytest.approx(life[-1].volume, rel=1e-12)
    one, other = (outcomes_from({"it": given | {"plate": each}})["it"] for each in (zone, zone[:1]))
    assert one.definition != other.definition


def test_the_wear_of_the_case_is_taken_where_an_outcome_has_none_of_its_own(result: Result, tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(f"{CASE}[wear]\ncoefficient = 4e-15\ncycles = 20\ntolerance = 0\n")
    own = (
        'own = { wear = "depth" }\nplate = { wear = "depth", plate = 1e-15 }\nlong = { wear = "depth", cycles = 30 }\n'
    )
    plan = parse_plan(f"{PLAN}{own}", folder=tmp_path)
    written = {
        "own": {"coefficient": 4e-15, "cycles": 20},
        "plate": {"plate": 1e-15, "cycles": 20},
        "long": {"coefficient": 4e-15, "cycles": 30},
    }
    for name, how in written.items():
        alone = outcomes_from({"it": {"wear": "depth", "tolerance": 0.0, **how}})["it"]
        assert plan.outcomes[name].definition == alone.definition
    added = plan.with_outcomes({"more": {"wear": "depth", "plate": 1e-15}})
    assert added.outcomes["more"].definition == plan.outcomes["plate"].definition
    with pytest.raises(CaseFileError, match=r'"wear\.plate": no run of a sweep wears'):
        parse_plan(PLAN.replace("[outcomes]", "wear.plate = [1e-15]\n[outcomes]"), folder=tmp_path)


def test_all_faults_come_at_once_with_their_lines(tmp_path: Path) -> None:
    text = """[grid]
solve.nodes = [41]
[outcomes]
a = { wear = "volum", cycles = 10, coefficient = 1e-15 }
b = { wear = "volume", coefficient = 1e-15 }
c = { wear = "volume", cycles = 0, coefficient = -1.0, tolerance = 2, law = "x", at = [3, 2] }
d = { wear = "depth", cycles = 10 }
e = { wear = "depth", cycles = 10, coefficient = 1e-15, pin = 1e-15 }
f = { wear = "depth", cycles = 10, coefficient = 1e-15, body = "pin", criterion = "findley" }
g = { wear = "life", cycles = 10, coefficient = 1e-15, criterion = "findley", body = "bolt" }
h = { wear = "life", cycles = 10, coefficent = 1e-15 }
i = { wear = "life", cycles = 10, plate = { zone = 1e-15, start = 10 } }
"""
    found = faults_of(parse_plan, text, folder=tmp_path)
    expected = [
        (4, 'a: wear: must be "volume", "depth"'),
        (5, "b: cycles is missing"),
        (6, 'c: law: must be "archard" or "energy", not "x"'),
        (6, "c: cycles: must lie between 1 and 1e+12, not 0"),
        (6, "c: tolerance: must lie between 0 and 0.1, not 2"),
        (6, "c: coefficient: must not be negative, not -1"),
        (6, "c: at: must be at most 10,000 increasing numbers"),
        (7, "d: coefficient: give the wear coefficient, or those of pin and plate"),
        (8, "e: coefficient: is that of both bodies together"),
        (9, "f: criterion: "),
        (9, "f: criterion: has no effect on the depth"),
        (9, "f: body: has no effect on the depth"),
        (10, "g: criterion: must be "),
        (10, "g: body: must be "),
        (11, 'h: unknown key "coefficent", did you mean "coefficient"?'),
        (11, "h: coefficient: give the wear coefficient"),
        (12, "i: plate: stop is missing"),
    ]
    starts = [(line, words[: len(start)]) for (line, words), (_, start) in zip(found, expected, strict=True)]
    assert starts == expected


@pytest.mark.survey
def test_a_life_that_fails_is_the_reason_of_its_outcome_alone(plan: Plan, tmp_path: Path) -> None:
    summary = sweep.run(plan, tmp_path, Inline())
    assert (summary.done, summary.failed) == (2, [])
    ((_, name, reason),) = summary.unread
    assert name == "deep"
    assert re.match(r"cycle [\d,]+: the worn depth .* is too large for small strains", reason)
    rows = sweep.rows(plan, tmp_path)
    assert all(row["volume"] > 0.0 for row in rows)
    assert [row["deep"] is None for row in rows] == [False, True]


@pytest.mark.survey
def test_worker_processes_read_the_same_numbers(plan: Plan, tmp_path: Path) -> None:
    sweep.run(plan, tmp_path / "one", Inline())
    sweep.run(plan, tmp_path / "two", workers=2)
    one, two = ([(row["volume"], row["deep"]) for row in sweep.rows(plan, tmp_path / name)] for name in ("one", "two"))
    assert one == two
    assert all(volume > 0.0 for volume, _ in one)


@pytest.mark.gate
def test_a_life_that_does_not_end_is_told_apart_from_one_that_could_not_be_read(tmp_path: Path) -> None:
    """No crack within 20 cycles; and a pin without constants."""
    (tmp_path / "case.toml").write_text(CASE)
    plan = parse_plan(
        'case = "case.toml"\n[grid]\nload.2.rotation = [[2e-2, -2e-2]]\n[outcomes]\n'
        'life = { wear = "life", cycles = 20, coefficient = 1e-16 }\n'
        'lost = { wear = "life", cycles = 20, coefficient = 1e-16, body = "pin" }\n',
        folder=tmp_path,
    )
    sweep.run(plan, tmp_path / "out", Inline())
    (row,) = sweep.rows(plan, tmp_path / "out")
    assert (row["life"], row["lost"], row["endless"]) == (None, None, ["life"])
