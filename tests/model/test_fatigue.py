"""Fatigue constants: their checks, and their way through case files, result files, identities and copies."""

import dataclasses
import pickle

import h5py
import pytest

import fastpin
from fastpin.casefile import parse_case
from fastpin.errors import CaseFileError, InputError
from fastpin.model import FatigueConstants
from fastpin.studies.identity import canonical
from fastpin.studies.variation import with_values
from tests.support.faults import faults_of
from tests.support.refusals import refused

CONSTANTS = FatigueConstants(fatigue_strength=1.1e9, strength_exponent=-0.124, source="a book")
TABLE = 'fatigue = { fatigue_strength = 1.1e9, strength_exponent = -0.124, source = "a book" }'
CASE = """
[pin]
material = "steel"
[plate]
E = 70e9
nu = 0.33
{plate}
[contact]
hole_radius = 0.01
clearance = 1e-5
friction = 0.3
pin_load = "body"
[[load]]
P = 1e6
[solve]
nodes = 51
"""
AT = 1 + CASE.split("{")[0].count("\n")
"""Line of the constants in the case."""


def test_only_given_constants_are_shown():
    assert FatigueConstants().given() == {}
    assert repr(FatigueConstants()) == "FatigueConstants()"
    assert CONSTANTS.given() == {"fatigue_strength": 1.1e9, "strength_exponent": -0.124, "source": "a book"}
    assert eval(repr(CONSTANTS)) == CONSTANTS
    assert isinstance(FatigueConstants(yield_strength=3).yield_strength, float)


UNLIKE = ("source", "curve", "curve_a", "curve_c", "curve_m", "curve_samples")
"""Fields that are no positive number: tests/damage/test_stress_life.py."""


@pytest.mark.parametrize(
    "name", [field.name for field in dataclasses.fields(FatigueConstants) if field.name not in UNLIKE]
)
def test_signs(name):
    exponent = name.endswith("_exponent")
    good, bad = (-0.1, 0.1) if exponent else (0.1, -0.1)
    assert FatigueConstants(**{name: good}).given() == {name: good}
    word = "negative" if exponent else "positive"
    for value in (bad, 0.0):
        with pytest.raises(InputError, match=rf"^{name}: must be {word}, not {value:g}$"):
            FatigueConstants(**{name: value})
    with pytest.raises(InputError, match=rf"^{name}: must be a finite number, not inf$"):
        FatigueConstants(**{name: float("inf")})
    with pytest.raises(InputError, match=rf'^{name}: must be a number, not "a"$'):
        FatigueConstants(**{name: "a"})


def test_a_source_is_text():
    with pytest.raises(InputError, match=r"^source: must be text in quotes, not 3$"):
        FatigueConstants(source=3)


def test_missing_constants_are_named():
    assert CONSTANTS.required(("strength_exponent",), "this", "plate") == (-0.124,)
    error = refused(CONSTANTS.required, ("torsion_limit", "fatigue_strength", "yield_strength"), "this", "plate")
    assert str(error) == "fatigue: this needs torsion_limit, yield_strength of the plate's material"


def test_materials_carry_constants():
    material = fastpin.Material(70e9, 0.33, "alloy", CONSTANTS)
    assert material != fastpin.Material(70e9, 0.33, "alloy")
    assert material == fastpin.Material(70e9, 0.33, "alloy", dataclasses.replace(CONSTANTS))
    assert hash(material) == hash(pickle.loads(pickle.dumps(material)))
    assert pickle.loads(pickle.dumps(material)) == material
    assert repr(material) == f"Material(7e+10, 0.33, 'alloy', fatigue={CONSTANTS!r})"
    with pytest.raises(InputError, match=r"^fatigue: must be fastpin.model.FatigueConstants, not a table$"):
        fastpin.Material(70e9, 0.33, fatigue={})


def test_scaled_pairs_have_none():
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["2024-T3"])
    assert pair.scaled(1.0).plate.fatigue is None


def test_named_materials_say_where_their_constants_come_from():
    with_constants = [material for material in fastpin.MATERIALS.values() if material.fatigue is not None]
    assert {material.name for material in with_constants} == {"2024-T3", "SAE 1020"}
    for material in with_constants:
        assert material.fatigue.source
        assert {"fatigue_strength", "yield_strength"} <= set(material.fatigue.given())


def test_a_case_file_gives_constants():
    assert parse_case(CASE.format(plate=TABLE)).problem.pair.plate.fatigue == CONSTANTS
    section = f"[plate.fatigue]\n{TABLE.split('{ ')[1][:-2].replace(', ', chr(10))}"
    assert parse_case(CASE.format(plate=section)).problem.pair.plate.fatigue == CONSTANTS
    named = CASE.format(plate="").replace('material = "steel"', f'material = "2024-T3"\n{TABLE}')
    pin = parse_case(named).problem.pair.pin
    assert pin == dataclasses.replace(fastpin.MATERIALS["2024-T3"], fatigue=CONSTANTS)
    assert parse_case(CASE.format(plate="")).problem.pair.plate.fatigue is None
    by_name = CASE.replace('"steel"', '"SAE 1020"').format(plate="")
    assert parse_case(by_name).problem.pair.pin == fastpin.MATERIALS["SAE 1020"]


@pytest.mark.parametrize(
    ("text", "faults"),
    [
        ("fatigue = 3", ["fatigue: must be a table { ... }, not 3"]),
        ("fatigue = { yield_strength = -3 }", ["yield_strength: must be positive, not -3"]),
        (
            'fatigue = { yield_strength = "a", strength_exponent = 1, fatigue_strength = 2 }',
            ["strength_exponent: must be negative, not 1", 'yield_strength: must be a number, not "a"'],
        ),
        (
            "fatigue = { yield_strenght = 3 }",
            ['unknown key "yield_strenght" in fatigue of [plate], did you mean "yield_strength"?'],
        ),
    ],
)
def test_faults_of_a_case_file(text, faults):
    assert faults_of(parse_case, CASE.format(plate=text)) == [(AT, fault) for fault in faults]


def test_a_rigid_body_has_no_constants():
    text = CASE.replace("E = 70e9\nnu = 0.33", "rigid = true").format(plate=TABLE)
    with pytest.raises(CaseFileError, match=r"\[plate\]: fatigue can't be given together with rigid"):
        parse_case(text)


def test_a_dimensionless_case_has_no_constants():
    text = CASE.replace("hole_radius = 0.01\nclearance = 1e-5", "load_parameter = 0.1")
    with pytest.raises(CaseFileError, match=r"fatigue: has no meaning with load_parameter"):
        parse_case(text.format(plate=TABLE))
    assert parse_case(text.format(plate="").replace('"steel"', '"2024-T3"')).problem.pair.pin.fatigue is None


def test_plans_replace_constants_with_their_material():
    base = {"plate": {"E": 70e9, "nu": 0.33, "fatigue": CONSTANTS.given()}, "pin": {"material": "2024-T3"}}
    assert with_values(base, {"plate.material": "steel"})["plate"] == {"material": "steel"}
    assert with_values(base, {"plate.rigid": True})["plate"] == {"rigid": True}
    assert with_values(base, {"plate.E": 60e9})["plate"] == {**base["plate"], "E": 60e9}
    kept = fastpin.MATERIALS["2024-T3"].fatigue.given()
    assert with_values(base, {"pin.nu": 0.3})["pin"] == {"E": 70e9, "nu": 0.3, "fatigue": kept}


def test_constants_survive_a_file(tmp_path):
    case = parse_case(CASE.format(plate=TABLE))
    result = fastpin.solve(case.problem, case.history, nodes=51)
    result.save(tmp_path / "one.h5")
    assert fastpin.load(tmp_path / "one.h5").problem == case.problem
    with h5py.File(tmp_path / "one.h5", "r+") as file:  # as an older version wrote it
        del file["problem/plate/fatigue"]
    assert fastpin.load(tmp_path / "one.h5").problem.pair.plate.fatigue is None


def test_identities():
    """The source makes no difference, a constant does, and a case without constants keeps its identity."""
    plain, given = (canonical(parse_case(CASE.format(plate=text))) for text in ("", TABLE))
    assert plain["plate"] == {"E": 70e9, "nu": 0.33}
    assert given == {
        **plain,
        "plate": {**plain["plate"], "fatigue": {"fatigue_strength": 1.1e9, "strength_exponent": -0.124}},
    }
    other = canonical(parse_case(CASE.format(plate=TABLE.replace("a book", "another book"))))
    assert other == given
    nothing = canonical(parse_case(CASE.format(plate="fatigue = {}")))
    assert nothing == plain
