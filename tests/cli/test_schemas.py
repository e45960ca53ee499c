"""The JSON of every command against its schema."""

import copy
import json
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from fastpin import InputError, verification
from fastpin.casefile import EXAMPLE, LUG_EXAMPLE
from fastpin.cli.main import main
from fastpin.cli.options import SCHEMAS, parser
from fastpin.report import json_schema
from fastpin.report.schema import COMMANDS
from fastpin.verification.rows import Check
from tests.support import seats
from tests.support.case_texts import PRESSED
from tests.support.commands import printed, said
from tests.support.tiers import gate, some_gate

BUSHED = PRESSED + '[plate_body]\nmaterial = "C93200"\nouter_radius = 0.012\ninterference = 1e-5\n'
CASES = {
    "example": EXAMPLE,
    "pressed": PRESSED,
    "thick": PRESSED.replace("[contact]", "[contact]\nthickness = 5e-3").replace("1e6", "5e3"),
    "dimensionless": "[dundurs]\nalpha = 0.1\nbeta = 0.0\nnu_pin = 0.3\n[contact]\nload_parameter = 0.1\n"
    "friction = 0.3\n[[load]]\nP = 1.0\n[[load]]\nQ = [0.1, -0.1]\nrepeat = 2\n",
    "bushed": BUSHED,
    "bush that slips": seats.TEXT.replace("repeat = 3", "repeat = 1"),
    "rigid": PRESSED.replace('[pin]\nmaterial = "steel"', "[pin]\nrigid = true"),
    "lug": PRESSED + "[plate_body]\nouter_radius = 0.02\n[pin_body]\nbore_radius = 0.004\n",
    "not followed": PRESSED + "[[load]]\nM = 1e5\n",
}


def faults(document: Any, command: str) -> list[str]:
    return [
        f"{error.json_path}: {error.message}"
        for error in Draft202012Validator(json_schema(command)).iter_errors(document)
    ]


def written(*words: str) -> Any:
    main([*words, "--json", "out.json"])
    return json.loads(Path("out.json").read_text())


@pytest.mark.gate
def test_every_command_with_json_has_a_schema() -> None:
    actions = next(action for action in parser()._actions if isinstance(action.choices, dict))
    commands = {
        name for name, each in actions.choices.items() if any("--json" in a.option_strings for a in each._actions)
    }
    assert commands | {"compliance"} == {*SCHEMAS, "resume", "show"}
    assert COMMANDS == SCHEMAS
    for command in SCHEMAS:
        Draft202012Validator.check_schema(json_schema(command))
    with pytest.raises(
        InputError, match=r'must be "run", "converge", "verify", .*, "charts", "identify" or "joint", not "x"'
    ):
        json_schema("x")


@pytest.mark.parametrize(
    "case", some_gate(CASES, "example", "dimensionless", "bushed", "bush that slips", "not followed", "lug")
)
def test_summaries(case: str) -> None:
    Path("case.toml").write_text(CASES[case])
    found = written("run", "case.toml", "--nodes", "61", "-o", "a.h5")
    assert faults(found, "run") == []
    assert (found["error"] is not None) == (case == "not followed")
    assert faults(written("show", "a.h5"), "run") == []


def test_summaries_with_error_bars_and_a_cycle() -> None:
    Path("case.toml").write_text(CASES["dimensionless"])
    words = ("run", "case.toml", "--nodes", "101", "--error-bars", "--slip-sums", "--cycle-csv", "c.csv")
    found = written(*words)
    assert found["states"][0]["error_bars"]
    assert found["cycle"]
    assert faults(found, "run") == []


@pytest.mark.gate
def test_a_study() -> None:
    Path("case.toml").write_text(PRESSED)
    for more in ([], ["--increments", "5,10,20"]):
        assert faults(written("converge", "case.toml", "--nodes", "51,61,81", *more), "converge") == []


def test_checks(monkeypatch: pytest.MonkeyPatch) -> None:
    checks = [Check("a", "b", "c", 1.0, 1.5, 0.5, 0.1, "relative"), Check("a", "b", message="no path")]
    monkeypatch.setattr(verification, "verify", lambda _: checks)
    assert faults(written("verify"), "verify") == []


@pytest.mark.parametrize(
    "words",
    [
        *gate("benchmarks nasa-tp-1862"),
        "charts",
        "charts kt_bearing",
        "charts contact_angle --load-parameter 1 --friction 0.3",
    ],
)
def test_benchmarks_and_charts(words: str) -> None:
    command, *more = words.split()
    assert faults(written(command, *more), command) == []


@pytest.mark.gate
def test_a_compliance() -> None:
    Path("lug.toml").write_text(LUG_EXAMPLE)
    said("compliance", "lug.toml", "-o", "lug.json")
    assert faults(json.loads(Path("lug.json").read_text()), "compliance") == []


def test_a_key_that_is_missing_or_new_is_noticed() -> None:
    Path("case.toml").write_text(PRESSED)
    found = written("run", "case.toml", "--nodes", "61")
    for key in ("states", "units"):
        assert faults({name: value for name, value in found.items() if name != key}, "run")
    assert faults(found | {"more": 1}, "run")
    other = copy.deepcopy(found)
    other["states"][0]["peak_pressure"] = "high"
    assert faults(other, "run") == ["$.states[0].peak_pressure: 'high' is not of type 'number', 'null'"]


def test_the_command_prints_the_schema() -> None:
    assert json.loads(printed("schema", "run")) == json_schema("run")
