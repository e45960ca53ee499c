"""The section [strength] of case files."""

import pytest

from fastpin import MATERIALS, Case, InputError, casefile
from fastpin.casefile import EXAMPLE, parse_case
from fastpin.model import StrengthAssessment
from tests.support.case_texts import LAMINATED as CASE
from tests.support.faults import fault_of

SECTION = """[strength]
criterion = "tsai-wu"
distance = 0.5e-3
failure = true
"""
LINE = CASE.count("\n") + 1


@pytest.mark.parametrize(
    ("section", "expected"),
    [
        (SECTION, StrengthAssessment("tsai-wu", 0.5e-3, failure=True)),
        ("[strength]\ndistance = 0\n", StrengthAssessment(distance=0.0)),
        (
            "[strength]\ntension = 5e-4\ncompression = 1.5e-3\nfailure = false\n",
            StrengthAssessment(tension=5e-4, compression=1.5e-3),
        ),
    ],
)
def test_a_case_has_a_strength_and_writes_it_back(section, expected):
    case = parse_case(CASE + section)
    assert case.strength == expected
    assert parse_case(casefile.case_text(case)).strength == expected


def test_without_the_section_there_is_none():
    assert parse_case(EXAMPLE).strength is None
    assert "strength" not in casefile.case_text(parse_case(CASE))


@pytest.mark.parametrize(
    ("section", "line", "sentence"),
    [
        (SECTION.replace("tsai-wu", "tsai-wuu"), 1, 'criterion: must be "maximum-stress", "maximum-strain"'),
        (SECTION.replace("0.5e-3", "-1"), 2, "distance: must not be negative, not -1"),
        (SECTION.replace("0.5e-3", "0.5"), 2, "distance: must be at most 100 radii of the hole, not 500 mm"),
        (SECTION.replace("= true", '= "yes"'), 3, 'failure: must be true or false, not "yes"'),
        (SECTION.replace("failure", "failur"), 3, 'unknown key "failur" in [strength], did you mean "failure"?'),
        (SECTION + "tension = 1e-3\n", 2, "distance: can't be given together with tension and compression"),
        (SECTION + "tension = 1e-3\ncompression = 1e-3\n", 2, "distance: can't be given together with tension"),
        ("[strength]\n", 0, "distance: or tension and compression must be given: lengths from tests, m"),
        ("[strength]\ntension = 1e-3\n", 0, "distance: or tension and compression must be given: lengths from"),
        ("[strength]\ntension = 1e-3\ncompression = -1e-3\n", 2, "compression: must not be negative"),
    ],
)
def test_a_fault_is_one_sentence_with_its_line(section, line, sentence):
    found_line, found = fault_of(parse_case, CASE + section)
    assert found_line == LINE + line
    assert found.startswith(sentence)


@pytest.mark.parametrize(
    "plate",
    [
        'material = "2024-T3"',
        "E1 = 54e9\nE2 = 54e9\nG12 = 20.7e9\nnu12 = 0.31",
        'layup = "[0/90]s"\nply = { E1 = 135e9, E2 = 9e9, G12 = 5e9, nu12 = 0.3, thickness = 0.125e-3 }',
    ],
)
def test_only_a_laminate_whose_plies_have_strengths_has_the_section(plate):
    text = CASE.replace('layup = "[0/45/-45/90]2s"\nply = "T300/914"', plate) + SECTION
    line = text[: text.index("[strength]")].count("\n") + 1
    words = "strength: belongs to a plate that is a laminate whose plies have strengths"
    assert fault_of(parse_case, text) == (line, words)


def test_the_class_of_a_section_is_checked():
    case = parse_case(CASE)
    with pytest.raises(InputError, match=r"strength: must be a fastpin.model.StrengthAssessment"):
        Case(case.problem, case.history, strength=MATERIALS["steel"])
    with pytest.raises(InputError, match="a FatigueAssessment"):
        Case(case.problem, case.history, fatigue=StrengthAssessment(distance=0.0))
