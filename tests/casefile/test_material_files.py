"""Files of materials, and the materials that fastpin names."""

import dataclasses
import re
from pathlib import Path

import pytest

import fastpin
from fastpin import CaseFileError, InputError
from fastpin.casefile import EXAMPLE, parse_case, read_materials
from fastpin.cracks import GrowthLaw, Nasgro, Walker
from fastpin.model import materials
from fastpin.model.doubts import doubts
from fastpin.studies import read_plan
from fastpin.studies.identity import canonical
from tests.support.faults import fault_of

SHEET = """
[sheet]
E = 71e9
nu = 0.33
yield_strength = 352e6
ultimate_strength = 440e6
source = "certificate 4711"

["cast iron"]
E = 110e9
nu = 0.26
fatigue = { fatigue_strength = 1.1e9, strength_exponent = -0.1, source = "a book" }
growth = { law = "paris", C = 1e-11, m = 3, threshold_range = 2e6, source = "a standard" }
"""

OWN = EXAMPLE.replace("[pin]  ", 'materials = "own.toml"\n[pin]  ', 1).replace('"Ti-6Al-4V"', '"cast iron"', 1)
BUSH = """
[plate_body]
material = "sheet"
outer_radius = 12e-3
[[load]]"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "own.toml").write_text(SHEET)
    return tmp_path


def test_a_file_gives_materials_by_name(folder: Path) -> None:
    found = read_materials(folder / "own.toml")
    assert list(found) == ["sheet", "cast iron"]
    assert found["sheet"] == fastpin.Material(71e9, 0.33, "sheet", yield_strength=352e6, ultimate_strength=440e6)
    assert found["cast iron"].fatigue.fatigue_strength == 1.1e9
    assert found["cast iron"].growth == Walker(1e-11, 3.0, threshold_range=2e6, source="a standard")
    assert found["cast iron"].name == "cast iron"


def test_a_case_takes_them_for_pin_plate_and_bush(folder: Path) -> None:
    case = parse_case(OWN.replace("[[load]]", BUSH, 1), folder=folder)
    own = read_materials(folder / "own.toml")
    assert case.problem.pair.pin == own["cast iron"]
    assert case.problem.plate_body.material == own["sheet"]
    changed = OWN.replace('"cast iron"', '"sheet"\nyield_strength = 300e6', 1)
    assert parse_case(changed, folder=folder).problem.pair.pin == dataclasses.replace(own["sheet"], yield_strength=3e8)


def test_a_plan_varies_them(folder: Path) -> None:
    (folder / "case.toml").write_text(OWN)
    (folder / "plan.toml").write_text('case = "case.toml"\n[grid]\npin.material = ["sheet", "steel", "cast iron"]\n')
    plan = read_plan(folder / "plan.toml")
    assert [plan.case(point).problem.pair.pin.name for point in plan.points] == ["sheet", "steel", "cast iron"]
    (folder / "own.toml").write_text(SHEET.replace("0.33", "0.34"))
    with pytest.raises(InputError, match="files of its loads, bodies or materials have changed"):
        plan.case(plan.points[0])
    (folder / "plan.toml").write_text('case = "case.toml"\n[grid]\npin.E = [50e9, 60e9]\n')
    plan = read_plan(folder / "plan.toml")
    found = [plan.case(point).problem.pair.pin for point in plan.points]
    assert [(pin.E, pin.nu, pin.fatigue.fatigue_strength) for pin in found] == [
        (50e9, 0.26, 1.1e9),
        (60e9, 0.26, 1.1e9),
    ]
    (folder / "case.toml").write_text(OWN.replace('"cast iron"', '"sheet"', 1))
    plan = read_plan(folder / "plan.toml")
    pin = plan.case(plan.points[0]).problem.pair.pin
    assert (pin.E, pin.strengths) == (50e9, {"yield_strength": 352e6, "ultimate_strength": 440e6})


@pytest.mark.parametrize(
    ("old", "new", "line", "sentence"),
    [
        ("nu = 0.33", "nu = 0.6", 4, "nu: Poisson's ratio must lie between 0 and 0.5, not 0.6"),
        ("E = 71e9", "E = -1", 3, "E: Young's modulus must be positive, not -1"),
        ("E = 71e9", "modulus = 71e9", 3, 'unknown key "modulus" in [sheet], did you mean "E"?'),
        ("E = 71e9", "", 2, "[sheet]: E is missing"),
        ("yield_strength = 352e6", "yield_strength = 0", 5, "yield_strength: must be positive, not 0"),
        ("yield_strength", "yield_stress", 5, 'unknown key "yield_stress" in [sheet], did you mean "yield_strength"?'),
        ("ultimate_strength = 440e6", "ultimate_strength = -1", 6, "ultimate_strength: must be positive, not -1"),
        ("ultimate_strength", "uts", 6, 'unknown key "uts" in [sheet], did you mean "ultimate_strength"?'),
        ("[sheet]", "[steel]", 2, "[steel]: is a material of fastpin; choose another name"),
        ("[sheet]", "colour = 3\n[sheet]", 2, "colour: must be a section [colour] with E and nu, not 3"),
        ('source = "certificate 4711"', "source = 4711", 7, "source: must be text in quotes, not 4711"),
        ("-0.1", "0.1", 12, "strength_exponent: must be negative, not 0.1"),
        ('"paris"', '"pares"', 13, 'law: must be "paris", "walker" or "nasgro", not "pares", did you mean "paris"?'),
        ('law = "paris", ', "", 13, "growth: law is missing; it is one of paris, walker, nasgro"),
        ("C = 1e-11", "C = 0", 13, "C: must be positive, not 0"),
        ("m = 3,", "", 13, "growth: m is missing; the law paris needs C, m"),
        (
            "m = 3,",
            "m = 3, exponent = 0.5,",
            13,
            'unknown key "exponent" in growth of [cast iron] with the law paris; the constants of this law are C, m,',
        ),
        (
            '{ law = "paris"',
            '3 # { law = "paris"',
            13,
            'growth: must be a table such as { law = "walker", ... }, not 3',
        ),
        (SHEET, "", 0, "no materials: a material is a section, such as [my-alloy], with E and nu"),
        (SHEET, "[sheet\n", 1, "not TOML"),
    ],
)
def test_a_fault_gets_one_sentence_in_python_and_in_a_case(folder, old, new, line, sentence):
    path = folder / "own.toml"
    path.write_text(SHEET.replace(old, new, 1))
    found_line, found = fault_of(read_materials, path)
    assert (found_line, found[: len(sentence)]) == (line, sentence)
    case = OWN if '["cast iron"]' in path.read_text() else OWN.replace('"cast iron"', '"steel"', 1)
    where = f"materials: own.toml{f', line {line}' if line else ''}: "
    place = OWN[: OWN.index('\nmaterials = "own')].count("\n") + 2
    assert fault_of(parse_case, case, folder=folder) == (place, where + found)


def test_a_missing_file_and_an_unknown_name_are_faults(folder: Path) -> None:
    with pytest.raises(CaseFileError, match=r"materials: none.toml: there is no such file"):
        parse_case(EXAMPLE.replace("[pin]  ", 'materials = "none.toml"\n[pin]  ', 1), folder=folder)
    with pytest.raises(CaseFileError, match=r'material: there is no material "shet", did you mean "sheet"\?'):
        parse_case(OWN.replace('"cast iron"', '"shet"', 1), folder=folder)
    with pytest.raises(InputError, match=r"^path: must be the name of a file, not 3$"):
        read_materials(3)


def test_named_materials_have_sources_and_plausible_numbers() -> None:
    text = Path(materials.__file__).read_text(encoding="utf-8")
    sources = text[text.index('"""Named materials at room temperature.') :]
    for name, material in fastpin.MATERIALS.items():
        assert material.name == name
        assert re.search(rf"\b{re.escape(name)}\b", sources), name
        strength = material.known_yield_strength
        if strength is not None:
            assert 5e-4 < strength / material.E < 0.03
    generic = {"aluminium", "steel", "nickel alloy"}
    assert {name for name, one in fastpin.MATERIALS.items() if one.known_yield_strength is None} == generic


NAMES = {"aluminum": "aluminium", "Ti64": "Ti-6Al-4V", "7075": "7075-T6", "bronze": "C93200", "718": "Inconel 718"}


@pytest.mark.parametrize("typed", NAMES)
def test_other_names_of_materials_are_answered(typed: str) -> None:
    with pytest.raises(CaseFileError, match=rf'did you mean "{NAMES[typed]}"\?'):
        parse_case(EXAMPLE.replace('"Ti-6Al-4V"', f'"{typed}"', 1))


NASGRO = 'growth = { law = "nasgro", C = 1e-10, n = 2.5, p = 1, q = 1, threshold_range = 1e6, toughness = 4e7 }'


def with_plate(keys: str) -> str:
    """The example with more keys of the plate."""
    return EXAMPLE.replace("nu = 0.33 ", f"nu = 0.33\n{keys} ", 1)


def test_a_body_of_a_case_has_growth_constants() -> None:
    text = with_plate(NASGRO)
    assert parse_case(text).problem.pair.plate.growth == Nasgro(1e-10, 2.5, 1.0, 1.0, 1e6, 4e7)
    with pytest.raises(CaseFileError, match="growth: has no meaning with load_parameter"):
        parse_case(text.replace("hole_radius = 10e-3", "load_parameter = 0.1").replace("clearance = 20e-6", ""))


@pytest.mark.parametrize(
    ("constants", "sentence"),
    [
        (
            '"paris", C = 1e-11, m = 3, threshold_range = 3.2',
            "growth.threshold_range: 3.2 Pa sqrt(m) of the plate is very",
        ),
        ('"paris", C = 1.65e-8, m = 3', None),
        ('"paris", C = 1.65e-5, m = 3', "growth.C: gives 1e-1.78 m per cycle of 10 MPa sqrt(m) in the plate; C is the"),
        ('"paris", C = 1e-30, m = 3e300', "growth.C: gives 1e3e+300 m per cycle"),
    ],
)
def test_constants_in_other_units_are_doubted(constants: str, sentence: str | None) -> None:
    case = parse_case(with_plate(f"growth = {{ law = {constants} }}"))
    found = [str(doubt) for doubt in doubts(case.problem, case.history)]
    assert [text[: len(sentence or "")] for text in found] == ([sentence] if sentence else [])


def test_only_laws_that_files_can_hold_belong_to_a_material() -> None:
    class Own(GrowthLaw):
        def _rate_above(self, K_max, K_min, length):
            return 1e-9 * K_max

    with pytest.raises(InputError, match=r"growth: must be a law with constants, .*; a law of your own is an argument"):
        fastpin.Material(70e9, 0.3, growth=Own())


def test_ids_change_with_the_growth_constants_only_where_they_are_given() -> None:
    plain, grown, cited = (
        parse_case(with_plate(keys))
        for keys in ("ultimate_strength = 4e8", NASGRO, NASGRO.replace("p = 1", 'source = "x", p = 1'))
    )
    assert canonical(plain) == canonical(parse_case(EXAMPLE))
    assert canonical(grown) == canonical(cited) != canonical(plain)
    assert canonical(grown)["plate"]["growth"] == {
        "law": "nasgro", "C": 1e-10, "n": 2.5, "p": 1.0, "q": 1.0, "threshold_range": 1e6, "toughness": 4e7,
    }  # fmt: skip
