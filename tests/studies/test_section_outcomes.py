"""Outcomes of cracks and of the strength of a laminate in sweeps, their faults, and envelopes of bearing and bypass."""

import math
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import CaseFileError, assess, cracks, damage
from fastpin.cli.main import main
from fastpin.cracks import CrackFate
from fastpin.report.sweep import envelopes
from fastpin.studies import read_plan, sweep
from tests.support.case_texts import IN_CYCLES, LAMINATED
from tests.support.commands import printed, refused, said
from tests.support.faults import fault_of

CRACKED = f"""{IN_CYCLES}[crack]
first = 1e-4
last = 3e-3
theta = 66
law = {{ law = "walker", C = 1e-10, m = 3, exponent = 0.5, threshold_range = 2e6, toughness = 11e6 }}
"""

CRACK_PLAN = """case = "case.toml"
[grid]
load.1.P = [[1e5, 5e4], [2e6, 3e5], [6e6, 3e5]]
[outcomes]
fate = { crack = "fate" }
life = { crack = "life" }
short = { crack = "arrest", law = { law = "paris", C = 1e-10, m = 3, threshold_range = 2e6 }, theta = -66 }
K = { crack = "largest_K" }
theta = { crack = "theta" }
"""


STRONG = f"""{LAMINATED}[solve]
nodes = 61
[strength]
criterion = "yamada-sun"
distance = 0.5e-3
failure = true
"""

STRENGTH_PLAN = """case = "case.toml"
[grid]
load.1.P = [0, 1e6]
load.1.syy = [-100e6, 100e6]
[outcomes]
factor = { strength = "factor" }
ratio = { strength = "ratio" }
curve = { strength = "ratio", criterion = "hashin", tension = 5e-4, compression = 1e-3 }
angle = { strength = "angle" }
ply = { margin = "ply" }
"""

CRACK, STRENGTH = (CRACKED, CRACK_PLAN), (STRONG, STRENGTH_PLAN)


@pytest.fixture(autouse=True)
def _inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def write(case: str, plan: str) -> None:
    Path("case.toml").write_text(case)
    Path("plan.toml").write_text(plan)


@pytest.mark.gate
def test_a_sweep_tells_the_fate_of_cracks() -> None:
    write(CRACKED, CRACK_PLAN)
    assert main(["sweep", "plan.toml", "--workers", "1"]) == 0
    rows = sweep.rows(read_plan("plan.toml"), "plan")
    assert [row["fate"] for row in rows] == [CrackFate.NONE, CrackFate.GROWS, CrackFate.BREAKS]
    case = fastpin.read_case("case.toml")
    for row, loads in zip(rows, ([1e5, 5e4], [2e6, 3e5], [6e6, 3e5]), strict=True):
        history = fastpin.LoadHistory([{"P": each} for each in loads]).repeated(2)
        result = fastpin.solve(case.problem, history, nodes=61)
        found = cracks.planned_growth(damage.cycle_states(result, result.cycles[-1]), case.crack)
        assert row["life"] == (pytest.approx(found.life) if math.isfinite(found.life) else None)
        assert row["K"] == pytest.approx(found.K_max.max())
        assert row["theta"] == pytest.approx(66.0)
    assert rows[0]["short"] == pytest.approx(1e-4)
    assert rows[1]["short"] is None


def test_a_case_without_a_crack_leaves_the_lengths_to_the_outcome() -> None:
    write(CRACKED[: CRACKED.index("[crack]")], CRACK_PLAN)
    with pytest.raises(CaseFileError, match="fate: first is missing: give the first length of the crack, m"):
        read_plan("plan.toml")


@pytest.mark.gate
def test_a_sweep_tells_the_strength_and_draws_the_envelope() -> None:
    write(STRONG, STRENGTH_PLAN)
    words = said("sweep", "plan.toml", "--workers", "1", "--plot", "one.svg", "--envelope", code=1).out
    assert "outcome curve can't be read in 2 runs" in words
    plan = read_plan("plan.toml")
    rows = sweep.rows(plan, "plan")
    problem = fastpin.read_case("case.toml").problem
    for row in rows:
        loads = [{"P": row["load.1.P"], "syy": row["load.1.syy"]}]
        state = fastpin.solve(problem, loads, nodes=61)[-1]
        found = damage.joint_strength(state, "yamada-sun", distance=0.5e-3)
        assert row["ratio"] == pytest.approx(found.least_ratio)
        assert row["ply"] == pytest.approx(found.least_ratio - 1.0)
        assert row["angle"] == pytest.approx(math.degrees(found.angle) + 90.0)
        failing = assess.failure_load(problem, loads, "yamada-sun", distance=0.5e-3, nodes=61)
        assert row["factor"] == pytest.approx(failing.factor)
    assert rows[0]["curve"] is None
    assert rows[3]["curve"] == pytest.approx(
        damage.joint_strength(state, "hashin", tension=5e-4, compression=1e-3).least_ratio
    )
    (curve,) = envelopes(plan, rows, "factor")
    assert {*np.round(curve["bypass stress [Pa]"])} == {round(row["factor"] * row["load.1.syy"]) for row in rows}
    assert curve["bearing stress [Pa]"].max() == pytest.approx(max(row["factor"] for row in rows[2:]) * 1e6 / 6e-3)
    assert np.all(np.diff(np.arctan2(curve["bypass stress [Pa]"], curve["bearing stress [Pa]"])) > 0.0)
    drawn = Path("one.svg").read_text()
    for words in (
        "bypass stress (MPa)",
        "failure of the first ply by yamada-sun 500 µm from the edge",
        "friction coefficient",
    ):
        assert words in drawn


@pytest.mark.gate
def test_an_envelope_follows_the_force_and_the_other_fields() -> None:
    write(
        STRONG,
        'case = "case.toml"\n[grid]\nload.1.Q = [-1e6]\nload.1.P = [0]\nload.1.sxx = [50e6]\nload.1.syy = [-9e6]\n'
        '"plate.layup" = ["[0/90]4s", "[0/45/-45/90]2s"]\n[outcomes]\nf = { strength = "factor" }\n'
        '[labels]\n"plate.layup" = "layup"\n',
    )
    said("sweep", "plan.toml", "--workers", "1")
    plan = read_plan("plan.toml")
    rows = sweep.rows(plan, "plan")
    for curve, row, layup in zip(envelopes(plan, rows, "f"), rows, ("[0/90]4s", "[0/45/-45/90]2s"), strict=True):
        assert curve.parameters == {"criterion": "yamada-sun 500 um from the edge", "case": f"layup = {layup}"}
        assert curve["bypass stress [Pa]"] == pytest.approx([row["f"] * 50e6])
        assert curve["bearing stress [Pa]"] == pytest.approx([row["f"] * 1e6 / 6e-3])


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--plot", "a.png", "--envelope", "--value", "ratio"], 'must be an outcome { strength = "factor" }'),
        (["--plot", "a.png", "--envelope", "--value", "max_shear"], 'must be an outcome { strength = "factor" }'),
        (["--plot", "a.png", "--envelope", "--x", "load.1.P"], "--envelope: has axes of its own"),
        (["--envelope"], "--envelope: says what a figure shows; --plot FILE is missing"),
    ],
)
def test_what_an_envelope_can_not_show(words, sentence):
    write(STRONG, STRENGTH_PLAN)
    assert sentence in refused("sweep", "plan.toml", *words)
    assert not Path("plan").exists()


@pytest.mark.gate
def test_points_without_a_factor_are_noted() -> None:
    plan = STRENGTH_PLAN.replace("[-100e6, 100e6]", "[0]")
    write(STRONG, plan)
    words = said("sweep", "plan.toml", "--workers", "1", "--plot", "one.svg", "--envelope", code=1).err
    assert "note: 1 of 2 points have no value in the figure" in words
    Path("plan.toml").write_text(plan.replace("[0, 1e6]", "[0]"))
    said("sweep", "plan.toml", "-o", "none", "--workers", "1", "--plot", "none.svg", "--envelope", code=1)
    assert not Path("none.svg").exists()


@pytest.mark.parametrize(
    ("texts", "old", "new", "line", "sentence"),
    [
        (CRACK, '"life"', '"lief"', 6, 'life: crack: must be "fate", "life"'),
        (CRACK, '{ crack = "life" }', '{ crack = "life", fist = 3 }', 6, 'life: unknown key "fist"'),
        (
            CRACK,
            '{ crack = "life" }',
            '{ crack = "life", last = 1e-5 }',
            6,
            "life: last: must be longer than the first",
        ),
        (CRACK, "m = 3, thres", "m = 0, thres", 7, "short: m: must be positive, not 0"),
        (CRACK, "load.1.P", "crack.first = [1e-4]\nload.1.P", 3, '"crack.first": no run of a sweep grows a crack'),
        (STRENGTH, '"ratio" }', '"ratios" }', 7, 'ratio: strength: must be "ratio", "angle" or "factor"'),
        (STRENGTH, '"factor" }', '"factor", failure = true }', 6, 'factor: unknown key "failure"'),
        (STRENGTH, '"factor" }', '"factor", distance = -1 }', 6, "factor: distance: must not be negative"),
        (
            STRENGTH,
            "load.1.P",
            "strength.distance = [1e-4]\nload.1.P",
            3,
            '"strength.distance": changes no run of a sweep; an',
        ),
    ],
)
def test_a_fault_is_one_sentence_with_its_line(texts, old: str, new: str, line: int, sentence: str) -> None:
    case, plan = texts
    write(case, plan.replace(old, new, 1))
    found_line, found = fault_of(read_plan, "plan.toml")
    assert found_line == line
    assert found.startswith(sentence)


@pytest.mark.survey
def test_a_tolerance_study_has_the_strength_too() -> None:
    write(STRONG, STRENGTH_PLAN)
    Path("tolerances.toml").write_text(
        'case = "case.toml"\n[tolerances]\n"contact.clearance" = { from = 10e-6, to = 30e-6 }\n'
        '[outcomes]\nratio = { strength = "ratio" }\n'
    )
    assert "ratio" in printed("tolerances", "tolerances.toml", "--workers", "1")
