"""Laminates in case files: read, written back, described, doubted and refused."""

import dataclasses
from collections.abc import Callable

import jsonschema
import pytest
from hypothesis import given

import fastpin
from fastpin import CaseFileError, InputError, cracks, damage
from fastpin.casefile import EXAMPLE, case_text, parse_case
from fastpin.figures.style import caption
from fastpin.model import CrackGrowth, FatigueAssessment, FatigueConstants, Laminate, Ply
from fastpin.model.angles import angle_at
from fastpin.model.crack import check_crack
from fastpin.model.doubts import doubts
from fastpin.model.laminate import ALONG_LOAD
from fastpin.report import describe, json_schema
from fastpin.report.summary import document
from tests.support.strategies import laminates
from tests.support.tiers import gate

OWN = "{ E1 = 135e9, E2 = 9e9, G12 = 5e9, nu12 = 0.3, thickness = 0.2e-3"
LAYUP = 'layup = "[0/45/-45/90]2s"\nply = "T300/5208"\n'
CONTACT = '[contact]\nplane = "stress"\nhole_radius = 3e-3\nclearance = 2e-5\nfriction = 0.2\n'


def text(plate: str, more: str = "") -> str:
    """A case file with these keys of [plate]."""
    return f'[pin]\nmaterial = "steel"\n[plate]\n{plate}\n{CONTACT}{more}[[load]]\nP = 1e6\n'


def plate_of(keys: str) -> Laminate:
    found = parse_case(text(keys)).problem.pair.plate
    assert isinstance(found, Laminate)
    return found


def test_a_layup_of_a_named_ply() -> None:
    plate = plate_of(LAYUP)
    assert plate == Laminate.from_layup("[0/45/-45/90]2s", "T300/5208")
    assert plate.axis == ALONG_LOAD
    assert plate_of(LAYUP + "axis = 30").axis == angle_at(30.0)
    assert plate_of('layup = [0, 90, 0]\nply = "T300/5208"').layup == "[0/90/0]"


def test_a_ply_of_ones_own() -> None:
    plate = plate_of(
        f'layup = "[0/90]s"\nply = {OWN}, Xt = 2e9, Xc = 1e9, Yt = 5e7, Yc = 2e8, S = 1e8, name = "mine" }}'
    )
    ply = plate.plies[0][0]
    assert (ply.E1, ply.name) == (135e9, "mine")
    assert ply.strengths.Yc == 2e8
    several = plate_of(f'layup = "[0/90]s"\nply = ["T300/5208", {OWN} }}, {OWN} }}, "T300/5208"]')
    assert [each.E1 for each, _ in several.plies] == [181e9, 135e9, 135e9, 181e9]


def test_moduli_and_compliances_of_the_whole() -> None:
    assert plate_of("E1 = 70e9\nE2 = 30e9\nG12 = 9e9\nnu12 = 0.25\naxis = 45") == Laminate.from_moduli(
        70e9, 30e9, 9e9, 0.25, axis=angle_at(45.0)
    )
    compliance = (2e-11, -5e-12, 3e-11, 1e-12, -2e-12, 6e-11)
    assert plate_of(f"compliance = {list(compliance)}").compliance == compliance


@pytest.mark.parametrize(
    "keys",
    [
        LAYUP,
        LAYUP + "axis = -12.5",
        f'layup = "[0/30/90]s"\nply = {OWN}, source = "a \\"test\\"" }}',
        f'layup = "[0]"\nply = {OWN} }}',
        f'layup = "[0/90]s"\nply = ["T300/5208", {OWN} }}, {OWN} }}, "T300/5208"]',
        'layup = "[0/90]s"\nply = ["T300/5208", "AS4/3501-6", "AS4/3501-6", "T300/5208"]',
        "E1 = 70e9\nE2 = 30e9\nG12 = 9e9\nnu12 = 0.25\naxis = 45",
        "compliance = [2e-11, -5e-12, 3e-11, 1e-12, -2e-12, 6e-11]",
    ],
)
def test_a_written_laminate_is_read_back(keys: str) -> None:
    case = parse_case(text(keys))
    again = parse_case(case_text(case))
    assert again.problem == case.problem
    assert case_text(again) == case_text(case)


@pytest.mark.gate
@given(laminates())
def test_any_laminate_is_written_and_read_back(plate: Laminate) -> None:
    case = parse_case(text(LAYUP))
    pair = fastpin.MaterialPair(case.problem.pair.pin, plate, "stress")
    problem = dataclasses.replace(case.problem, pair=pair)
    again = parse_case(case_text(dataclasses.replace(case, problem=problem))).problem.pair.plate
    assert isinstance(again, Laminate)
    assert again == plate
    assert (again.compliance, again.axis) == (plate.compliance, plate.axis)


def test_a_dimensionless_laminate_is_read_back() -> None:
    given = text(LAYUP + "axis = 20").replace("hole_radius = 3e-3\nclearance = 2e-5\n", "load_parameter = 0.1\n")
    case = parse_case(given.replace("P = 1e6", "P = 1.0"))
    plate, again = case.problem.pair.plate, parse_case(case_text(case)).problem.pair.plate
    assert isinstance(plate, Laminate)
    assert isinstance(again, Laminate)
    assert again.layup == plate.layup == "[0/45/-45/90]2s"
    assert again.compliance == pytest.approx(plate.compliance, rel=1e-12)
    assert plate.plies[0][0].strengths is None


@pytest.mark.parametrize(
    ("keys", "line", "words"),
    [
        ('layup = "[0//90]s"\nply = "T300/5208"', 4, r'layup: must be an angle at position 4 of "\[0//90\]s"'),
        ('layup = "[0/90]"\nply = "T300/5208"', 4, "layup: must be symmetric about the middle"),
        ('layup = "[0]"\nply = "T300"', 5, 'ply: must be "AS4/3501-6", "T300/914", .* did you mean "T300/914"'),
        ('layup = "[0]"\nply = 3', 5, "ply: must be the name of a ply in quotes, or a table with E1, E2, G12"),
        ('layup = "[0]"', 3, r"\[plate\]: ply is missing"),
        ('ply = "T300/5208"', 3, r"\[plate\]: layup is missing"),
        ("axis = 30", 4, "axis: belongs to a laminate: give layup and ply, or E1"),
        ("E = 7e10\nnu = 0.3\naxis = 30", 6, "axis: belongs to a laminate"),
        (
            LAYUP + "axis = 1.5708",
            6,
            "axis: must be in degrees from the bottom of the hole; 1.5708 is 90 degrees in rad",
        ),
        (LAYUP + "E = 7e10", 6, r"\[plate\]: E can't be given together with layup"),
        (LAYUP + "E1 = 7e10", 6, r"\[plate\]: E1 can't be given together with layup"),
        (LAYUP + 'material = "steel"', 6, r"\[plate\]: material can't be given together with layup"),
        (LAYUP + "yield_strength = 7e8", 6, "yield_strength: has no meaning for a laminate"),
        (LAYUP + "fatigue = { fatigue_strength = 1e9 }", 6, "fatigue: has no meaning for a laminate"),
        (LAYUP + 'growth = { law = "paris", C = 1e-11, m = 3 }', 6, "growth: has no meaning for a laminate"),
        (LAYUP + "plyes = 3", 6, r'unknown key "plyes" in \[plate\], did you mean "ply"'),
        ("E1 = 7e10\nE2 = 7e10\nG12 = 1e9", 3, r"\[plate\]: nu12 is missing"),
        ("E1 = 7e10\nE2 = 7e10\nG12 = 1e9\nnu12 = 1.5", 7, "nu12: must lie within"),
        ("E1 = 7e10\nE2 = 7e10\nG12 = 0\nnu12 = 0.3", 6, "G12: must be positive, not 0"),
        ("compliance = [1.0, 2.0]", 4, "compliance: must be six numbers, a11, a12, a22"),
        (f'layup = "[0]"\nply = {OWN}, E3 = 1e9 }}', 5, 'unknown key "E3" in ply of '),
        (f'layup = "[0]"\nply = {OWN}, Xt = 1e9 }}', 5, "Xc: is missing: the strengths of a ply are Xt, Xc, Yt, Yc, S"),
        ('layup = "[0]"\nply = { E1 = -1 }', 5, "E1: must be positive"),
        (f'layup = "[0/90]s"\nply = ["T300/5208", {OWN} }}]', 5, "ply: must be one ply, or a list of 4 for the whole"),
    ],
)
def test_faults_of_a_laminate_have_lines(keys: str, line: int, words: str) -> None:
    with pytest.raises(CaseFileError, match=words) as caught:
        parse_case(text(keys))
    assert line in [where for where, _ in caught.value.problems]


INFINITE = "must be an infinite plate if it is a laminate"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (text(LAYUP, '[plate_body]\nouter_radius = 9e-3\nsupport = "held"\n'), INFINITE),
        (text(LAYUP, "[plate_body]\nreaction = [0.0, 6e-2]\n"), INFINITE),
        (text(LAYUP, '[plate_body]\nmaterial = "steel"\nouter_radius = 4e-3\n'), INFINITE),
        (
            text(LAYUP, '[crack]\nfirst = 1e-4\nlast = 1e-3\nlaw = { law = "paris", C = 1e-11, m = 3 }\n'),
            "body: the plate is a laminate",
        ),
        (text(LAYUP, '[fatigue]\nbodies = "plate"\n'), "bodies: the plate is a laminate, and a criterion of fatigue"),
        (
            text("E = 7e10\nnu = 0.3").replace('material = "steel"', 'material = "steel"\nE1 = 3'),
            r'unknown key "E1" in \[pin\]; it belongs in \[plate\]',
        ),
        (
            text(f'layup = "[0]"\nply = {OWN}, Xt = 2e9, Xc = 1e9, Yt = 5e7, Yc = 2e8, S = 1e8 }}').replace(
                "hole_radius = 3e-3\nclearance = 2e-5\n", "load_parameter = 0.1\n"
            ),
            "Xt: has no meaning with load_parameter",
        ),
    ],
    ids=["ring", "reaction", "bush", "crack", "fatigue", "pin", "without units"],
)
def test_what_does_not_go_with_a_laminate_is_refused(given: str, words: str) -> None:
    with pytest.raises(CaseFileError, match=words):
        parse_case(given)


def test_a_laminate_may_wear() -> None:
    case = parse_case(text(LAYUP, "[wear]\ncoefficient = 1e-15\ncycles = 10\n") + "repeat = 10\n")
    assert case.wear is not None


def test_the_example_names_all_keys() -> None:
    for key in ("layup", "ply", "E1", "compliance", "axis"):
        assert f"# {key} = " in EXAMPLE


def test_a_laminate_in_words() -> None:
    case = parse_case(text(LAYUP + "axis = 30"))
    words = describe(case)
    row = next(line for line in words.splitlines() if line.startswith("plate"))
    assert "[0/45/-45/90]2s of T300/5208, E1 = 69.6757 GPa, E2 = 69.6757 GPa, G12 = 26.8804 GPa, nu12 = 0.296" in row
    assert row.endswith("axis 1 at 30 deg from the bottom")
    assert "plate: [0/45/-45/90]2s of T300/5208" in caption(case.problem)
    unnamed = parse_case(text("E1 = 70e9\nE2 = 30e9\nG12 = 9e9\nnu12 = 0.25"))
    assert "laminate, E1 = 70 GPa" in describe(unnamed)
    whole = parse_case(
        text(LAYUP).replace("hole_radius = 3e-3\nclearance = 2e-5\n", "load_parameter = 0.1\n").replace("1e6", "1.0")
    )
    assert "/ beta*" in next(line for line in describe(whole).splitlines() if line.startswith("plate"))


@pytest.mark.gate
def test_a_laminate_in_json() -> None:
    case = parse_case(text(LAYUP + "axis = 30"))
    result = fastpin.solve(case.problem, case.history, nodes=31)
    found = document(case, result)
    jsonschema.validate(found, json_schema("run"))
    laminate = found["problem"]["plate"]["laminate"]
    assert (laminate["layup"], laminate["ply"], laminate["axis"]) == ("[0/45/-45/90]2s", "T300/5208", 30.0)
    assert laminate["moduli"]["E1"] == pytest.approx(69.6757e9, rel=1e-5)
    assert laminate["is_isotropic_contact"] is True
    assert "laminate" not in found["problem"]["pin"]
    moduli = parse_case(text("E1 = 70e9\nE2 = 30e9\nG12 = 9e9\nnu12 = 0.25"))
    jsonschema.validate(document(moduli, None), json_schema("run"))


def doubted(keys: str, thickness: str = "") -> dict[str, str]:
    case = parse_case(text(keys).replace("friction = 0.2", f"friction = 0.2\n{thickness}"))
    return {each.field: each.reason for each in doubts(case.problem, case.history)}


def test_angles_in_rad_are_doubted() -> None:
    found = doubted('layup = "[0/0.7854/-0.7854/1.5708]s"\nply = "T300/5208"')
    assert found["layup"].startswith("the angles look like rad: 0.7854 is 45 degrees in rad")
    for layup in ("[0/45/-45/90]s", "[0/0.5]s", "[0]", "[0/0.7854/90]s"):
        assert "layup" not in doubted(f'layup = "{layup}"\nply = "T300/5208"')


def test_another_thickness_than_that_of_the_plies_is_doubted() -> None:
    assert "2e-3 m" in doubted(LAYUP, "thickness = 3e-3")["thickness"]
    assert "thickness" not in doubted(LAYUP, "thickness = 2.01e-3")
    assert "thickness" not in doubted("E1 = 70e9\nE2 = 30e9\nG12 = 9e9\nnu12 = 0.25", "thickness = 3e-3")


def test_strengths_of_plies_in_mpa_are_doubted() -> None:
    found = doubted(f'layup = "[0]"\nply = {OWN}, Xt = 2000, Xc = 1e9, Yt = 5e7, Yc = 2e8, S = 1e8 }}')
    assert "did you mean 2000 MPa" in found["Xt"]
    assert "Yt" not in found


def test_a_pin_in_a_laminate_may_be_assessed() -> None:
    given = text(LAYUP).replace('material = "steel"', 'material = "2024-T3"')
    problem = parse_case(given).problem
    how = FatigueAssessment("smith-watson-topper")
    assert fastpin.model.assessment.assessed_bodies(problem, how, "smith-watson-topper") == ("pin",)
    rigid = dataclasses.replace(
        problem, pair=fastpin.MaterialPair(fastpin.Material.rigid(), problem.pair.plate, "stress")
    )
    with pytest.raises(InputError, match="bodies: the plate is a laminate"):
        fastpin.model.assessment.assessed_bodies(rigid, how, "smith-watson-topper")


CONSTANTS = FatigueConstants(1e9, -0.1, 0.5, -0.6, 5e8, -0.1, 0.5, -0.6)


@pytest.mark.parametrize(
    "call",
    [
        *gate(lambda states: damage.fatigue(states, "smith-watson-topper", "plate", constants=CONSTANTS)),
        lambda states: damage.spectrum_damage(states, "smith-watson-topper", "plate", constants=CONSTANTS),
        lambda states: cracks.stress_intensity(states[0], cracks.Crack(0.3), [1e-4]),
        lambda states: check_crack(states[0].problem, CrackGrowth(1e-4, 1e-3, cracks.Walker(1e-11, 3.0))),
    ],
)
def test_criteria_of_metals_refuse_a_laminate(call: Callable[[list[fastpin.State]], object]) -> None:
    case = parse_case(text(LAYUP) + "[[load]]\nP = 5e5\n[[load]]\nP = 1e6\n")
    states = list(fastpin.solve(case.problem, case.history, nodes=31))
    with pytest.raises(InputError, match=r"body: the plate is a laminate, and a .* is that of isotropic bodies"):
        call(states)


def test_no_doubt_of_the_equivalent_plate() -> None:
    ply = Ply(135e9, 9e9, 5e9, 0.3, 0.125e-3)
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], Laminate.from_layup("[+-45]s", ply), "stress")
    assert pair.plate.nu > 0.5
    problem = fastpin.Problem(pair, 3e-3, 2e-5, 0.2)
    assert not doubts(problem, fastpin.LoadHistory([{"P": 1e6}]))
