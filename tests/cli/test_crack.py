"""``fastpin crack``: a crack that grows under the last cycle of a stored result."""

import csv
import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

import fastpin
from fastpin import cracks, damage
from fastpin.assess.crack import crack_words, growth_line
from fastpin.bodies import Bushing
from fastpin.casefile import case_text
from fastpin.lugs import Lug
from fastpin.lugs.outline import rectangle
from fastpin.model.case import questions_of
from fastpin.report import json_schema
from tests.support.case_texts import IN_CYCLES
from tests.support.commands import printed, refused, said
from tests.support.lugs import outlined

jsonschema = pytest.importorskip("jsonschema")

LAW = ["--first", "1e-4", "--last", "3e-3", "--C", "1e-10", "--m", "3"]


PAIR = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.Material(70e9, 0.33))
PROBLEM = fastpin.Problem(PAIR, 10e-3, 20e-6, 0.3)
PULSES = fastpin.LoadHistory([{"P": 3e6}, {"P": 3e5}]).repeated(2)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result with two cycles of P and three states in each step."""
    path = tmp_path_factory.mktemp("crack") / "joint.h5"
    fastpin.save(fastpin.solve(PROBLEM, PULSES, nodes=101, between=2), path)
    return path


@pytest.mark.gate
def test_a_crack_at_a_place(stored):
    options = [*LAW, "--at", "66", "--angle", "5", "--exponent", "0.5", "-o", "a.svg", "--csv", "a.csv"]
    lines = printed("crack", stored, *options).splitlines()
    result = fastpin.load(stored)
    states = damage.cycle_states(result, result.cycles[-1])
    crack = cracks.Crack(math.radians(-24.0), math.radians(5.0))
    found = cracks.growth(states, crack, cracks.Walker(1e-10, 3.0, 0.5), 1e-4, 3e-3)
    assert lines[0] == growth_line(found)
    assert " ".join(lines[2].split()) == "length K_I largest smallest K_II range threshold growth cycles"
    assert lines[3].split() == ["mm", *["MPa", "sqrt(m)"] * 5, "nm/cycle"]
    assert lines[4].split()[:2] == ["0.1", f"{found.K_max[0] / 1e6:.4g}"]
    assert lines[-1].split()[-1] == f"{found.life:.4g}"
    assert len(lines) == 4 + 13
    rows = list(csv.DictReader(Path("a.csv").read_text().splitlines()))
    assert len(rows) == found.length.size
    assert float(rows[-1]["cycles"]) == pytest.approx(found.life)
    assert "<svg" in Path("a.svg").read_text()


@pytest.mark.gate
def test_the_fastest_crack(stored):
    place = float(printed("crack", stored, *LAW, "--threshold-range", "1e6", "--intrinsic-length", "5e-5").split()[2])
    assert 30.0 < abs(place) < 100.0


def test_a_crack_that_never_grows(stored):
    lines = printed("crack", stored, *LAW, "--at", "66", "--threshold-range", "1e9").splitlines()
    assert lines[0].endswith("no growth at 100 um")
    assert lines[-1].split()[-1] == "never"


def test_a_cycle_of_corners_alone_is_noted():
    fastpin.save(fastpin.solve(PROBLEM, PULSES, nodes=61), "joint.h5")
    words = "note: the cycle has only its 3 corners; K between the corners is unknown"
    assert words in said("crack", "joint.h5", *LAW, "--at", "66").err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--at", "north"], '--at: must be a number, not "north"'),
        (["--at", "0", "--angle", "90"], "--angle: must lie between"),
        (["--at", "0", "--m", "0"], "--m: must be positive, not 0"),
        (["--at", "0", "--last", "1e-5"], "--last: must be longer than the first length"),
        (["--at", "0", "--threshold-range", "-1"], "--threshold-range: must not be negative"),
        (["--at", "0", "--body", "seat"], '--body: "seat" is the edge of the plate round a bush'),
        (["--place", "22e-3", "0"], "--place: needs a plate of any outline"),
        (["--place", "22e-3", "up"], '--place: must be a number, not "up"'),
        (["--place", "22e-3", "0", "--at", "0"], "--place: stands in place of theta: leave one of them out"),
        (["--at", "0", "-o", "a.txt"], "--output: must"),
        (["--at", "0", "--last", "1e3"], "--last: must be at most 10000 radii of the hole"),
        (["--at", "0", "--law", "nasgro"], "--m: is no constant of the law nasgro"),
        (["--at", "0", "--law", "paris", "--exponent", "0.5"], "--exponent: is no constant of the law paris"),
        (["--at", "0", "--case", "none.toml"], "none.toml: there is no such file"),
    ],
)
def test_refusals(stored, arguments, words):
    assert words in refused("crack", stored, *LAW, *arguments)


def test_a_result_without_a_cycle():
    fastpin.save(fastpin.solve(PROBLEM, [{"P": 3e6}], nodes=61), "joint.h5")
    words = "history: has no cycle that has ended, and less than three corners; add repeat = 2 to a [[load]] block"
    assert words in refused("crack", "joint.h5", *LAW)


CASE = f"""{IN_CYCLES}[crack]
first = 1e-4
last = 1e-3
theta = 66
residual_stress = -10e6
"""


def planned(case: fastpin.Case, spectrum: bool = False) -> cracks.Growth:
    result = fastpin.solve(case.problem, case.history, nodes=61)
    states = list(result) if spectrum else damage.cycle_states(result, result.cycles[-1])
    return cracks.planned_growth(states, case.crack, spectrum)


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_case_with_a_crack_has_its_growth():
    """tests/whole/test_agreement.py holds the outputs against each other."""
    Path("case.toml").write_text(CASE)
    found = planned(fastpin.read_case("case.toml"))
    line = f"crack at 66.00 deg from the bottom: {found.words}"
    assert line in printed("run", "case.toml", "-o", "case.h5", "--json", "case.json")
    document = json.loads(Path("case.json").read_text())["crack"]
    assert document["life"] == pytest.approx(found.life, rel=1e-12)
    assert document["law"]["source"] == "own tests"
    assert (document["fate"], document["arrest"], document["angle_of_mouth"]) == ("grows", None, pytest.approx(66.0))
    assert fastpin.storage.StoredResult("case.h5").case.crack == fastpin.read_case("case.toml").crack
    assert "100 um to 1 mm, at 66 deg, walker, C = 1e-10" in printed("check", "case.toml")
    said("report", "case.h5", "-o", "page.html")
    law = "Law of growth: walker, C = 1e-10, m = 3, exponent = 0.5 (SI units); source: own tests."
    assert law in Path("page.html").read_text()


@pytest.mark.gate
def test_one_residual_stress_serves_fatigue_and_crack():
    """That of [fatigue] acts on a crack in the plate too, unless [crack] has its own."""
    Path("own.toml").write_text(CASE)
    of_fatigue = CASE.replace("residual_stress = -10e6\n", "[fatigue]\nbodies = 'plate'\nresidual_stress = -10e6\n")
    constants = "strength_exponent = -0.1, fatigue_ductility = 0.5, ductility_exponent = -0.6"
    of_fatigue = of_fatigue.replace("plate = {", f"plate = {{ fatigue = {{ fatigue_strength = 1e9, {constants} }},")
    Path("case.toml").write_text(of_fatigue)
    line = f"crack at 66.00 deg from the bottom: {planned(fastpin.read_case('own.toml')).words}"
    assert line in printed("run", "case.toml", "-o", "case.h5")
    assert line in printed("crack", "case.h5")
    assert any(
        "walker" in row and row.endswith(", with a residual stress")
        for row in printed("check", "case.toml").split("\n")
    )
    assert line not in printed("crack", "case.h5", "--at", 60)
    case = fastpin.read_case("case.toml")
    assert case.crack.residual_stress is None
    assert questions_of(case)["crack"].residual_stress == -10e6
    in_bush = replace(case.problem, plate_body=Bushing(case.problem.pair.plate, 12e-3))
    assert questions_of(replace(case, problem=in_bush))["crack"].residual_stress is None
    own = replace(case, crack=replace(case.crack, residual_stress=0.0))
    assert questions_of(own)["crack"].residual_stress == 0.0


@pytest.mark.gate
def test_options_and_another_case_replace_the_crack_of_a_result():
    Path("case.toml").write_text(CASE)
    said("run", "case.toml", "-o", "case.h5")
    case = fastpin.read_case("case.toml")
    other = replace(case.crack, last=2e-3, law=cracks.Nasgro(6e-10, 2.5, 1.0, 1.0, 1e6, 3e7), theta=None)
    Path("other.toml").write_text(case_text(replace(case, crack=other)))
    nasgro = ["--law", "nasgro", "--C", "6e-10", "--n", "2.5", "--p", "1", "--q", "1"]
    nasgro += ["--threshold-range", "1e6", "--toughness", "3e7", "--last", "2e-3"]
    expected = planned(replace(case, crack=replace(other, theta=case.crack.theta)))
    for words in (nasgro, ["--case", "other.toml", "--at", "66"]):
        line = f"{growth_line(expected)}\n"
        assert printed("crack", "case.h5", *words).startswith(line)
    Path("none.toml").write_text(CASE[: CASE.index("[crack]")])
    assert "--case: none.toml has no section [crack]" in refused("crack", "case.h5", "--case", "none.toml")


@pytest.mark.gate
def test_a_history_without_cycles_is_a_spectrum():
    Path("case.toml").write_text(CASE.replace("P = [3e6, 3e5]\nrepeat = 2", "P = [3e6, 3e5, 1.5e6, 3e5, 1.5e6, 3e5]"))
    found = planned(fastpin.read_case("case.toml"), spectrum=True)
    assert f"{growth_line(found)}\n" in printed("run", "case.toml", "-o", "case.h5")
    shown = printed("crack", "case.h5", "-o", "figure.svg")
    assert shown.startswith(f"{growth_line(found)}\n")
    assert shown.splitlines()[2].endswith("spectra")
    assert "m/spectrum" in Path("figure.svg").read_text()


def test_a_crack_that_can_not_be_followed_is_noted():
    Path("case.toml").write_text(CASE.replace("nodes = 61", 'nodes = 61\nkeep = "every 3"'))
    assert "note: no crack is followed: states: must hold all corners of the cycle" in said("run", "case.toml").err


@pytest.mark.gate
def test_json_has_the_growth_and_its_margins(stored):
    law = [*LAW, "--at", "66", "--threshold-range", "1e6", "--toughness", "5e7"]
    document = json.loads(printed("crack", stored, *law, "--csv", "a.csv", "--json", "-"))
    jsonschema.validate(document, json_schema("crack"))
    result = fastpin.load(stored)
    states = damage.cycle_states(result, result.cycles[-1])
    walker = cracks.Walker(1e-10, 3.0, threshold_range=1e6, toughness=5e7)
    found = cracks.growth(states, cracks.Crack(math.radians(-24.0)), walker, 1e-4, 3e-3)
    assert document["crack"]["words"] == found.words
    assert document["lengths"]["cycles"][-1] == pytest.approx(found.life)
    assert {len(column) for column in document["lengths"].values()} == {found.length.size}
    margins = {row["name"]: row["margin"] for row in document["margins"]}
    assert margins["fracture"] == pytest.approx(5e7 / found.K_max.max() - 1.0)
    assert margins["growth"] == pytest.approx(1e6 / found.delta_K[0] - 1.0)
    assert printed("crack", stored, *law, "--json", "a.json").startswith("crack at 66.00 deg")
    assert json.loads(Path("a.json").read_text()) == document


def test_the_place_that_a_text_names_is_a_key_of_the_case_and_an_option():
    """In millimetres, with a compliance that means nothing."""
    outline = rectangle((-22e-3, 22e-3), (-22e-3, 60e-3))
    plate = outlined(Lug(0.33, "strain", 10e-3, outline, {"top": "both"}))
    Path("lug.json").write_text(plate.to_text())
    text = """units = "mm, N, MPa"
plate = { E = 70e3, nu = 0.33 }
pin.material = "steel"
contact = { hole_radius = 10, clearance = 0.02, friction = 0.3 }
plate_body.file = "lug.json"
load = [{ P = [300, 30], repeat = 2 }]
solve.nodes = 61
crack = { first = 1, last = 2, place = [22.1, 50], law = { law = "paris", C = 1e-10, m = 3 } }
"""
    Path("case.toml").write_text(text)
    crack = fastpin.read_case("case.toml").crack
    assert crack.place == pytest.approx((22.1e-3, 50e-3))
    text_of_crack = crack_words(fastpin.read_case("case.toml").problem, crack)
    assert 'at x = 22.1 mm, y = 50 mm on the edge "right", walker' in text_of_crack
    words = 'place: must lie on an edge beyond the hole; the nearest one, "right", is 2 mm away'
    Path("case.toml").write_text(text.replace("22.1", "20"))
    assert words in refused("check", "case.toml")
