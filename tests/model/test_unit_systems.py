"""Systems of units: their names, the way of numbers to SI units and back, and what is refused."""

import math
import random
import re
from dataclasses import fields

import pytest

from fastpin import CaseFileError, InputError, Material, MaterialPair, Problem
from fastpin.casefile import LUG_EXAMPLE, builtin_case, case_text, parse_case, parse_lug
from fastpin.casefile.reader import KEYS
from fastpin.model import FatigueConstants
from fastpin.model.growth import LAWS
from fastpin.model.keys import CASE, FATIGUE, LAW, PLY, converted, kind_of
from fastpin.model.ply import PLY_KEYS
from fastpin.model.unit_systems import INCH, POUND, SI, checked_system, measures
from fastpin.model.units import in_other_units, measures_of, units

PAIR = MaterialPair(Material(210e9, 0.3), Material(70e9, 0.33))
KSI = 1e3 * POUND / INCH**2


TEXT = """
[pin]
material = "steel"
[plate]
E = 10e3
nu = 0.3
[contact]
hole_radius = 10.0
clearance = 0.02
friction = 0.3
"""
LOAD = "[[load]]\nP = 5.0\n"


def in_units(text, system="mm, N, MPa", **options):
    """The case of a text in a system of units."""
    return parse_case(f'units = "{system}"\n{text}', **options)


def fault(text, system="mm, N, MPa"):
    """The sentences with which a case in a system of units is refused."""
    with pytest.raises(CaseFileError) as caught:
        in_units(text, system)
    return str(caught.value)


def problem(**given):
    return Problem(PAIR, 0.01, 2e-5, 0.4, **given)


@pytest.mark.parametrize(
    ("given", "name"),
    [("SI", "SI"), ("mm,N,MPa", "mm, N, MPa"), (" ksi, in ,lbf", "in, lbf, ksi"), ("m, kN, kPa", "m, kN, kPa")],
)
def test_a_system_is_a_length_a_force_and_a_stress_in_any_order(given, name):
    assert checked_system("units", given) == name


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("mm, lbf, MPa", 'units: must not mix metric and US customary units, as "mm, lbf, MPa" does'),
        (
            "mm, N",
            'units: must be "SI", or a length, a force and a stress, such as "mm, N, MPa" or "in, lbf, ksi", not',
        ),
        ("mm, m, MPa", "units: must be"),
        ("mm, N, mpa", 'units: there is no unit "mpa", did you mean "MPa"?'),
        ("furlong, N, Pa", 'units: there is no unit "furlong"; there are m, cm, mm, um, N, kN, MN, Pa'),
        (3, "units: must be"),
    ],
)
def test_other_systems_are_refused_in_one_sentence(given, sentence):
    with pytest.raises(InputError, match=re.escape(sentence)):
        checked_system("units", given)
    if isinstance(given, str):
        assert sentence in fault(TEXT + LOAD, given)


def test_a_case_with_a_load_parameter_has_no_units():
    text = TEXT.replace("hole_radius = 10.0\nclearance = 0.02", "load_parameter = 0.5")
    assert "line 1: units: has no meaning in a dimensionless problem" in fault(text + LOAD)
    with pytest.raises(InputError, match="unit_system: has no meaning"):
        Problem(PAIR, 1.0, 0.1, 0.4, dimensionless=True, unit_system="mm, N, MPa")


@pytest.mark.parametrize("whole", [True, False])
@pytest.mark.parametrize("system", ["in, lbf, ksi", "mm, N, MPa", "cm, kN, GPa", "m, N, Pa", "in, kip, psi"])
def test_a_number_that_is_written_is_read_as_the_same_one(system, whole):
    draw = random.Random(7)
    for kind, way in measures_of(system, whole).items():
        for _ in range(20):
            number = round(draw.uniform(-1.0, 1.0), 4) * 10.0 ** draw.randint(-9, 9)
            back = way.in_si(way.given(way.in_si(number)))
            assert back == way.in_si(number), kind
            assert way.per_si * way.in_si(number) == pytest.approx(number, rel=1e-15)


def test_units_of_all_kinds_follow_from_three():
    found = units(problem(unit_system="in, lbf, ksi", thickness=0.5))
    assert found["force"].factor * 1.0 == pytest.approx(0.5 / POUND)
    assert found["moment"].factor == pytest.approx(0.5 / (POUND * INCH))
    assert found["traction"].factor == pytest.approx(1.0 / KSI)
    assert found["stress intensity"].factor == pytest.approx(1.0 / (KSI * math.sqrt(INCH)))
    assert found["energy density"].factor == pytest.approx(INCH / POUND)
    names = {kind: found[kind].name for kind in ("force", "moment", "stiffness", "crack growth", "wear coefficient")}
    assert names == {
        "force": "lbf", "moment": "lbf in", "stiffness": "lbf in/rad", "crack growth": "in/cycle",
        "wear coefficient": "1/ksi",
    }  # fmt: skip
    plain = units(problem(unit_system="mm, N, MPa"))
    assert (plain["force"].name, plain["energy"].name) == ("N/mm", "N mm/mm")
    assert (plain["force"].factor, plain["energy"].factor) == (1e-3, 1.0)


def test_a_chosen_unit_has_no_prefix():
    chosen, usual = (units(problem(unit_system=each))["displacement"] for each in ("mm, N, MPa", SI))
    assert chosen.scale([2e-8]) == (1e3, "mm")
    assert usual.scale([2e-8]) == (1e9, "nm")


@pytest.mark.parametrize("system", ["in, lbf, ksi", "mm, N, MPa"])
@pytest.mark.parametrize("thickness", [None, 7e-3])
def test_a_case_survives_its_file_in_any_units(system, thickness):
    case = builtin_case()
    problem = case.problem.__class__(
        case.problem.pair, 9.5e-3, 13e-6, 0.4, "centre", "spring", hub_stiffness=1234.5, thickness=thickness,
        unit_system=system,
    )  # fmt: skip
    text = case_text(case.__class__(problem, case.history, case.options))
    assert f'units = "{system}"' in text
    back = parse_case(text)
    assert back.problem.clearance == pytest.approx(13e-6, rel=4e-16)  # no float in inches is read as this one
    assert (back.problem.hole_radius, back.problem.thickness) == (9.5e-3, thickness)
    assert back.history.values() == pytest.approx(case.history.values(), rel=2e-16)
    assert case_text(back) == text


def test_a_message_about_a_converted_number_shows_the_number_of_the_file():
    found = fault(TEXT.replace("clearance = 0.02", "clearance = 500.0") + LOAD)
    assert "line 10: clearance: must lie between minus and plus the hole radius 0.01, not 0.5" in found
    assert found.endswith('; in SI units: the file has 500.0, with units = "mm, N, MPa"')
    assert fault(TEXT + LOAD.replace("5.0", '[5.0, "x"]')).endswith('value 2 of P: must be a number, not "x"')


def test_a_column_without_a_unit_is_in_the_units_of_the_case(tmp_path):
    (tmp_path / "loads.csv").write_text("P,Q [N/m],sxx\n12.0,3.0,5.0\n14.0,3.0,6.0\n")
    found = in_units(TEXT + '[history]\ncsv = "loads.csv"', folder=tmp_path).history.values()
    assert found[:, [0, 1, 3]].tolist() == [[12e3, 3.0, 5e6], [14e3, 3.0, 6e6]]


def test_a_law_of_growth_belongs_to_the_range_one_of_the_file():
    text = TEXT.replace("[contact]", 'growth = { law = "paris", C = 1e-9, m = 3.0 }\n[contact]') + LOAD
    law = in_units(text, "in, lbf, ksi").problem.pair.plate.growth
    assert pytest.approx(1e-9 * INCH) == law.C
    assert law.unit == pytest.approx(KSI * math.sqrt(INCH))
    assert parse_case(text.replace("10e3", "70e9")).problem.pair.plate.growth.unit == 1e6


def test_a_stress_life_curve_keeps_its_lives():
    given = {"curve_a": 20.83, "curve_b": 9.84, "curve_c": 11.0, "curve_kt": 1.0}
    found = converted(given, FATIGUE, lambda kind, number: measures_of("in, lbf, ksi", False)[kind].in_si(number))
    for stress in (40.0, 80.0):
        life = given["curve_a"] - given["curve_b"] * math.log10(stress - given["curve_c"])
        same = found["curve_a"] - found["curve_b"] * math.log10(KSI * stress - found["curve_c"])
        assert same == pytest.approx(life)
    text = TEXT.replace("[contact]", "fatigue = { curve_a = 20.0 }\n[contact]") + LOAD
    assert "fatigue: curve_a needs curve_b beside it" in fault(text)


def test_a_lug_file_has_units_of_its_own():
    changed = in_other_units(
        {"plate": {"hole_radius": 10e-3}}, {"plate": {"hole_radius": "length"}}, SI, "mm, N, MPa", False
    )
    assert changed == {"plate": {"hole_radius": 10.0}, "units": "mm, N, MPa"}
    text = re.sub(r"-?\d+e-3|(?<=\[)0\.0", lambda each: str(1e3 * float(each[0])), LUG_EXAMPLE)
    assert parse_lug(f'units = "mm, N, MPa"\n{text}').lug == parse_lug(LUG_EXAMPLE).lug


def test_every_kind_of_a_key_is_a_kind_of_quantity():
    known = measures_of(SI, True)
    assert {kind_of(f"{section}.{key}") for section, keys in KEYS.items() for key in keys} <= {*known, ""}
    assert CASE.keys() <= KEYS.keys()
    assert [each.name for each in measures(SI)] == ["m", "N", "Pa"]


WITHOUT_UNIT = """
alpha angle angles arc at author axis beta between bodies body compressive_slope confidence constraint
convention count criterion csv curve curve_a curve_b curve_kt curve_m curve_samples curve_scatter cycles date drive
ductility_exponent error_bars expansion exponent failure fatigue_ductility friction increments keep kind knee
law layup life load_parameter m material method n name nodes normal_stress_factor nu nu12 nu_pin over
p phase pin_load plane points project q reliability repeat revision rigid rotation shear_ductility_exponent
shear_fatigue_ductility shear_strength_exponent shortcut skip slip_sums small_cycles source straight
strength_exponent stress_level theta threshold_exponent threshold_slope tolerance turning_points
"""
"""Keys that have no unit, or the same one in every system."""


def test_every_key_has_a_kind_or_no_unit():
    keys = [(CASE.get(section, {}), names) for section, names in KEYS.items()]
    keys += [(FATIGUE, [each.name for each in fields(FatigueConstants)]), (PLY, PLY_KEYS)]
    keys += [(LAW, constants) for _, constants, _ in LAWS.values()]
    assert {name for kinds, names in keys for name in names if name not in kinds} == {*WITHOUT_UNIT.split()}


def test_files_of_materials_have_units_of_their_own(tmp_path):
    (tmp_path / "own.toml").write_text('units = "in, lbf, ksi"\n[own]\nE = 10e3\nnu = 0.3\nyield_strength = 50.0\n')
    text = 'materials = "own.toml"\n' + TEXT.replace("E = 10e3\nnu = 0.3", 'material = "own"') + LOAD
    material = in_units(text, folder=tmp_path).problem.pair.plate
    assert (material.E, material.yield_strength) == pytest.approx((10e3 * KSI, 50.0 * KSI))
