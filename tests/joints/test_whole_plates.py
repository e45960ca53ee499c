"""The whole plates of a joint: stresses anywhere, and cracks."""

from __future__ import annotations

import json
import math
import pickle
from functools import cache

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import fastpin
from fastpin import Grid, InputError, MaterialPair, Problem, lugs
from fastpin.assess.outputs import whole_document
from fastpin.cracks import Crack, stress_intensity
from fastpin.joints import Joint, JointPin, JointPlate, JointResult, SectionCrack, parse_joint, solve_joint
from fastpin.lugs import fields, plates, several_holes
from fastpin.lugs.outline import Lug, rectangle
from fastpin.lugs.plates import COARSE
from fastpin.model import Material, Points
from fastpin.model.angles import BOTTOM
from fastpin.model.crack import CrackGrowth
from fastpin.model.growth import Walker
from fastpin.report import joints as report
from fastpin.report import json_schema
from fastpin.report.joint_document import JOINT
from fastpin.states.state import State
from tests.support.faults import faults_of

ALUMINIUM, STEEL = Material(72e9, 0.33), Material(210e9, 0.30)
RADIUS, THICKNESS, FORCE = 5e-3, 2e-3, 6e3
STRIP, SUPPORTS = rectangle((-40e-3, 16e-3), (-16e-3, 16e-3)), {"left": "both"}
LAW = Walker(1e-10, 3.0)


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Panels with errors of 1e-5: the tests take a third of the time."""
    monkeypatch.setattr(fields, "FINENESS", COARSE)
    monkeypatch.setattr(several_holes, "FINE", COARSE)
    monkeypatch.setattr(plates, "FINE", COARSE)


def pin(name: str, at: complex, *plates: str) -> JointPin:
    return JointPin(name, at, STEEL, RADIUS, plates, clearance=2e-5, friction=0.3)


@cache
def doubled() -> JointResult:
    """A doubler that floats, with a hole without a pin, on an infinite sheet under tension."""
    sheet = JointPlate("sheet", ALUMINIUM, THICKNESS)
    outline, window = rectangle((-26e-3, 25e-3), (-16e-3, 18e-3)), lugs.Hole("window", 1e-3 + 9e-3j, 3e-3)
    doubler = JointPlate("doubler", ALUMINIUM, THICKNESS, outline, moves="free", holes=(window,))
    pins = pin("A", -12e-3 + 1e-3j, "sheet", "doubler"), pin("B", 12e-3 + 0j, "sheet", "doubler")
    return solve_joint(
        Joint((sheet, doubler), pins), [{"sheet.sxx": 300e6}, {"sheet.sxx": 150e6}], nodes=32, harmonics=16
    )


@cache
def whole(name: str) -> list[State]:
    return doubled().of(name, "doubler", whole=True)


def centre(name: str) -> complex:
    return next(each.at for each in doubled().joint.pins if each.name == name)


@pytest.mark.gate
def test_one_pin_has_the_stresses_and_cracks_of_a_problem() -> None:
    plate = JointPlate("strip", ALUMINIUM, THICKNESS, STRIP, SUPPORTS)
    joint = solve_joint(Joint((plate,), (pin("A", 0j, "strip"),)), [{"A.x": FORCE}, {"A.x": 0.0}], nodes=48)
    body = lugs.plate_compliance(Lug(ALUMINIUM.nu, "stress", RADIUS, STRIP, SUPPORTS)).compliance
    pair = MaterialPair(STEEL, ALUMINIUM, "stress")
    problem = Problem(pair, RADIUS, 2e-5, 0.3, pin_load="body", thickness=THICKNESS, plate_body=body)
    alone = fastpin.solve(problem, [{"Q": FORCE / THICKNESS, "P": 0.0}], grid=Grid.circle(48, BOTTOM))[0]
    (state, _), lengths = joint.of("A", "strip", whole=True), [1e-4, 2e-3, 6e-3]
    assert state.outline_peak[:3] == pytest.approx(alone.outline_peak[:3], rel=1e-4, abs=1e-9)
    assert state.outline_peak.edge == alone.outline_peak.edge
    crack = Crack(0.45 * math.pi, 0.2)
    found, expected = (stress_intensity(each, crack, lengths) for each in (state, alone))
    size = np.abs(expected.K_I).max()
    np.testing.assert_allclose(found.K_I, expected.K_I, atol=2e-4 * size)
    np.testing.assert_allclose(found.K_II, expected.K_II, atol=2e-4 * size)
    growth = joint.crack_growth(SectionCrack("A", "strip", CrackGrowth(1e-4, 6e-3, LAW, theta=0.5 * math.pi)))
    assert growth.per == "spectrum"
    np.testing.assert_allclose(
        growth.K_max[[0, -1]], stress_intensity(state, Crack(0.5 * math.pi), [1e-4, 6e-3]).K_I[0]
    )


@pytest.mark.gate
def test_both_holes_know_one_plate() -> None:
    """Each of the two fields leaves its own hole free and integrates over the other: they share no line of points."""
    z = np.array([-10e-3j, 15e-3j, -24e-3 - 2e-3j])
    sums, peaks = [], []
    for name in "AB":
        state, away = whole(name)[0], z - centre(name)
        stress = state.stress(Points.at_xy(away.real, away.imag), "plate", straight=True)
        sums.append(stress.radial + stress.hoop)
        peak = state.outline_peak
        peaks.append((peak.value, peak.x + centre(name).real, peak.y + centre(name).imag, peak.edge))
    np.testing.assert_allclose(sums[0], sums[1], rtol=1e-4)
    assert peaks[0][3] == peaks[1][3]
    np.testing.assert_allclose(peaks[0][:3], peaks[1][:3], rtol=1e-4, atol=1e-12)


@pytest.mark.gate
def test_a_crack_in_a_floating_plate_is_the_same_from_both_holes() -> None:
    mouth, found = 2e-3 - 16e-3j, []
    for name in "AB":
        away = mouth - centre(name)
        crack = Crack(place=(away.real, away.imag))
        found.append(stress_intensity(whole(name), crack, [1e-3, 6e-3], straight=True).K_I)
    np.testing.assert_allclose(found[0], found[1], rtol=1e-4)


@pytest.mark.gate
def test_a_hole_of_the_whole_plate_has_the_stress_of_the_hole_alone() -> None:
    known, alone = (doubled().of("A", "doubler", each)[1] for each in (True, False))
    points = Points.at_depth(np.array([[0.0], [4e-4]]), np.linspace(0.0, 6.0, 7))
    for name in ("radial", "hoop", "shear"):
        one, other = (getattr(state.stress(points, "plate"), name) for state in (known, alone))
        np.testing.assert_allclose(one, other, atol=1e-6 * float(np.abs(alone.stress(points, "plate").hoop).max()))
    body = known.problem.plate_body
    again = pickle.loads(pickle.dumps(body))
    assert again == body
    assert again != alone.problem.plate_body
    assert again.pinned == ("hole of B",)


SECOND_PIN = """[[pin]]
name = "B"
at = [-20e-3, 0.0]
material = "steel"
diameter = 10e-3
plates = ["strip"]
"""
STRAP = (
    """title = "strap"
[joint]
nodes = 16
repeat = 2
[[plate]]
name = "strip"
E = 72e9
nu = 0.33
yield_strength = 300e6
thickness = 2e-3
x = [-40e-3, 16e-3]
y = [-16e-3, 16e-3]
supports = { left = "both" }
[[pin]]
name = "A"
at = [0.0, 0.0]
material = "steel"
diameter = 10e-3
plates = ["strip"]
"""
    + SECOND_PIN
    + """[[load]]
"A.x" = 6e3
[[load]]
"A.x" = 1e3
[crack]
pin = "A"
plate = "strip"
first = 2e-4
last = 4e-3
theta = 180.0
law = { law = "walker", C = 1e-10, m = 3.0 }
"""
)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('pin = "A"\n', "", "[crack]: pin is missing"),
        ('pin = "A"\n', 'pin = "C"\n', 'pin: must be "A" or "B", not "C"'),
        ('plate = "strip"\nfirst', 'plate = "skin"\nfirst', 'plate: must be "strip", not "skin"'),
        ("last = 4e-3", "last = 40e-3", "last: must end within"),
        ("first = 2e-4\n", "", "first is missing"),
        ("law = {", "place = [0.0, 0.0]\nlaw = {", 'unknown key "place" in [crack]'),
        ('law = { law = "walker", C = 1e-10, m = 3.0 }\n', "", "law: is missing"),
    ],
)
def test_a_fault_of_a_crack_names_its_key(old: str, new: str, words: str) -> None:
    assert old in STRAP
    found = faults_of(parse_joint, STRAP.replace(old, new))
    assert any(words in sentence for _, sentence in found), found


def test_a_crack_needs_an_outline_and_two_corners() -> None:
    one = STRAP.replace("repeat = 2\n", "").replace('[[load]]\n"A.x" = 1e3\n', "")
    assert "crack: needs a turning point" in faults_of(parse_joint, one)[0][1]
    sheet = JointPlate("sheet", ALUMINIUM, THICKNESS)
    joint = Joint((sheet,), (pin("A", 0j, "sheet"),))
    with pytest.raises(InputError, match="plate: sheet is infinite: give it an outline"):
        joint.lug("A", "sheet")


@pytest.mark.gate
def test_text_and_json_tell_the_same_crack() -> None:
    case = parse_joint(STRAP.replace(SECOND_PIN, ""))
    result = solve_joint(case.joint, case.corners, nodes=case.nodes)
    judged = report.judged(result, crack=case.crack)
    document = whole_document(JOINT, judged, report.joint_units(result.joint), title="strap")
    Draft202012Validator(json_schema("joint")).validate(document)
    told = document["crack"]
    assert (told["pin"], told["plate"], told["error"]) == ("A", "strip", None)
    assert f"A in strip, crack at 180.00 deg from the bottom: {told['growth']['crack']['words']}" in report.describe(
        judged
    )
    assert told["growth"]["crack"]["repeated"] == "cycle"
    unfinished = report.judged(result, crack=case.crack, is_complete=False)
    assert "A in strip, crack: not known, the history has not come to its end" in report.describe(unfinished)
    document = whole_document(JOINT, unfinished, report.joint_units(result.joint), title="strap")
    assert document["crack"]["growth"] is None
    assert json.loads(json.dumps(document)) == document
