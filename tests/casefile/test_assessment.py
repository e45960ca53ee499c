"""The section [fatigue] of a case file."""

import re

import pytest
from hypothesis import given

import fastpin
from fastpin import CaseFileError
from fastpin.casefile import case_text, parse_case
from fastpin.casefile.beside import read_assessment
from fastpin.casefile.toml_text import CaseText
from fastpin.model import FatigueAssessment
from tests.support.faults import fault_of
from tests.support.refusals import refused
from tests.support.strategies import assessments

CASE = """\
[pin]
material = "Ti-6Al-4V"
[plate]
material = "2024-T3"
{plate}
[contact]
hole_radius = 10e-3
clearance = 40e-6
friction = 0.4
[[load]]
P = 6e6
{load}
[solve]
keep = "{keep}"
[fatigue]
{keys}
"""
TURNS = "[[load]]\nQ = [1e6, -1e6]\nrepeat = 3"


def text_of(keys="", plate="", load=TURNS, keep="all"):
    return CASE.format(keys=keys, plate=plate, load=load, keep=keep)


READ = {
    "": {},
    'criterion = ["smith-watson-topper"]\nbodies = "plate"': {"bodies": "plate"},
    'over = "cycle"\nstraight = true': {"over": "cycle", "straight": True},
    'small_cycles = "haibach"\nknee = 1e6': {"small_cycles": "haibach", "knee": 1e6},
    'method = "line"\nlength = 2e-5\nangles = 90': {"method": "line", "length": 2e-5, "angles": [90.0]},
}


@pytest.mark.parametrize("keys", READ)
def test_the_section_is_read(keys):
    assert parse_case(text_of(keys)).fatigue == FatigueAssessment(**READ[keys])


def test_a_case_without_the_section():
    assert parse_case(text_of().replace("[fatigue]", "")).fatigue is None


MISSING = 'must be given with small_cycles = "haibach": the cycles at the knee, such as 1e6'

FAULTS = {
    'criterion = "findley"': 'criterion: must be "smith-watson-topper", "fatemi-socie" or "stress-life", not "findley"',
    "criterion = 3": "criterion: must be a word or a list of words, not 3",
    'bodies = ["hole"]': 'bodies: must be "plate", "pin" or "seat", not "hole"',
    'small_cycles = "miner"': 'small_cycles: must be "elementary", "original" or "haibach", not "miner"',
    'small_cycles = "haibach"': f"knee: {MISSING}",
    "knee = 1e6": 'knee: belongs to "original" and "haibach", but small_cycles is "elementary"',
    'small_cycles = "original"\nknee = -1': "knee: must lie between 1 and 1e+18, not -1",
    "length = 1e-5": 'length: belongs to the methods "point", "line" and "area", but method is "edge"',
    'method = "line"\nlength = 0': "length: must be positive, not 0",
    'method = "area"\nlength = 1e300': "length: must lie between 1e-30 and 1e+30, not 1e+300",
    "angles = 400": "angles: must lie between -360 and 360, not 400",
    "straight = 1": "straight: must be true or false, not 1",
}


@pytest.mark.parametrize("keys", FAULTS)
def test_a_fault_names_its_line_and_has_the_sentence_of_python(keys):
    place = re.match(r"\w+", FAULTS[keys])[0]
    lines = text_of(keys).splitlines()
    written = [number for number, line in enumerate(lines, 1) if re.match(rf"{place} = ", line)]
    line = written[-1] if written else lines.index("[fatigue]") + 1
    assert fault_of(parse_case, text_of(keys)) == (line, FAULTS[keys])
    assert str(refused(FatigueAssessment, **CaseText(keys).root.table)) == FAULTS[keys]


TOGETHER = {
    "the pin lacks them": ({"keys": 'bodies = "pin"'}, "fatigue: smith-watson-topper needs fatigue_strength, "),
    "no shear": ({"keys": 'criterion = "fatemi-socie"'}, "fatigue: fatemi-socie needs normal_stress_factor, "),
    "no length": (
        {"keys": 'method = "area"'},
        'fatigue: method "area" needs threshold_range, limit_range of the plate\'s material',
    ),
    "no seat": ({"keys": 'bodies = "seat"'}, 'body: "seat" is the edge of the plate round a bush'),
    "no cycle": ({"keys": 'over = "cycle"', "load": ""}, "over: the history has no cycles"),
    "one corner": ({"load": ""}, "fatigue: needs a turning point: the history has one corner only"),
    "corners lost": ({"keep": "cycles"}, 'keep: must be "all" or "corners": fatigue needs the states at all corners'),
}


@pytest.mark.parametrize("name", TOGETHER)
def test_a_case_whose_fatigue_cannot_be_assessed(name):
    how, words = TOGETHER[name]
    line, found = fault_of(parse_case, text_of(**how))
    assert found.startswith(words)
    assert line >= 1


def test_the_length_of_the_materials():
    life = "fatigue_strength = 1e9, strength_exponent = -0.1, fatigue_ductility = 0.2, ductility_exponent = -0.6"
    plate = f"E = 7e10\nnu = 0.33\nfatigue = {{ threshold_range = 3e6, limit_range = 2e8, {life} }}"
    text = text_of('method = "line"', plate).replace('material = "2024-T3"\n', "")
    assert parse_case(text).fatigue == FatigueAssessment(method="line")


def test_unknown_keys_are_named():
    with pytest.raises(CaseFileError, match=r'unknown key "criteria" in \[fatigue\], did you mean "criterion"\?'):
        parse_case(text_of('criteria = "smith-watson-topper"'))


@pytest.mark.gate
@given(assessments())
def test_a_written_section_is_read_back(how):
    case = parse_case(text_of())
    section = case_text(fastpin.Case(case.problem, case.history, fatigue=how)).split("[fatigue]")[1]
    source = CaseText(f"[fatigue]{section}")
    assert read_assessment(source, source.section("fatigue")) == how
    assert not source.faults
