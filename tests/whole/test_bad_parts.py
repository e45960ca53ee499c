"""One wrong body or profile gets one sentence: in Python, in a case file, in a plan and from fastpin check."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, LoadHistory, Material, MaterialPair, Problem
from fastpin.bodies import Bushing, Plate, Ring, Tube
from fastpin.model import InitialGap, Profile
from fastpin.model.acting import check_loads
from tests.support.bodies import soft_plate
from tests.support.case_texts import PRESSED
from tests.support.everywhere import one_sentence

PAIR = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
CONTACT = {"hole_radius": 0.01, "clearance": 2e-5, "friction": 0.3}
BRONZE = Material(110e9, 0.34)
BUSH = {"E": 110e9, "nu": 0.34, "outer_radius": 0.0125}


def problem(contact: dict[str, Any] | None = None, **bodies: Any) -> Problem:
    return Problem(PAIR, **CONTACT, **(contact or {}), **bodies)


def bushed(**given: Any) -> Problem:
    return problem(plate_body=Bushing(BRONZE, 0.0125, **given))


def loaded(body: Any, **load: float) -> None:
    check_loads(problem(plate_body=body), LoadHistory([load]))


Values = dict[str, Any]

ALONE: list[tuple[str, str, Values, Any]] = [
    ("pin_body", "bore_radius", {"bore_radius": 0.02}, lambda: problem(pin_body=Tube(0.02))),
    ("pin_body", "bore_radius", {"bore_radius": 0.00995}, lambda: problem(pin_body=Tube(0.00995))),
    ("pin_body", "bore_radius", {"bore_radius": -0.1}, lambda: Tube(-0.1)),
    ("pin_body", "load", {"bore_radius": 5e-3, "load": "centre"}, lambda: Tube(5e-3, "centre")),
    ("plate_body", "outer_radius", {"outer_radius": 5e-3}, lambda: problem(plate_body=Ring(5e-3))),
    ("plate_body", "outer_radius", {"outer_radius": 0.01005}, lambda: problem(plate_body=Ring(0.01005))),
    ("plate_body", "support", {"outer_radius": 0.02, "support": "soft"}, lambda: Ring(0.02, "soft")),
    ("plate_body", "reaction", {"reaction": [0, 0.01]}, lambda: problem(plate_body=Plate((0, 0.01)))),
    ("plate_body", "interference", {**BUSH, "interference": -1e-6}, lambda: Bushing(BRONZE, 0.02, -1e-6)),
    ("plate_body", "interference", {**BUSH, "interference": 0.5}, lambda: bushed(interference=0.5)),
    ("plate_body", "friction", {**BUSH, "friction": -1}, lambda: Bushing(BRONZE, 0.02, friction=-1)),
    ("plate_body", "rigid", {"rigid": True, "outer_radius": 0.02}, lambda: Bushing(Material.rigid(), 0.02)),
    ("plate_body", "ring_outer_radius", {**BUSH, "ring_outer_radius": 0.012}, lambda: bushed(inside=Ring(0.012))),
    *(
        ("plate_body", "file", {"file": f"{name}.json"}, lambda name=name: problem(plate_body=WRONG[name]))
        for name in ("nu", "plane", "hole")
    ),
]
"""Section and key at fault, the values of the section in files, and the same in Python."""

HOLLOW: dict[str, Values] = {"pin_body": {"bore_radius": 5e-3}}
RING: dict[str, Values] = {"plate_body": {"outer_radius": 0.02}}
FILE: dict[str, Values] = {"plate_body": {"file": "good.json"}}
BUSHED: dict[str, Values] = {"plate_body": {**BUSH, "ring_outer_radius": 0.02}}
SUPPORTED: dict[str, Values] = {"plate_body": {"reaction": [0, 0.1]}}
PRESSED_IN = Bushing(BRONZE, 0.0125, inside=Ring(0.02))
HELD, DRIVEN = {"rotation": "fixed", "hub_radius": 4e-3}, {"drive": "ux", "gauge_radius": 0.03}

TOO_FAR = "must be at most the outer radius 0.02, not 0.03"

TOGETHER: list[tuple[str, str, Values, Any, dict[str, Values], str]] = [
    (
        "contact", "pin_load", {"pin_load": "body"}, lambda: problem({"pin_load": "body"}, pin_body=Tube(5e-3)), HOLLOW,
        "a hollow pin has its load in its own body",
    ),
    (
        "contact", "hub_radius", HELD, lambda: problem(HELD, pin_body=Tube(5e-3)), HOLLOW,
        "must be at least the bore radius 0.005, not 0.004",
    ),
    ("contact", "gauge_radius", DRIVEN, lambda: problem(DRIVEN, plate_body=Ring(0.02)), RING, TOO_FAR),
    ("contact", "gauge_radius", DRIVEN, lambda: problem(DRIVEN, plate_body=PRESSED_IN), BUSHED, TOO_FAR),
    (
        "contact", "gauge_radius", DRIVEN, lambda: problem(DRIVEN, plate_body=Plate((0.0, 0.1))), SUPPORTED,
        "a plate with a reaction at a point has no gauge circle",
    ),
    ("load.1", "sxx", {"sxx": 1e6}, lambda: loaded(Ring(0.02), sxx=1e6), RING, ""),
    ("load.1", "syy", {"syy": 1e6}, lambda: loaded(soft_plate(), syy=1e6), FILE, ""),
]  # fmt: skip
"""The same, the values of another section, which does not fit, and the sentence."""

WRONG = {"nu": soft_plate(nu=0.3), "plane": soft_plate(plane="stress"), "hole": soft_plate(hole_radius=0.02)}
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
    for name, body in {"good": soft_plate(), **WRONG}.items():
        (tmp_path / f"{name}.json").write_text(body.to_text())
    return tmp_path


@pytest.mark.parametrize(
    "case", [*((*each, {}, "") for each in ALONE), *TOGETHER], ids=lambda case: f"{case[0]}.{case[1]}"
)
def test_a_wrong_body_gets_the_same_sentence_everywhere(case, folder):
    section, key, own, in_python, others, sentence = case
    values = {section: own, **others}
    text = case_text(values)
    fields = [f'"{name}.{each}" = {toml(value)}\n' for name, table in values.items() for each, value in table.items()]
    plan = f"[[list]]\n{''.join(fields)}"
    line, words = one_sentence(in_python, section, text, case_text({}), plan, folder)
    assert words.startswith(f"{key}: {sentence}")
    assert text.splitlines()[line - 1].split(" = ")[0] == key


def hole(profile: Any) -> Problem:
    return Problem(PAIR, 0.01, 1e-5, 0.3, gap=profile)


sampled = Profile.samples


def rubbed(profile: Any) -> Problem:
    return Problem(PAIR, 0.01, 1e-5, profile)


FOUR = [0.0, 1.5, 3.0, 4.5]

PROFILES: list[tuple[str, str, str, Callable[[], Any]]] = [
    ("gap.hole", "{ ellipse = 5e-3 }", "", lambda: hole(Profile.ellipse(5e-3))),
    ("gap.hole", "{ ellipse = nan }", "ellipse", lambda: Profile.ellipse(math.nan)),
    ("gap.hole", "{ lobes = 0, size = 1e-6 }", "lobes", lambda: Profile.lobes(0, 1e-6)),
    ("gap.hole", "{ lobes = 3, size = true }", "size", lambda: Profile.lobes(3, True)),
    ("gap.hole", "{ harmonic = 1001 }", "harmonic", lambda: Profile.harmonic(1001)),
    ("gap.hole", "{ flat = -1e-6, centre = 0 }", "flat", lambda: Profile.flat(-1e-6, 0.0)),
    ("gap.pin", "{ crown = inf, centre = 0, half_width = 9 }", "crown", lambda: Profile.crown(math.inf, 0.0, 0.1)),
    ("gap.pin", "{ zone = 1e-6, start = 0, stop = 9 }", "", lambda: InitialGap(pin=Profile.zone(1e-6, 0.0, 0.1))),
    ("gap.pin", "{ angles = [0, 90, 180, 270], values = [0, 1, 2] }", "values", lambda: sampled(FOUR, [0, 1, 2])),
    ("gap.pin", "{ angles = [0, 90, 180, 170], values = [0, 1, 2, 1] }", "angles", lambda: sampled([0, 1, 2, 1], FOUR)),
    ("gap.hole", '"wide"', "", lambda: InitialGap("wide")),  # type: ignore[arg-type]
    ("contact.friction", "{ harmonic = 1, cosine = 0.1 }", "", lambda: rubbed(Profile.harmonic(1, 0.1))),
    ("contact.friction", "{ zone = 2e6, start = -9, stop = 9 }", "", lambda: rubbed(Profile.zone(2e6, 0, 1))),
    ("contact.friction", "{ flat = 1e-5, centre = 0 }", "", lambda: rubbed(Profile.flat(1e-5, 0.0))),
    ("contact.friction", "[0.4]", "", lambda: rubbed([0.4])),
    ("contact.friction", '"rough"', "", lambda: rubbed("rough")),
]  # fmt: skip


@pytest.mark.parametrize("case", PROFILES, ids=lambda case: f"{case[0]} {case[1]}")
def test_a_wrong_profile_gets_the_same_sentence_everywhere(case: Any, tmp_path: Path) -> None:
    field, value, word, in_python = case
    section, key = field.split(".")
    text = PRESSED.replace("friction = 0.3", f"friction = {value}")
    if section == "gap":
        text = f"{PRESSED}\n[gap]\n{key} = {value}\n"
    _, words = one_sentence(in_python, section, text, PRESSED, f"[grid]\n{field} = [{value}]\n", tmp_path)
    assert words.startswith(f"{key}.{word}: " if word else f"{key}: ")


def test_functions_that_are_no_profiles_are_refused() -> None:
    for function, words in (
        (lambda theta: theta, "values: must be equal at the ends of a turn"),
        (lambda theta: 1e-6, "must return an array of the shape"),
        (lambda: 1e-6, "must be a callable of 1 arguments"),
        (lambda theta: theta * np.nan, "must be finite numbers in one row"),
        (lambda theta: theta * 1j, "must be a number"),
    ):
        with pytest.raises(InputError, match=words):
            hole(function)


def test_angles_in_degrees_are_refused_in_python() -> None:
    for made in (
        lambda: Profile.ellipse(1e-6, 45.0),
        lambda: Profile.flat(1e-6, -90.0),
        lambda: Profile.zone(0.1, -30.0, 30.0),
        lambda: Profile.crown(1e-6, 45.0, 0.1),
    ):
        with pytest.raises(InputError, match="must lie within two turns: angles are in rad"):
            made()
    with pytest.raises(InputError, match="must increase, all within one turn"):
        hole(([0.0, 90.0, 180.0, 270.0], [0.0, 1e-6, 0.0, 1e-6]))
