"""Outcomes of the strength of a laminate in sweeps, their faults, and envelopes of bearing and bypass."""

import math
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import assess, damage
from fastpin.report.sweep import envelopes
from fastpin.studies import read_plan, sweep
from tests.support.case_texts import LAMINATED
from tests.support.commands import printed, refused, said
from tests.support.faults import fault_of

CASE = f"""{LAMINATED}[solve]
nodes = 61
[strength]
criterion = "yamada-sun"
distance = 0.5e-3
failure = true
"""

PLAN = """case = "case.toml"
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


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(CASE)
    Path("plan.toml").write_text(PLAN)
    return tmp_path


@pytest.mark.gate
def test_a_sweep_tells_the_strength_and_draws_the_envelope(folder: Path) -> None:
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
def test_an_envelope_follows_the_force_and_the_other_fields(folder: Path) -> None:
    Path("plan.toml").write_text(
        'case = "case.toml"\n[grid]\nload.1.Q = [-1e6]\nload.1.P = [0]\nload.1.sxx = [50e6]\nload.1.syy = [-9e6]\n'
        '"plate.layup" = ["[0/90]4s", "[0/45/-45/90]2s"]\n[outcomes]\nf = { strength = "factor" }\n'
        '[labels]\n"plate.layup" = "layup"\n'
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
def test_what_an_envelope_can_not_show(folder, words, sentence):
    assert sentence in refused("sweep", "plan.toml", *words)
    assert not Path("plan").exists()


@pytest.mark.gate
def test_points_without_a_factor_are_noted(folder: Path) -> None:
    plan = PLAN.replace("[-100e6, 100e6]", "[0]")
    Path("plan.toml").write_text(plan)
    words = said("sweep", "plan.toml", "--workers", "1", "--plot", "one.svg", "--envelope", code=1).err
    assert "note: 1 of 2 points have no value in the figure" in words
    Path("plan.toml").write_text(plan.replace("[0, 1e6]", "[0]"))
    said("sweep", "plan.toml", "-o", "none", "--workers", "1", "--plot", "none.svg", "--envelope", code=1)
    assert not Path("none.svg").exists()


@pytest.mark.parametrize(
    ("old", "new", "line", "sentence"),
    [
        ('"ratio" }', '"ratios" }', 7, 'ratio: strength: must be "ratio", "angle" or "factor"'),
        ('"factor" }', '"factor", failure = true }', 6, 'factor: unknown key "failure"'),
        ('"factor" }', '"factor", distance = -1 }', 6, "factor: distance: must not be negative"),
        ("load.1.P", "strength.distance = [1e-4]\nload.1.P", 3, '"strength.distance": changes no run of a sweep; an'),
    ],
)
def test_a_fault_is_one_sentence_with_its_line(folder: Path, old: str, new: str, line: int, sentence: str) -> None:
    Path("plan.toml").write_text(PLAN.replace(old, new, 1))
    found_line, found = fault_of(read_plan, "plan.toml")
    assert found_line == line
    assert found.startswith(sentence)


@pytest.mark.survey
def test_a_tolerance_study_has_the_strength_too(folder: Path) -> None:
    Path("tolerances.toml").write_text(
        'case = "case.toml"\n[tolerances]\n"contact.clearance" = { from = 10e-6, to = 30e-6 }\n'
        '[outcomes]\nratio = { strength = "ratio" }\n'
    )
    assert "ratio" in printed("tolerances", "tolerances.toml", "--workers", "1")
