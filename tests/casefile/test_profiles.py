"""Profiles along the rim in case files: what is read, what is written, and the sentences of wrong ones."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin import CaseFileError, Problem
from fastpin.casefile import case_text, parse_case
from fastpin.model import Profile
from fastpin.model.angles import BOTTOM, angle_at
from fastpin.studies.identity import canonical
from tests.support.case_texts import PRESSED
from tests.support.faults import faults_of

ANGLES = np.linspace(-math.pi, math.pi, 61)

X = ANGLES - BOTTOM
"""Angles from the bottom of the hole."""


def problem(friction: str = "0.3", gap: str = "", folder: Path | str = ".") -> Problem:
    return parse_case(text(friction, gap), "case.toml", folder).problem


def text(friction: str = "0.3", gap: str = "") -> str:
    return PRESSED.replace("friction = 0.3", f"friction = {friction}") + (f"\n[gap]\n{gap}\n" if gap else "")


def faults(friction: str = "0.3", gap: str = "", folder: Path | str = ".") -> list[str]:
    return [sentence for _, sentence in faults_of(problem, friction, gap, folder)]


HOLES = {
    "{ ellipse = 2e-5, axis = 30 }": 2e-5 * np.cos(2 * (X - math.radians(30))),
    "{ lobes = 3, size = 1e-6 }": 1e-6 * np.cos(3 * X),
    "{ lobes = 5, size = 1e-6, axis = -10 }": 1e-6 * np.cos(5 * (X + math.radians(10))),
    "{ harmonic = 7, cosine = 1e-6, sine = -2e-6 }": 1e-6 * np.cos(7 * X) - 2e-6 * np.sin(7 * X),
    "{ crown = 1e-5, centre = 20, half_width = 40 }": np.where(
        np.abs(X - math.radians(20)) < math.radians(40), 5e-6 * (1 + np.cos(4.5 * (X - math.radians(20)))), 0.0
    ),
    "[1e-6, { harmonic = 1, cosine = 3e-6 }]": 1e-6 + 3e-6 * np.cos(X),
    "{ constant = -1e-6 }": np.full(61, -1e-6),
}


@pytest.mark.parametrize("words", HOLES)
def test_words_of_a_gap_mean_angles_from_the_bottom(words: str) -> None:
    assert problem(gap=f"hole = {words}").gap_at(ANGLES)[0] == pytest.approx(HOLES[words], abs=1e-18)


def test_a_lobe_on_the_vertical_has_no_rounding() -> None:
    """Then a problem that is symmetric about the vertical stays so to the last bit."""
    for order in range(9):
        found = problem(gap=f"hole = {{ lobes = {order + 1}, size = 1e-5, axis = 180 }}").gap.hole.toml()
        assert found == [{"harmonic": order + 1, "cosine": 1e-5 * (-1) ** (order + 1), "sine": 0.0}]


def test_a_flat_counts_from_the_radius_of_the_hole() -> None:
    gap = problem(gap="pin = { flat = 1e-5, centre = -90 }").gap
    assert gap.values(np.array([math.pi, BOTTOM]), 0.01)[0] == pytest.approx([1e-5, 0.0], abs=1e-18)
    assert gap.given.keys() == {"pin"}


def test_friction_in_zones() -> None:
    found = problem("[0.3, { zone = 0.2, start = -30, stop = 30 }]")
    assert found.friction_at(np.radians([-90.0, -59.0, -61.0, -121.0, 90.0])).tolist() == [0.5, 0.3, 0.5, 0.3, 0.3]
    assert (found.least_friction, found.most_friction) == (0.3, 0.5)


def test_the_same_friction_all_round_is_a_number() -> None:
    assert problem("{ constant = 0.4 }").friction == 0.4
    assert problem("{ harmonic = 0, cosine = 0.4 }") == problem("0.4")


def test_a_profile_of_zeros_is_none() -> None:
    assert problem(gap="hole = { ellipse = 0.0, axis = 20 }") == problem()
    assert canonical(parse_case(text(gap="hole = 0.0"))) == canonical(parse_case(text()))


CSV = {
    "um": ("angle [deg],gap [um]", ",", 1e6, lambda degrees: degrees),
    "no units": ("x;g", ";", 1.0, lambda degrees: degrees),
    "rad, mm": ("angle / rad\tgap (mm)", "\t", 1e3, math.radians),
}


@pytest.mark.parametrize("kind", CSV)
def test_samples_from_a_csv_file(tmp_path: Path, kind: str) -> None:
    head, separator, factor, angle = CSV[kind]
    rows = [f"{angle(k)!r}{separator}{factor * 1e-6 * math.cos(math.radians(3 * k))!r}" for k in range(-180, 181, 5)]
    written = "\n".join(["# from the coordinate measuring machine", head, *rows])
    (tmp_path / "hole.csv").write_text(written.replace(".", ",") if kind == "no units" else written)
    found = problem(gap='hole = "hole.csv"', folder=tmp_path).gap_at(ANGLES)[0]
    assert found == pytest.approx(1e-6 * np.cos(3 * X), abs=1e-10)
    listed = problem(gap='hole = ["hole.csv", { ellipse = 1e-6 }]', folder=tmp_path).gap_at(ANGLES)[0]
    assert listed - found == pytest.approx(1e-6 * np.cos(2 * X), abs=1e-15)


WRITTEN = [
    *(("0.3", f"hole = {words}") for words in HOLES),
    ("0.3", "pin = { flat = 1e-5, centre = -90.3 }"),
    ("[0.3, { zone = 0.2, start = -30.7, stop = 31.1 }, { crown = -0.1, centre = 0.3, half_width = 10.1 }]", ""),
    ("{ angles = [-180, -91.3, 0.1, 90.7], values = [0.1, 0.2, 0.3, 0.2] }", "hole = 1e-6\npin = -3e-6"),
]


@pytest.mark.parametrize(("friction", "gap"), WRITTEN)
def test_a_written_case_gives_the_same_problem(friction: str, gap: str) -> None:
    case = parse_case(text(friction, gap))
    again = parse_case(case_text(case))
    assert again.problem == case.problem
    assert again.problem.profiles
    assert canonical(again) == canonical(case)


def test_a_function_is_written_exactly() -> None:
    case = parse_case(text())
    for made in (Profile.of("gap", lambda theta: 1e-6 * np.cos(theta) ** 5), Profile.harmonic(3, 1e-7, 2e-7)):
        given = type(case)(Problem(case.problem.pair, 0.01, 1e-5, 0.3, gap=made), case.history)
        assert parse_case(case_text(given)).problem == given.problem


GAPS: dict[str, str] = {
    "hole = { zone = 1e-6, start = 0, stop = 20 }": "hole: must not jump: a zone has a step at its ends",
    "hole = { ellipse = 5e-3 }": "hole: is too large for small strains: must lie within 0.001, a tenth of the hole "
    "radius, not 0.005",
    "hole = { oval = 1e-6 }": "hole: must be a table with one of constant, ellipse, lobes, harmonic, flat, crown, "
    'zone, angles, file, not oval, did you mean "ellipse"?',
    "hole = { ellipse = 1e-6, axes = 3 }": 'hole: unknown key "axes" beside ellipse, did you mean "axis"?',
    "hole = [1e-6, { ellipse = true }]": "hole.2.ellipse: must be a number, not true",
    "pin = { lobes = 2.5, size = 1e-6 }": "pin.lobes: must be a whole number from 1 to 1000, not 2.5",
    "pin = { flat = -1e-6, centre = 0 }": "pin.flat: must be positive, not -1e-06",
    "pin = { flat = 1e-6 }": "pin: centre is missing beside flat",
    "pin = { ellipse = 1e-6, lobes = 3 }": "pin: lobes can't be given together with ellipse; write a list of tables",
    "pin = { flat = 1e-6, centre = 400 }": "pin.centre: must lie between -360 and 360, not 400",
    "pin = { flat = 1e-6, centre = -1.5708 }": "pin.centre: must be in degrees from the bottom of the hole; -1.5708 is "
    "-90 degrees in rad",
    "pin = { crown = 1e-6, centre = 0, half_width = 0.5236 }": "pin.half_width: must be in degrees from the bottom of "
    "the hole; 0.5236 is 30 degrees in rad",
    "pin = { angles = [0, 1.5, 3, 4.5, 6], values = [0, 1e-6, 0, 1e-6, 0] }": "pin.angles: must go all round the hole: "
    "neighbours are 354 degrees apart, more than 120",
    "pin = { angles = [0, 90, 180, 270, 360], values = [0, 1e-6, 0, 1e-6, 2e-6] }": "pin.values: must be equal at the "
    "ends of a turn, not 0 and 2e-06",
    "pin = { angles = [0, 90, 180], values = [0, 1e-6, 0, 1e-6, 2e-6] }": "pin.values: must be as many as the angles, "
    "3, not 5",
    "hole = { crown = 1e-6, centre = 0, half_width = 1e-300 }": "hole.half_width: must lie between 5.7e-08 and 180 "
    "degrees, not 1e-300",
    "hole = { crown = 1e300, centre = 0, half_width = 9 }": "hole.crown: must lie between -1e+100 "
    "and 1e+100, not 1e+300",
    "pin = { angles = [0, 1e-9, 120, 240], values = [0, 1e-6, 0, 0] }": "pin.angles: neighbours are 1e-09 degrees "
    "apart, less than 5.7e-08",
    'pin = "none.csv"': "pin: none.csv: there is no such file",
    "pin = true": "pin: must be a number, not true",
    "hol = 1e-6": 'unknown key "hol" in [gap], did you mean "hole"?',
}


@pytest.mark.parametrize("gap", GAPS)
def test_a_wrong_gap_is_explained(gap: str) -> None:
    assert faults(gap=gap) == [GAPS[gap]]


@pytest.mark.parametrize("angle", [5.76, 1.57085, 2.617912345678901, 1.0])
def test_an_angle_beside_one_in_rad_is_in_degrees(angle: float) -> None:
    """The first three are within 2e-4 of 330, 90 and 150 degrees in rad, but have other digits."""
    case = parse_case(text(gap=f"pin = {{ flat = 1e-6, centre = {angle} }}"))
    assert case.problem.gap.pin.terms[0].centre == angle_at(angle)


def test_all_angles_in_rad_are_refused() -> None:
    for degrees in range(15, 375, 15):
        for angle in (math.radians(degrees), -degrees * (math.pi / 180.0), round(math.radians(degrees), 5)):
            assert "degrees in rad" in faults(gap=f"pin = {{ flat = 1e-6, centre = {angle!r} }}")[0]


def test_one_of_many_samples_may_look_like_an_angle_in_rad() -> None:
    case = parse_case(
        f"{PRESSED}\n[gap]\npin = {{ angles = [0, 1.5708, 90, 180, 270], values = [0, 0, 1e-6, 0, 0] }}\n"
    )
    assert case.problem.gap.pin.terms[0].angles[1] == angle_at(1.5708)


FRICTIONS: dict[str, str] = {
    "[0.3, { zone = -0.4, start = -3, stop = 5 }]": "friction: must not be negative, not -0.1",
    "{ flat = 1e-5, centre = 0 }": "friction: must not have a flat, which is a shape of a pin",
    "{ zone = 0.3 }": "friction: start is missing beside zone",
    "{ zone = 0.3, start = 10, stop = 5 }": "friction.stop: must lie beyond the start, by less than a turn",
    '"0.3"': 'friction: must be a number, not "0.3"',
    '"rough"': 'friction: must be a number, not "rough"',
    "[]": "friction: must be a number, not []",
    "[0.3]": "friction: must be a number, not [0.3]",
}


@pytest.mark.parametrize("friction", FRICTIONS)
def test_wrong_friction_is_explained(friction: str) -> None:
    assert faults(friction) == [FRICTIONS[friction]]


FILES: dict[str, tuple[Any, str]] = {
    "empty": ("", "holds no samples"),
    "no header": ("0,1e-6\n90,2e-6", "line 1: the first line must name the columns"),
    "three columns": ("a,b,c\n1,2,3", "line 1: a profile has two columns, an angle and a value, not 3"),
    "a force": ("angle [deg],gap [kN]\n0,1", "line 1: values: a length must be in m, mm, um, nm, in or mil, not"),
    "words": ("x,g\n0,1e-6\n90,much", 'line 3: values: must be a number, not "much" (column "g")'),
    "infinite": ("x,g\n0,inf", "line 2: values: must be a finite number, not inf"),
    "short line": ("x,g\n0", "line 2: the line has 1 cell, the header has 2"),
    "a part": ("x,g\n0,0\n10,0\n20,0\n30,0", "angles must go all round the hole: neighbours are 330 degrees apart"),
    "turning back": ("x,g\n0,0\n90,0\n80,0\n180,0", "angles must increase, all within one turn"),
    "binary": (b"x,g\n\x81,1\n", "is not UTF-8 text; save it with this encoding"),
    "large": (b"#" * 2_000_001, "line 1: the line is longer than 1,000,000 characters"),
    "many": ("x,g\n" + "0,0\n" * 20_002, "line 20003: more than 20,000 samples can't be read"),
}


@pytest.mark.parametrize("kind", FILES)
def test_a_wrong_csv_file_is_explained(tmp_path: Path, kind: str) -> None:
    content, words = FILES[kind]
    (tmp_path / "a.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    (found,) = faults(gap='hole = "a.csv"', folder=tmp_path)
    assert f"hole: a.csv, {words}" in found or f"hole: a.csv: {words}" in found


def test_units_are_refused_where_there_are_none(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x,mu [um]\n0,0.1\n90,0.1\n180,0.1\n270,0.1\n")
    assert 'friction has no unit; leave it out, not "um"' in faults('"a.csv"', folder=tmp_path)[0]
    dimensionless = PRESSED.replace("hole_radius = 0.01\nclearance = 1e-5", "load_parameter = 0.1")
    for gap, words in (
        ('hole = "a.csv"', "the gap of a problem with load_parameter has no unit; leave it out, not um"),
        ("hole = { flat = 1e-5, centre = 0 }", "a flat has no meaning in a dimensionless problem: its shape needs"),
    ):
        with pytest.raises(CaseFileError, match=words):
            parse_case(dimensionless.replace("P = 1e6", "P = 1.0") + f"\n[gap]\n{gap}\n", folder=tmp_path)
