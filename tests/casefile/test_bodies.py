"""The sections [pin_body] and [plate_body] of case files."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, Material, Problem
from fastpin.bodies import Bushing, Compliance, Disk, Plate, Ring, Tube
from fastpin.bodies.compliance import MOST_BYTES
from fastpin.bodies.kinds import PLATES
from fastpin.casefile import EXAMPLE, parse_case
from tests.support.bodies import soft_plate
from tests.support.body_texts import HEAD
from tests.support.commands import refused
from tests.support.faults import faults_of

LINES = HEAD.count("\n")
BUSH = "[plate_body]\nE = 110e9\nnu = 0.34\nouter_radius = 12.5e-3\n"
BRONZE = Material(110e9, 0.34)
PLATE_KINDS = [f'"{kind}"' for kind in PLATES]


def problem(bodies: str, folder: Path | str = ".", head: str = HEAD) -> Problem:
    return parse_case(head + bodies, folder=folder).problem


def faults(bodies: str, folder: Path | str = ".", head: str = HEAD) -> list[tuple[int, str]]:
    """Lines after the head, and sentences."""
    return [(line - head.count("\n"), text) for line, text in faults_of(parse_case, head + bodies, folder=folder)]


def the_fault(bodies: str, folder: Path | str = ".", head: str = HEAD) -> tuple[int, str]:
    (one,) = faults(bodies, folder, head)
    return one


@pytest.mark.parametrize(
    ("text", "body"),
    [
        ("", Disk()),
        ("[pin_body]\n", Disk()),
        ('[pin_body]\nkind = "disk"\n', Disk()),
        ("[pin_body]\nbore_radius = 5e-3\n", Tube(5e-3)),
        ('[pin_body]\nkind = "tube"\nbore_radius = 5e-3\nload = "held"\n', Tube(5e-3, "held")),
    ],
)
def test_bodies_of_the_pin(text, body):
    assert problem(text).pin_body == body


@pytest.mark.parametrize(
    ("keys", "body"),
    [
        ("", Plate()),
        ('kind = "plate"', Plate()),
        ("reaction = [0, 6e-2]", Plate((0.0, 0.06))),
        ("outer_radius = 2e-2", Ring(0.02)),
        ('kind = "ring"\nouter_radius = 2e-2\nsupport = "half"', Ring(0.02, "half")),
        ('material = "steel"\nouter_radius = 12e-3', Bushing(MATERIALS["steel"], 0.012)),
        ("E = 110e9\nnu = 0.34\nouter_radius = 12e-3\nbonded = true", Bushing(BRONZE, 0.012)),
        (
            "E = 110e9\nnu = 0.34\nouter_radius = 12e-3\nfriction = 0.2\nbonded = false",
            Bushing(BRONZE, 0.012, friction=0.2, bonded=False),
        ),
        (
            'kind = "bushing"\nE = 110e9\nnu = 0.34\nouter_radius = 12e-3\ninterference = 2e-5\n'
            'ring_outer_radius = 2e-2\nsupport = "normal"',
            Bushing(BRONZE, 0.012, 2e-5, Ring(0.02, "normal")),
        ),
        (
            "E = 110e9\nnu = 0.34\nouter_radius = 12e-3\nreaction = [3e-2, 0]",
            Bushing(BRONZE, 0.012, inside=Plate((0.03, 0.0))),
        ),
    ],
)
def test_bodies_of_the_plate(keys, body):
    assert problem(f"[plate_body]\n{keys}\n").plate_body == body


def test_a_compliance_lies_beside_the_case_file(tmp_path):
    (tmp_path / "lug.json").write_text(soft_plate().to_text())
    for keys in ('file = "lug.json"\n', 'kind = "compliance"\nfile = "lug.json"\n'):
        assert problem(f"[plate_body]\n{keys}", tmp_path).plate_body == soft_plate()


def test_a_compliance_that_changes_is_read_again(tmp_path):
    path = tmp_path / "lug.json"
    path.write_text(soft_plate().to_text())
    first = problem('[plate_body]\nfile = "lug.json"\n', tmp_path).plate_body
    assert problem('[plate_body]\nfile = "lug.json"\n', tmp_path).plate_body is first
    path.write_text(soft_plate(columns={"sxx": np.ones(18)}).to_text())
    assert problem('[plate_body]\nfile = "lug.json"\n', tmp_path).plate_body != first


def test_fatigue_constants_of_a_bush():
    body = problem(BUSH + "fatigue = { fatigue_strength = 1e9, strength_exponent = -0.1 }\n").plate_body
    assert body.material.fatigue.fatigue_strength == 1e9


def test_a_dimensionless_case_counts_bodies_in_its_units():
    """Radii in R, the interference in F beta* of pin and bush, moduli in one unit."""
    head = HEAD.replace("hole_radius = 10e-3\nclearance = 20e-6", "load_parameter = 0.1").replace("1e6", "1.0")
    text = (
        "[pin_body]\nbore_radius = 0.5\n[plate_body]\nE = 110e9\nnu = 0.34\nouter_radius = 1.25\ninterference = 2.0\n"
    )
    found = problem(text, head=head)
    assert found.pin_body == Tube(0.5)
    assert (found.plate_body.outer_radius, found.plate_body.interference) == (1.25, 2.0)
    assert found.surfaces.beta_star == pytest.approx(1.0, rel=1e-14)
    moduli = found.pair.pin.E, found.pair.plate.E, found.plate_body.material.E
    assert np.array(moduli) / moduli[0] == pytest.approx([1.0, 69 / 210, 110 / 210], rel=1e-14)


def test_bodies_beside_dundurs_parameters(tmp_path):
    dundurs = "[dundurs]\nalpha = 0.2\nbeta = 0.05\nnu_pin = 0.3\n"
    head = dundurs + "beta_star = 8e-11\n" + HEAD[HEAD.index("[contact]") :]
    found = problem('[pin_body]\nbore_radius = 5e-3\n[plate_body]\nouter_radius = 2e-2\nsupport = "half"\n', head=head)
    assert (found.pin_body, found.plate_body) == (Tube(5e-3), Ring(2e-2, "half"))
    assert found.surfaces.dundurs() == pytest.approx((0.2, 0.05))
    assert problem(BUSH, head=head).plate_body == Bushing(BRONZE, 0.0125)
    (tmp_path / "lug.json").write_text(soft_plate(nu=found.pair.plate.nu).to_text())
    assert problem('[plate_body]\nfile = "lug.json"\n', tmp_path, head).plate_body.nu == found.pair.plate.nu
    loose = dundurs + HEAD[HEAD.index("[contact]") :].replace(
        "hole_radius = 10e-3\nclearance = 20e-6", "load_parameter = 0.1"
    ).replace("1e6", "1.0")
    assert problem("[plate_body]\nE = 2.0\nnu = 0.3\nouter_radius = 1.2\n", head=loose).surfaces.beta_star == (
        pytest.approx(1.0, rel=1e-14)
    )
    line, text = the_fault('[plate_body]\nmaterial = "steel"\nouter_radius = 1.2\n', head=loose)
    assert (line, text[:39]) == (2, "material: with [dundurs] and load_param")


@pytest.mark.parametrize(
    ("bodies", "line", "words"),
    [
        ("[pin_body]\nbore_radius = 11e-3\n", 2, "bore_radius: must be at most 0.0096"),
        ("[pin_body]\nbore_radius = 9.95e-3\n", 2, "bore_radius: must be at most 0.0096"),
        ("[pin_body]\nbore_radius = 0\n", 2, "bore_radius: must be positive, not 0"),
        ('[pin_body]\nbore_radius = "wide"\n', 2, "bore_radius: must be a number"),
        ('[pin_body]\nbore_radius = 5e-3\nload = "centre"\n', 3, 'load: must be "uniform", "normal"'),
        ('[pin_body]\nload = "held"\n', 1, "[pin_body]: bore_radius is missing"),
        ('[pin_body]\nkind = "tube"\n', 1, "[pin_body]: bore_radius is missing"),
        ('[pin_body]\nkind = "hollow"\n', 2, 'kind: must be "disk" or "tube", not "hollow"'),
        (
            '[pin_body]\nkind = "disk"\nbore_radius = 5e-3\n',
            3,
            'bore_radius: belongs to kind = "tube", not to kind = "disk"',
        ),
        ("[pin_body]\nbore_radus = 5e-3\n", 2, 'unknown key "bore_radus" in [pin_body], did you mean "bore_radius"?'),
        ("[pin_bodies]\n", 1, 'unknown section [pin_bodies], did you mean "pin_body"?'),
        ("[outline]\n", 1, "unknown section [outline]; a file with [outline] is a lug file, see fastpin compliance"),
        ("[plate_body]\nouter_radius = 9e-3\n", 2, "outer_radius: must lie between 0.0104167 and 10000 for the hole"),
        ("[plate_body]\nouter_radius = 10.05e-3\n", 2, "outer_radius: must lie between"),
        ('[plate_body]\nouter_radius = 2e-2\nsupport = "clamped"\n', 3, 'support: must be "held", "uniform", "normal"'),
        ('[plate_body]\nkind = "ring"\n', 1, "[plate_body]: outer_radius is missing"),
        ('[plate_body]\nsupport = "held"\n', 1, "[plate_body]: outer_radius is missing"),
        ('[plate_body]\nkind = "lug"\n', 2, f"kind: must be {', '.join(PLATE_KINDS[:-1])} or {PLATE_KINDS[-1]}"),
        ("[plate_body]\nreaction = [5e-3, 0]\n", 2, "reaction: must be a point from 0.0105 to 10000 from the centre"),
        ("[plate_body]\nreaction = 5e-3\n", 2, "reaction: must be a point [x, y]"),
        ('[plate_body]\nreaction = [0, "far"]\n', 2, "reaction: must be a number"),
        (
            '[plate_body]\nfile = "lug.json"\nouter_radius = 2e-2\n',
            2,
            'file: belongs to kind = "compliance", not to kind = "ring"',
        ),
        (
            BUSH + 'file = "lug.json"\nkind = "bushing"\n',
            5,
            'file: belongs to kind = "compliance", not to kind = "bushing"',
        ),
        (BUSH + "interference = -1e-6\n", 5, "interference: must not be negative, not -1e-06"),
        (BUSH + "interference = 2e-2\n", 5, "interference: must be smaller than the outer radius 0.0125 of the bush"),
        (BUSH + "friction = -1\n", 5, "friction: must not be negative, not -1"),
        (BUSH + "ring_outer_radius = 12e-3\n", 5, "ring_outer_radius: must lie between 0.0130208"),
        (BUSH + "reaction = [12e-3, 0]\n", 5, "reaction: must be a point from 0.013125"),
        (BUSH + 'support = "held"\n', 5, "support: needs ring_outer_radius"),
        (
            BUSH + "ring_outer_radius = 2e-2\nreaction = [0.1, 0]\n",
            6,
            "reaction: can't be given together with ring_outer_radius",
        ),
        ("[plate_body]\nrigid = true\nouter_radius = 12e-3\n", 2, "rigid: a rigid bush is a rigid plate: leave the bu"),
        ("[plate_body]\nE = inf\nnu = 0.3\nouter_radius = 12e-3\n", 2, "E: must be a finite number, not inf"),
        ("[plate_body]\nE = 1e-20\nnu = 0.3\nouter_radius = 12e-3\n", 2, "E: the moduli of pin and bush must not di"),
        ("[plate_body]\nE = 110e9\nouter_radius = 12e-3\n", 1, "[plate_body]: nu is missing"),
        ('[plate_body]\nmaterial = "bronze"\nouter_radius = 12e-3\n', 2, 'material: there is no material "bronze"'),
        ('[plate_body]\nkind = "bushing"\nouter_radius = 12e-3\n', 1, "[plate_body]: needs material, or E and nu"),
        (BUSH.replace("outer_radius = 12.5e-3", "interference = 0"), 1, "[plate_body]: outer_radius is missing"),
        ('[plate_body]\nkind = "compliance"\n', 1, "[plate_body]: file is missing"),
        ("[plate_body]\nfile = 5\n", 2, "file: must be text in quotes, not 5"),
        ("[[plate_body]]\nouter_radius = 2e-2\n", 1, "plate_body: must be a section [plate_body], not [[plate_body]]"),
    ],
)
def test_a_fault_is_told_once_with_its_line(bodies, line, words):
    ((found_line, found),) = (fault for fault in faults(bodies) if "lug.json" not in fault[1])
    assert found.startswith(words)
    assert found_line == line


GOOD = soft_plate().document()


def with_number(row: int, column: int, value: float) -> str:
    """The good file with another number in its matrix."""
    matrix = np.array(GOOD["matrix"])
    matrix[row, column] = value
    return json.dumps(GOOD | {"matrix": matrix.tolist()})


WRONG_FILES: dict[str, tuple[str | bytes | Callable[[Path], object], str]] = {
    "asymmetric": (with_number(2, 7, 0.3), "matrix: must be symmetric"),
    "undecayed": (with_number(-1, -1, 0.2), "matrix: its last harmonic 4 is"),
    "not finite": (with_number(3, 3, np.nan), "matrix: must be a finite number"),
    "large": (with_number(2, 2, 1e308), "matrix: must be at least -1e+09 and at most 1e+09, not 1e+308"),
    "short": (json.dumps(GOOD | {"matrix": GOOD["matrix"][:5]}), "matrix: must have the shape (2 + 4 K, 2 + 4 K)"),
    "no matrix": (json.dumps({key: GOOD[key] for key in GOOD if key != "matrix"}), "matrix: is missing"),
    "foreign": (json.dumps({"name": "something else"}), "is no compliance file"),
    "text": ("no JSON", "is no compliance file"),
    "list": ("[1, 2]", "is no compliance file"),
    "nested": ("[" * 200_000, "is no compliance file"),
    "binary": (bytes(range(256)) * 10, "is no compliance file"),
    "version": (json.dumps(GOOD | {"version": 99}), "version: must be 1, not 99"),
    "column": (
        json.dumps(GOOD | {"columns": {"P": [0.0] * 18}}),
        'columns: must be "sxx", "syy", "sxy" or "temperature", not "P"',
    ),
    "large column": (
        json.dumps(GOOD | {"columns": {"syy": [1e308] * 18}}),
        "columns.syy: must be at least -1e+09 and at most 1e+09, not 1e+308",
    ),
    "order": (
        json.dumps(GOOD | {"order": 10**9}),
        "order: must be 4, the last harmonic of the matrix, not 1000000000",
    ),
    "order in words": (
        json.dumps(GOOD | {"order": "4"}),
        'order: must be 4, the last harmonic of the matrix, not "4"',
    ),
    "true order": (
        json.dumps(GOOD | {"order": True}),
        "order: must be 4, the last harmonic of the matrix, not true",
    ),
    "huge": (lambda path: path.write_bytes(bytes(MOST_BYTES + 1)), "is larger than 10,000,000 bytes"),
    "missing": (lambda path: None, "there is no such file"),
    "folder": (Path.mkdir, "is a directory, a file is needed"),
    "material": (
        soft_plate(nu=0.3).to_text(),
        "the compliance was made for nu = 0.3, plane strain; the plate has nu = 0.33",
    ),
    "plane": (soft_plate(plane="stress").to_text(), "the compliance was made for nu = 0.33, plane stress"),
    "hole": (
        soft_plate(hole_radius=0.02).to_text(),
        "the compliance was made for a hole of radius 0.02; the hole radius is 0.01",
    ),
}
"""The content of a file, or what makes it, and its fault."""


@pytest.mark.parametrize("kind", WRONG_FILES)
def test_wrong_files_of_compliances(kind, tmp_path):
    path = tmp_path / "lug.json"
    content, words = WRONG_FILES[kind]
    if callable(content):
        content(path)
    else:
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    line, text = the_fault('[plate_body]\nfile = "lug.json"\n', tmp_path)
    assert line == 2
    assert text.startswith("file: ")
    assert words in text
    if kind not in ("material", "plane", "hole"):
        with pytest.raises(InputError) as raised:
            Compliance.from_file(path)
        assert str(raised.value) == text
    (tmp_path / "case.toml").write_text(f'{HEAD}[plate_body]\nfile = "lug.json"\n')
    assert f"line {LINES + 2}: {text}" in refused("check", tmp_path / "case.toml")


def test_all_faults_of_bodies_at_once(tmp_path):
    text = """[pin_body]
bore_radius = -1
load = "hung"
[plate_body]
E = -5
nu = 0.7
outer_radius = 12e-3
interference = -1
friction = "rough"
ring_outer_radius = 0
support = "none"
colour = "red"
"""
    head = HEAD.replace("friction = 0.3", "friction = -0.3")
    found = faults(text, head=head)
    assert [line for line, _ in found] == [8 - LINES, 2, 3, 5, 6, 8, 9, 10, 11, 12]
    later = faults(BUSH + "interference = 1.0\nring_outer_radius = 1e-3\n[pin_body]\nbore_radius = 1.0\n")
    assert [line for line, _ in later] == [5, 6, 8]


def test_bodies_are_checked_without_a_contact_section_or_a_hole():
    bodies = "[pin_body]\nbore_radius = -1\n[plate_body]\nouter_radius = 1e-9\n"
    for head, words in (
        (HEAD[: HEAD.index("[contact]")] + "[[load]]\nP = 1e6\n", "the section [contact] is missing"),
        (HEAD.replace("hole_radius = 10e-3", "hole_radius = -1"), "hole_radius: must be positive, not -1"),
    ):
        found = [text for _, text in faults(bodies, head=head)]
        assert found == [words, "bore_radius: must be positive, not -1"]


def test_a_compliance_beside_a_wrong_material_is_not_blamed(tmp_path):
    (tmp_path / "lug.json").write_text(soft_plate().to_text())
    head = HEAD.replace('material = "aluminium"', 'material = "tin"')
    line, text = the_fault('[plate_body]\nfile = "lug.json"\n', tmp_path, head)
    assert text.startswith('material: there is no material "tin"')
    assert line == 4 - LINES


def test_the_bodies_of_the_example_can_be_switched_on():
    """Every commented section of a body is valid as it stands, apart from the file of a compliance."""
    text = EXAMPLE.replace('pin_load = "body"  ', 'pin_load = "centre"')
    blocks = EXAMPLE[EXAMPLE.index("# A hollow pin") : EXAMPLE.index("# Loads: the corners")].split("\n\n")
    found = []
    for block in blocks:
        lines = [line.removeprefix("# ") for line in block.splitlines() if " = " in line or line.startswith("# [")]
        if lines and "file" not in lines[-1]:
            found.append(parse_case("\n".join([text, *lines])).problem)
    kinds = [type(one.pin_body if one.plate_body == Plate() else one.plate_body).__name__ for one in found]
    assert kinds == ["Tube", "Plate", "Ring", "Bushing"]
