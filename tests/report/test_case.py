"""Descriptions of cases."""

import json

import numpy as np
import pytest

from fastpin.bodies.compliance import Compliance
from fastpin.casefile.reader import parse_case
from fastpin.report.case import describe
from fastpin.report.summary import document
from tests.support.body_texts import HEAD


def test_description_of_other_kinds_of_cases() -> None:
    text = """
    [dundurs]
    alpha = 1.0
    beta = 0.3
    nu_pin = 0.3
    [contact]
    load_parameter = 0.05
    friction = 0.4
    rotation = "fixed"
    hub_radius = 1.0
    [[load]]
    P = 1
    [[load]]
    P = 0
    """
    said = describe(parse_case(text))
    for words in ("rigid", "load parameter 0.05", "rotation fixed at radius 1 R", "dimensionless"):
        assert words in said
    assert said.splitlines()[-1].split() == ["2", "0", "-"]


JOINED = HEAD.replace("friction = 0.3", 'friction = 0.3\nrotation = "fixed"')
BUSH = """
[plate_body]
E = 110e9
nu = 0.34
outer_radius = 12.5e-3
interference = 20e-6
"""


def lines(text: str) -> dict[str, str]:
    """The rows of a description by their names."""
    rows = describe(parse_case(text)).split("\n\n")[0].splitlines()
    width = 10 if any(row.startswith("plate body") for row in rows) else 8
    return {row[:width].strip(): row[width + 1 :] for row in rows}


def test_an_oval_is_described_by_the_place_of_its_largest_gap() -> None:
    """The hole has its longer half axis there, and the pin its shorter one."""
    gap = "[gap]\nhole = { ellipse = 20e-6, axis = 30 }\npin = { ellipse = 5e-6 }\n"
    said, words = describe(parse_case(JOINED + gap)), "(missing material, angles in degrees from the bottom)"
    assert f"hole profile oval of 20 um, largest at 30 deg {words}\n" in said
    assert f"pin profile  oval of 5 um, largest at 0 deg {words}\n" in said


def test_a_hollow_pin_is_described() -> None:
    said = lines(JOINED + "[pin_body]\nbore_radius = 5e-3\n")
    assert said["pin body"] == "hollow, bore radius 5 mm"
    assert said["loading"] == "uniform traction in the bore, rotation fixed at the bore"
    assert "plate body" not in said
    assert lines(JOINED)["loading"] == "force at the centre, rotation fixed at radius 5.976 mm, the paper's datum"
    rigid = JOINED.replace('material = "steel"', "rigid = true")
    assert lines(rigid)["loading"] == "force at the centre, rotation fixed"


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("outer_radius = 20e-3", "ring of outer radius 20 mm, rim clamped"),
        ('outer_radius = 20e-3\nsupport = "half"', "ring of outer radius 20 mm, held by normal pressure on half of"),
        ("reaction = [0, 60e-3]", "infinite plate, forces balanced at x = 0 m, y = 60 mm"),
    ],
)
def test_a_plate_is_described(keys, words) -> None:
    assert lines(f"{JOINED}[plate_body]\n{keys}\n")["plate body"].startswith(words)


def test_a_bush_is_described_with_its_press_fit() -> None:
    case = parse_case(JOINED + BUSH)
    said, problem = lines(JOINED + BUSH), case.problem
    assert said["plate body"] == "infinite plate"
    assert said["bush"] == "E = 110 GPa, nu = 0.34, outer radius 12.5 mm"
    slipping = lines(JOINED + BUSH + "bonded = false\nfriction = 0.2\n")
    assert slipping["bush"] == f"{said['bush']}, slips, friction 0.2 in the plate"
    loose = BUSH.replace("interference = 20e-6", "interference = -5e-6") + "bonded = false\nfriction = 0.2\n"
    assert lines(JOINED + loose)["loose fit"] == "clearance 5 um of the bush in the plate"
    pressure, clearance = problem.press_fit_pressure / 1e6, problem.assembled_clearance * 1e6
    assert said["press fit"] == (
        f"interference 20 um, pressure {pressure:.4g} MPa, clearance after it {clearance:.6g} um"
    )
    alpha, beta = problem.surfaces.dundurs()
    assert (alpha, beta) != pytest.approx(problem.pair.dundurs())
    assert f"pin and bush: Dundurs alpha = {alpha:.4f}, beta = {beta:.4f}" in said["pair"]
    assert f"beta* = {problem.surfaces.beta_star:.4g} 1/Pa" in said["pair"]
    assert describe(case).splitlines()[-1].split()[-1] == f"{problem.load_parameter(1e6):.4g}"
    ring = lines(JOINED + BUSH + "ring_outer_radius = 25e-3\n")
    assert ring["plate body"] == "ring of outer radius 25 mm, rim clamped"
    assert "press fit" not in lines(JOINED + BUSH.replace("interference = 20e-6\n", ""))


def test_a_finite_plate_is_described(tmp_path) -> None:
    matrix = np.zeros((18, 18))
    matrix[0, 0] = 0.25
    plate = Compliance(0.33, "strain", 0.01, matrix, {"sxx": np.ones(18)}, "made by hand")
    (tmp_path / "lug.json").write_text(plate.to_text())
    case = parse_case(f'{JOINED}[plate_body]\nfile = "lug.json"\n', folder=tmp_path)
    words = "plate body finite plate, compliance of 4 harmonics, made by hand, loads: forces, sxx"
    assert words in describe(case).splitlines()
    found = document(case, None)["problem"]["plate_body"]
    assert found["sha256"] == plate.digest
    assert {key: found[key] for key in ("kind", "order", "loads", "made_by")} == {
        "kind": "compliance",
        "order": 4,
        "loads": ["sxx"],
        "made_by": "made by hand",
    }


def test_the_summary_has_the_bodies() -> None:
    case = parse_case(JOINED + BUSH + '[pin_body]\nbore_radius = 5e-3\nload = "held"\n')
    found, problem = document(case, None)["problem"], case.problem
    assert found["pin_body"] == {"kind": "tube", "bore_radius": 5e-3, "load": "held"}
    assert found["plate_body"]["material"] == {
        "name": "", "rigid": False, "E": 110e9, "nu": 0.34, "yield_strength": None, "ultimate_strength": None,
    }  # fmt: skip
    assert found["plate_body"]["inside"] == {"kind": "plate", "reaction": None}
    assert found["plate_body"]["interference"] == 20e-6
    assert found["dundurs"]["alpha"] == problem.surfaces.dundurs()[0]
    assert found["beta_star"] == problem.surfaces.beta_star
    assert found["assembled_clearance"] == problem.assembled_clearance < found["clearance"]
    assert found["press_fit_pressure"] == problem.press_fit_pressure > 0.0
    json.dumps(found, allow_nan=False)
    plain = document(parse_case(JOINED), None)["problem"]
    assert (plain["pin_body"], plain["plate_body"]) == ({"kind": "disk"}, {"kind": "plate", "reaction": None})
    assert plain["assembled_clearance"] == plain["clearance"]
