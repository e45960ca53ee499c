"""Lives and margins of stresses above yield are marked on their own lines: text, tables, JSON and pages."""

import pytest

from fastpin import MATERIALS, Case, LoadHistory, MaterialPair, Problem, Result, SolveOptions, solve
from fastpin.assess import fatigue as assessment
from fastpin.assess.crack import growth_line
from fastpin.assess.margins import in_json, margin_rows, reserve_margins
from fastpin.cracks import planned_growth
from fastpin.damage import cycle_states
from fastpin.model import CrackGrowth, FatigueAssessment
from fastpin.model.doubts import doubts_given
from fastpin.model.growth import Walker
from fastpin.pages.source import Source
from fastpin.report.summary import document as summary
from fastpin.states.margins import Margin, over_yield, over_yield_words
from fastpin.storage.held import Held

HISTORY = LoadHistory([{"P": 0.0}]) + LoadHistory([{"P": 1e6, "syy": 66e6}, {"P": 1e5, "syy": 6.6e6}]).repeated(2)
MARK = "above yield: stresses reach 3.16 times the yield strength"


@pytest.fixture(scope="module")
def result() -> Result:
    """A steel pin with an interference of 1.5 % in 2024-T3: its stress before any load is three times the strength."""
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"], "stress")
    with doubts_given():
        return solve(Problem(pair, 2.5e-3, -37.5e-6, 0.2, "body"), HISTORY, nodes=31)


@pytest.fixture(scope="module")
def case(result: Result) -> Case:
    how = FatigueAssessment(over="cycle", life=1e5, angles=(0.5, 2.0))
    return Case(result.problem, HISTORY, SolveOptions(nodes=31), fatigue=how)


@pytest.fixture(scope="module")
def assessed(case: Case, result: Result) -> assessment.Assessed:
    found = assessment.find(case, Held(result))
    assert found is not None
    assert found.reason == ""
    return found


ROWS = [
    Margin("plate: yield, von Mises", "traction", 6e8, 3e8, name="yield", owner="plate"),
    Margin("plate: ultimate, von Mises", "traction", 6e8, 4e8, name="ultimate", owner="plate"),
    Margin("bush: yield, von Mises", "traction", 1e8, 3e8, name="yield", owner="bush"),
    Margin("plate: fatigue", "ratio", 1.0, 1.6, remark="at 3 deg", name="fatigue", owner="plate"),
    Margin("bush: fatigue", "ratio", 1.0, 1.6, remark="at 4 deg", name="fatigue", owner="bush"),
]


def test_rows_of_margins_are_marked(result: Result) -> None:
    assert over_yield(ROWS) == {"plate": 2.0}
    remarks = [row[-1] for row in margin_rows(result.problem, ROWS)]
    mark = "at 3 deg; above yield: stresses reach 2 times the yield strength"
    assert remarks == ["", "", "", mark, "at 4 deg"]
    assert [row.over_yield for row in in_json(result.problem, ROWS)] == [None, None, None, 2.0, None]


def test_a_body_below_yield_has_no_mark() -> None:
    assert over_yield(ROWS[2:]) == {}
    assert over_yield_words({"plate": 2.0}, "bush") == ""


def test_lines_of_lives_are_marked(result: Result, assessed: assessment.Assessed) -> None:
    over = Source.of_result(result).over_yield
    assert over["plate"] == pytest.approx(3.16, abs=0.01)
    line = assessment.lines(assessed, over)[1]
    assert "life" in line
    assert line.endswith(f"; {MARK}")
    assert MARK not in assessment.lines(assessed, {})[1]


@pytest.mark.gate
def test_the_line_of_a_crack_is_marked(result: Result) -> None:
    how = CrackGrowth(0.1e-3, 0.5e-3, Walker(1e-11, 3.0), theta=0.0)
    found = planned_growth(cycle_states(result, result.cycles[-1]), how)
    mark = "; above yield: stresses reach 2 times the yield strength"
    assert growth_line(found, {"plate": 2.0}) == growth_line(found) + mark
    assert growth_line(found, {"pin": 2.0}) == growth_line(found)


def test_json_has_the_mark(case: Case, result: Result, assessed: assessment.Assessed) -> None:
    found = summary(case, result, found={"fatigue": assessed})
    assert found["fatigue"]["bodies"][0]["over_yield"] == pytest.approx(3.16, abs=0.01)
    marked = {row["name"]: row["over_yield"] for row in found["margins"] if row["body"] == "plate"}
    assert marked["yield"] is None
    assert marked["fatigue"] == found["fatigue"]["bodies"][0]["over_yield"]
    assert reserve_margins(assessed.reserves, assessed.how)[0].margin > 0.0  # and looks safe
