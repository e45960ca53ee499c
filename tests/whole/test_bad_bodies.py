"""One wrong body gets one sentence: in Python, in a case file, in a plan and from fastpin check."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin.bodies import Bushing, Plate, Ring, Tube
from fastpin.bodies.compliance import Compliance
from fastpin.casefile.reader import parse_case
from fastpin.cli.main import main
from fastpin.errors import CaseFileError, InputError
from fastpin.model.history import LoadHistory, check_loads
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.studies.plan import parse_plan

PAIR = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
CONTACT = {"hole_radius": 0.01, "clearance": 2e-5, "friction": 0.3}
BRONZE = Material(110e9, 0.34)
BUSH = {"E": 110e9, "nu": 0.34, "outer_radius": 0.0125}


def plate(**given: Any) -> Compliance:
    matrix = np.zeros((18, 18))
    matrix[0, 0] = 0.25
    return Compliance(**{"nu": 0.33, "plane": "strain", "hole_radius": 0.01, "matrix": matrix} | given)


def problem(contact: dict[str, Any] | None = None, **bodies: Any) -> Problem:
    return Problem(PAIR, **CONTACT, **(contact or {}), **bodies)


def loaded(body: Any, **load: float) -> None:
    check_loads(problem(plate_body=body), LoadHistory([load]))


CASES: list[tuple[str, str, dict[str, dict[str, Any]], Any]] = [
    ("pin_body", "bore_radius", {"pin_body": {"bore_radius": 0.02}}, lambda: problem(pin_body=Tube(0.02))),
    ("pin_body", "bore_radius", {"pin_body": {"bore_radius": 0.00995}}, lambda: problem(pin_body=Tube(0.00995))),
    ("pin_body", "bore_radius", {"pin_body": {"bore_radius": -0.1}}, lambda: Tube(-0.1)),
    ("pin_body", "load", {"pin_body": {"bore_radius": 5e-3, "load": "centre"}}, lambda: Tube(5e-3, "centre")),
    ("plate_body", "outer_radius", {"plate_body": {"outer_radius": 5e-3}}, lambda: problem(plate_body=Ring(5e-3))),
    (
        "plate_body",
        "outer_radius",
        {"plate_body": {"outer_radius": 0.01005}},
        lambda: problem(plate_body=Ring(0.01005)),
    ),
    ("plate_body", "support", {"plate_body": {"outer_radius": 0.02, "support": "soft"}}, lambda: Ring(0.02, "soft")),
    ("plate_body", "reaction", {"plate_body": {"reaction": [0, 0.01]}}, lambda: problem(plate_body=Plate((0, 0.01)))),
    (
        "plate_body",
        "interference",
        {"plate_body": {**BUSH, "interference": -1e-6}},
        lambda: Bushing(BRONZE, 0.02, -1e-6),
    ),
    (
        "plate_body",
        "interference",
        {"plate_body": {**BUSH, "interference": 0.5}},
        lambda: problem(plate_body=Bushing(BRONZE, 0.0125, 0.5)),
    ),
    ("plate_body", "friction", {"plate_body": {**BUSH, "friction": -1}}, lambda: Bushing(BRONZE, 0.02, friction=-1)),
    (
        "plate_body",
        "rigid",
        {"plate_body": {"rigid": True, "outer_radius": 0.02}},
        lambda: Bushing(Material.rigid(), 0.02),
    ),
    (
        "plate_body",
        "ring_outer_radius",
        {"plate_body": {**BUSH, "ring_outer_radius": 0.012}},
        lambda: problem(plate_body=Bushing(BRONZE, 0.0125, inside=Ring(0.012))),
    ),
    (
        "contact",
        "pin_load",
        {"contact": {"pin_load": "body"}, "pin_body": {"bore_radius": 5e-3}},
        lambda: problem({"pin_load": "body"}, pin_body=Tube(5e-3)),
    ),
    (
        "contact",
        "hub_radius",
        {"contact": {"rotation": "fixed", "hub_radius": 4e-3}, "pin_body": {"bore_radius": 5e-3}},
        lambda: problem({"rotation": "fixed", "hub_radius": 4e-3}, pin_body=Tube(5e-3)),
    ),
    (
        "contact",
        "gauge_radius",
        {"contact": {"drive": "ux", "gauge_radius": 0.03}, "plate_body": {"outer_radius": 0.02}},
        lambda: problem({"drive": "ux", "gauge_radius": 0.03}, plate_body=Ring(0.02)),
    ),
    (
        "load.1",
        "sxx",
        {"load.1": {"sxx": 1e6}, "plate_body": {"outer_radius": 0.02}},
        lambda: loaded(Ring(0.02), sxx=1e6),
    ),
    ("load.1", "syy", {"load.1": {"syy": 1e6}, "plate_body": {"file": "good.json"}}, lambda: loaded(plate(), syy=1e6)),
    *(
        (
            "plate_body",
            "file",
            {"plate_body": {"file": f"{name}.json"}},
            lambda name=name: problem(plate_body=WRONG[name]),
        )
        for name in ("nu", "plane", "hole")
    ),
]
"""Section and key at fault, the values in files, and the same in Python."""

WRONG = {"nu": plate(nu=0.3), "plane": plate(plane="stress"), "hole": plate(hole_radius=0.02)}
"""Compliances of another plate, by the names of their files."""


def toml(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else f'"{value}"' if isinstance(value, str) else repr(value)


def case_text(values: dict[str, dict[str, Any]]) -> str:
    tables = {
        "pin": {"material": "steel"},
        "plate": {"material": "aluminium"},
        "contact": CONTACT,
        "load.1": {"P": 1e6},
    }
    for section, table in values.items():
        tables[section] = {**tables.get(section, {}), **table}
    parts = ["[[load]]" if name == "load.1" else f"[{name}]" for name in tables]
    keys = ["".join(f"{key} = {toml(value)}\n" for key, value in table.items()) for table in tables.values()]
    return "".join(f"{part}\n{lines}" for part, lines in zip(parts, keys, strict=True))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, body in {"good": plate(), **WRONG}.items():
        (tmp_path / f"{name}.json").write_text(body.to_text())
    return tmp_path


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}.{case[1]}")
def test_a_wrong_body_gets_the_same_sentence_everywhere(case, folder, capsys):
    section, key, values, in_python = case
    with pytest.raises(InputError) as raised:
        in_python()
    reason = raised.value.reason
    text = case_text(values)
    with pytest.raises(CaseFileError) as raised:
        parse_case(text, folder=folder)
    ((line, words),) = raised.value.problems
    assert words == f"{key}: {reason}"
    assert text.splitlines()[line - 1].split(" = ")[0] == key
    (folder / "case.toml").write_text(text)
    assert main(["check", str(folder / "case.toml")]) == 2
    assert capsys.readouterr().err.rstrip().endswith(f"line {line}: {key}: {reason}")
    (folder / "base.toml").write_text(case_text({}))
    fields = [f'"{name}.{each}" = {toml(value)}\n' for name, table in values.items() for each, value in table.items()]
    with pytest.raises(CaseFileError) as raised:
        parse_plan(f'case = "base.toml"\n[[list]]\n{"".join(fields)}', folder=folder)
    assert [words for _, words in raised.value.problems] == [f"{section}.{key}: {reason}"]
