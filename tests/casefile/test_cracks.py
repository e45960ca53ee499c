"""The section [crack] of case files."""

import pytest

from fastpin import casefile
from fastpin.casefile.reader import EXAMPLE, parse_case
from fastpin.cracks import Nasgro, Walker
from fastpin.model import CrackGrowth
from fastpin.model.angles import DEGREE, angle_at
from tests.support.faults import fault_of

SECTION = """
[crack]
first = 1e-4
last = 3e-3
theta = 66
angle = 5
law = { law = "paris", C = 1e-10, m = 3 }
residual_stress = [[0, -20e6], [1e-3, 0]]
"""
LINE = EXAMPLE.count("\n") + 2


def test_a_case_has_a_crack_and_writes_it_back():
    case = parse_case(EXAMPLE + SECTION)
    pairs = ((0.0, -20e6), (1e-3, 0.0))
    law = Walker(1e-10, 3.0)
    assert case.crack == CrackGrowth(1e-4, 3e-3, law, angle_at(66.0), 5.0 * DEGREE, residual_stress=pairs)
    assert case.crack.residual([0.0, 5e-4, 1.0]).tolist() == [-20e6, -10e6, 0.0]
    assert parse_case(casefile.case_text(case)).crack == case.crack
    assert parse_case(EXAMPLE).crack is None


def test_the_law_may_be_that_of_the_plate():
    law = 'growth = { law = "nasgro", C = 1e-10, n = 2.5, p = 1, q = 1, threshold_range = 1e6, toughness = 4e7 }'
    text = EXAMPLE.replace("nu = 0.33 ", f"nu = 0.33\n{law} ", 1) + "[crack]\nfirst = 1e-4\nlast = 1e-3\n"
    case = parse_case(text)
    assert case.crack == CrackGrowth(1e-4, 1e-3)
    assert case.problem.pair.plate.growth == Nasgro(1e-10, 2.5, 1.0, 1.0, 1e6, 4e7)
    assert parse_case(casefile.case_text(case)).crack == case.crack


@pytest.mark.parametrize(
    ("old", "new", "line", "sentence"),
    [
        ("3e-3", "3e-5", 2, "last: must be longer than the first length of 0.0001 m, not 3e-05"),
        ("3e-3", "3e3", 2, "last: must be at most 10000 radii of the hole, not 3 km"),
        ("last = 3e-3", "", 0, "last is missing: give the last length of the crack, m"),
        ("theta = 66", "theta = north", 3, 'theta: text must stand in quotes, "north"'),
        ("theta = 66", "thetta = 66", 3, 'unknown key "thetta" in [crack], did you mean "theta"?'),
        ("angle = 5", "angle = 70", 4, "angle: must lie between -60 and 60, not 70"),
        ("angle = 5", 'body = "seat"', 4, 'body: "seat" is the edge of the plate round a bush'),
        ("theta = 66", "place = [22e-3]", 3, "place: must be a pair of coordinates, x and y, not [0.022]"),
        ("theta = 66", "place = [22e-3, 0]", 3, "place: needs a plate of any outline"),
        ("angle = 5", "place = [22e-3, 0]", 4, "place: stands in place of theta: leave one of them out"),
        ("m = 3", "m = 0", 5, "m: must be positive, not 0"),
        ('law = { law = "paris", C = 1e-10, m = 3 }', "", 0, "law: is missing: the material of the plate has no"),
        ("[0, -20e6]", "[0]", 6, "residual_stress: must be pairs of a distance, m, and a stress, Pa, not [0]"),
    ],
)
def test_a_fault_is_one_sentence_with_its_line(old, new, line, sentence):
    found_line, found = fault_of(parse_case, EXAMPLE + SECTION.replace(old, new, 1))
    assert found_line == LINE + line
    assert found.startswith(sentence)
