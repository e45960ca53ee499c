"""Outcomes of cracks in sweeps: what becomes of a crack, its life, and faults of their tables."""

import math
from pathlib import Path

import pytest

import fastpin
from fastpin import CaseFileError, cracks, damage
from fastpin.cli.main import main
from fastpin.cracks import CrackFate
from fastpin.studies import read_plan, sweep
from tests.support.case_texts import IN_CYCLES
from tests.support.faults import fault_of

CASE = f"""{IN_CYCLES}[crack]
first = 1e-4
last = 3e-3
theta = 66
law = {{ law = "walker", C = 1e-10, m = 3, exponent = 0.5, threshold_range = 2e6, toughness = 11e6 }}
"""

PLAN = """case = "case.toml"
[grid]
load.1.P = [[1e5, 5e4], [2e6, 3e5], [6e6, 3e5]]
[outcomes]
fate = { crack = "fate" }
life = { crack = "life" }
short = { crack = "arrest", law = { law = "paris", C = 1e-10, m = 3, threshold_range = 2e6 }, theta = -66 }
K = { crack = "largest_K" }
theta = { crack = "theta" }
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(CASE)
    Path("plan.toml").write_text(PLAN)
    return tmp_path


@pytest.mark.gate
def test_a_sweep_tells_the_fate_of_cracks(folder: Path) -> None:
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


@pytest.mark.parametrize(
    ("old", "new", "line", "sentence"),
    [
        ('"life"', '"lief"', 6, 'life: crack: must be "fate", "life"'),
        ('{ crack = "life" }', '{ crack = "life", fist = 3 }', 6, 'life: unknown key "fist"'),
        ('{ crack = "life" }', '{ crack = "life", last = 1e-5 }', 6, "life: last: must be longer than the first"),
        ("m = 3, thres", "m = 0, thres", 7, "short: m: must be positive, not 0"),
        ("load.1.P", "crack.first = [1e-4]\nload.1.P", 3, '"crack.first": no run of a sweep grows a crack'),
    ],
)
def test_a_fault_is_one_sentence_with_its_line(folder: Path, old: str, new: str, line: int, sentence: str) -> None:
    Path("plan.toml").write_text(PLAN.replace(old, new, 1))
    found_line, found = fault_of(read_plan, "plan.toml")
    assert found_line == line
    assert found.startswith(sentence)


def test_a_case_without_a_crack_leaves_the_lengths_to_the_outcome(folder: Path) -> None:
    Path("case.toml").write_text(CASE[: CASE.index("[crack]")])
    with pytest.raises(CaseFileError, match="fate: first is missing: give the first length of the crack, m"):
        read_plan("plan.toml")
